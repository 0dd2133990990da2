//! Cell files, and the files of robots with arms that they name: TOML that an engineer can read, read strictly.
//!
//! All that is wrong with a file is told at once, each with its place.

mod bodies;
mod edit;
pub mod explain;
pub mod explain_trajectory;
mod file;
mod mesh;
mod problem;
pub mod robot;
mod stations;
mod tree;

pub use edit::{Change, note_station, set_station};
pub use file::{MAX_BYTES, read};
pub use mesh::{MAX_MESH_BYTES, MAX_TRIANGLES};
pub use problem::{Fault, Problem};

/// The files that a cell names, by name: bytes, or why they cannot be had.
pub type Files<'f> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'f;

/// A cell that comes with the program: a robot with two arms between two load ports, an aligner and a process station.
pub const EXAMPLE: &str = include_str!("../../../../cells/example.toml");
