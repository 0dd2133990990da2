//! Studies and plans: all tests in one program, which takes a fraction of the time to build.

mod parallel;
mod plan;
mod study;
