//! Loop joints for imported trees, and errors with their places.

use jointplay_core::mechanism::JointKind;
use jointplay_format::mechanism::with_loops;
use jointplay_interop::import::parse;
use nalgebra::Vector3;
use proptest::prelude::*;

/// Two parallel cranks, drawn in rotated frames.
const CRANKS: &str = r#"<robot name="cranks">
  <link name="base"/><link name="left"/><link name="right"/>
  <joint name="a" type="continuous">
<origin rpy="0 0 0.5"/><parent link="base"/><child link="left"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="b" type="continuous">
<origin xyz="0.3 0 0" rpy="0 0 -0.5"/><parent link="base"/><child link="right"/><axis xyz="0 0 1"/>
  </joint>
</robot>"#;

const LOOPS: &str = r#"
kind = "loops"
units = { length = "mm", angle = "deg" }
[parameters]
r = 100
[[joint]]
name = "rod"
kind = "revolute"
links = ["left", "right"]
in = "left"
point = ["r", 0, 0]
axis = [0, 0, 1]
"#;

#[test]
fn a_loop_joint_is_given_in_a_link_frame_or_in_the_base_frame() {
    let chain = parse(CRANKS).unwrap().mechanism;
    let closed = with_loops(&chain, LOOPS).unwrap();
    assert_eq!((closed.loops(), closed.links()), (1, chain.links()));
    let rod = &closed.joints()[2];
    assert_eq!(rod.kind, JointKind::Revolute);
    let on_left = rod.frames[0].translation.vector;
    assert!((on_left - Vector3::x() * 0.1).norm() < 1e-15, "{on_left}");
    // Where it is in the base frame, from either side.
    let (sin, cos) = 0.5_f64.sin_cos();
    let in_base = Vector3::new(0.1 * cos, 0.1 * sin, 0.0);
    let point = chain.joints()[1].frames[0]
        * chain.joints()[1].frames[1].inverse()
        * nalgebra::Point3::from(rod.frames[1].translation.vector);
    assert!((point.coords - in_base).norm() < 1e-15, "{point}");
    let text = LOOPS
        .replace("in = \"left\"\n", "")
        .replace("[\"r\", 0, 0]", "[\"r * cos(0.5 * 180 / pi)\", \"r * sin(0.5 * 180 / pi)\", 0]");
    let same = with_loops(&chain, &text).unwrap();
    for (one, other) in same.joints()[2].frames.iter().zip(&rod.frames) {
        assert!((one.translation.vector - other.translation.vector).norm() < 1e-15);
        assert!(((one.rotation * Vector3::z()) - (other.rotation * Vector3::z())).norm() < 1e-15);
    }
}

#[test]
fn a_loop_joint_is_given_by_a_frame_on_each_link() {
    let chain = parse(CRANKS).unwrap().mechanism;
    let frames = "frames = [{ point = [1, 0, 0], axis = [0, 0, 1] }, { point = [2, 0, 0], axis = [0, 0, 1] }]";
    let start = LOOPS.find("in =").unwrap();
    let closed = with_loops(&chain, &format!("{}{frames}", &LOOPS[..start])).unwrap();
    let points = closed.joints()[2].frames.map(|frame| frame.translation.x);
    assert_eq!(points, [0.001, 0.002]);
}

/// Replaces a part of the file, and checks an error message and the text above its carets.
#[track_caller]
fn refuse(from: &str, to: &str, blamed: &str, message: &str) {
    assert!(LOOPS.contains(from), "{from:?} is not in the file");
    let chain = parse(CRANKS).unwrap().mechanism;
    let errors = with_loops(&chain, &LOOPS.replacen(from, to, 1)).unwrap_err();
    let is_blamed = errors.iter().any(|error| {
        let place = &error.place;
        let found: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
        error.to_string().contains(message) && found == blamed
    });
    assert!(is_blamed, "{}", errors.with_excerpt("loops.toml"));
}

#[test]
fn joints_that_close_no_loop_are_rejected() {
    refuse("\"loops\"", "\"mechanism\"", "\"mechanism\"", "known: loops");
    refuse("\"right\"]", "\"write\"]", "\"write\"", "link \"write\" is not known");
    refuse("\"right\"]", "\"left\"]", "\"rod\"", "to itself");
    refuse("in = \"left\"", "in = \"lift\"", "\"lift\"", "did you mean `left`?");
    refuse("in = \"left\"", "on = \"left\"", "on", "unknown key `on`");
    refuse("\"rod\"", "\"a\"", "\"a\"", "used twice");
    refuse("axis = [0, 0, 1]", "", "\"rod\"", "needs `axis`");
    refuse("[\"r\",", "[\"s\",", "s", "unknown name `s`");
    let frames = "frames = [{ point = [1, 0, 0], axis = [0, 0, 1] }, { point = [2, 0, 0], axis = [0, 0, 1] }]";
    refuse("point = [\"r\", 0, 0]\naxis = [0, 0, 1]", frames, "\"left\"", "`frames` places");
    let chain = parse(CRANKS).unwrap().mechanism;
    let closed = with_loops(&chain, LOOPS).unwrap();
    let again = with_loops(&closed, LOOPS).unwrap_err();
    assert!(again.to_string().contains("has 1 loop already"), "{again}");
}

proptest! {
    #[test]
    fn mutated_loop_files_do_not_panic(
        cuts in prop::collection::vec((0..LOOPS.len(), 0..30_usize, "[-\\[\\]\"={},.0-9a\n ]{0,3}"), 1..4)
    ) {
        let mut text = LOOPS.to_owned();
        for (start, length, replacement) in cuts {
            let start = start.min(text.len());
            let end = (start + length).min(text.len());
            if text.is_char_boundary(start) && text.is_char_boundary(end) {
                text.replace_range(start..end, &replacement);
            }
        }
        let chain = parse(CRANKS).unwrap().mechanism;
        if let Err(error) = with_loops(&chain, &text) {
            let _ = error.with_excerpt("x");
        }
    }
}

#[test]
fn couplings_of_a_file_of_loops_join_those_of_the_model() {
    let sliding = CRANKS
        .replace("<link name=\"right\"/>", "<link name=\"right\"/><link name=\"tool\"/>")
        .replace("</robot>", "<joint name=\"c\" type=\"prismatic\"><parent link=\"base\"/><child link=\"tool\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/><mimic joint=\"a\" multiplier=\"0.1\"/></joint></robot>");
    let chain = parse(&sliding).unwrap().mechanism;
    let free = LOOPS.replace("kind = \"revolute\"", "kind = \"cylindrical\"");
    let coupled = |coordinate: &str, other: &str| {
        let terms = format!("terms = [{{ coordinate = \"{other}\", ratio = \"3 / 90\" }}]");
        with_loops(
            &chain,
            &format!(
                "{free}[[coupling]]\nname = \"thread\"\ncoordinate = \"{coordinate}\"\n{terms}\noffset = 2\n"
            ),
        )
    };
    let closed = coupled("rod[0]", "b").unwrap();
    let [mimic, thread] = closed.couplings() else { panic!("{closed:?}") };
    assert_eq!((mimic.follower.joint, thread.follower.joint), (2, 3));
    assert_eq!((thread.follower.freedom, thread.terms[0].0.joint), (0, 1));
    // 3 mm for 90°.
    let expected = 0.003 / std::f64::consts::FRAC_PI_2;
    assert!((thread.terms[0].1 - expected).abs() < 1e-15 && (thread.offset - 0.002).abs() < 1e-18);
    for (coordinate, other, message) in [
        ("rod", "b", "coordinate \"rod\" is not known"),
        ("rod[0]", "base", "coordinate \"base\" is not known"),
        ("rod[0]", "rod[0]", "twice"),
    ] {
        let error = coupled(coordinate, other).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
