//! Velocities and accelerations of wafers against differences of their poses.

use crate::common;

use common::{KINDS, cell, kind};
use jointplay_cell::CellError;
use jointplay_cell::robot::{AxesMotion, AxisKind, EffectorId, FrameMotion, PlatformModel, RODS};
use jointplay_cell::wafer::{Droop, DroopRow, Unreachable};
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::BuiltIn;
use nalgebra::Vector3;
use proptest::prelude::*;

/// Table rows of the size of the cantilever's deflection, few enough that hardly any reach is near a row.
fn table() -> Droop {
    let row = |reach: f64, drop: f64| DroopRow {
        reach,
        empty_drop: drop,
        empty_slope: 2.0 * drop,
        loaded_drop: 2.0 * drop,
        loaded_slope: 3.0 * drop,
        load: 0.2,
    };
    Droop::Table { rows: vec![row(0.0, 0.0), row(5.0, 0.01)] }
}

/// Rotation vector from one rotation to another that is near (rad).
fn turn(from: &Pose, to: &Pose) -> Vector3<f64> {
    let turn = (to.rotation * from.rotation.inverse()).into_inner();
    let sine = |i: usize, j: usize| 0.5 * (turn[(i, j)] - turn[(j, i)]);
    let sines = Vector3::new(sine(2, 1), sine(0, 2), sine(1, 0));
    let length = sines.norm();
    if length > 0.0 { sines * (length.asin() / length) } else { sines }
}

/// First and second derivative from five equidistant values.
fn derivatives(of: [Vector3<f64>; 5], step: f64) -> [Vector3<f64>; 2] {
    let [a, b, c, d, e] = of;
    [
        (a - b * 8.0 + d * 8.0 - e) / (12.0 * step),
        (b * 16.0 - a - c * 30.0 + d * 16.0 - e) / (12.0 * step * step),
    ]
}

proptest! {
    #[test]
    fn velocities_and_accelerations_agree_with_differences(
        number in 0..KINDS,
        lengths in prop::array::uniform3(0.15..0.3),
        (droop, polar, loaded) in (0..3, any::<bool>(), any::<bool>()),
        (azimuth, tilt_angle) in (-3.0..3.0, 0.001..0.02),
        fractions in prop::collection::vec(0.2..0.8, 12),
        rates in prop::collection::vec(-1.0..1.0, 24),
        even in any::<bool>(),
    ) {
        let mut robot = kind(number, lengths);
        let kernel = if polar { BuiltIn::Polar } else { BuiltIn::Planar };
        robot.model = PlatformModel { virtualization: kernel, ..robot.model };
        for arm in &mut robot.arms {
            arm.droop = match droop {
                0 => Droop::Rigid,
                1 => Droop::Cantilever { stiffness: 1500.0, mass_per_length: 2.5 },
                _ => table(),
            };
        }
        let cell = cell(robot);
        let axes = &cell.robot.axes;
        let mut positions: Vec<f64> =
            axes.iter().zip(&fractions).map(|(axis, by)| axis.min + by * (axis.max - axis.min)).collect();
        let rods = cell.robot.gpr.inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(0.5)).unwrap();
        positions[..RODS].copy_from_slice(&rods);
        let rate = |k: usize, most: f64| {
            let k = if even && k % 12 < RODS { k - k % 12 } else { k };
            rates[k] * most
        };
        let slides = |k: usize| axes[k].kind == AxisKind::Linear;
        let velocities: Vec<f64> =
            (0..axes.len()).map(|k| rate(k, if slides(k) { 0.2 } else { 1.0 })).collect();
        let accelerations: Vec<f64> =
            (0..axes.len()).map(|k| rate(12 + k, if slides(k) { 1.0 } else { 4.0 })).collect();
        let motion = AxesMotion {
            positions: &positions,
            velocities: &velocities,
            accelerations: &accelerations,
        };
        let at = |t: f64| -> Vec<f64> {
            let by = |k: usize| positions[k] + t * (velocities[k] + 0.5 * t * accelerations[k]);
            (0..axes.len()).map(by).collect()
        };
        for id in cell.robot.effectors() {
            let step = 1e-3;
            let poses = [-2.0, -1.0, 0.0, 1.0, 2.0]
                .map(|k| cell.wafer_pose(id, &at(k * step), loaded).unwrap());
            // Within 50 mm of the joint the rotation by the droop fades out: at that reach, to which the rigid arm has a little less or more, it is continuous, but has no second derivative.
            let joint = cell.robot.platform_and_effector(&positions, id).unwrap().0
                * nalgebra::Point3::from(cell.robot.arms[id.arm].mount);
            let is_extended =
                |pose: &Pose| (pose.translation.vector - joint.coords).xy().norm() > 0.051;
            prop_assume!(poses.iter().all(is_extended));
            let found = cell.wafer_motion(id, &motion, loaded).unwrap();
            let [velocity, acceleration] = derivatives(poses.map(|pose| pose.translation.vector), step);
            let [omega, alpha] = derivatives(poses.map(|pose| turn(&poses[2], &pose)), step);
            let near = |found: Vector3<f64>, expected: Vector3<f64>, tolerance: f64| {
                prop_assert!((found - expected).norm() < tolerance, "{} {}", found, expected);
                Ok(())
            };
            prop_assert!((found.base_from_frame.to_homogeneous() - poses[2].to_homogeneous()).norm() < 1e-12);
            near(found.velocity, velocity, 1e-7)?;
            near(found.angular_velocity, omega, 1e-6)?;
            near(found.acceleration, acceleration, 2e-5)?;
            near(found.angular_acceleration, alpha, 2e-5)?;
            if droop == 0 {
                let rigid = cell.robot.effector_motion(&motion, id).unwrap();
                prop_assert_eq!(rigid, found);
            }
        }
    }
}

#[test]
fn invalid_axis_motions_are_rejected() {
    let cell = cell(kind(0, [0.25, 0.22, 0.2]));
    let id = EffectorId { arm: 0, effector: 0 };
    let (still, there) = ([0.0; 5], [0.5, 0.5, 0.5, 0.0, 0.9]);
    let of = |velocities: &[f64], id: EffectorId| {
        let motion = AxesMotion { positions: &there, velocities, accelerations: &still };
        cell.friction_demand(id, &motion).map(|margin| margin.required)
    };
    assert_eq!(of(&still, id), Ok(0.0));
    let short = CellError::LengthMismatch { found: 4, expected: 5 };
    assert_eq!(of(&still[1..], id), Err(Unreachable::Robot(short)));
    let error = of(&[0.0, 0.0, 0.0, f64::NAN, 0.0], id).unwrap_err().to_string();
    assert!(error.contains('T'), "{error}");
    assert!(of(&still, EffectorId { arm: 1, effector: 0 }).is_err());
    let pose = cell.wafer_pose(id, &there, true).unwrap();
    let motion = AxesMotion { positions: &there, velocities: &still, accelerations: &still };
    assert_eq!(cell.wafer_motion(id, &motion, true).unwrap(), FrameMotion::still(pose));
}
