//! Values of the paper, closed forms and other programs: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod catalogue;
mod closed_forms;
mod documents;
mod errata;
mod golden;
mod hybrid;
mod imported;
mod linkages;
mod many_positions;
mod near;
mod paper;
mod sag;
mod teach;
