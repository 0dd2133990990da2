//! Friction that a wafer needs to stay on its effector.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::model::{Support, Wafer};
use crate::robot::FrameMotion;

/// Friction that a wafer needs, and friction that is available, as forces per mass of the wafer.
///
/// ```text
///    |f_t|  +  |M| / (b − |c|)   ≤   µ f_n        f = a + g e_z,   c = n × m / f_n,   M = n · (m − c × f)
/// ```
/// f and m: force per mass that the effector exerts on the wafer, and its moment about the middle of the resting plane, rotational inertia included; f_n and f_t: components of f along the normal n and perpendicular to it.
/// a: acceleration of the wafer's centre of mass; g: gravitational acceleration; e_z: upward unit vector.
/// c: centre of pressure of the pads; M: moment about it that friction has to transmit.
/// b: radius of the three points, or of the wafer on its edge, or half the distance of the rails.
///
/// # Assumptions
/// Coulomb friction at the pads, a rigid flat wafer.
/// The condition is sufficient for any position of the pads and any distribution of the weight over them.
/// It is exact for M = 0, and for f_t = 0 and c = 0; on two rails the latter holds for pads opposite to each other.
///
/// # Source
/// Own derivation, docs/explanation/wafers.md
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionDemand {
    /// Force per mass that friction has to transmit (m/s²); infinite where the wafer may lift off its support: c is outside the largest circle about the middle within the support.
    pub required: f64,
    /// Force per mass that friction can transmit (m/s²).
    pub available: f64,
}

/// Force and moment per mass that a wafer needs to move with its effector, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RequiredWrench {
    /// Force (m/s²).
    force: Vector3<f64>,
    /// Moment about the middle of its resting plane (m²/s²).
    moment: Vector3<f64>,
    /// Upward normal of the resting plane.
    normal: Vector3<f64>,
}

impl FrictionDemand {
    /// Friction demand of a moving wafer.
    pub(super) fn new(
        motion: &FrameMotion,
        wafer: &Wafer,
        support: &Support,
        friction: f64,
        gravity: f64,
    ) -> Self {
        friction_check(&required_wrench(motion, wafer, gravity), wafer, support, friction)
    }

    /// Required friction divided by the available friction; above 1 the wafer may slip.
    #[must_use]
    pub fn utilization(&self) -> f64 {
        if self.available > 0.0 { self.required / self.available } else { f64::INFINITY }
    }
}

/// Directions of force in the plane of a wafer for which friction is constrained: the polygon exceeds the circle by 2 % at its corners, and by nothing along the motion.
const DIRECTIONS: usize = 16;
/// Moment over the lever arm of friction, relative to the force, below which it is neglected.
const NEGLIGIBLE_MOMENT: f64 = 1e-3;

/// Wrenches that a wafer needs along a path, for the squared rate x = u̇² of the path parameter u: w = w₀ + w₁ x + w₂ x'.
pub(super) struct WrenchAlongPath {
    constant: RequiredWrench,
    by_rate: RequiredWrench,
    by_slope: RequiredWrench,
}

impl WrenchAlongPath {
    /// # Arguments
    /// * `[still, along, starting]` – motions at u̇ = 0; at u̇ = 1, ü = 0; and at u̇ = 0, ü = 1
    pub(super) fn new(motions: [&FrameMotion; 3], wafer: &Wafer, gravity: f64) -> Self {
        let [constant, along, starting] =
            motions.map(|motion| required_wrench(motion, wafer, gravity));
        let change = |of: &RequiredWrench, factor: f64| RequiredWrench {
            force: (of.force - constant.force) * factor,
            moment: (of.moment - constant.moment) * factor,
            normal: constant.normal,
        };
        // ü = x' / 2
        let (by_rate, by_slope) = (change(&along, 1.0), change(&starting, 0.5));
        Self { constant, by_rate, by_slope }
    }

    /// Coefficients k₀ and k₁ of constraints k₀ x + k₁ x' ≤ 1 that keep a fraction of the available friction; `None` where the wafer needs more at rest.
    ///
    /// The condition of [`FrictionDemand`] for the component of f_t in each of 16 directions and for both signs of M, the offset of the centre of pressure neglected in b − |c|.
    pub(super) fn constraints(
        &self,
        wafer: &Wafer,
        support: &Support,
        friction: f64,
    ) -> Option<Vec<[f64; 2]>> {
        let wrenches = [&self.constant, &self.by_rate, &self.by_slope];
        let normal = self.constant.normal;
        let pressed = wrenches.map(|wrench| wrench.force.dot(&normal));
        let along = wrenches.map(|wrench| wrench.force - normal * wrench.force.dot(&normal));
        let turning = wrenches.map(|wrench| wrench.moment.dot(&normal) / support.lever(wafer));
        // Along the motion, where its force is largest.
        let main = if along[2].norm() > along[1].norm() { along[2] } else { along[1] };
        let first = main.try_normalize(0.0).unwrap_or_else(|| perpendicular_to(&normal));
        let second = normal.cross(&first);
        let force = along[1].norm() + along[2].norm();
        let turns = turning[1].abs() + turning[2].abs() > NEGLIGIBLE_MOMENT * force;
        let signs: &[f64] = if turns { &[1.0, -1.0] } else { &[0.0] };
        let mut constraints = Vec::with_capacity(signs.len() * DIRECTIONS);
        for k in 0..DIRECTIONS {
            let (sin, cos) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
            let direction = first * cos + second * sin;
            for sign in signs {
                let excess = [0, 1, 2].map(|term| {
                    direction.dot(&along[term]) + sign * turning[term] - friction * pressed[term]
                });
                if excess[0] >= 0.0 {
                    return None;
                }
                constraints.push([excess[1] / -excess[0], excess[2] / -excess[0]]);
            }
        }
        Some(constraints)
    }
}

/// A unit vector perpendicular to another one.
fn perpendicular_to(normal: &Vector3<f64>) -> Vector3<f64> {
    let along = if normal.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    normal.cross(&along).normalize()
}

impl Support {
    /// Lever arm of friction against rotation (m).
    pub(crate) fn lever(&self, wafer: &Wafer) -> f64 {
        match *self {
            Self::Edge => 0.5 * wafer.diameter,
            Self::ThreePoints { radius } => radius,
            Self::TwoRails { distance } => 0.5 * distance,
        }
    }
}

/// Force and moment that accelerate a wafer.
fn required_wrench(motion: &FrameMotion, wafer: &Wafer, gravity: f64) -> RequiredWrench {
    let half = 0.5 * wafer.thickness;
    let [.., acceleration] = motion.point(&Vector3::new(0.0, 0.0, half));
    let force = acceleration + Vector3::new(0.0, 0.0, gravity);
    let FrameMotion { angular_velocity: omega, angular_acceleration: alpha, .. } = motion;
    // Moments of inertia of a disc per mass: about a diameter, and about its normal.
    let radius = 0.5 * wafer.diameter;
    let across = 0.25 * radius * radius + wafer.thickness * wafer.thickness / 12.0;
    let about = 0.5 * radius * radius;
    let n = motion.base_from_frame.rotation.matrix().column(2).into_owned();
    let swept = n * alpha.dot(&n) + omega.cross(&n) * omega.dot(&n);
    let turning = alpha * across + swept * (about - across);
    RequiredWrench { force, moment: turning + (n * half).cross(&force), normal: n }
}

/// Friction that a support needs to transmit a wrench, and friction that it has.
fn friction_check(
    wrench: &RequiredWrench,
    wafer: &Wafer,
    support: &Support,
    friction: f64,
) -> FrictionDemand {
    let RequiredWrench { force, moment, normal } = wrench;
    let radius = 0.5 * wafer.diameter;
    let lever = support.lever(wafer);
    // Largest distance of the centre of pressure from the middle.
    let room = match *support {
        Support::Edge => radius,
        Support::ThreePoints { radius } => 0.5 * radius,
        Support::TwoRails { .. } => lever.min((radius * radius - lever * lever).max(0.0).sqrt()),
    };
    let pressed = force.dot(normal);
    let along = force - normal * pressed;
    let center = normal.cross(moment) / pressed;
    let off = center.norm();
    // Pads do not pull: with the centre of pressure outside the support, the wafer lifts off at the other side.
    if pressed <= 0.0 || off > room {
        return FrictionDemand { required: f64::INFINITY, available: friction * pressed.max(0.0) };
    }
    let twisting = normal.dot(&(moment - center.cross(force)));
    let turning = if twisting == 0.0 { 0.0 } else { twisting.abs() / (lever - off) };
    FrictionDemand { required: along.norm() + turning, available: friction * pressed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wafer::Material;
    use jointplay_core::spatial::Pose;
    use nalgebra::{Rotation3, Translation3, Vector2};
    use proptest::prelude::RngExt;
    use proptest::test_runner::{RngAlgorithm, TestRng};

    const GRAVITY: f64 = 9.80665;
    const FRICTION: f64 = 0.4;
    const SUPPORTS: [Support; 3] =
        [Support::Edge, Support::ThreePoints { radius: 0.12 }, Support::TwoRails { distance: 0.2 }];
    const LEVER_ARMS: [f64; 3] = [0.15, 0.12, 0.1];

    fn wafer() -> Wafer {
        let material =
            Material { name: "silicon".into(), young: 147e9, poisson: 0.18, density: 2329.0 };
        Wafer { diameter: 0.3, thickness: 775e-6, material }
    }

    /// Level, of a force and a moment about the normal through the centre of mass.
    fn level(force: Vector2<f64>, moment: f64) -> RequiredWrench {
        let force = Vector3::new(force.x, force.y, GRAVITY);
        let half = Vector3::z() * 0.5 * wafer().thickness;
        let moment = Vector3::z() * moment + half.cross(&force);
        RequiredWrench { force, moment, normal: Vector3::z() }
    }

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    #[test]
    fn friction_of_translation_rotation_and_slope_has_closed_forms() {
        for (support, lever) in SUPPORTS.iter().zip(LEVER_ARMS) {
            let grip =
                |wrench: &RequiredWrench| friction_check(wrench, &wafer(), support, FRICTION);
            // Friction alone holds a wafer that moves straight, wherever the pads are.
            let straight = grip(&level(Vector2::new(1.2, -0.5), 0.0));
            near(straight.required, 1.3, 1e-12);
            near(straight.available, FRICTION * GRAVITY, 1e-12);
            // On the spot: m R²/2 α against µ m g b.
            let acceleration: f64 = 30.0;
            let mut turning = FrameMotion::still(Pose::identity());
            turning.angular_acceleration.z = acceleration;
            let spinning = grip(&required_wrench(&turning, &wafer(), GRAVITY));
            near(spinning.required, 0.15_f64.powi(2) / 2.0 * acceleration / lever, 1e-12);
            near(spinning.available, FRICTION * GRAVITY, 1e-12);
            // At rest on a slope: g sin α against µ g cos α.
            let tilt = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.3);
            let still = FrameMotion::still(Pose::from_parts(Translation3::identity(), tilt));
            let resting = grip(&required_wrench(&still, &wafer(), GRAVITY));
            near(resting.required, GRAVITY * 0.3_f64.sin(), 1e-12);
            near(resting.available, FRICTION * GRAVITY * 0.3_f64.cos(), 1e-12);
        }
    }

    #[test]
    fn friction_of_translation_and_rotation_adds_up() {
        // Round an axis 0.5 m away: r (α, ω²) for the middle, and R²/2 α about it.
        let (out, velocity, acceleration): (f64, f64, f64) = (0.5, 1.4, 3.0);
        let round = FrameMotion {
            base_from_frame: Translation3::new(out, 0.0, 0.0) * Rotation3::identity(),
            velocity: Vector3::y() * (out * velocity),
            acceleration: Vector3::new(-velocity * velocity, acceleration, 0.0) * out,
            angular_velocity: Vector3::z() * velocity,
            angular_acceleration: Vector3::z() * acceleration,
        };
        let straight = out * acceleration.hypot(velocity * velocity);
        let turning = 0.15_f64.powi(2) / 2.0 * acceleration;
        // The centre of mass is above the pads: pressed forward by its height.
        let off = 0.5 * wafer().thickness * straight / GRAVITY;
        for (support, lever) in SUPPORTS.iter().zip(LEVER_ARMS) {
            let found = friction_check(
                &required_wrench(&round, &wafer(), GRAVITY),
                &wafer(),
                support,
                FRICTION,
            );
            near(found.required, straight + turning / (lever - off), 1e-12);
        }
    }

    #[test]
    fn precessing_wafer_needs_the_gyroscopic_moment() {
        // ω = ω₁ e₃ + ω₂ n with the spin ω₂ and the tilt fixed: the angular momentum H turns with ω₁, Ḣ = ω₁ e₃ × H.
        let (around, spin, tilt) = (2.0, -5.0, 0.4);
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), tilt);
        let n = turn * Vector3::z();
        let omega = Vector3::z() * around + n * spin;
        let alpha = (Vector3::z() * around).cross(&(n * spin));
        // About its centre of mass, so that this rests.
        let lever = n * (-0.5 * wafer().thickness);
        let precessing = FrameMotion {
            base_from_frame: Translation3::from(lever) * turn,
            velocity: omega.cross(&lever),
            acceleration: alpha.cross(&lever) + omega.cross(&omega.cross(&lever)),
            angular_velocity: omega,
            angular_acceleration: alpha,
        };
        let (about, across) = (0.15_f64.powi(2) / 2.0, 0.15_f64.powi(2) / 4.0);
        let across = across + wafer().thickness.powi(2) / 12.0;
        let momentum = omega * across + n * omega.dot(&n) * (about - across);
        let expected = (Vector3::z() * around).cross(&momentum);
        let found = required_wrench(&precessing, &wafer(), 0.0);
        assert!((found.moment - expected).norm() < 1e-12, "{} {expected}", found.moment);
        assert!(found.force.norm() < 1e-12, "{}", found.force);
    }

    #[test]
    fn lifted_or_tipped_wafer_has_no_friction_margin() {
        for support in &SUPPORTS {
            let grip = |wrench: &RequiredWrench| friction_check(wrench, &wafer(), support, 1e9);
            let mut thrown = level(Vector2::zeros(), 0.0);
            thrown.force.z = -0.1;
            assert_eq!(grip(&thrown), FrictionDemand { required: f64::INFINITY, available: 0.0 });
            let mut tipped = level(Vector2::zeros(), 0.0);
            tipped.moment.x = 0.16 * GRAVITY;
            assert_eq!(grip(&tipped).required, f64::INFINITY);
            tipped.moment.x = 0.05 * GRAVITY;
            assert!(grip(&tipped).required.is_finite());
        }
    }

    /// Places of pads with what each bears, by a generator of numbers from 0 to 1.
    fn pads(support: &Support, center: Vector2<f64>, mut random: impl FnMut() -> f64) -> Pads {
        let ring =
            |radius: f64, angle: f64| Vector2::new(radius * angle.cos(), radius * angle.sin());
        let third = TAU / 3.0;
        match *support {
            Support::Edge | Support::ThreePoints { .. } => {
                let radius =
                    if let Support::ThreePoints { radius } = *support { radius } else { 0.15 };
                let start = random() * third;
                let points = [0.0, 1.0, 2.0].map(|k| ring(radius, start + k * third));
                let share = |at: &Vector2<f64>| {
                    GRAVITY * (1.0 / 3.0 + 2.0 / 3.0 * center.dot(at) / (radius * radius))
                };
                points.iter().map(|at| (*at, share(at))).collect()
            }
            Support::TwoRails { distance } => {
                // Two points on each rail, whose centre of pressure is at the same place along it.
                let half = 0.5 * distance;
                let chord = (0.15_f64.powi(2) - half * half).sqrt() - center.y.abs();
                let mut points = Vec::new();
                for side in [-1.0, 1.0] {
                    let load = 0.5 * GRAVITY * (1.0 + side * center.x / half);
                    let (up, down) = (random() * chord, random() * chord + 1e-6);
                    let share = down / (up + down);
                    points.push((Vector2::new(side * half, center.y + up), load * share));
                    points.push((Vector2::new(side * half, center.y - down), load * (1.0 - share)));
                }
                points
            }
        }
    }

    type Pads = Vec<(Vector2<f64>, f64)>;

    /// How much more than all friction a small slide takes, over many of them: above 0 the wafer moves.
    fn slides(pads: &Pads, force: Vector2<f64>, moment: f64, friction: f64) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        for k in 0..60 {
            let direction = f64::from(k) * TAU / 60.0;
            let velocity = Vector2::new(direction.cos(), direction.sin());
            for turn in -60..=60 {
                // Turns per metre, up to those on the spot.
                let spin = (f64::from(turn) * 0.026).tan() / 0.12;
                let work = force.dot(&velocity) + moment * spin;
                let rub: f64 = pads
                    .iter()
                    .map(|(at, load)| {
                        let slide = velocity + Vector2::new(-at.y, at.x) * spin;
                        friction * load * slide.norm()
                    })
                    .sum();
                worst = worst.max((work - rub) / (1.0 + 0.12 * spin.abs()));
            }
        }
        worst
    }

    #[test]
    fn friction_condition_is_sufficient_and_within_a_factor_of_two() {
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
        let mut random = || generator.random::<f64>();
        for round in 0..240 {
            let support = &SUPPORTS[round % 3];
            let lever = LEVER_ARMS[round % 3];
            let (direction, mix) = (random() * TAU, random());
            // The same needed by all: what is left over for turning.
            let needed = 0.999 * FRICTION * GRAVITY;
            let force = Vector2::new(direction.cos(), direction.sin()) * mix * needed;
            let center = -force * (0.5 * wafer().thickness / GRAVITY);
            let moment = (1.0 - mix) * needed * (lever - center.norm());
            let found = friction_check(&level(force, moment), &wafer(), support, FRICTION);
            near(found.required, needed, 1e-9);
            let pads = pads(support, center, &mut random);
            near(pads.iter().map(|(_, load)| load).sum(), GRAVITY, 1e-9);
            let pressed: Vector2<f64> = pads.iter().map(|(at, load)| at * *load / GRAVITY).sum();
            assert!((pressed - center).norm() < 1e-9, "{pressed} {center}");
            let held = slides(&pads, force, moment, FRICTION);
            assert!(held <= 0.0, "{support:?} {mix} {held}");
            // Points that lie at the lever: the bound is off by less than two.
            if !matches!(support, Support::TwoRails { .. }) {
                let moved = slides(&pads, force * 2.1, moment * 2.1, FRICTION);
                assert!(moved > 0.0, "{support:?} {mix} {moved}");
            }
        }
    }
}
