//! Models of other programs: what is taken over, what is listed, what is refused.

use crate::sandbox::Sandbox;

/// A prismatic joint on the base, and a ball joint next to it.
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

/// The same as a hinge of an exporter.
pub(crate) const CLOSURES: &str = "closures:
- {link_a: slider, link_b: arm, point: [0, 0, 0], axis: [0, 1, 0]}
dependent: [turn]
independent: [slide]
";

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", URDF);
    sandbox.write("loops.toml", LOOPS);
    sandbox
}

const IGNORED: &str = "ignored: 1 × effort of limit\nignored: 1 × inertial\nignored: 1 × velocity of limit\nignored: 1 × visual\n";

#[test]
fn a_model_becomes_a_mechanism_file() {
    let sandbox = sandbox();
    let run = sandbox.run("import robot.urdf --loops loops.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    insta::assert_snapshot!("import_robot_urdf", run.stdout);
    let run = sandbox.run("import robot.urdf --loops loops.toml --out new/robot.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    assert_eq!(run.stdout, "written to new/robot.toml: 3 links, 3 joints, 1 loop\n");
    // Slide and turn cannot go while the tip holds the arm at its length.
    let found = sandbox.json("mobility new/robot.toml");
    assert_eq!(
        (&found["instantaneous_mobility"], &found["finite_mobility"]),
        (&1.into(), &0.into())
    );
    assert_eq!(found["joint_freedoms"], 5);
}

#[test]
fn a_file_that_is_there_is_not_replaced() {
    let sandbox = sandbox();
    sandbox.write("robot.toml", "mine");
    let run = sandbox.run("import robot.urdf --out robot.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("exists: choose another name"), "{}", run.stderr);
    assert_eq!(sandbox.read("robot.toml"), "mine");
}

#[test]
fn other_commands_take_models_too() {
    let sandbox = sandbox();
    let run = sandbox.run("mobility robot.urdf --at slide=0.1 --format json");
    assert_eq!((run.code, run.stderr.as_str()), (0, IGNORED));
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(found["finite_mobility"], 2);
    let run = sandbox.run("mobility robot.urdf --set a=1");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("a model has no parameters"), "{}", run.stderr);
}

#[test]
fn the_robot_as_a_model_of_mujoco_is_the_robot() {
    let sandbox = Sandbox::new();
    let model = include_str!("../../../../validation/golden/models/gpr.mjcf.xml");
    sandbox.write("gpr.xml", model);
    let run = sandbox.run("mobility gpr.xml --format json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let expected = sandbox.json("mobility gpr-mechanism");
    for key in ["joint_freedoms", "loops", "rank", "instantaneous_mobility", "finite_mobility"] {
        assert_eq!(found[key], expected[key], "{key}");
    }
    assert_eq!(found["coordinates"]["q1"], 0.5);
}

#[track_caller]
fn refused(sandbox: &Sandbox, line: &str, message: &str) {
    let run = sandbox.run(line);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}");
    assert!(run.stderr.contains(message), "{}", run.stderr);
}

#[test]
fn errors_show_their_place() {
    let sandbox = sandbox();
    sandbox.write("bad.urdf", &URDF.replace("0 1 0", "0 1"));
    let place = "bad.urdf:11:56: `xyz` is \"0 1\", but has to be 3 numbers\n   |\n11 |     <parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 1\"/>";
    refused(&sandbox, "import bad.urdf", place);
    refused(&sandbox, "mobility bad.urdf", place);
    sandbox.write("bad.toml", &LOOPS.replace("arm", "harm"));
    refused(
        &sandbox,
        "import robot.urdf --loops bad.toml",
        "bad.toml:6:20: link \"harm\" is not known",
    );
    sandbox.write("cut.urdf", &URDF[..100]);
    refused(&sandbox, "import cut.urdf", "cut.urdf:1:1: not well-formed XML");
    refused(&sandbox, "import loops.toml", "loops.toml is a file of loops, but a model");
    refused(&sandbox, "import missing.sdf", "cannot read missing.sdf");
}

#[test]
fn loops_may_be_in_yaml() {
    let sandbox = sandbox();
    sandbox.write("robot.yaml", "closed_loop: [[slider, arm]]\ntype: [3d]\nname_mot: [slide]\n");
    let run = sandbox.run("import robot.urdf --loops robot.yaml --quiet");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("name = \"slider to arm\""), "{}", run.stdout);
    assert!(run.stdout.contains("actuated = true"), "{}", run.stdout);
    sandbox.write("robot.yaml", "closed_loop: [[slider, harm]]\n");
    refused(
        &sandbox,
        "import robot.urdf --loops robot.yaml",
        "robot.yaml:1:24: link or joint \"harm\" is not known (did you mean `arm`?)",
    );
    sandbox.write("robot.yaml", "closed_loop: [[slider, arm]\n");
    refused(&sandbox, "import robot.urdf --loops robot.yaml", "robot.yaml:");
}

#[test]
fn mjcf_includes_files_of_its_folder_only() {
    let sandbox = Sandbox::new();
    let include =
        |file: &str| format!("<mujoco><worldbody><include file=\"{file}\"/></worldbody></mujoco>");
    let body = "<mujocoinclude>\n<body name=\"arm\">\n<joint name=\"j\"/></body></mujocoinclude>";
    std::fs::create_dir_all(sandbox.file("models/parts")).unwrap();
    sandbox.write("models/parts/arm.xml", body);
    sandbox.write("secret.xml", body);
    sandbox.write("models/robot.xml", &include("parts/arm.xml"));
    let found = sandbox.json("mobility models/robot.xml");
    assert_eq!(found["finite_mobility"], 1);
    sandbox.write("models/parts/arm.xml", &body.replace("\"j\"", "\"j\" pos=\"0\""));
    refused(&sandbox, "mobility models/robot.xml", "models/parts/arm.xml:3:");
    for (file, message) in [
        ("../secret.xml", "it must be in the folder of the input file or below"),
        ("/etc/hostname", "it must be in the folder of the input file or below"),
        ("absent.xml", "there is no such file"),
        ("robot.xml", "a file is included at most once"),
    ] {
        sandbox.write("models/robot.xml", &include(file));
        refused(&sandbox, "mobility models/robot.xml", message);
    }
}

#[test]
fn a_guess_that_does_not_close_leads_to_the_nearest_closed_configuration() {
    let sandbox = Sandbox::new();
    // The crank is commanded to where the guess of the rocker does not lead.
    let run = sandbox.run("assemble four-bar --at D=170");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.stderr.contains(
            "the loops do not close from the guess: the nearest closed configuration found is used"
        ),
        "{}",
        run.stderr
    );
    let found = sandbox.json("assemble four-bar --at D=170 --quiet");
    assert!(found["residual"].as_f64().unwrap() < 1e-10);
    assert!(found["farthest_from_guess"]["value"].as_f64().unwrap().abs() > 1.0, "{found}");
}

#[test]
fn a_three_rod_robot_is_a_mechanism_and_comes_back_as_the_same_robot() {
    let sandbox = Sandbox::new();
    let inverse = "inverse --azimuth-deg 45 --tilt-deg 1 --format json";
    let rods =
        |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap()["q_mm"].clone();
    let expected = rods(&sandbox.done(inverse));
    let run = sandbox.run("import gpr --virtualization radial --out there.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, "ignored: largest tilt of 1.5°\n"));
    let run = sandbox.run("import there.toml --to gpr --tilt-limit-deg 1.5 --out back.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, "ignored: 3 × virtual_joint\n"));
    let found = rods(&sandbox.done(&format!("{inverse} --robot back.toml")));
    for k in 0..3 {
        let (a, b) = (found[k].as_f64().unwrap(), expected[k].as_f64().unwrap());
        assert!((a - b).abs() < 1e-11, "{found} {expected}");
    }
    for line in ["draw gpr", "move gpr --steps 2", "suggest gpr", "jacobian gpr", "assemble gpr"] {
        sandbox.done(line);
    }
}

#[test]
fn conversions_of_robots_state_what_is_missing() {
    let sandbox = Sandbox::new();
    for (line, part) in [
        ("import gpr-mechanism --to gpr", "give --tilt-limit-deg"),
        ("import hexapod --to gpr --tilt-limit-deg 1", "is not a three-rod robot"),
        ("import gpr --tilt-limit-deg 1", "applies to `--to gpr`"),
        (
            "import gpr-mechanism --to gpr --tilt-limit-deg 1 --virtualization polar",
            "applies to three-rod robots",
        ),
        ("import gpr-mechanism --to gpr --tilt-limit-deg -1", "error: the largest tilt is -1°"),
        ("import gpr --virtualization offset", "use --virtualization radial, polar or planar"),
        ("import gpr --loops x.toml", "--loops applies to models"),
    ] {
        let run = sandbox.run(line);
        assert_eq!(run.code, 2, "{line}");
        assert!(run.stderr.contains(part), "{line}: {}", run.stderr);
    }
}

#[test]
fn a_document_of_freecad_is_a_model() {
    let sandbox = Sandbox::new();
    let archive = include_bytes!("../../../../validation/golden/models/crank-press.FCStd");
    std::fs::write(sandbox.file("press.FCStd"), archive).unwrap();
    let run = sandbox.run("import press.FCStd --out press.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("ignored: 1 × suppressed joint \"old guide\""), "{}", run.stderr);
    assert_eq!(run.stdout, "written to press.toml: 5 links, 5 joints, 1 loop\n");
    // The limits are those of the file: the pin stops at -20°, its only limit.
    let run = sandbox.run("move press.toml --drive drive=0.5:3.1:0.1");
    assert!(
        run.code == 1 && run.stderr.contains("pin is at -0.367880 rad, its least value is -0.349"),
        "{}",
        run.stderr
    );
    assert_eq!(sandbox.run("move press.toml --drive drive=0.5:0.7:0.1").code, 0);
    // Other commands take it as it is.
    assert_eq!(sandbox.json("mobility press.FCStd --quiet")["finite_mobility"], 1);
    refused(&sandbox, "import press.FCStd --units mm", "--units applies to assemblies");
    refused(&sandbox, "study press.FCStd", "is a model of another program");
    std::fs::write(sandbox.file("cut.FCStd"), &archive[..5000]).unwrap();
    refused(
        &sandbox,
        "import cut.FCStd",
        "cut.FCStd: the archive of FreeCAD cannot be read: it is damaged or incomplete",
    );
    // Bytes of anything, text of anything, and a document that was unpacked.
    let bytes: Vec<u8> = (0..400_u32).map(|k| (k * k % 251) as u8).collect();
    for content in [&bytes[..], b"", b"kind = \"mechanism\""] {
        std::fs::write(sandbox.file("other.FCStd"), content).unwrap();
        refused(
            &sandbox,
            "mobility other.FCStd",
            "other.FCStd: a document of FreeCAD (.FCStd) is a zip archive",
        );
    }
    std::fs::write(sandbox.file("plain.FCStd"), "<Document/>").unwrap();
    refused(&sandbox, "import plain.FCStd", "without an assembly");
    std::fs::write(sandbox.file("other.FCStd"), b"PK\x03\x04").unwrap();
    refused(
        &sandbox,
        "mobility other.FCStd",
        "other.FCStd: the archive of FreeCAD cannot be read: it is damaged or incomplete",
    );
}

#[test]
fn an_assembly_of_freecad_needs_its_unit() {
    let sandbox = Sandbox::new();
    let assembly = include_str!("../../../../validation/golden/models/slider-crank.asmt");
    sandbox.write("crank.asmt", assembly);
    for line in ["import crank.asmt", "mobility crank.asmt"] {
        let run = sandbox.run(line);
        assert_eq!(run.code, 2, "{line}");
        assert!(run.stderr.contains("--units mm"), "{line}: {}", run.stderr);
    }
    let run = sandbox.run("import crank.asmt --units mm --out crank.toml");
    assert_eq!((run.code, run.stderr.as_str()), (0, "ignored: 3 × PrincipalMassMarker\n"));
    let mobility = sandbox.done("mobility crank.toml");
    assert!(mobility.contains("finite                 1"), "{mobility}");
    for (line, part) in [
        ("import gpr --units mm", "--units applies to assemblies"),
        ("import crank.asmt --units ft", "must be one of m, mm, um, in"),
    ] {
        let run = sandbox.run(line);
        assert!(run.code == 2 && run.stderr.contains(part), "{line}: {}", run.stderr);
    }
}
