//! Models of other programs: what is taken over, what is listed, what is refused.

use crate::desk::Desk;

/// A slide on the base, and a ball joint beside it.
pub(crate) const URDF: &str = r#"<robot name="pair">
  <link name="base"><visual/></link>
  <link name="slider"/>
  <link name="arm"><inertial/></link>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="slider"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/>
  </joint>
  <joint name="turn" type="continuous">
    <origin xyz="1 0 0"/>
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
  </joint>
</robot>
"#;

pub(crate) const LOOPS: &str = r#"kind = "loops"
units = { length = "mm", angle = "deg" }
[[joint]]
name = "tip"
kind = "spherical"
links = ["slider", "arm"]
point = [0, 0, 0]
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("robot.urdf", URDF);
    desk.write("loops.toml", LOOPS);
    desk
}

const IGNORED: &str = "ignored: 1 × effort of limit\nignored: 1 × inertial\nignored: 1 × velocity of limit\nignored: 1 × visual\n";

#[test]
fn a_model_becomes_a_mechanism_file() {
    let desk = desk();
    let run = desk.run("import robot.urdf --loops loops.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    insta::assert_snapshot!("import_robot_urdf", run.stdout);
    let run = desk.run("import robot.urdf --loops loops.toml --output new/robot.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    assert_eq!(run.stdout, "written to new/robot.toml: 3 links, 3 joints, 1 loop\n");
    // Slide and turn cannot go while the tip holds the arm at its length.
    let found = desk.json("mobility new/robot.toml");
    assert_eq!(
        (&found["instantaneous_mobility"], &found["finite_mobility"]),
        (&1.into(), &0.into())
    );
    assert_eq!(found["joint_freedoms"], 5);
}

#[test]
fn a_file_that_is_there_is_not_replaced() {
    let desk = desk();
    desk.write("robot.toml", "mine");
    let run = desk.run("import robot.urdf --output robot.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("exists: choose another name"), "{}", run.stderr);
    assert_eq!(desk.read("robot.toml"), "mine");
}

#[test]
fn other_commands_take_models_too() {
    let desk = desk();
    let run = desk.run("mobility robot.urdf --at slide=0.1 --format json");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(found["finite_mobility"], 2);
    let run = desk.run("mobility robot.urdf --set a=1");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("a model has no parameters"), "{}", run.stderr);
}

#[test]
fn the_robot_as_a_model_of_mujoco_is_the_robot() {
    let desk = Desk::new();
    let model = include_str!("../../../../validation/golden/models/gpr.mjcf.xml");
    desk.write("gpr.xml", model);
    let run = desk.run("mobility gpr.xml --format json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let expected = desk.json("mobility gpr-mechanism");
    for key in ["joint_freedoms", "loops", "rank", "instantaneous_mobility", "finite_mobility"] {
        assert_eq!(found[key], expected[key], "{key}");
    }
    assert_eq!(found["coordinates"]["q1"], 0.5);
}

#[track_caller]
fn refused(desk: &Desk, line: &str, message: &str) {
    let run = desk.run(line);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}");
    assert!(run.stderr.contains(message), "{}", run.stderr);
}

#[test]
fn errors_show_their_place() {
    let desk = desk();
    desk.write("bad.urdf", &URDF.replace("0 1 0", "0 1"));
    let place = "bad.urdf:11:56: `xyz` is \"0 1\", but has to be 3 numbers\n   |\n11 |     <parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 1\"/>";
    refused(&desk, "import bad.urdf", place);
    refused(&desk, "mobility bad.urdf", place);
    desk.write("bad.toml", &LOOPS.replace("arm", "harm"));
    refused(
        &desk,
        "import robot.urdf --loops bad.toml",
        "bad.toml:6:20: link \"harm\" is not known",
    );
    desk.write("cut.urdf", &URDF[..100]);
    refused(&desk, "import cut.urdf", "cut.urdf:1:1: not well-formed XML");
    refused(&desk, "import loops.toml", "loops.toml is a file of loops, but a model");
    refused(&desk, "import missing.sdf", "cannot read missing.sdf");
}
