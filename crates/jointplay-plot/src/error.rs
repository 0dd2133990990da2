//! Errors of figures and pictures.

/// Why a figure cannot be drawn; panels are numbered from 0, top to bottom.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file name with special characters of LaTeX.
    #[error(
        "{name}: the name of a figure for LaTeX can have letters, digits, spaces and - _ . + only"
    )]
    LatexName {
        /// The file name.
        name: String,
    },
    /// The figure has no panel.
    #[error("figure {title:?} has no panel: add at least one")]
    NoPanel {
        /// Title of the figure.
        title: String,
    },
    /// No curve of a panel has a point of which both coordinates are finite.
    #[error("panel {panel}: none of its {curves} curves has a finite point")]
    NoFinitePoint {
        /// Index of the panel.
        panel: usize,
        /// Number of curves in the panel.
        curves: usize,
    },
    /// The two columns of a curve have different lengths.
    #[error("panel {panel}, curve {curve:?}: {x} values of x but {y} values of y")]
    UnequalLengths {
        /// Index of the panel.
        panel: usize,
        /// Name of the curve.
        curve: String,
        /// Number of values of x.
        x: usize,
        /// Number of values of y.
        y: usize,
    },
    /// A value on a logarithmic axis is not positive.
    #[error("panel {panel}, {item}: {value:?} on the logarithmic axis {axis:?} must be above 0")]
    NotPositive {
        /// Index of the panel.
        panel: usize,
        /// What holds the value, such as `curve "residual", point 3`.
        item: String,
        /// Label of the axis.
        axis: String,
        /// The value found (unit of the axis).
        value: f64,
    },
    /// The position of a marker or a label is not finite.
    #[error("panel {panel}, {item}: position {value:?} on axis {axis:?} is not finite")]
    NotFinite {
        /// Index of the panel.
        panel: usize,
        /// What holds the value, such as `marker "singular pass"`.
        item: String,
        /// Label of the axis.
        axis: String,
        /// The value found (unit of the axis).
        value: f64,
    },
    /// A range is empty, reversed, not finite, or finer than round-off.
    #[error("panel {panel}, axis {axis:?}: cannot draw the range from {min:?} to {max:?}")]
    Range {
        /// Index of the panel.
        panel: usize,
        /// Label of the axis.
        axis: String,
        /// Lower end (unit of the axis).
        min: f64,
        /// Upper end (unit of the axis).
        max: f64,
    },
    /// Equal aspect is asked of a panel with a logarithmic axis.
    #[error("panel {panel}: equal aspect needs two linear axes, but {axis:?} is logarithmic")]
    EqualAspect {
        /// Index of the panel.
        panel: usize,
        /// Label of the logarithmic axis.
        axis: String,
    },
    /// A width, height or line width is outside what can be drawn.
    #[error("{what} is {} px, outside {min} px to {max} px", short(*.found))]
    Size {
        /// Which size, such as `width of the figure`.
        what: &'static str,
        /// The size found (px).
        found: f64,
        /// Least size that can be drawn (px).
        min: f64,
        /// Greatest size that can be drawn (px).
        max: f64,
    },
    /// The text of a figure would be too small or too large.
    #[error("text scale is {}, but has to lie from {min} to {max}", short(*.found))]
    TextScale {
        /// The factor found.
        found: f64,
        /// Least factor.
        min: f64,
        /// Greatest factor.
        max: f64,
    },
    /// A name that cannot be that of a font family.
    #[error(
        "invalid font family {family:?}: expected a name of letters, digits, spaces and hyphens"
    )]
    Font {
        /// The name.
        family: String,
    },
    /// The coordinates are not a configuration of the mechanism.
    #[error(transparent)]
    Coordinates(Box<jointplay_core::Error>),
    /// A label for a name that no joint, virtual joint or link has.
    #[error("a label is given for {name:?}, but no joint, virtual joint or link has this name")]
    NoSuchName {
        /// The name.
        name: String,
    },
    /// The position of a joint is not finite.
    #[error("joint {joint:?} cannot be drawn: its position is not finite")]
    Unplaced {
        /// The joint.
        joint: String,
    },
    /// A cell or a trajectory with an extent that is zero or not finite.
    #[error("{what} cannot be drawn: its extent is {found:e} {unit}")]
    Extent {
        /// The object to be drawn.
        what: String,
        /// Its extent, in `unit`.
        found: f64,
        /// `m` or `s`.
        unit: &'static str,
    },
    /// The figure cannot be rendered as PNG or PDF.
    #[error("cannot render the figure: {reason}")]
    Paint {
        /// Message of the renderer.
        reason: String,
    },
}

impl From<jointplay_core::Error> for Error {
    fn from(error: jointplay_core::Error) -> Self {
        Self::Coordinates(Box::new(error))
    }
}

/// A number without hundreds of digits.
fn short(number: f64) -> String {
    if number.abs() < 1e16 { number.to_string() } else { format!("{number:e}") }
}
