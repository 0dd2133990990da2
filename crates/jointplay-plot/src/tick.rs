//! Ticks of an axis with their labels.

use crate::text::{TICK, width};

/// A tick with room for a label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Position (unit of the axis).
    pub(crate) value: f64,
    /// Label; empty for none.
    pub(crate) label: String,
}

/// All ticks of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Ticks {
    /// Labelled ticks, in rising order.
    pub(crate) major: Vec<Tick>,
    /// Ticks without label (unit of the axis).
    pub(crate) minor: Vec<f64>,
    /// Common factor or offset of the labels, such as `×10⁻⁶`; empty for none.
    pub(crate) note: String,
}

impl Ticks {
    /// Width of the widest label (px).
    pub(crate) fn widest(&self) -> f64 {
        self.major.iter().map(|tick| width(&tick.label, TICK)).fold(0.0, f64::max)
    }
}
