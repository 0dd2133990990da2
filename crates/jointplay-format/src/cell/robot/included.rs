//! Robots with arms of the catalogue.

use super::words::KIND;
use crate::catalogue;

/// The names of the robots with arms in the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> {
    let of_kind = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some(KIND);
    catalogue::entries().iter().filter(of_kind).map(|entry| entry.name)
}

/// Those of them that programs with stations run on.
///
/// The arms of the others have more motors than a straight line into a station determines, and their lines are followed by a local method that mostly gets stuck: they are jogged and posed, but not offered for programs.
pub fn names_for_programs() -> impl Iterator<Item = &'static str> {
    names().filter(|name| !POSED_ONLY.contains(name))
}

/// Robots of the catalogue that are posed and jogged only.
const POSED_ONLY: [&str; 2] = ["scara-3r", "scara-4r"];
