//! Causes of violations and their remedies, compared with depths in closed form.

use crate::common;

use common::A;
use jointplay_cell::EntityId;
use jointplay_cell::check::{
    CheckOptions, Report, ViolationKind, bodies_in_zones, check, group_violations, remedies,
};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::{Phase, Step};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::{Body, Cell, ParentFrame, Zone, ZoneRule};
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

const BENT: f64 = 0.9;
const CLEARANCE: f64 = 3e-3;

/// A radial arm that carries a wafer, level and without droop, past nothing.
fn cell() -> Cell {
    let mut robot = common::kind(0, [0.25, 0.22, 0.2]);
    robot.arms[0].effectors[0].friction = 1.0;
    Cell { clearance: CLEARANCE, ..common::cell(robot) }
}

/// T from 0 to 1.2 rad in line 10, and back in line 11.
fn there_and_back(cell: &Cell) -> Trajectory {
    let step = |instruction: usize, from: f64, to: f64| {
        let [from, to] = [from, to].map(|turn| [0.5, 0.5, 0.5, turn, BENT]);
        Step { phase: Phase::Turn, ..common::step(instruction, &from, &to) }
    };
    let steps = vec![step(0, 0.0, 1.2), step(1, 1.2, 0.0)];
    plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap()
}

/// A post under the middle of the path, whose top is at this distance below the wafer; above its lower face for negative distances.
fn with_post(gap: f64) -> Cell {
    let mut cell = cell();
    let wafer = cell.wafer_pose(A, &[0.5, 0.5, 0.5, 0.6, BENT], true).unwrap();
    let half = 0.05;
    let center = wafer.translation.vector - Vector3::z() * (gap + half);
    cell.bodies.push(Body {
        name: "post".into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(center.into(), Rotation3::identity()),
        shape: Shape::Box { half: [0.01, 0.01, half] },
        station: None,
    });
    cell
}

fn checked(cell: &Cell) -> (Trajectory, Report) {
    let motion = there_and_back(cell);
    let report = check(cell, &motion, &CheckOptions::default());
    (motion, report)
}

#[test]
fn a_post_is_lowered_by_its_depth_and_the_clearance() {
    for (gap, lowered) in [(1.4e-3, 1.6e-3), (-0.1e-3, 3.1e-3)] {
        let cell = with_post(gap);
        let (motion, report) = checked(&cell);
        let options = CheckOptions::default();
        let found = remedies(&cell, &motion, &options, &report, &|| false).unwrap();
        let [remedy] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(remedy.entity, EntityId::Body(0));
        assert_eq!(remedy.violations, report.violations.len());
        let [x, y, z] = remedy.translation;
        assert_eq!([x, y], [0.0, 0.0]);
        assert!((z + lowered).abs() < 1e-9, "{z} for {lowered}");
        let mut moved = cell.clone();
        moved.bodies[0].parent_from_shape.translation.vector.z += z;
        assert!(checked(&moved).1.violations.is_empty());
        // Less by one increment does not suffice.
        moved.bodies[0].parent_from_shape.translation.vector.z += 1e-4;
        assert!(!checked(&moved).1.violations.is_empty());
    }
}

#[test]
fn a_pair_is_one_cause_with_its_instructions_and_its_depth() {
    let cell = with_post(-0.1e-3);
    let (motion, report) = checked(&cell);
    let groups = group_violations(&motion.steps, &report.violations);
    let [group] = groups.as_slice() else { panic!("{groups:?}") };
    let worst = &report.violations[group.worst];
    assert_eq!(worst.kind, ViolationKind::Collision);
    // The depth is the wafer's in the post, sideways or upward, and the clearance is added.
    assert!((worst.excess() - (0.1e-3 + CLEARANCE)).abs() < 1e-5, "{}", worst.excess());
    assert_eq!(worst.limit, CLEARANCE);
    let lines: Vec<(usize, usize)> =
        group.occurrences.iter().map(|one| (one.place.line, one.count)).collect();
    assert_eq!(lines, [(10, 1), (11, 1)]);
    assert_eq!(group.wafers.len(), 1);
    assert_eq!(group.first(), 0);
}

#[test]
fn a_clearance_is_kept_to_ten_nanometres() {
    assert!(checked(&with_post(2.999_999_9e-3)).1.violations.is_empty());
    assert!(!checked(&with_post(2.999_98e-3)).1.violations.is_empty());
}

#[test]
fn a_fixed_body_in_a_keep_out_zone_is_listed_with_its_depth() {
    let mut cell = cell();
    let block = |name: &str, x: f64| Body {
        name: name.into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(
            Vector3::new(x, 2.0, 0.0).into(),
            Rotation3::identity(),
        ),
        shape: Shape::Box { half: [0.1; 3] },
        station: None,
    };
    cell.bodies = vec![block("far", 5.0), block("door", 2.0), block("hand", 2.0)];
    cell.bodies[2].parent = ParentFrame::Platform;
    cell.zones.push(Zone {
        name: "gap".into(),
        rule: ZoneRule::KeepOut,
        base_from_shape: Pose::from_parts(
            Vector3::new(2.17, 2.0, 0.0).into(),
            Rotation3::identity(),
        ),
        shape: Shape::Box { half: [0.1; 3] },
    });
    let found = bodies_in_zones(&cell);
    let [found] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((found.body, found.zone), (1, 0));
    assert!((found.depth - 0.03).abs() < 1e-6, "{}", found.depth);
}

#[test]
fn a_keep_out_zone_is_lowered_by_its_depth() {
    let mut cell = with_post(-2.5e-3);
    let post = cell.bodies.remove(0);
    cell.zones.push(Zone {
        name: "door".into(),
        rule: ZoneRule::KeepOut,
        base_from_shape: post.parent_from_shape,
        shape: post.shape,
    });
    let (motion, report) = checked(&cell);
    let excess = report.violations.iter().map(|one| one.excess()).fold(0.0, f64::max);
    assert!(excess > 2.4e-3, "{excess}");
    let found = remedies(&cell, &motion, &CheckOptions::default(), &report, &|| false).unwrap();
    let [remedy] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(remedy.entity, EntityId::Zone(0));
    assert!((remedy.translation[2] + 2.6e-3).abs() < 1e-4 + 1e-9, "{:?}", remedy.translation);
}
