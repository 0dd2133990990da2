//! Bad input and broken limits: the exit code, the message, and nothing left behind.

use crate::sandbox::Sandbox;

#[track_caller]
fn refuse(line: &str, code: i32, message: &str) {
    let sandbox = Sandbox::new();
    let run = sandbox.run(line);
    assert_eq!(run.code, code, "{line}: {}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
    assert_eq!(run.stdout, "", "{line}");
    assert_eq!(sandbox.names(""), [""; 0], "{line} left files behind");
}

#[test]
fn flags_that_make_no_sense() {
    refuse("forward --q-mm 500,501", 2, "expected 3 rod lengths, got 2");
    refuse("forward --q-mm 500,501,502,503", 2, "got 4");
    refuse("forward --q-mm 500,nan,502", 2, "nan is not a finite number");
    refuse("forward --q-mm 500,inf,502", 2, "inf is not a finite number");
    refuse("forward --q-mm 500,,502", 2, "invalid number");
    refuse("forward --q-mm 1e300,1,1", 2, "got 1e300 mm");
    refuse("inverse --tilt-deg 1e308", 2, "got 1e308°");
    refuse("draw bennett --view 20,1e308", 2, "got 1e308°");
    refuse("simulate --azimuth-step-deg 1e308", 2, "miss 360");
    refuse("draw four-bar --ghost A=1e308", 2, "A = 1e308 deg is too large");
    refuse("move four-bar --drive A=0:1e308", 2, "A = 1e308 deg is too large");
    refuse("assemble four-bar --at A=1e308", 2, "values must be within ±3600000 deg");
    refuse("assemble bennett --tolerance -1", 2, "must be from 1e-11 to 1e-2, got -1");
    refuse("inverse --height-mm 1e9", 2, "within ±1000000 mm");
    refuse("simulate --height-mm -1e9", 2, "length must be within");
    refuse("forward --metric 0", 2, "must be positive");
    refuse("forward --metric -3", 2, "must be positive");
    refuse("forward --metric nan", 2, "paper, radius, or a length in mm");
    refuse("forward --virtualization cubic", 2, "possible values: radial, polar, offset, planar");
    refuse("inverse --tilt-deg 90", 2, "must be between -90° and 90°");
    refuse("inverse --tilt-deg -95", 2, "--tilt-deg");
    refuse("inverse --azimuth-deg NaN", 2, "--azimuth-deg");
    refuse("inverse --height-mm inf", 2, "--height-mm");
    refuse("sensitivity --q-mm 1,2,3 --tilt-deg 1", 2, "cannot be used with");
    refuse("simulate --tilt-deg 2:-2:0.2", 2, "does not lead from 2 to -2");
    refuse("simulate --tilt-deg -2:2:0", 2, "a step of 0");
    refuse("simulate --tilt-deg -2:2:0.3", 2, "fits");
    refuse("simulate --tilt-deg -2:2", 2, "expected FROM:TO:STEP");
    refuse("simulate --tilt-deg 0:100:10", 2, "got 90°");
    refuse("simulate --azimuth-step-deg 0", 2, "--azimuth-step-deg 0");
    refuse("simulate --azimuth-step-deg 7", 2, "miss 360");
    refuse("simulate --azimuth-step-deg -10", 2, "does not lead");
    refuse(
        "simulate --azimuth-step-deg 0.001 --tilt-deg -2:2:0.00001",
        2,
        "at most 500000 are allowed",
    );
    refuse("forward --metric 1e-99", 2, "'--metric");
    refuse("simulate --azimuth-step-deg 1e-9", 2, "at most 1000000");
    refuse("simulate --out /dev/null/study", 2, "cannot write /dev/null/study: a file exists at");
    refuse("compare --figure shift.eps", 2, "must end in .svg, .png, .pdf or .tex");
    refuse("completions tcl", 2, "possible values: bash");
    refuse("forward --robot missing.toml", 2, "cannot read missing.toml");
    refuse("forward --robot .", 2, ". is a folder, but a file is needed");
    refuse("assemble four-bar --branches 0", 2, "expected a whole number from 1 to 10000");
    refuse("assemble four-bar --branches many", 2, "invalid value 'many'");
    refuse(
        "assemble four-bar --at A=1e308rad",
        2,
        "A = 1e308 rad is too large, values must be within ±62831.8530718 rad",
    );
    refuse("frobnicate", 2, "unrecognized subcommand");
}

/// Before, these were ranges of Rust ("0 is not in 1..=4294967295"), lengths in another unit, and numbers of 309 digits.
#[test]
fn messages_have_the_numbers_and_units_of_the_argument() {
    refuse("move four-bar --steps 0", 2, "expected a whole number from 1 to 100000");
    refuse("draw bennett --redundant 0", 2, "expected a whole number from 1\n");
    refuse("suggest gpr-mechanism --write 0", 2, "expected a whole number from 1\n");
    refuse("suggest gpr-mechanism --limit 0", 2, "expected a whole number from 1\n");
    refuse("suggest gpr-mechanism --joints 0", 2, "expected a whole number from 1\n");
    refuse(
        "move four-bar --tolerance-um 0 --to gltf --out scene",
        2,
        "must be positive, got 0 µm; use one such as 1 µm",
    );
    refuse("compare --text-scale 1e308 --figure a.svg", 2, "text scale is 1e308,");
    refuse("cell displacement --tilt-deg 1e300,1e300", 2, "between -90° and 90°, got 1e300°");
}

/// These were accepted, and had no effect.
#[test]
fn nothing_given_is_ignored() {
    refuse("assemble four-bar --at A=10,A=20", 2, "A has two values");
    refuse("mobility four-bar --at A=10 --at A=20", 2, "A has two values");
    refuse("jacobian four-bar --velocity A=1,A=5", 2, "A has two values");
    refuse("suggest parallelogram --command A1=5,A1=9", 2, "A1 has two values");
    refuse(
        "mobility four-bar --ignore-limits",
        2,
        "--ignore-limits applies to the three-rod robot",
    );
    refuse("cell export --to csv --dialect points", 2, "--dialect is for controller text");
    refuse("cell export --from-s 1 --dialect points", 2, "--dialect is for controller text");
}

#[test]
fn poses_beyond_the_limits() {
    let rod = "rod 3 is 800.000000 mm long, its limits are 246 to 754 mm";
    refuse("forward --q-mm 500,501,800", 1, rod);
    refuse("forward --q-mm 500,501,800", 1, "the tilt is");
    refuse("forward --q-mm -500,501,502", 1, "rod 1 is -500");
    refuse("mobility --q-mm 500,501,800", 1, rod);
    refuse("sensitivity --q-mm 500,501,800", 1, rod);
    refuse("inverse --height-mm 800", 1, "use --ignore-limits to compute it anyway");
    refuse("inverse --tilt-deg 1.6", 1, "the tilt is 1.600000°, its limit is 1.5°");
    refuse("inverse --tilt-deg -1.6 --height-of center", 1, "the tilt is 1.600000°");
    refuse("sensitivity --tilt-deg 1.6", 1, "the tilt");
    refuse("compare --tilt-deg -2:0:1", 1, "the tilt is 2.000000°");
    // However little beyond, and whether the pose could be solved or not.
    refuse("forward --q-mm 754.0000001,754,754", 1, "rod 1 is 754.0000001 mm long");
    refuse("forward --q-mm 100,500,2000 --virtualization polar", 1, "rod 3 is 2000");
    refuse("inverse --tilt-deg 60 --height-of center --virtualization polar", 1, "the tilt is 60");
    refuse("sensitivity --tilt-deg 60 --virtualization polar", 1, "the tilt is 60");
}

#[test]
fn limits_can_be_ignored_aloud() {
    let sandbox = Sandbox::new();
    for line in
        ["inverse --tilt-deg 1.6", "forward --q-mm 500,501,520", "mobility --q-mm 800,800,800"]
    {
        let text = sandbox.done(&format!("{line} --ignore-limits"));
        assert!(text.contains("limits exceeded (ignored)"), "{text}");
    }
    assert_eq!(sandbox.run("inverse --tilt-deg 1.5").code, 0, "a pose on its limit is allowed");
}

#[test]
fn programs_get_errors_as_json() {
    let run = Sandbox::new().run("forward --q-mm 500,501,800 --format json");
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    let error: serde_json::Value = serde_json::from_str(&run.stderr).unwrap();
    assert_eq!(error["error"]["kind"], "limits");
    assert_eq!(error["error"]["limits_broken"][0]["limit"], "rod 3");
    assert_eq!(error["error"]["limits_broken"][0]["found"], 800.0);
}

#[test]
fn robot_files_are_read_strictly() {
    let sandbox = Sandbox::new();
    let paper = include_str!("../../../jointplay-format/robots/gpr.toml");
    sandbox.write("same.toml", paper);
    assert_eq!(sandbox.done("forward --robot same.toml"), sandbox.done("forward"));

    sandbox.write("typo.toml", &paper.replacen("socket_radius_mm", "socket_radious_mm", 1));
    let run = sandbox.run("mobility --robot typo.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains(
        "typo.toml:13:1: unknown key `socket_radious_mm` (did you mean `socket_radius_mm`?)"
    ));
    assert!(
        run.stderr.contains("13 | socket_radious_mm = 93.218\n   | ^^^^^^^^^^^^^^^^^"),
        "{}",
        run.stderr
    );

    for (bytes, message) in [
        ([0xff, 0xfe, 0x00], "cannot read binary.toml: the text is in UTF-16; save it in UTF-8"),
        ([0x41, 0xff, 0x00], "cannot read binary.toml: the file is not text in UTF-8"),
    ] {
        std::fs::write(sandbox.file("binary.toml"), bytes).unwrap();
        let run = sandbox.run("forward --robot binary.toml");
        assert_eq!(run.code, 2);
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }

    sandbox.write("long.toml", &"#".repeat(2_000_000));
    let run = sandbox.run("forward --robot long.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("too large: at most 1000000 bytes"), "{}", run.stderr);
}

#[test]
fn turns_of_the_azimuth_change_nothing() {
    let sandbox = Sandbox::new();
    let once = sandbox.done("inverse --azimuth-deg 17 --tilt-deg 1");
    assert_eq!(sandbox.done("inverse --azimuth-deg 36000000017 --tilt-deg 1"), once);
}

#[test]
fn one_model_without_an_answer_leaves_the_others_theirs() {
    let sandbox = Sandbox::new();
    let offset = include_str!("../../../jointplay-format/robots/gpr.toml").replacen(
        "socket_angle_deg = 0.0",
        "socket_angle_deg = 0.0\nbase_point_mm = [80, 10]",
        1,
    );
    sandbox.write("offset.toml", &offset);
    let found = sandbox.json("compare --robot offset.toml --metric 1e-9");
    let models = found["models"].as_array().unwrap();
    assert!(models[1]["failure"].as_str().unwrap().contains("independently"), "{}", models[1]);
    assert!(models[3]["failure"].is_null());
    assert_eq!(models[3]["center_shift_x_um"].as_array().unwrap().len(), 7);
}

#[test]
fn a_pose_that_cannot_be_solved_is_no_answer() {
    let run = Sandbox::new()
        .run("forward --q-mm 0,400,50000 --ignore-limits --virtualization radial --solver newton");
    if run.code == 0 {
        // Solved after all: then the sides have to be met.
        assert!(run.stdout.contains("side residual"));
    } else {
        assert_eq!(run.code, 1, "{}", run.stderr);
        assert!(
            run.stderr.contains("best virtual joints")
                || run.stderr.contains("turn the platform over")
        );
    }
}
