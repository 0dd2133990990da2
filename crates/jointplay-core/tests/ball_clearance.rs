//! Clearance of the balls that poses need: against closed forms, and laws for random robots.

use jointplay_core::gpr::{AxisHeight, Gpr, Limb, Limits};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Planar, Radial, SolveOptions, Virtualization, built_in};
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;

fn needed(
    gpr: &Gpr,
    tilt: Tilt,
    virtualization: &dyn Virtualization,
) -> jointplay_core::gpr::BallClearance {
    let rods = gpr.inverse(tilt, AxisHeight(gpr.working_height())).unwrap();
    let pose = gpr.forward(rods, virtualization, &SolveOptions::default()).unwrap();
    gpr.needed_clearance(&pose, virtualization)
}

/// Half of the change of the side along the tilt, and the change of a radius, by trigonometry.
///
/// Balls stay over vertical rods: a tilt by γ stretches the in-plane distances along its direction by 1/cos γ.
#[test]
fn bounds_of_the_paper_s_robot_are_those_of_trigonometry() {
    let (gpr, radius) = (Gpr::paper(), 0.093_218);
    let angle = 1.5_f64.to_radians();
    let stretch = 1.0 / angle.cos();
    // Toward ball 1 the sides to it lengthen: each spans 3/2 R along the tilt and √3/2 R across.
    let toward_ball = needed(&gpr, Tilt { azimuth: 0.0, angle }, &Planar);
    let side = (1.5 * radius * stretch).hypot(3.0_f64.sqrt() / 2.0 * radius);
    let nominal = 3.0_f64.sqrt() * radius;
    assert!((toward_ball.lower_bound - 0.5 * (side - nominal)).abs() < 1e-15);
    // Along a side it lengthens by itself.
    let azimuth = 30.0_f64.to_radians();
    let along_side = needed(&gpr, Tilt { azimuth, angle }, &Planar);
    assert!((along_side.lower_bound - 0.5 * nominal * (stretch - 1.0)).abs() < 1e-15);
    // Known to four decimals of a micrometre from a second-order cone program over all placements.
    assert!((along_side.lower_bound * 1e6 - 27.6733).abs() < 5e-3, "{along_side:?}");
    assert!(along_side.upper_bound() >= along_side.lower_bound);
}

#[test]
fn a_verdict_needs_a_known_clearance_outside_the_bounds() {
    let tilt = Tilt { azimuth: 0.0, angle: 1.5_f64.to_radians() };
    let found = needed(&Gpr::paper(), tilt, &Radial);
    assert_eq!((found.available, found.is_sufficient()), (None, None));
    assert!(found.lower_bound < 0.9 * found.upper_bound());
    let verdict = |radius: f64| {
        let gpr = Gpr::paper().with_ball_clearance(radius).unwrap();
        assert_eq!(gpr.ball_clearance(), Some(radius));
        needed(&gpr, tilt, &Radial).is_sufficient()
    };
    assert_eq!(verdict(found.upper_bound()), Some(true));
    assert_eq!(verdict(0.99 * found.upper_bound()), None);
    assert_eq!(verdict(1.01 * found.lower_bound), None);
    assert_eq!(verdict(0.99 * found.lower_bound), Some(false));
    assert_eq!(verdict(0.0), Some(false));
    // A level platform needs none.
    let gpr = Gpr::paper().with_ball_clearance(0.0).unwrap();
    let level = needed(&gpr, Tilt::LEVEL, &Planar);
    assert!(level.upper_bound() < 1e-16, "{level:?}");
}

#[test]
fn a_clearance_that_is_no_length_is_refused() {
    for radius in [-1e-9, f64::NAN, f64::INFINITY] {
        let message = Gpr::paper().with_ball_clearance(radius).unwrap_err().to_string();
        assert!(message.contains("clearance of the balls"), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn no_placement_needs_less_than_the_lower_bound(
        radii in prop::array::uniform3(0.05..0.3_f64),
        turns in prop::array::uniform3(-0.4..0.4_f64),
        azimuth in -3.0..3.0_f64,
        angle in 0.001..0.03_f64,
        moves in prop::array::uniform6(-1.0..1.0_f64),
    ) {
        let limb = |k: usize| {
            let nominal = std::f64::consts::TAU * [0.0, 1.0, 2.0][k] / 3.0;
            Limb::under_socket(radii[k], nominal + turns[k])
        };
        let limits = Limits { rod_min: 0.2, rod_max: 0.8, tilt_max: 0.05 };
        let gpr = Gpr::new([0, 1, 2].map(limb), limits, 0.5).unwrap();
        let rods = gpr.inverse(Tilt { azimuth, angle }, AxisHeight(0.5)).unwrap();
        for virtualization in built_in() {
            let pose = gpr.forward(rods, virtualization, &SolveOptions::default()).unwrap();
            let found = gpr.needed_clearance(&pose, virtualization);
            prop_assert!(found.lower_bound <= found.upper_bound() * (1.0 + 1e-6) + 1e-14);
            // Any other placement of the rigid platform, near the pose.
            let size = found.upper_bound();
            let shift = Vector3::new(moves[0], moves[1], moves[2]) * size;
            let turn = Vector3::new(moves[3], moves[4], moves[5]) * (size / 0.1);
            let turn = Rotation3::from_scaled_axis(turn);
            let balls = gpr.ball_centers(&rods);
            let most = (0..3).map(|k| {
                let socket = Point3::from(gpr.platform().sockets()[k].push(0.0));
                let placed = turn * (pose.base_from_platform * socket).coords + shift;
                (placed - balls[k]).norm()
            });
            prop_assert!(most.fold(0.0, f64::max) >= found.lower_bound * (1.0 - 1e-9) - 1e-15);
        }
    }
}
