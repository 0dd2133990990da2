//! Comparison of all models over a range of tilts.

use jointplay_core::gpr::{AxisHeight, BrokenLimit, Gpr};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{SolveOptions, Virtualization};
use nalgebra::Vector2;

use crate::Error;

/// Results of one model over the tilts.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCurve {
    /// Name of the virtualization.
    pub name: String,
    /// Offset of O_p from the base axis, e_b1 and e_b2 (m).
    pub center_shift: Vec<Vector2<f64>>,
    /// The farthest that a socket is moved from its nominal place in the platform (m).
    pub largest_displacement: Vec<f64>,
    /// Why the columns end before the last tilt angle, where the model has no answer there.
    pub failure: Option<Box<jointplay_core::Error>>,
}

/// All models and the approximate one over the same tilts.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Azimuth of all tilts (rad).
    pub azimuth: f64,
    /// Axis height of all tilts.
    pub height: AxisHeight,
    /// The tilt angles (rad).
    pub tilt_angles: Vec<f64>,
    /// One curve for each virtualization; their displacements are distances in the platform, the same measure for all.
    pub models: Vec<ModelCurve>,
    /// The farthest that a socket of the approximate model is off its ball (m); its centre never shifts.
    pub approximate_gap: Vec<f64>,
}

/// Computes every model at every tilt angle.
///
/// A model that cannot be solved at some tilt angle ends there with its error; the others continue.
///
/// # Errors
/// [`Error::Empty`]; [`Error::Pose`] with the first pose that cannot be computed.
pub fn compare(
    gpr: &Gpr,
    virtualizations: &[&dyn Virtualization],
    azimuth: f64,
    tilt_angles: &[f64],
    height: AxisHeight,
    options: &SolveOptions,
) -> Result<Comparison, Error> {
    if tilt_angles.is_empty() {
        return Err(Error::Empty { azimuths: 1, tilt_angles: 0 });
    }
    let failed = |sample: usize| {
        move |source| Error::pose(sample, Tilt { azimuth, angle: tilt_angles[sample] }, source)
    };
    let mut models = Vec::with_capacity(virtualizations.len());
    for virtualization in virtualizations {
        let mut curve = ModelCurve {
            name: virtualization.name().to_owned(),
            center_shift: Vec::with_capacity(tilt_angles.len()),
            largest_displacement: Vec::with_capacity(tilt_angles.len()),
            failure: None,
        };
        for (sample, &tilt_angle) in tilt_angles.iter().enumerate() {
            let rods =
                gpr.inverse(Tilt { azimuth, angle: tilt_angle }, height).map_err(failed(sample))?;
            let pose = match gpr.forward(rods, *virtualization, options) {
                Ok(pose) => pose,
                Err(
                    error @ (jointplay_core::Error::NotConverged(_)
                    | jointplay_core::Error::DependentSides { .. }
                    | jointplay_core::Error::TurnedOver { .. }),
                ) => {
                    curve.failure = Some(Box::new(error));
                    break;
                }
                Err(error) => return Err(failed(sample)(error)),
            };
            let sockets = virtualization.sockets(gpr.platform(), &pose.solution.virtual_joints);
            let nominal = gpr.platform().sockets();
            let moved = (0..3).map(|k| (sockets[k] - nominal[k]).norm());
            curve.center_shift.push(pose.center_shift());
            curve.largest_displacement.push(moved.fold(0.0, f64::max));
        }
        models.push(curve);
    }
    let approximate_gap = tilt_angles
        .iter()
        .enumerate()
        .map(|(sample, &tilt_angle)| {
            let approximate = gpr
                .approximate(Tilt { azimuth, angle: tilt_angle }, height)
                .map_err(failed(sample))?;
            Ok(approximate.gaps.iter().map(|gap| gap.norm()).fold(0.0, f64::max))
        })
        .collect::<Result<_, Error>>()?;
    Ok(Comparison { azimuth, height, tilt_angles: tilt_angles.to_vec(), models, approximate_gap })
}

/// Limits that a range of tilts at one azimuth and one axis height breaks, each once.
///
/// Rods are monotonic in the tilt angle, so that the two ends of the range break every limit that a tilt between them breaks; the values are those at the ends.
///
/// # Errors
/// Those of [`Gpr::inverse`] at an end of the range; a robot with limit checks refuses a tilt beyond its limits.
pub fn broken_limits(
    gpr: &Gpr,
    azimuth: f64,
    tilt_angles: &[f64],
    height: AxisHeight,
) -> Result<Vec<BrokenLimit>, jointplay_core::Error> {
    let angles = || tilt_angles.iter().copied();
    let ends = [angles().reduce(f64::min), angles().reduce(f64::max)];
    let mut all = Vec::new();
    for angle in ends.into_iter().flatten() {
        let tilt = Tilt { azimuth, angle };
        let rods = gpr.inverse(tilt, height)?;
        for limit in gpr.limits().broken(&rods, tilt).iter() {
            if !all.contains(&limit) {
                all.push(limit);
            }
        }
    }
    Ok(all)
}
