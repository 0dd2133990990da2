//! Numbers in the unit of their column.

use jointplay_format::units::Unit;

/// A number of a table, in the unit of its column.
#[inline]
pub(super) fn value_in_table(value: f64, unit: Unit, typed: bool) -> f64 {
    if typed { unit.of_typed(value) } else { unit.of(value) }
}
