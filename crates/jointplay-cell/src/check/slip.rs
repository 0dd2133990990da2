//! Whether friction holds a wafer.

use jointplay_core::gpr::Forward;
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

use super::scene::Scene;
use crate::motion::Sample;
use crate::robot::{EffectorId, Positions, RODS};
use crate::wafer::{Support, Wafer};

/// What a wafer's effector has to hold it with, and what friction can, by mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Push {
    /// Needed along the wafer's plane; infinite where the wafer lifts off what it rests on [m/s²].
    pub(super) needed: f64,
    /// Held by friction [m/s²].
    pub(super) held: f64,
}

/// Half the step of the second difference [s]: short against what jerk does, long against round-off.
const STEP: f64 = 1e-4;

/// What has to act on a wafer that moves with its effector, by mass and in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Burden {
    /// Force [m/s²].
    force: Vector3<f64>,
    /// Moment about the middle of its resting plane [m²/s²].
    moment: Vector3<f64>,
    /// Normal of that plane, up.
    normal: Vector3<f64>,
}

/// What holds the wafer of an effector on its way.
///
/// ```text
///    |f_t|  +  |M| / (b − |c|)   ≤   µ f_n        f = g̈ + g e_b3,   c = n × m / f_n,   M = n · (m − c × f)
/// ```
/// f and m: force and moment about the middle of the resting plane that move the wafer, its turning included, by mass; f_n and f_t: along the normal n and across it.
/// c: where the pressure of the pads has its centre, M: moment about it that friction has to bear.
/// b: radius of the three points, or of the wafer on its edge, or half the distance of the rails.
///
/// # Errors
/// Those of the platform and of the droop.
///
/// # Numerics
/// `platform` and `now` are its pose and that of the wafer at the sample; its accelerations are second differences over the parabola of velocities and accelerations through the sample: off by the square of the step.
///
/// # Assumptions
/// Coulomb friction at the pads, a rigid flat wafer.
/// Sufficient, however the pads lie and the weight is spread over them; exact without a moment, and without a force along the plane.
///
/// # Source
/// own derivation, docs/theory.md
pub(super) fn push(
    scene: &Scene<'_>,
    sample: &Sample,
    effector: EffectorId,
    platform: &Forward,
    now: &Pose,
) -> Result<Push, String> {
    let cell = scene.cell;
    let still = |values: &[f64]| values.iter().all(|value| *value == 0.0);
    let around = if still(&sample.velocities) && still(&sample.accelerations) {
        [*now; 3]
    } else {
        let on_parabola = |t: f64| {
            let mut moved = Positions::new(&sample.positions);
            for (k, position) in moved.iter_mut().enumerate() {
                *position += t * (sample.velocities[k] + 0.5 * t * sample.accelerations[k]);
            }
            // While the rods stand, so does the platform.
            if moved[..RODS] == platform.rods {
                return scene.wafer(platform, effector, &moved);
            }
            let moving = cell.robot.platform(&moved).map_err(|error| error.to_string())?;
            scene.wafer(&moving, effector, &moved)
        };
        [on_parabola(-STEP)?, *now, on_parabola(STEP)?]
    };
    let described = &cell.robot.arms[effector.arm].effectors[effector.effector];
    let burden = burden(&cell.wafer, around, cell.gravity);
    Ok(gripped(&burden, &cell.wafer, &described.support, described.friction))
}

/// What moves a wafer as it goes through three poses, a step of time apart.
fn burden(wafer: &Wafer, [before, now, after]: [Pose; 3], gravity: f64) -> Burden {
    let normal = |pose: &Pose| pose.rotation.matrix().column(2).into_owned();
    let half = 0.5 * wafer.thickness;
    let middle = |pose: &Pose| pose.translation.vector + normal(pose) * half;
    let second = (middle(&after) - middle(&now)) - (middle(&now) - middle(&before));
    let force = second / (STEP * STEP) + Vector3::new(0.0, 0.0, gravity);
    let first = turned(&now.rotation, &after.rotation);
    let last = turned(&before.rotation, &now.rotation);
    let velocity = (first + last) / (2.0 * STEP);
    let acceleration = (first - last) / (STEP * STEP);
    // Of a disc, by mass: across its plane and about its normal.
    let radius = 0.5 * wafer.diameter;
    let across = 0.25 * radius * radius + wafer.thickness * wafer.thickness / 12.0;
    let about = 0.5 * radius * radius;
    let n = normal(&now);
    let swept = n * acceleration.dot(&n) + velocity.cross(&n) * velocity.dot(&n);
    let turning = acceleration * across + swept * (about - across);
    Burden { force, moment: turning + (n * half).cross(&force), normal: n }
}

/// The turn from one rotation to another that is near, as a vector in the base frame [rad].
fn turned(from: &Rotation3<f64>, to: &Rotation3<f64>) -> Vector3<f64> {
    let turn = (to * from.inverse()).into_inner();
    let twice = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    twice * 0.5
}

/// What a support needs to bear a burden, and what its friction holds.
fn gripped(burden: &Burden, wafer: &Wafer, support: &Support, friction: f64) -> Push {
    let Burden { force, moment, normal } = burden;
    let radius = 0.5 * wafer.diameter;
    // Lever of friction against turning, and how far from the middle the pressure may have its centre.
    let (lever, room) = match *support {
        Support::Edge => (radius, radius),
        Support::ThreePoints { radius } => (radius, 0.5 * radius),
        Support::TwoRails { distance } => {
            let half = 0.5 * distance;
            (half, half.min((radius * radius - half * half).max(0.0).sqrt()))
        }
    };
    let pressed = force.dot(normal);
    let along = force - normal * pressed;
    let center = normal.cross(moment) / pressed;
    let off = center.norm();
    // Nothing pulls the wafer down: pressed over the rim of its support, it lifts at the other side.
    if pressed <= 0.0 || off > room {
        return Push { needed: f64::INFINITY, held: friction * pressed.max(0.0) };
    }
    let twisting = normal.dot(&(moment - center.cross(force)));
    let turning = if twisting == 0.0 { 0.0 } else { twisting.abs() / (lever - off) };
    Push { needed: along.norm() + turning, held: friction * pressed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wafer::Material;
    use nalgebra::{Translation3, Vector2};

    const GRAVITY: f64 = 9.80665;
    const FRICTION: f64 = 0.4;
    const SUPPORTS: [Support; 3] =
        [Support::Edge, Support::ThreePoints { radius: 0.12 }, Support::TwoRails { distance: 0.2 }];
    const LEVERS: [f64; 3] = [0.15, 0.12, 0.1];

    fn wafer() -> Wafer {
        let material =
            Material { name: "silicon".into(), young: 147e9, poisson: 0.18, density: 2329.0 };
        Wafer { diameter: 0.3, thickness: 775e-6, material }
    }

    /// Level, of a force and a moment about the normal through the centre of mass.
    fn level(force: Vector2<f64>, moment: f64) -> Burden {
        let force = Vector3::new(force.x, force.y, GRAVITY);
        let half = Vector3::z() * 0.5 * wafer().thickness;
        let moment = Vector3::z() * moment + half.cross(&force);
        Burden { force, moment, normal: Vector3::z() }
    }

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    #[test]
    fn pushed_straight_turned_on_the_spot_and_tilted() {
        for (support, lever) in SUPPORTS.iter().zip(LEVERS) {
            let grip = |burden: &Burden| gripped(burden, &wafer(), support, FRICTION);
            // Friction alone holds what goes straight, wherever the pads are.
            let straight = grip(&level(Vector2::new(1.2, -0.5), 0.0));
            near(straight.needed, 1.3, 1e-12);
            near(straight.held, FRICTION * GRAVITY, 1e-12);
            // On the spot: m R²/2 α against µ m g b.
            let turn = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            let acceleration: f64 = 30.0;
            let poses = [-STEP, 0.0, STEP].map(|t| {
                Pose::from_parts(Translation3::identity(), turn(0.5 * acceleration * t * t))
            });
            let spinning = grip(&burden(&wafer(), poses, GRAVITY));
            near(spinning.needed, 0.15_f64.powi(2) / 2.0 * acceleration / lever, 1e-6);
            near(spinning.held, FRICTION * GRAVITY, 1e-6);
            // At rest on a slope: g sin α against µ g cos α.
            let lean = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.3);
            let still = [Pose::from_parts(Translation3::identity(), lean); 3];
            let resting = grip(&burden(&wafer(), still, GRAVITY));
            near(resting.needed, GRAVITY * 0.3_f64.sin(), 1e-12);
            near(resting.held, FRICTION * GRAVITY * 0.3_f64.cos(), 1e-12);
        }
    }

    #[test]
    fn away_from_the_axis_both_add_up() {
        // Round an axis 0.5 m away: r (α, ω²) for the middle, and R²/2 α about it.
        let (out, velocity, acceleration): (f64, f64, f64) = (0.5, 1.4, 3.0);
        let poses = [-STEP, 0.0, STEP].map(|t| {
            let angle = velocity * t + 0.5 * acceleration * t * t;
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            Pose::from_parts(Translation3::from(turn * Vector3::x() * out), turn)
        });
        let straight = out * acceleration.hypot(velocity * velocity);
        let turning = 0.15_f64.powi(2) / 2.0 * acceleration;
        // The centre of mass is above the pads: pressed forward by its height.
        let off = 0.5 * wafer().thickness * straight / GRAVITY;
        for (support, lever) in SUPPORTS.iter().zip(LEVERS) {
            let found = gripped(&burden(&wafer(), poses, GRAVITY), &wafer(), support, FRICTION);
            near(found.needed, straight + turning / (lever - off), 1e-6);
        }
    }

    #[test]
    fn a_wafer_that_precesses_has_the_moment_of_its_spin() {
        // ω = ω₁ e₃ + ω₂ n with the spin ω₂ and the lean fixed: the angular momentum H turns with ω₁, Ḣ = ω₁ e₃ × H.
        let (around, spin, lean) = (2.0, -5.0, 0.4);
        let at = |t: f64| {
            let z = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            z(around * t) * Rotation3::from_axis_angle(&Vector3::x_axis(), lean) * z(spin * t)
        };
        let half = 0.5 * wafer().thickness;
        let poses = [-STEP, 0.0, STEP].map(|t| {
            // About its centre of mass, so that this rests.
            let turn = at(t);
            Pose::from_parts(Translation3::from(turn * Vector3::z() * -half), turn)
        });
        let n = at(0.0) * Vector3::z();
        let omega = Vector3::z() * around + n * spin;
        let (about, across) = (0.15_f64.powi(2) / 2.0, 0.15_f64.powi(2) / 4.0);
        let across = across + wafer().thickness.powi(2) / 12.0;
        let momentum = omega * across + n * omega.dot(&n) * (about - across);
        let expected = (Vector3::z() * around).cross(&momentum);
        let found = burden(&wafer(), poses, 0.0);
        assert!((found.moment - expected).norm() < 1e-6, "{} {expected}", found.moment);
        assert!(found.force.norm() < 1e-6, "{}", found.force);
    }

    #[test]
    fn a_wafer_that_is_thrown_or_tipped_is_not_held() {
        for support in &SUPPORTS {
            let grip = |burden: &Burden| gripped(burden, &wafer(), support, 1e9);
            let mut thrown = level(Vector2::zeros(), 0.0);
            thrown.force.z = -0.1;
            assert_eq!(grip(&thrown), Push { needed: f64::INFINITY, held: 0.0 });
            let mut tipped = level(Vector2::zeros(), 0.0);
            tipped.moment.x = 0.16 * GRAVITY;
            assert_eq!(grip(&tipped).needed, f64::INFINITY);
            tipped.moment.x = 0.05 * GRAVITY;
            assert!(grip(&tipped).needed.is_finite());
        }
    }

    /// Places of pads with what each bears, by a generator of numbers from 0 to 1.
    fn pads(support: &Support, center: Vector2<f64>, mut random: impl FnMut() -> f64) -> Pads {
        let ring =
            |radius: f64, angle: f64| Vector2::new(radius * angle.cos(), radius * angle.sin());
        let third = std::f64::consts::TAU / 3.0;
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
            let direction = f64::from(k) * std::f64::consts::TAU / 60.0;
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
    fn what_is_held_does_not_slide_and_what_is_pushed_twice_as_much_does() {
        let mut state = 7_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for round in 0..240 {
            let support = &SUPPORTS[round % 3];
            let lever = LEVERS[round % 3];
            let (direction, mix) = (random() * std::f64::consts::TAU, random());
            // The same needed by all: what is left over for turning.
            let needed = 0.999 * FRICTION * GRAVITY;
            let force = Vector2::new(direction.cos(), direction.sin()) * mix * needed;
            let center = -force * (0.5 * wafer().thickness / GRAVITY);
            let moment = (1.0 - mix) * needed * (lever - center.norm());
            let found = gripped(&level(force, moment), &wafer(), support, FRICTION);
            near(found.needed, needed, 1e-9);
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
