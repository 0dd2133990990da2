//! Robots with arms: another program puts their links and wafers to the same places, and the inverse finds the positions that it was given.
//!
//! Provenance and the reason for the tolerance: `validation/golden/README.md`.

use std::collections::BTreeMap;

use jointplay::cell::robot::{HybridRobot, WaferTarget};
use jointplay::format::catalogue;
use jointplay::format::cell::robot;
use jointplay::format::units::m_from_mm;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::{Pose, tilt_rotation};
use jointplay_validation::{Row, golden};

/// Of positions (m) and of entries of rotation matrices.
const TOLERANCE: f64 = 1e-12;

type Sample = (HybridRobot, Vec<f64>, Vec<Row>);

fn samples() -> BTreeMap<(String, String), Sample> {
    let mut samples: BTreeMap<(String, String), Sample> = BTreeMap::new();
    let key = |row: &Row| (row.text("robot").to_owned(), row.text("sample").to_owned());
    for row in golden("hybrid-positions.csv") {
        let (robot, positions, _) = samples.entry(key(&row)).or_insert_with(|| {
            let text = catalogue::find(row.text("robot")).unwrap().text;
            (robot::parse(text).unwrap(), Vec::new(), Vec::new())
        });
        assert_eq!(robot.axes[positions.len()].name, row.text("axis"));
        let value = row.number("value").unwrap();
        positions.push(if positions.len() < 3 { m_from_mm(value) } else { value.to_radians() });
    }
    for row in golden("hybrid-poses.csv") {
        samples.get_mut(&key(&row)).unwrap().2.push(row);
    }
    assert_eq!(samples.len(), 4 * 12);
    samples
}

fn check(row: &Row, found: &Pose) {
    let near = |column: &str, value: f64, expected: f64| {
        let (robot, sample, what) = (row.text("robot"), row.text("sample"), row.text("what"));
        let off = (value - expected).abs();
        assert!(off <= TOLERANCE, "{robot} {sample} {what}: {column} is {value}, not {expected}");
    };
    for (i, column) in ["x", "y", "z"].into_iter().enumerate() {
        near(column, found.translation.vector[i], row.number(column).unwrap() * 1e-3);
    }
    for i in 0..3 {
        for j in 0..3 {
            let column = format!("r{}{}", i + 1, j + 1);
            near(&column, found.rotation[(i, j)], row.number(&column).unwrap());
        }
    }
}

#[test]
fn links_and_wafers_stand_where_pinocchio_puts_them() {
    for (robot, positions, rows) in samples().values() {
        let pose = robot.forward(positions).unwrap();
        for row in rows {
            let what = row.text("what");
            if what == "platform" {
                check(row, &pose.platform.base_from_platform);
            } else if let Some((arm, link)) = what.split_once('/') {
                let arm = robot.arms.iter().position(|one| one.name == arm).unwrap();
                let link: usize = link.parse().unwrap();
                check(row, &pose.base_from_link[arm][link]);
            } else {
                let id = robot
                    .effectors()
                    .find(|id| robot.arms[id.arm].effectors[id.effector].name == what);
                let id = id.unwrap();
                check(row, &pose.base_from_wafer[id.arm][id.effector]);
                check(row, &robot.effector_pose(positions, id).unwrap());
            }
        }
        let links: usize =
            robot.arms.iter().map(|arm| arm.joints.len() + arm.effectors.len()).sum();
        assert_eq!(rows.len(), 1 + links);
    }
}

/// From the wafers as the other program places them.
#[test]
fn the_inverse_finds_the_positions_that_pinocchio_was_given() {
    for ((name, sample), (robot, positions, rows)) in &samples() {
        for id in robot.effectors() {
            let effector = &robot.arms[id.arm].effectors[id.effector].name;
            let row = rows.iter().find(|row| row.text("what") == effector).unwrap();
            let column =
                |names: [&str; 3]| Vector3::from(names.map(|name| row.number(name).unwrap()));
            let normal = column(["r13", "r23", "r33"]);
            let x = tilt_rotation(&normal).inverse() * column(["r11", "r21", "r31"]);
            let center = column(["x", "y", "z"]) * 1e-3;
            let target = WaferTarget { center, normal, heading: Some(x.y.atan2(x.x)) };
            let found = robot.inverse(id, &target, positions).unwrap();
            let all = found.branches.iter();
            let again = all.clone().any(|branch| {
                let apart = branch.positions.iter().zip(positions);
                apart.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) < 1e-9
            });
            for branch in all {
                assert!(branch.residual <= TOLERANCE, "{name} {sample}: {branch:?}");
            }
            // With a joint more than needed the positions are the inverse's own choice.
            assert!(again || name == "scara-4r", "{name} {sample} {effector}: {found:#?}");
            assert!(found.chosen.is_some(), "{name} {sample} {effector}: {found:#?}");
        }
    }
}
