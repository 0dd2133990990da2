//! Studies and plans: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod parallel;
mod plan;
mod study;
