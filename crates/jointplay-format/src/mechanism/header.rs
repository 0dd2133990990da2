//! The beginning of every mechanism file and loop closure file: kind and units.

use super::tree::Table;
use super::values::{LengthUnit, Units};
use crate::expression::AngleUnit;

/// Largest accepted text in bytes, so that reading takes limited time.
pub const MAX_BYTES: usize = 4_000_000;

/// The units of the file.
pub(super) fn units(top: &Table) -> Option<Units> {
    let table = top.needed("units")?.table(top.reader, "`units`")?;
    let word = |key| table.needed(key);
    let length =
        word("length").and_then(|entry| entry.word(top.reader, "unit of length", &LengthUnit::ALL));
    let angle =
        word("angle").and_then(|entry| entry.word(top.reader, "unit of angle", &AngleUnit::ALL));
    table.finish();
    Some(Units { length: length?, angle: angle? })
}
