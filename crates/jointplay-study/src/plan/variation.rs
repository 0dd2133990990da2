//! Values or distribution of a varied quantity.

use super::random::Stream;

/// Values or distribution of a varied quantity, in its SI unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Variation {
    /// These, each with each value of the others: a direction of the grid.
    Values(Vec<f64>),
    /// Drawn, every value of a range as likely as the others.
    Uniform {
        /// Least value.
        from: f64,
        /// Greatest value.
        to: f64,
    },
    /// Drawn from a normal distribution.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
}

impl Variation {
    /// How many values it gives to the grid: one where it is drawn.
    #[must_use]
    pub fn values(&self) -> u64 {
        match self {
            Self::Values(values) => values.len() as u64,
            Self::Uniform { .. } | Self::Normal { .. } => 1,
        }
    }

    /// Whether it is drawn.
    #[must_use]
    pub fn is_random(&self) -> bool {
        !matches!(self, Self::Values(_))
    }

    /// A value: of the grid at a place, or of a draw.
    pub(super) fn value(&self, stream: &mut Stream, place: u64, draw: u64) -> f64 {
        match self {
            // Places come from a remainder by the number of values.
            Self::Values(values) => values[place as usize],
            Self::Uniform { from, to } => from + (to - from) * stream.uniform(draw),
            Self::Normal { mean, deviation } => mean + deviation * stream.normal(draw),
        }
    }
}
