//! Bounds of the platform's motion in its own plane as its tilt changes.

use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::spatial::{Tilt, tilt_rotation};
use jointplay_core::virtualization::{BuiltIn, Solver};
use nalgebra::{Vector2, Vector3};

use crate::robot::{HybridRobot, PlatformModel};

/// Tilt up to which the motion is sampled at least (rad).
///
/// Samples extend up to the larger of this tilt and the robot's limit.
const MIN_SAMPLED_TILT: f64 = 0.2;
/// Number of sampled tilts.
const RINGS: usize = 8;
/// Number of sampled directions at each tilt.
const DIRECTIONS: usize = 24;
/// Half of the step of central differences, as a slope.
const STEP: f64 = 1e-4;

/// Bounds of the platform's motion beyond the shortest rotation to its normal, as its plane's slope changes.
///
/// The slope s is the gradient of the plane's height, |s| = tan α, α: tilt.
/// The chapter "Platform" of `docs/explanation/collision-guarantee.md` derives the inequalities.
#[derive(Debug, Clone)]
pub(crate) enum InPlaneMotion {
    /// Bound of the planar model, in closed form.
    Planar {
        /// Σ |p_k'| |b_k'| / N_0: largest rotation about the normal per strain of the triangle of ball centres.
        ///
        /// b_k', p_k': base point and socket k from the centroids of their triangles; N_0: largest Σ (U p_k') · b_k' over all rotations U.
        torsion_per_strain: f64,
        /// Distance of the centroid of the base points from the base axis (m).
        base_centroid_offset: f64,
        /// Distance of the centroid of the sockets from the platform's origin (m).
        platform_centroid_offset: f64,
    },
    /// Bounds of other models: tan α of each ring of samples, with the largest rates up to it.
    Sampled(Vec<(f64, InPlaneRates)>),
}

/// Upper bounds of the rates of in-plane motion per unit change of the plane's slope.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct InPlaneRates {
    /// Displacement of the platform's origin, without that of the plane's height on the base axis (m).
    pub(crate) shift: f64,
    /// Rotation about the normal, beyond the shortest rotation (rad).
    pub(crate) torsion: f64,
}

impl InPlaneMotion {
    pub(crate) fn new(robot: &HybridRobot) -> Self {
        let PlatformModel { virtualization, options } = robot.model;
        if virtualization == BuiltIn::Planar && options.solver == Solver::ClosedForm {
            Self::planar(&robot.gpr)
        } else {
            Self::sampled(robot)
        }
    }

    fn planar(gpr: &Gpr) -> Self {
        let (base_points, sockets) = (gpr.base_points(), gpr.platform().sockets());
        let mean = |points: &[Vector2<f64>; 3]| (points[0] + points[1] + points[2]) / 3.0;
        let (base_centroid, socket_centroid) = (mean(base_points), mean(sockets));
        let (mut lengths, mut along, mut across) = (0.0, 0.0, 0.0);
        for k in 0..3 {
            let (b, s) = (base_points[k] - base_centroid, sockets[k] - socket_centroid);
            lengths += b.norm() * s.norm();
            along += s.dot(&b);
            across += s.perp(&b);
        }
        Self::Planar {
            torsion_per_strain: lengths / f64::hypot(along, across),
            base_centroid_offset: base_centroid.norm(),
            platform_centroid_offset: socket_centroid.norm(),
        }
    }

    fn sampled(robot: &HybridRobot) -> Self {
        let height = AxisHeight(robot.gpr.working_height());
        // In-plane shift, and torsion, at a slope.
        let at = |slope: Vector2<f64>| -> Option<(Vector2<f64>, f64)> {
            let tilt = Tilt::from_normal(&Vector3::new(-slope.x, -slope.y, 1.0));
            let rods = robot.gpr.inverse(tilt, height).ok()?;
            let pose = robot.model.forward(&robot.gpr, rods).ok()?;
            let from_axis = pose.base_from_platform.translation.vector - Vector3::z() * height.0;
            let flat = tilt_rotation(&pose.normal()).inverse() * from_axis;
            Some((flat.xy(), pose.torsion()))
        };
        let top = robot.gpr.limits().tilt_max.clamp(MIN_SAMPLED_TILT, 1.1);
        let mut rings = Vec::with_capacity(RINGS);
        let mut most = InPlaneRates::default();
        for ring in 1..=RINGS {
            let slope_of_ring = (top * ring as f64 / RINGS as f64).tan();
            let rates: Vec<Option<InPlaneRates>> = (0..DIRECTIONS)
                .map(|direction| {
                    let angle = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
                    let slope = Vector2::new(angle.cos(), angle.sin()) * slope_of_ring;
                    let (here, _) = at(slope)?;
                    let (mut shift, mut torsion) = (0.0_f64, 0.0_f64);
                    for axis in [Vector2::x(), Vector2::y()] {
                        let [(before, left), (after, right)] =
                            [at(slope - axis * STEP)?, at(slope + axis * STEP)?];
                        shift = shift.hypot((after - before).norm() / (2.0 * STEP));
                        torsion = torsion.hypot((right - left) / (2.0 * STEP));
                    }
                    Some(InPlaneRates { shift: shift + here.norm(), torsion })
                })
                .collect();
            // Between neighbours the rate exceeds the larger one by at most their difference.
            for (k, rate) in rates.iter().enumerate() {
                let next = rates[(k + 1) % DIRECTIONS].or(*rate);
                if let (Some(one), Some(other)) = (rate, next) {
                    let over = |one: f64, other: f64| one.max(other) + (one - other).abs();
                    most.shift = most.shift.max(over(one.shift, other.shift));
                    most.torsion = most.torsion.max(over(one.torsion, other.torsion));
                }
            }
            rings.push((slope_of_ring, most));
        }
        Self::Sampled(rings)
    }

    /// Bounds for slopes of at most this magnitude.
    pub(crate) fn rates(&self, slope: f64) -> InPlaneRates {
        match self {
            Self::Planar { torsion_per_strain, base_centroid_offset, platform_centroid_offset } => {
                // 1 / cos α
                let secant = (1.0 + slope * slope).sqrt();
                // ‖dA/ds‖, A: stretch of the triangle of base points to that of ball centres.
                let strain = 2.0 / 3.0_f64.sqrt() * slope / secant;
                let torsion = strain * torsion_per_strain;
                let shift = strain * base_centroid_offset
                    + torsion * platform_centroid_offset
                    + secant * base_centroid_offset
                    + platform_centroid_offset;
                InPlaneRates { shift, torsion }
            }
            Self::Sampled(rings) => {
                let ring = rings.iter().find(|(reached, _)| slope <= *reached).or(rings.last());
                let Some(&(reached, rates)) = ring else { return InPlaneRates::default() };
                // Beyond the rings the rates grow in proportion.
                let more = (slope / reached).max(1.0);
                InPlaneRates { shift: rates.shift * more, torsion: rates.torsion * more }
            }
        }
    }
}
