//! The beginning of every mechanism file and loop closure file: kind and units.

use super::tree::Table;
use super::values::{LengthUnit, Units};
use crate::expression::AngleUnit;

/// Largest accepted text in bytes, so that reading takes limited time.
pub const MAX_BYTES: usize = 4_000_000;

/// Whether the file names another kind, which is reported; the keys of such a file are not checked.
pub(super) fn has_other_kind(top: &Table, kind: &'static str) -> bool {
    let Some(entry) = top.needed("kind") else { return false };
    let is_text = entry.is_text();
    entry.word(top.reader, "kind", &[(kind, ())]).is_none() && is_text
}

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
