//! Reports on violated limits of the three-rod robot.

use jointplay_core::gpr::BrokenLimit;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::explain::explain_limit;
use jointplay_format::units::{deg, mm};

/// A violated limit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct LimitReport {
    /// `rod 1`, `rod 2`, `rod 3` or `tilt`; of a mechanism, the name of a coordinate.
    pub limit: String,
    /// The value found, in `unit`.
    pub found: f64,
    /// Least allowed, in `unit`; `null` without a limit at this end.
    #[cfg_attr(feature = "schema", schema(required))]
    pub min: Option<f64>,
    /// Greatest allowed, in `unit`; `null` without a limit at this end.
    #[cfg_attr(feature = "schema", schema(required))]
    pub max: Option<f64>,
    /// `mm` or `deg`; of a mechanism, a unit of its file.
    pub unit: &'static str,
    /// Message with values and units.
    pub message: String,
}

/// Reports violated limits, with messages in units of display.
#[must_use]
pub fn limits(broken: &[BrokenLimit], units: DisplayUnits) -> Vec<LimitReport> {
    broken
        .iter()
        .map(|limit| {
            let message = explain_limit(limit, units);
            match *limit {
                BrokenLimit::Rod { limb, length, min, max } => LimitReport {
                    limit: format!("rod {limb}"),
                    found: mm(length),
                    min: Some(mm(min)),
                    max: Some(mm(max)),
                    unit: "mm",
                    message,
                },
                BrokenLimit::Tilt { angle: tilt_angle, max } => LimitReport {
                    limit: "tilt".to_owned(),
                    found: deg(tilt_angle),
                    min: Some(0.0),
                    max: Some(deg(max)),
                    unit: "deg",
                    message,
                },
            }
        })
        .collect()
}
