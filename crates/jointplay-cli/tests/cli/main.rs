//! The command from outside: what it answers, what it refuses, what it writes.

#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod answers;
mod cell;
mod command;
mod desk;
mod documents;
mod draw;
mod import;
mod mechanism;
mod page;
mod refusals;
mod simulate;
#[cfg(all(feature = "studio", unix))]
mod studio;
mod study;
#[cfg(unix)]
mod study_interrupted;
