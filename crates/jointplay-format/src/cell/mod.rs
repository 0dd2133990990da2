//! Cell files, and the files of robots with arms that they name: readable TOML with a strict schema.
//!
//! The readers report all errors of a file, each with its place.

mod bodies;
mod described;
mod edit;
mod effectors;
mod entries;
mod expansion;
pub mod explain;
pub mod explain_trajectory;
mod file;
mod files;
mod frames;
mod glb;
mod mesh;
mod pose;
mod problem;
pub mod robot;
mod rules;
mod stations;
mod surface;
mod taught;
mod tree;
mod unique;

pub use edit::{Change, TaughtNoise, note_station, set_station};
pub use entries::{
    ArmEdits, EntryAdded, EntryList, NewEntry, add_entry, duplicate_entry, remove_entry,
};
pub use expansion::{Part, PartParameter, parts};
pub use file::{MAX_BYTES, expand, parameter_names, read, read_with};
pub use files::Files;
pub use mesh::MAX_MESH_BYTES;
pub use problem::{Errors, Fault, Problem};
pub use surface::MAX_TRIANGLES;
pub use taught::{inconsistent_points, inconsistent_references};

/// Example cell: a robot with two arms, two load ports, an aligner and a process station.
pub const EXAMPLE: &str = include_str!("../../cells/example.toml");
