//! Robots with arms of the catalogue.

use super::words::KIND;
use crate::catalogue;

/// The names of the robots with arms in the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> {
    let of_kind = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some(KIND);
    catalogue::entries().iter().filter(of_kind).map(|entry| entry.name)
}

/// Names of the robots with arms in the catalogue that are offered for programs with stations.
///
/// The arms of the others have more motors than a straight line into a station determines, and the local method for such lines often fails: they are only jogged and posed.
pub fn names_for_programs() -> impl Iterator<Item = &'static str> {
    names().filter(|name| !POSED_ONLY.contains(name))
}

/// Robots of the catalogue that are posed and jogged only.
const POSED_ONLY: [&str; 2] = ["scara-3r", "scara-4r"];
