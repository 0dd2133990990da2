//! Values of a column, in its unit.

#[cfg(feature = "parquet")]
use jointplay_format::study::{Column, Source};
use jointplay_format::units::Unit;
#[cfg(feature = "parquet")]
use jointplay_study::plan::Block;

/// A number of a table, in the unit of its column.
#[inline]
pub(super) fn value_in_table(value: f64, unit: Unit, typed: bool) -> f64 {
    if typed { unit.typed_from_si(value) } else { unit.from_si(value) }
}

/// Values of a column of some samples.
#[cfg(feature = "parquet")]
pub(super) enum Values {
    /// Numbers of samples or draws.
    Counts(Vec<i64>),
    /// Numbers in the unit of the column, NaN without an answer.
    Numbers(Vec<f64>),
    /// Status of each sample.
    Words(Vec<&'static str>),
}

/// Values of a column of a block.
#[cfg(feature = "parquet")]
pub(super) fn values(column: &Column, block: &Block) -> Values {
    let signed = |counts: &[u64]| counts.iter().map(|&count| count.cast_signed()).collect();
    match column.source {
        Source::Sample => Values::Counts(signed(&block.samples)),
        Source::Draw => Values::Counts(signed(&block.draws)),
        Source::Number { index, unit, typed, .. } => {
            let values = block.columns[index].iter();
            Values::Numbers(values.map(|&value| value_in_table(value, unit, typed)).collect())
        }
        Source::Status { model } => {
            Values::Words(block.outcomes[model].iter().map(|outcome| outcome.name()).collect())
        }
    }
}
