//! Poses of the paper's robot, by degrees and at its working height.

use jointplay::gpr::{AxisHeight, Gpr, PlatformPose};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{
    Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};

/// Socket radius of the paper's robot (m).
pub const RADIUS: f64 = 0.093218;

/// Axis height in the paper's study (m).
pub const HEIGHT: AxisHeight = AxisHeight(0.5);

/// The four virtualizations, in the order of a legend.
pub const MODELS: [&dyn Virtualization; 4] = [&Radial, &Polar, &Offset, &Planar];

/// A tilt from azimuth and tilt angle in degrees.
#[must_use]
pub fn tilt(azimuth_deg: f64, tilt_deg: f64) -> Tilt {
    Tilt { azimuth: azimuth_deg.to_radians(), angle: tilt_deg.to_radians() }
}

/// Options with this solver and metric.
#[must_use]
pub fn options(solver: Solver, metric: Metric) -> SolveOptions {
    SolveOptions { solver, metric, ..SolveOptions::default() }
}

/// The pose of the paper's robot at a tilt in degrees.
///
/// # Panics
/// If there is none, which no case here means to show.
#[must_use]
pub fn pose(
    virtualization: &dyn Virtualization,
    solver: Solver,
    metric: Metric,
    azimuth_deg: f64,
    tilt_deg: f64,
) -> PlatformPose {
    let gpr = Gpr::paper().without_limit_checks();
    let rods = gpr.inverse(tilt(azimuth_deg, tilt_deg), HEIGHT).expect("a tilt angle below 90°");
    gpr.forward(rods, virtualization, &options(solver, metric)).expect("a pose near level")
}

/// Azimuths every 10° from 0° to 350° (deg).
pub fn azimuths_deg() -> impl Iterator<Item = f64> {
    (0..36).map(|i| 10.0 * f64::from(i))
}
