//! An axis: what is measured, how it is scaled, and from where to where.

/// How values are placed along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// In proportion to the value.
    #[default]
    Linear,
    /// In proportion to the decimal logarithm; values must be above 0.
    Log10,
}

/// One axis of a panel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// What is measured, with its unit: `length (mm)`.
    pub label: String,
    /// How values are placed along the axis.
    pub scale: Scale,
    /// Lower and upper end (unit of the axis); `None` fits all that the panel holds.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis that fits its values.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that fits its values.
    pub fn log10(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log10, range: None }
    }

    /// The same axis from `min` to `max` (unit of the axis); what lies outside is cut off.
    pub fn with_range(mut self, min: f64, max: f64) -> Self {
        self.range = Some((min, max));
        self
    }
}
