//! Mechanisms as models of simulators and as units, and their motions as 3D scenes.

use crate::sandbox::Sandbox;

#[test]
fn models_are_written_and_read_again() {
    let sandbox = Sandbox::new();
    let found = sandbox.json("export gpr-mechanism --to mjcf,sdf,urdf,mjcf --out models");
    let exports = found["exports"].as_array().unwrap();
    assert_eq!(exports.len(), 3);
    for export in exports {
        assert!(!export["lost"].as_array().unwrap().is_empty(), "{export}");
    }
    let files = exports[2]["files"].as_array().unwrap();
    assert_eq!(files.len(), 2, "{files:?}");
    // The virtual joints are joints now, so that the robot tilts.
    let loops = "--loops models/gpr-mechanism-loops.toml";
    let run = sandbox.run(&format!("import models/gpr-mechanism.urdf {loops} --out again.toml"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    for model in ["models/gpr-mechanism.xml", "models/gpr-mechanism.sdf", "again.toml"] {
        // The reader lists the elements of simulators that it ignores.
        let run = sandbox.run(&format!("mobility {model} --format json"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let mobility: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(mobility["finite_mobility"], 3, "{model}");
        assert_eq!(mobility["redundancy"], 0, "{model}");
    }
    // A folder with files is not written into.
    let run = sandbox.run("export four-bar --to sdf --out models");
    assert_eq!(run.code, 2, "{}", run.stderr);
    let run = sandbox.run("export gpr-mechanism --to mjcf --rigid --out rigid");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let run = sandbox.run("mobility rigid/gpr-mechanism.xml --format json");
    let mobility: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(mobility["redundancy"], 3);
    // A reference that rigid links cannot close.
    let run = sandbox.run(
        "export gpr-mechanism --to mjcf --rigid --at \"rod 1=3,rod 2=0,rod 3=0\" --out tilted",
    );
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(!sandbox.file("tilted").exists());
}

#[test]
fn packages_in_modelica_have_the_name_of_their_file() {
    let sandbox = Sandbox::new();
    let found = sandbox.json("export gpr-mechanism --to modelica --out models");
    assert_eq!(found["exports"][0]["format"], "Modelica");
    assert_eq!(found["exports"][0]["files"][0], "models/GprMechanism.mo");
    let text = sandbox.read("models/GprMechanism.mo");
    assert!(text.starts_with("package GprMechanism \""), "{text}");
    assert!(text.ends_with("end GprMechanism;\n"), "{text}");
    assert!(
        text.contains("    RealInput drive_rod_1(start = 0, min = -0.254, max = 0.254"),
        "{text}"
    );
    // Names that no class can have.
    let mechanism = include_str!("../../../jointplay-format/robots/four-bar.toml");
    for (file, class) in [("2 bars.toml", "M2Bars"), ("real.toml", "MReal"), ("ü.toml", "M")] {
        sandbox.write(file, mechanism);
        let run = sandbox.run(&format!("export \"{file}\" --to modelica --out {class}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let text = sandbox.read(&format!("{class}/{class}.mo"));
        assert!(text.starts_with(&format!("package {class} ")), "{text}");
    }
}

#[test]
fn a_scene_needs_its_format_and_its_folder() {
    let sandbox = Sandbox::new();
    let motion = "move four-bar --drive A=0:90 --steps 4";
    for (flags, message) in [
        ("--exaggerate 10 --out a", "--to gltf"),
        ("--to gltf", "--out"),
        ("--to gltf --parts missing.glb --out a", "missing.glb"),
        ("--to gltf --duration-s 0 --out a", "duration"),
        ("--to gltf --tolerance-um -1 --out a", "must be positive, got -1 µm"),
        ("--to gltf --part a=b --out a", "--parts"),
    ] {
        let run = sandbox.run(&format!("{motion} {flags}"));
        assert!(run.code == 2 && run.stderr.contains(message), "{flags}: {}", run.stderr);
    }
    sandbox.write("parts.glb", "solid");
    let run = sandbox.run(&format!("{motion} --to gltf --parts parts.glb --out a"));
    assert!(run.code == 2 && run.stderr.contains("not binary glTF"), "{}", run.stderr);
    let run = sandbox.run(&format!("{motion} --to gltf,csv --out scene"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    let scene = std::fs::read(sandbox.file("scene/four-bar-motion.glb")).unwrap();
    assert!(scene.starts_with(b"glTF"));
    assert!(sandbox.file("scene/four-bar-motion.csv").exists());
}

/// The rows of a table are shown at its times, by default in their seconds.
#[test]
fn a_scene_of_a_table_has_the_times_of_its_variable() {
    let sandbox = Sandbox::new();
    sandbox.write("timed.csv", "time_s,A_deg\n10,0\n11,40\n14.5,60\n16,90\n");
    sandbox.write("turns.csv", "share,A_deg\n3,0\n2,40\n0,90\n");
    for (flags, duration) in [
        ("--table timed.csv", 6.0),
        ("--table timed.csv --duration-s 3", 3.0),
        ("--table turns.csv", 4.0),
        ("--drive A=0:90 --steps 4", 4.0),
    ] {
        sandbox.done(&format!("move four-bar {flags} --to gltf --out scene --force"));
        let document = sandbox.scene("scene/four-bar-motion.glb");
        let samplers = document["animations"][0]["samplers"].as_array().unwrap();
        assert!(!samplers.is_empty());
        for sampler in samplers {
            let input = &document["accessors"][sampler["input"].as_u64().unwrap() as usize];
            assert_eq!(
                (&input["min"][0], &input["max"][0]),
                (&0.0.into(), &duration.into()),
                "{flags}"
            );
        }
    }
}

#[test]
fn units_are_written_with_the_libraries_of_their_platforms() {
    let sandbox = Sandbox::new();
    let mark = jointplay::interop::fmu::library_mark();
    let library = |head: &[u8]| [head, mark.as_bytes()].concat();
    let mut elf = b"\x7fELF\x02\x01".to_vec();
    elf.resize(18, 0);
    elf.extend([0x3e, 0]);
    std::fs::write(sandbox.file("linux.so"), library(&elf)).unwrap();
    let mac = [0xcf, 0xfa, 0xed, 0xfe, 0x0c, 0, 0, 1];
    std::fs::write(sandbox.file("mac.dylib"), library(&mac)).unwrap();
    std::fs::write(sandbox.file("other.so"), &elf).unwrap();
    sandbox.write("fixed.toml", "kind = \"mechanism\"\nname = \"Fixed\"\nunits = { length = \"m\", angle = \"rad\" }\nbase = \"a\"\n\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nlinks = [\"a\", \"b\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\n");
    let both = "--library linux.so --library mac.dylib";
    let written = sandbox.json(&format!("export hexapod --to fmu,sdf {both} --out units"));
    assert_eq!(written["exports"][0]["files"][0], "units/hexapod.fmu");
    let first = std::fs::read(sandbox.file("units/hexapod.fmu")).unwrap();
    assert!(first.starts_with(b"PK"));
    // The same bytes again.
    sandbox.done(&format!("export hexapod --to fmu {both} --out again"));
    assert_eq!(std::fs::read(sandbox.file("again/hexapod.fmu")).unwrap(), first);
    for command in [
        "gpr --to fmu --fmi 3 --virtualization offset --q-mm 500,501,502",
        "four-bar --to fmu --at A=30 --set crank=0.09",
        "bennett --to fmu --rigid",
    ] {
        let out = command.split(' ').next().unwrap();
        sandbox.done(&format!("export {command} --library linux.so --out out-{out}"));
    }
    for (flags, code, message) in [
        ("four-bar --to sdf --fmi 3", 2, "--fmi needs --to fmu"),
        ("four-bar --to sdf --library linux.so", 2, "--library needs --to fmu"),
        ("gpr --to mjcf --q-mm 500,500,500", 2, "--q-mm needs --to fmu"),
        ("four-bar --to fmu --library missing.so", 2, "missing.so"),
        ("four-bar --to fmu --library other.so", 2, "other.so: it is not jointplay's library"),
        ("four-bar --to fmu --library fixed.toml", 2, "not a shared library"),
        ("four-bar --to fmu --library linux.so --library linux.so", 2, "two libraries"),
        ("four-bar --to fmu --library linux.so --virtualization polar", 2, "--virtualization"),
        ("gpr --to fmu --library linux.so --at \"rod 1=1\"", 2, "--q-mm"),
        ("gpr --to fmu --library linux.so --rigid", 2, "--rigid"),
        ("gpr --to fmu --library linux.so --q-mm 900,500,500", 1, "limits exceeded"),
        ("fixed.toml --to fmu --library linux.so", 2, "actuated = true"),
        ("delta --to fmu --library linux.so", 1, "leave 6 motions free: the spins of rod 1 left"),
        ("four-bar --to fmu --library linux.so --fmi 4", 2, "possible values: 2, 3"),
    ] {
        let run = sandbox.run(&format!("export {flags} --out refused"));
        assert!(run.code == code && run.stderr.contains(message), "{flags}: {}", run.stderr);
        assert!(!sandbox.file("refused").exists(), "{flags}");
    }
}
