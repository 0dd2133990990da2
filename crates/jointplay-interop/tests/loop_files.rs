//! Loops in YAML of other programs: their joints, their motors, and errors with their places.

use jointplay_core::mechanism::{
    JointKind, Kinematics, Mechanism, MechanismSystem, OpenLoops, assemble, guess,
    mechanism_mobility,
};
use jointplay_core::mobility::RANK_THRESHOLD;
use jointplay_interop::import::{Imported, parse, parse_closed};
use nalgebra::{DVector, Vector3};
use proptest::prelude::*;

/// A link and the joint that attaches it.
fn part(name: &str, kind: &str, parent: &str, xyz: &str, rpy: &str, axis: &str) -> String {
    format!(
        "<link name=\"{name}\"/>\n<joint name=\"{name} joint\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{name}\"/><origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><axis xyz=\"{axis}\"/></joint>\n"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\"><link name=\"base\"/>\n{}</robot>", parts.concat())
}

/// Two cranks and two rods in a plane, open at the end; at zero all are along x.
fn five_bar() -> String {
    let turn = |name: &str, parent: &str, xyz: &str| {
        part(name, "continuous", parent, xyz, "0 0 0", "0 0 1")
    };
    robot(&[
        turn("left", "base", "-0.1 0 0"),
        turn("right", "base", "0.1 0 0"),
        turn("left rod", "left", "0.2 0 0"),
        turn("right rod", "right", "0.2 0 0"),
        part("left end", "fixed", "left rod", "0.25 0 0", "0 0 0", "1 0 0"),
        turn("right end", "right rod", "0.25 0 0"),
    ])
}

const FIVE_BAR: &str = "# Motors at the base.\nclosed_loop: [['left end', 'right end joint']]\ntype: ['6d']\nname_mot: ['left joint', 'right joint']\n";

/// Three arms with rods to a platform, which hangs on the first rod in the tree.
fn delta() -> String {
    let mut parts = Vec::new();
    for (k, angle) in ["0", "2.0943951023931953", "4.1887902047863905"].iter().enumerate() {
        let mount = format!("mount {k}");
        parts.push(part(&mount, "fixed", "base", "0 0 0", &format!("0 0 {angle}"), "1 0 0"));
        let (arm, rod) = (format!("arm {k}"), format!("rod {k}"));
        parts.push(part(&arm, "revolute", &mount, "0.2 0 0", "0 0.3 0", "0 1 0"));
        parts.push(part(&rod, "revolute", &arm, "0.25 0 0", "0 1.5 0", "1 0 0"));
    }
    parts.push(part("platform", "revolute", "rod 0", "0.5 0 0", "0 -1.8 0", "0 0 1"));
    for k in [1, 2] {
        let (x, y) = (f64::from(k) * std::f64::consts::TAU / 3.0).sin_cos();
        let xyz = format!("{} {} 0", 0.05 * (y - 1.0), 0.05 * x);
        parts.push(part(&format!("seat {k}"), "fixed", "platform", &xyz, "0 0 0", "1 0 0"));
        parts.push(part(
            &format!("tip {k}"),
            "fixed",
            &format!("rod {k}"),
            "0.5 0 0",
            "0 0 0",
            "1 0 0",
        ));
    }
    robot(&parts)
}

const DELTA: &str = "closed_loop:
  - [tip 1, seat 1]
  - [seat 2 joint, tip 2 joint]
type: [3D, 3d]
name_mot: [arm 0 joint, arm 1 joint, arm 2 joint]
joint_name: [rod 0 joint, rod 1 joint, rod 2 joint, platform joint]
joint_type: [UJOINT_ZY, UJOINT_ZY, UJOINT_YZ, SPHERICAL]
";

fn closed(text: &str, loops: &str) -> Imported {
    parse_closed(text, None, loops).unwrap()
}

/// Rank, instantaneous mobility and redundancy where the mechanism is assembled from zero.
fn analysed(mechanism: &Mechanism) -> (usize, usize, usize) {
    let start = guess(mechanism);
    let at = match assemble(mechanism, &start, &[], 30) {
        Ok(closed) => closed,
        Err(jointplay_core::Error::NotAssembled(found)) => found.accepted(None).unwrap().clone(),
        Err(other) => panic!("{other}"),
    };
    let system = MechanismSystem::new(mechanism, at.coordinates).unwrap();
    let first = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused)
        .unwrap()
        .finite
        .instantaneous;
    (first.rank, first.mobility, first.redundancy)
}

#[test]
fn pairs_of_frames_close_a_five_bar() {
    let model = closed(&five_bar(), FIVE_BAR);
    let mechanism = &model.mechanism;
    assert_eq!(mechanism.loops(), 1);
    let actuated: Vec<&str> = mechanism
        .joints()
        .iter()
        .filter(|joint| joint.actuated)
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(actuated, ["left joint", "right joint"]);
    assert_eq!(mechanism.joints().last().unwrap().kind, JointKind::Fixed);
    // Five turns about parallel axes: three equations of the plane, three redundant ones.
    assert_eq!(analysed(mechanism), (3, 2, 3));
    // As points, two equations of the plane and three of the ball; the end also turns by itself.
    let points = closed(&five_bar(), &FIVE_BAR.replace("6d", "3d")).mechanism;
    assert_eq!(points.joints().last().unwrap().kind, JointKind::Spherical);
    assert_eq!(analysed(&points), (5, 3, 1));
}

#[test]
fn pairs_of_frames_close_a_delta_whose_joints_change_their_kind() {
    let model = closed(&delta(), DELTA);
    let mechanism = &model.mechanism;
    let kinds = |name: &str| mechanism.joints()[mechanism.joint(name).unwrap()].kind;
    assert_eq!(kinds("rod 0 joint"), JointKind::Universal);
    assert_eq!(kinds("platform joint"), JointKind::Spherical);
    assert_eq!((mechanism.loops(), mechanism.joint_freedoms()), (2, 3 + 6 + 3 + 6));
    // Eighteen freedoms less six equations of each loop.
    assert_eq!(analysed(mechanism), (12, 6, 0));
}

#[test]
fn universal_joints_turn_about_the_two_axes_of_the_joint_frame_one_after_the_other() {
    let text = robot(&[
        part("a", "revolute", "base", "0.1 0.2 0.3", "0.4 0.5 0.6", "1 2 3"),
        part("b", "revolute", "base", "0 0 0", "0 0 0", "0 0 1"),
        part("c", "fixed", "b", "0 0 0", "0 0 0", "0 0 1"),
    ]);
    let origin = nalgebra::Isometry3::from_parts(
        nalgebra::Translation3::new(0.1, 0.2, 0.3),
        nalgebra::UnitQuaternion::from_euler_angles(0.4, 0.5, 0.6),
    );
    let turn = |axis: Vector3<f64>, angle: f64| nalgebra::UnitQuaternion::new(axis * angle);
    let axes = [('X', Vector3::x()), ('Y', Vector3::y()), ('Z', Vector3::z())];
    for (first, one) in axes {
        for (second, other) in axes.into_iter().filter(|(name, _)| *name != first) {
            let loops = format!(
                "closed_loop: []\njoint_name: [a joint]\njoint_type: [UJOINT_{first}{second}]\n"
            );
            let mechanism = closed(&text, &loops).mechanism;
            let q = DVector::from_row_slice(&[0.3, -0.7, 0.0]);
            let pose = Kinematics::new(&mechanism).link_poses(&q).unwrap()[1];
            let expected = origin * turn(one, 0.3) * turn(other, -0.7);
            let off = pose.to_homogeneous() - expected.to_homogeneous();
            assert!(off.amax() < 1e-14, "{first}{second}: {off}");
        }
    }
}

/// A four-bar as exporters write it: a tree, with a linear coupling in place of the hinge that was cut.
fn four_bar() -> String {
    let turn = |name: &str, parent: &str, xyz: &str| {
        part(name, "continuous", parent, xyz, "0 0 0", "0 0 1")
    };
    let coupled = turn("rocker", "base", "0.3 0 0")
        .replace("<axis", "<mimic joint=\"crank joint\" multiplier=\"0.9\"/><axis");
    robot(&[turn("crank", "base", "0 0 0"), turn("coupler", "crank", "0.1 0 0"), coupled])
}

const HINGE: &str = "closures:
- link_a: coupler
  link_b: rocker
  point: [0.3, 0.25, 0.0]
  axis: [0.0, 0.0, 2.0]
dependent: [coupler joint, rocker joint]
independent: [crank joint]
";

#[test]
fn a_cut_hinge_is_closed_in_the_base_frame_and_replaces_couplings() {
    let model = closed(&four_bar(), HINGE);
    let mechanism = &model.mechanism;
    let hinge = mechanism.joints().last().unwrap();
    assert_eq!((hinge.kind, hinge.name.as_str()), (JointKind::Revolute, "coupler to rocker"));
    // The coupler is at x = 0.1 and the rocker at x = 0.3 with all coordinates at zero.
    let at = |side: usize| hinge.frames[side].translation.vector;
    assert!((at(0) - Vector3::new(0.2, 0.25, 0.0)).amax() < 1e-15);
    assert!((at(1) - Vector3::new(0.0, 0.25, 0.0)).amax() < 1e-15);
    assert!(model.ignored.contains(&"1 × mimic of a joint that a loop determines".to_owned()));
    assert!(mechanism.joints()[0].actuated && !mechanism.joints()[1].actuated);
    assert_eq!(analysed(mechanism), (3, 1, 3));
    assert!(mechanism.couplings().is_empty());
    // Without the loop, the coupling is kept.
    let [coupling] = parse(&four_bar()).unwrap().mechanism.couplings().to_vec().try_into().unwrap();
    assert_eq!((coupling.follower.joint, coupling.terms[0].1), (2, 0.9));
}

#[test]
fn two_hinges_of_the_same_links_have_names_of_their_own() {
    let second = "- {link_a: coupler, link_b: rocker, point: [0.3, 0.25, 0.1], axis: [0, 0, 1]}\n";
    let twice = HINGE.replace("\ndependent", &format!("\n{second}dependent"));
    let model = closed(&four_bar(), &twice);
    let names: Vec<&str> = model.mechanism.joints()[3..].iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["coupler to rocker", "coupler to rocker (2)"]);
    assert_eq!(analysed(&model.mechanism), (4, 1, 8));
}

#[track_caller]
fn refuse(text: &str, loops: &str, from: &str, to: &str, blamed: &str, message: &str) {
    assert!(loops.contains(from), "{from:?} is not in the file");
    let loops = loops.replacen(from, to, 1);
    let error = parse_closed(text, None, &loops).unwrap_err();
    let jointplay_interop::import::ClosedError::Loops(jointplay_interop::import::LoopsError::Yaml(
        error,
    )) = error
    else {
        panic!("{error}")
    };
    let shown = error.with_excerpt("loops.yaml");
    assert!(error.to_string().contains(message), "{shown}");
    let place = &error.place;
    let found: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
    assert!(found.starts_with(blamed), "{shown}");
}

#[test]
fn errors_of_yaml_show_their_place() {
    let pairs = |from: &str, to: &str, blamed: &str, message: &str| {
        refuse(&delta(), DELTA, from, to, blamed, message);
    };
    pairs("seat 1]", "seats 1]", "seats 1", "did you mean `seat 1`?");
    pairs("[3D, 3d]", "[3D]", "[", "one entry for each loop or joint");
    pairs("[3D, 3d]", "[3D, 4d]", "4d", "3d or 6d");
    pairs("UJOINT_YZ", "UJOINT_YY", "UJOINT_YY", "two of the axes");
    pairs("[tip 1, seat 1]", "[tip 1, seat 1, tip 2]", "[", "pairs of two frames");
    pairs("[tip 1, seat 1]", "[tip 1, tip 1 joint]", "[", "frames of two links");
    pairs("[arm 0 joint, ", "[arm 9 joint, ", "arm 9 joint", "joint \"arm 9 joint\" is not known");
    pairs("name_mot", "motors", "motors", "motors");
    pairs("[3D, 3d]", "[3D, 3d", "", "");
    let hinge = |from: &str, to: &str, blamed: &str, message: &str| {
        refuse(&four_bar(), HINGE, from, to, blamed, message);
    };
    hinge("0.25, 0.0]", "0.25]", "[", "3 finite numbers");
    hinge("0.25, 0.0]", ".nan, 0.0]", "[", "3 finite numbers");
    hinge("[0.0, 0.0, 2.0]", "[0, 0, 0]", "[", "a direction that is not 0");
    hinge("link_b: rocker", "link_b: rock", "rock", "did you mean `rocker`?");
    hinge("link_b: rocker", "link_b: coupler", "coupler", "another link than link_a");
    hinge("  axis: [0.0, 0.0, 2.0]\n", "", "", "axis");
    let closed_already = "<mujoco><worldbody><body name=\"a\"><joint name=\"j\"/></body><body name=\"b\"><joint name=\"k\"/></body></worldbody><equality><connect body1=\"a\" body2=\"b\" anchor=\"0 0 0\"/></equality></mujoco>";
    refuse(
        closed_already,
        "closed_loop: [[a, b]]\n",
        "a",
        "a",
        "closed_loop",
        "has 1 loop already",
    );
}

#[test]
fn aliases_and_deep_lists_are_refused() {
    let bomb = "closed_loop: &a [[left end, right end]]\nname_mot: *a\n";
    let error = parse_closed(&five_bar(), None, bomb).unwrap_err();
    assert!(error.to_string().contains("alias"), "{error}");
    let deep = format!("closed_loop: {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(parse_closed(&five_bar(), None, &deep).is_err());
    let long = format!("closed_loop: []\n{}", " ".repeat(4_000_000));
    let error = parse_closed(&five_bar(), None, &long).unwrap_err();
    assert!(error.to_string().contains("at most 4000000 are allowed"), "{error}");
}

proptest! {
    #[test]
    fn mutated_files_do_not_panic(
        which in 0..3_usize,
        cuts in prop::collection::vec((0.0..1.0, 0..20_usize, "[-\\[\\]:,&*!?|>'\"#{} \n.0-9a-z]{0,4}"), 1..4),
    ) {
        let (text, loops) = [(five_bar(), FIVE_BAR), (delta(), DELTA), (four_bar(), HINGE)][which].clone();
        let mut loops = loops.to_owned();
        for (part, length, replacement) in cuts {
            let start = (part * loops.len() as f64) as usize;
            let end = (start + length).min(loops.len());
            loops.replace_range(start..end, &replacement);
        }
        let _ = parse_closed(&text, None, &loops);
    }
}
