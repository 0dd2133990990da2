//! Cells: programs, motions and checks: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod check;
mod common;
mod compensation;
mod inverse;
mod raised_steps;
mod reach;
mod remedies;
mod schedule;
mod slides;
mod teach;
mod trajectory;
mod wafer_acceleration;
