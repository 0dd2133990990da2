//! Bounds of the platform's motion in its own plane as its tilt changes.

use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::spatial::{Tilt, tilt_rotation};
use jointplay_core::virtualization::{BuiltIn, Solver};
use nalgebra::{Vector2, Vector3};

use crate::robot::{HybridRobot, PlatformModel};

/// Least tilt up to which the motion is sampled (rad); the tilt limit of the robot counts where it is larger.
const MIN_SAMPLED_TILT: f64 = 0.2;
/// Number of sampled tilts.
const RINGS: usize = 8;
/// Number of sampled directions at each tilt.
const DIRECTIONS: usize = 24;
/// Half of the step of central differences, as a slope.
const STEP: f64 = 1e-4;

/// Bounds of the platform's motion beyond the shortest rotation to its normal, as its plane's slope changes.
///
/// The slope s is the gradient of the plane's height, |s| = tan α.
/// See "Platform" in `docs/explanation/collision-guarantee.md` for the inequalities and their proof.
#[derive(Debug, Clone)]
pub(crate) enum InPlaneMotion {
    /// Bound of the planar model, in closed form.
    Planar {
        /// Σ|b̂_k||b_k| / N_0: largest twist by strain of the ball triangle.
        ratio: f64,
        /// Distance of the centroid of the base points from the base axis (m).
        balls: f64,
        /// Distance of the centroid of the sockets from the platform's origin (m).
        sockets: f64,
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
    pub(crate) twist: f64,
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
        let (balls, sockets) = (gpr.base_points(), gpr.platform().sockets());
        let mean = |of: &[Vector2<f64>; 3]| (of[0] + of[1] + of[2]) / 3.0;
        let (ball, socket) = (mean(balls), mean(sockets));
        let (mut lengths, mut along, mut across) = (0.0, 0.0, 0.0);
        for k in 0..3 {
            let (b, s) = (balls[k] - ball, sockets[k] - socket);
            lengths += b.norm() * s.norm();
            along += s.dot(&b);
            across += s.perp(&b);
        }
        let ratio = lengths / f64::hypot(along, across);
        Self::Planar { ratio, balls: ball.norm(), sockets: socket.norm() }
    }

    fn sampled(robot: &HybridRobot) -> Self {
        let height = AxisHeight(robot.gpr.working_height());
        // In-plane shift, and twist, at a slope.
        let at = |slope: Vector2<f64>| -> Option<(Vector2<f64>, f64)> {
            let tilt = Tilt::from_normal(&Vector3::new(-slope.x, -slope.y, 1.0));
            let rods = robot.gpr.inverse(tilt, height).ok()?;
            let pose = robot.model.forward(&robot.gpr, rods).ok()?;
            let from_axis = pose.base_from_platform.translation.vector - Vector3::z() * height.0;
            let flat = tilt_rotation(&pose.normal()).inverse() * from_axis;
            Some((flat.xy(), pose.twist_about_normal()))
        };
        let top = robot.gpr.limits().tilt_max.clamp(MIN_SAMPLED_TILT, 1.1);
        let mut rings = Vec::with_capacity(RINGS);
        let mut most = InPlaneRates::default();
        for ring in 1..=RINGS {
            let steep = (top * ring as f64 / RINGS as f64).tan();
            let rates: Vec<Option<InPlaneRates>> = (0..DIRECTIONS)
                .map(|direction| {
                    let angle = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
                    let slope = Vector2::new(angle.cos(), angle.sin()) * steep;
                    let (here, _) = at(slope)?;
                    let (mut shift, mut twist) = (0.0_f64, 0.0_f64);
                    for axis in [Vector2::x(), Vector2::y()] {
                        let [(before, left), (after, right)] =
                            [at(slope - axis * STEP)?, at(slope + axis * STEP)?];
                        shift = shift.hypot((after - before).norm() / (2.0 * STEP));
                        twist = twist.hypot((right - left) / (2.0 * STEP));
                    }
                    Some(InPlaneRates { shift: shift + here.norm(), twist })
                })
                .collect();
            // Between neighbours the rate exceeds the larger one by at most their difference.
            for (k, rate) in rates.iter().enumerate() {
                let next = rates[(k + 1) % DIRECTIONS].or(*rate);
                if let (Some(one), Some(other)) = (rate, next) {
                    let over = |one: f64, other: f64| one.max(other) + (one - other).abs();
                    most.shift = most.shift.max(over(one.shift, other.shift));
                    most.twist = most.twist.max(over(one.twist, other.twist));
                }
            }
            rings.push((steep, most));
        }
        Self::Sampled(rings)
    }

    /// Bounds for slopes up to a given one.
    pub(crate) fn rates(&self, steep: f64) -> InPlaneRates {
        match self {
            Self::Planar { ratio, balls, sockets } => {
                let secant = 1.0_f64.hypot(steep);
                // ‖dA/ds‖, A the stretch of the base triangle to that of the balls.
                let strain = 2.0 / 3.0_f64.sqrt() * steep / secant;
                let twist = strain * ratio;
                let shift = strain * balls + twist * sockets + secant * balls + sockets;
                InPlaneRates { shift, twist }
            }
            Self::Sampled(rings) => {
                let ring = rings.iter().find(|(reached, _)| steep <= *reached).or(rings.last());
                let Some(&(reached, rates)) = ring else { return InPlaneRates::default() };
                // Beyond the rings the rates grow in proportion.
                let more = (steep / reached).max(1.0);
                InPlaneRates { shift: rates.shift * more, twist: rates.twist * more }
            }
        }
    }
}
