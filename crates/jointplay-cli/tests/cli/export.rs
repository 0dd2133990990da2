//! Mechanisms as models of simulators, and their motions as 3D scenes.

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
    let run = sandbox.run(&format!("import models/gpr-mechanism.urdf {loops} --output again.toml"));
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
fn a_scene_needs_its_format_and_its_folder() {
    let sandbox = Sandbox::new();
    let motion = "move four-bar --drive A=0:90 --steps 4";
    for (flags, message) in [
        ("--exaggerate 10 --out a", "--to gltf"),
        ("--to gltf", "--out"),
        ("--to gltf --parts missing.glb --out a", "missing.glb"),
        ("--to gltf --duration-s 0 --out a", "duration"),
        ("--to gltf --tolerance-um -1 --out a", "tolerance"),
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
