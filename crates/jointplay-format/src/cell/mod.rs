//! Cell files, and the files of robots with arms that they name: TOML that an engineer can read, read strictly.
//!
//! All that is wrong with a file is told at once, each with its place.

pub mod explain;
mod problem;
pub mod robot;
#[expect(dead_code, reason = "files of cells will read by it")]
mod tree;

pub use problem::{Fault, Problem};
