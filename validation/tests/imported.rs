//! Models of other programs: every link is where those programs place it.
//!
//! Provenance and the reason for the tolerance: `validation/golden/README.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use jointplay::format::mechanism;
use jointplay::interop::import;
use jointplay::mechanism::{Kinematics, Mechanism};
use jointplay::nalgebra::DVector;
use jointplay::spatial::Pose;
use jointplay_validation::{Row, golden};

/// Of positions (m) and of entries of rotation matrices.
const TOLERANCE: f64 = 1e-12;

fn model(name: &str) -> Mechanism {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/models").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    let imported = import::parse(&text).map_err(|error| error.with_excerpt(name));
    imported.unwrap_or_else(|message| panic!("{message}")).mechanism
}

/// The mechanism with its loops open, and its closures.
fn opened(mechanism: &Mechanism, rows: &[&Row]) -> Mechanism {
    let closures: BTreeSet<&str> =
        rows.iter().filter_map(|row| Some(row.text("what").split_once('[')?.0)).collect();
    let is_kept = |name: &str| !closures.contains(name);
    let joints = mechanism.joints().iter().filter(|joint| is_kept(&joint.name)).cloned();
    let open = Mechanism::new("open", mechanism.links().to_vec(), joints.collect()).unwrap();
    assert_eq!(open.loops(), 0, "{}", mechanism.name());
    assert_eq!(mechanism.loops(), closures.len(), "{}", mechanism.name());
    open
}

fn check(row: &Row, found: &Pose) {
    let near = |column: &str, value: f64| {
        let Some(expected) = row.number(column) else { return };
        assert!(
            (value - expected).abs() <= TOLERANCE,
            "{} {} {}: {column} is {value}, expected {expected}",
            row.text("model"),
            row.text("sample"),
            row.text("what"),
        );
    };
    for (i, column) in ["x", "y", "z"].into_iter().enumerate() {
        near(column, found.translation.vector[i]);
    }
    for i in 0..3 {
        for j in 0..3 {
            near(&format!("r{}{}", i + 1, j + 1), found.rotation[(i, j)]);
        }
    }
}

#[test]
fn links_and_closures_stand_where_other_programs_put_them() {
    let coordinates = golden("imported-coordinates.csv");
    let rows = golden("imported-poses.csv");
    let mut samples: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in &rows {
        samples.entry((row.text("model"), row.text("sample"))).or_default().push(row);
    }
    assert_eq!(samples.len(), 4 * 7);
    for ((name, sample), rows) in samples {
        let imported = model(name);
        // Written and read again, it has to be there again.
        let written = mechanism::write(&imported, Some(name));
        let read = mechanism::parse(&written).map_err(|error| error.with_excerpt(name)).unwrap();
        for mechanism in [imported, read.mechanism] {
            let open = opened(&mechanism, &rows);
            let kinematics = Kinematics::new(&open);
            let mut values = DVector::from_element(open.joint_freedoms(), f64::NAN);
            let given = coordinates
                .iter()
                .filter(|row| row.text("model") == name && row.text("sample") == sample);
            for row in given {
                let joint = open.joint(row.text("joint"));
                let joint = joint.unwrap_or_else(|| panic!("no joint {}", row.text("joint")));
                let index: usize = row.text("index").parse().unwrap();
                values[kinematics.coordinates_of(joint).start + index] =
                    row.number("value").unwrap();
            }
            // A coordinate that the other program does not have would stop here, as it is no number.
            let poses = kinematics.link_poses(&values).unwrap();
            let mut links = 0;
            for row in &rows {
                let what = row.text("what");
                if let Some((joint, side)) = what.split_once('[') {
                    let joint = &mechanism.joints()[mechanism.joint(joint).unwrap()];
                    let side: usize = side.trim_end_matches(']').parse().unwrap();
                    let link = open.link(&mechanism.links()[joint.links[side]]).unwrap();
                    check(row, &(poses[link] * joint.frames[side]));
                } else {
                    let link = open.link(what).unwrap_or_else(|| panic!("no link {what}"));
                    check(row, &poses[link]);
                    links += 1;
                }
            }
            let real = open.links().iter().filter(|link| !link.contains(", part ")).count();
            assert_eq!(links + usize::from(open.links()[0] == "world"), real, "{name}");
        }
    }
}

#[test]
fn what_is_ignored_is_listed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/models/frames.sdf");
    let text = std::fs::read_to_string(path).unwrap();
    let ignored = import::parse(&text).unwrap().ignored;
    assert_eq!(
        ignored,
        ["1 × dynamics of a joint", "1 × effort of a limit", "1 × inertial", "1 × visual"]
    );
}
