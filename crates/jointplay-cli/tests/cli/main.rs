//! The command from outside: what it answers, what it refuses, what it writes.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod answers;
mod cell;
mod cell_parameters;
mod command;
mod documents;
mod draw;
mod export;
mod import;
mod mechanism;
mod motion;
mod page;
mod refusals;
mod report;
mod sandbox;
mod serve;
mod simulate;
#[cfg(all(feature = "studio", unix))]
mod studio;
mod study;
mod study_cell;
#[cfg(unix)]
mod study_interrupted;
mod study_parts;
