//! Robots with arms of the catalogue.

use super::words::KIND;
use crate::catalogue;

/// The names of the robots with arms in the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> {
    let of_kind = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some(KIND);
    catalogue::entries().iter().filter(of_kind).map(|entry| entry.name)
}
