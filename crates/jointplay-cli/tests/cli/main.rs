//! The command from outside: what it answers, what it refuses, what it writes.

mod answers;
mod desk;
mod refusals;
mod simulate;
