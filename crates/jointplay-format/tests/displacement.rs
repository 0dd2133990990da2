//! Displacements of wafers in the example cell: sums, closed forms, and first-order effects against recomputation.

use jointplay_cell::displacement::{Cause, Contribution, Tolerances, parameter_effects};
use jointplay_cell::robot::EffectorId;
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Tilt;
use jointplay_format::cell::{EXAMPLE, read};
use nalgebra::Vector3;

const A: EffectorId = EffectorId { arm: 0, effector: 0 };

fn example() -> Cell {
    read(EXAMPLE, &mut |_| Err("no files".to_owned())).unwrap()
}

fn all_tolerances(size: f64) -> Tolerances {
    let some = Some(size);
    Tolerances {
        guide: some,
        socket: some,
        rod_zero: some,
        mount: some,
        link: some,
        joint_zero: some,
        linear_resolution: some,
        rotary_resolution: some,
        droop_share: Some(0.1),
        sag_share: Some(0.1),
    }
}

#[test]
fn shifts_add_up_and_the_lever_has_its_closed_form() {
    let cell = example();
    for tilt_angle in [0.0, 0.6_f64, 1.2] {
        for azimuth in [0.0, 1.0, 4.0] {
            let tilt = Tilt { azimuth, angle: tilt_angle.to_radians() };
            let wafer = cell.wafer_over_tilt(A, tilt, Some([0.0, 0.65])).unwrap();
            let found = cell.wafer_displacement(&wafer, &Tolerances::default()).unwrap();
            let sum: Vector3<f64> = found.shifts.iter().map(|one| one.shift).sum();
            assert!((sum - found.total).norm() < 1e-15);
            assert!((found.tilt.angle - tilt.angle).abs() < 1e-12);
            let lever = found.shifts.iter().find(|one| one.cause == Cause::Lever).unwrap();
            // About the horizontal axis across the tilt: h sin α along it, less what the cosine shortens of the reach.
            let along = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
            let radius = Vector3::new(0.0, 0.65, 0.0).dot(&along);
            let (sin, cos) = tilt.angle.sin_cos();
            let expected = found.lever * sin - radius * (1.0 - cos);
            assert!((lever.shift.dot(&along) - expected).abs() < 1e-12, "{expected}");
            let down = -radius * sin - found.lever * (1.0 - cos);
            assert!((lever.shift.z - down).abs() < 1e-12, "{down}");
        }
    }
}

#[test]
fn first_order_effects_agree_with_recomputation_of_perturbed_robots() {
    let cell = example();
    for (station, slot) in [(0, 3), (1, 25), (3, 1)] {
        let wafer = cell.wafer_in_slot(A, SlotId { station, slot }).unwrap();
        let tolerances = all_tolerances(1e-5);
        let effects = parameter_effects(&cell, A, &wafer.positions, &tolerances).unwrap();
        let nominal = cell.wafer_pose(A, &wafer.positions, true).unwrap().translation.vector;
        let effect = |name: &str| effects.iter().find(|one| one.parameter == name).unwrap().effect;
        // All deviations at once: links, mounts, zeros and axes of a perturbed robot.
        let size = 2e-6;
        let mut changed = cell.clone();
        let arm = &mut changed.robot.arms[0];
        let mut expected = Vector3::zeros();
        for (axis, name) in ["mount x", "mount y", "mount z"].into_iter().enumerate() {
            arm.mount[axis] += size;
            expected += effect(name) * size;
        }
        for joint in 0..arm.joints.len() - 1 {
            arm.joints[joint].length -= size;
            arm.joints[joint].rise += size;
            arm.joints[joint].zero += size;
            expected += (effect(&format!("rise of link {}", joint + 1))
                - effect(&format!("length of link {}", joint + 1))
                + effect(&format!("zero of joint {}", joint + 1)))
                * size;
        }
        let mut positions = wafer.positions.clone();
        positions[1] += size;
        expected += effect("zero of q2") * size;
        let found = changed.wafer_pose(A, &positions, true).unwrap().translation.vector - nominal;
        assert!((found - expected).norm() < 1e-4 * expected.norm(), "{found} {expected}");
        // The zero of the first joint turns the wafer about it; its rise lifts it along the normal.
        let links = cell.robot.forward(&wafer.positions).unwrap();
        let joint = links.base_from_link[0][0];
        let rigid = links.base_from_wafer[0][0].translation.vector;
        let turned = (joint.rotation * Vector3::z()).cross(&(rigid - joint.translation.vector));
        assert!((effect("zero of joint 1") - turned).norm() < 2e-3 * turned.norm());
        assert!((effect("rise of link 1") - joint.rotation * Vector3::z()).norm() < 1e-3);
        // The position of an axis and its zero are the same.
        assert_eq!(effect("zero of q1"), effect("resolution of q1"));
    }
}

#[test]
fn guides_and_sockets_of_a_perturbed_platform_agree_with_their_effects() {
    let cell = example();
    let wafer = cell.wafer_in_slot(A, SlotId { station: 1, slot: 1 }).unwrap();
    let effects = parameter_effects(&cell, A, &wafer.positions, &all_tolerances(1e-5)).unwrap();
    let nominal = cell.wafer_pose(A, &wafer.positions, true).unwrap().translation.vector;
    let effect = |name: &str| effects.iter().find(|one| one.parameter == name).unwrap().effect;
    let size = 3e-5;
    let mut limbs = cell.robot.gpr.limbs();
    limbs[0].base_point.x += size;
    limbs[2].socket_radius -= size;
    limbs[1].socket_angle += size / limbs[1].socket_radius;
    let expected = (effect("guide 1 x") - effect("socket 3 radially")
        + effect("socket 2 tangentially"))
        * size;
    let mut changed = cell.clone();
    let gpr = &cell.robot.gpr;
    changed.robot.gpr =
        jointplay_core::gpr::Gpr::new(limbs, *gpr.limits(), gpr.working_height()).unwrap();
    let found = changed.wafer_pose(A, &wafer.positions, true).unwrap().translation.vector - nominal;
    assert!((found - expected).norm() < 1e-3 * expected.norm(), "{found} {expected}");
    // Guides and sockets that move alike translate the whole robot.
    let all: Vector3<f64> = (1..=3).map(|k| effect(&format!("guide {k} x"))).sum();
    assert!((all.xy() - Vector3::x().xy()).norm() < 1e-3, "{all}");
}

#[test]
fn bounds_combine_all_contributions() {
    let cell = example();
    let slot = SlotId { station: 3, slot: 1 };
    let wafer = cell.wafer_in_slot(A, slot).unwrap();
    let found = cell.wafer_displacement(&wafer, &all_tolerances(1e-5)).unwrap();
    // The plane of the station is taught, its centre and heading are nominal.
    assert_eq!(found.unknown, [Cause::Station]);
    let linear_sum = Contribution::linear_sum(&found.contributions);
    let expanded = Contribution::expanded_sum(&found.contributions, cell.coverage_factor);
    assert!(expanded.horizontal < linear_sum.horizontal && expanded.vertical < linear_sum.vertical);
    let largest = found.contributions.iter().map(|one| one.expanded(2.0).horizontal);
    assert!(expanded.horizontal >= largest.fold(0.0, f64::max));
    // Droop and sag are compensated.
    let compensation = found.contributions.iter().find(|one| one.cause == Cause::Compensation);
    assert!(compensation.unwrap().linear_sum.horizontal < 1e-9);
    let station = found.contributions.iter().find(|one| one.cause == Cause::Station).unwrap();
    let known = &cell.stations[3].uncertainty;
    let [_, height] = known.lateral_and_height(&cell.stations[3].slot_position(1));
    assert!((station.expanded(2.0).vertical - 2.0 * height).abs() < 1e-7);
    // Without tolerances, each cause that has some is listed.
    let found = cell.wafer_displacement(&wafer, &Tolerances::default()).unwrap();
    let unknown = [
        Cause::AxisResolution,
        Cause::PlatformTolerances,
        Cause::ArmTolerances,
        Cause::Droop,
        Cause::Sag,
        Cause::Station,
    ];
    assert_eq!(found.unknown, unknown);
}
