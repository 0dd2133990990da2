//! Behaviour common to all commands: files, names of the catalogue, standard input, overwriting, usage errors.

use std::io::Write as _;
use std::process::{Output, Stdio};

use serde_json::Value;

use crate::sandbox::Sandbox;

/// Runs a line with a text on standard input: exit code, standard output, standard error.
fn with_input(sandbox: &Sandbox, line: &str, text: &str) -> (i32, String, String) {
    let mut command = sandbox.command(line);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

#[track_caller]
fn refused(sandbox: &Sandbox, line: &str, parts: &[&str]) {
    let run = sandbox.run(line);
    assert_eq!(run.code, 2, "{line}: {}", run.stderr);
    for part in parts {
        assert!(run.stderr.contains(part), "{line}: {part}: {}", run.stderr);
    }
}

#[test]
fn catalogue_names_work_wherever_a_file_does() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.done("forward --robot gpr"), sandbox.done("forward"));
    assert_eq!(sandbox.done("mobility gpr"), sandbox.done("mobility"));
    for line in ["mobility benett", "draw benett", "move benett", "assemble benett"] {
        refused(&sandbox, line, &["`benett` is not known (did you mean `bennett`?)"]);
    }
    refused(&sandbox, "forward --robot gprr", &["did you mean `gpr`?"]);
    refused(&sandbox, "cell check exampel", &["`exampel` is not known"]);
}

#[test]
fn a_file_of_another_kind_is_refused_with_its_commands() {
    let sandbox = Sandbox::new();
    sandbox.write("study.toml", crate::study::SMALL);
    sandbox.write("cell.toml", include_str!("../../../jointplay-format/cells/example.toml"));
    sandbox.write("loops.toml", crate::import::LOOPS);
    for (line, parts) in [
        ("study gpr", ["is a three-rod robot", "jointplay draw, move, suggest or jacobian gpr"]),
        ("mobility dual-arm", ["is a robot with arms", "robot = \"dual-arm\""]),
        ("forward --robot hexapod", ["is a mechanism", "jointplay import hexapod --to gpr"]),
        ("forward --robot cell.toml", ["is a work cell", "jointplay cell check cell.toml"]),
        ("cell check dual-arm", ["is a robot with arms", "a work cell is needed"]),
        ("cell check study.toml", ["is a study", "jointplay study study.toml"]),
        ("study bennett", ["is a mechanism", "a study is needed"]),
        ("study cell.toml", ["is a work cell", "a study is needed"]),
        ("import bennett", ["is a mechanism", "a model of MuJoCo"]),
        ("import dual-arm --to gpr", ["is a robot with arms", "a mechanism or a model is needed"]),
        ("draw loops.toml", ["is a file of loops", "--loops loops.toml"]),
        ("simulate --robot study.toml", ["is a study", "a three-rod robot is needed"]),
    ] {
        refused(&sandbox, line, &parts);
    }
    #[cfg(feature = "studio")]
    refused(&sandbox, "studio --cell hexapod --no-open", &["is a mechanism", "studio hexapod"]);
    #[cfg(feature = "studio")]
    refused(&sandbox, "studio hexapod --mechanism bennett --no-open", &["given twice"]);
    #[cfg(feature = "studio")]
    refused(&sandbox, "studio hexapod --loops x.toml --no-open", &["--loops needs a model"]);
    #[cfg(feature = "studio")]
    refused(&sandbox, "studio --loops x.toml --no-open", &["name its file too"]);
}

/// A file of each kind with a part of the noun that names it, and how it is read.
fn files_of_all_kinds(sandbox: &Sandbox) -> Vec<(&'static str, &'static str, &'static str)> {
    sandbox.write("study.toml", crate::study::SMALL);
    sandbox.write("loops.toml", crate::import::LOOPS);
    sandbox.write("closures.yaml", crate::import::CLOSURES);
    sandbox.write("robot.urdf", crate::import::URDF);
    sandbox.write("cell.toml", include_str!("../../../jointplay-format/cells/example.toml"));
    sandbox.write("lot.program", include_str!("../../../jointplay-format/cells/example.program"));
    // The name of a file does not decide.
    sandbox.write("lot.toml", "# A program.\nparameter n = 2\nhome\nREPEAT n\n  WAIT 1 s\nEND\n");
    sandbox.write("part.toml", include_str!("../../../jointplay-format/parts/aligner.toml"));
    sandbox.write(
        "drawing.svg",
        "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<svg xmlns=\"http://www.w3.org/2000/svg\"/>\n",
    );
    std::fs::write(sandbox.file("picture.png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap();
    std::fs::write(sandbox.file("paper.pdf"), b"%PDF-1.7\n").unwrap();
    // An archive with one empty entry, as the tool `zip` writes it.
    let mut archive =
        b"PK\x03\x04\n\0\0\0\0\0\0\0!\0\0\0\0\0\0\0\0\0\0\0\0\0\x14\0\0\0modelDescription.xml"
            .to_vec();
    let start = u32::try_from(archive.len()).unwrap();
    archive.extend(b"PK\x01\x02\x1e\x03\n\0\0\0\0\0\0\0!\0\0\0\0\0\0\0\0\0\0\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0modelDescription.xml");
    let length = u32::try_from(archive.len()).unwrap() - start;
    archive.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    archive.extend(length.to_le_bytes().into_iter().chain(start.to_le_bytes()).chain([0, 0]));
    std::fs::write(sandbox.file("unit.fmu"), archive).unwrap();
    vec![
        ("bennett", "a mechanism", "jointplay mobility, assemble"),
        ("robot.urdf", "a model of another program", "jointplay mobility, assemble"),
        ("gpr", "a three-rod robot", "jointplay forward, inverse"),
        ("dual-arm", "a robot with arms", "robot = \"dual-arm\""),
        ("cell.toml", "a work cell", "jointplay cell check cell.toml"),
        ("part.toml", "a part of work cells", "part = \"part.toml\""),
        ("lot.program", "a program of a work cell", "jointplay cell check CELL lot.program"),
        ("lot.toml", "a program of a work cell", "jointplay cell check CELL lot.toml"),
        ("study.toml", "a study", "jointplay study study.toml"),
        ("loops.toml", "a file of loops", "--loops loops.toml"),
        ("closures.yaml", "a file of loops", "--loops closures.yaml"),
        ("drawing.svg", "a picture", "which no command reads"),
        ("picture.png", "a picture", "which no command reads"),
        ("paper.pdf", "a picture", "which no command reads"),
        ("unit.fmu", "a functional mock-up unit (FMU)", "which no command reads"),
    ]
}

/// Every kind of file for every command that reads another one: what the file is, and its command.
#[test]
fn each_command_names_files_of_all_other_kinds() {
    const MECHANISMS: [&str; 3] =
        ["a mechanism", "a model of another program", "a three-rod robot"];
    let sandbox = Sandbox::new();
    let files = files_of_all_kinds(&sandbox);
    let named: Vec<&str> = files.iter().map(|(_, noun, _)| *noun).collect();
    for kind in jointplay::interop::FileKind::ALL {
        assert!(named.contains(&kind.noun()), "a file of the kind {kind:?} is not tried");
    }
    let mut lines: Vec<(String, &[&str])> = Vec::new();
    for command in ["mobility", "assemble", "draw", "suggest", "jacobian", "move"] {
        lines.push((format!("{command} FILE"), &MECHANISMS));
    }
    lines.push(("export FILE --to urdf --out model".to_owned(), &MECHANISMS));
    lines.push(("import FILE".to_owned(), &["a model of another program", "a three-rod robot"]));
    for command in ["forward", "inverse", "simulate", "sensitivity"] {
        lines.push((format!("{command} --robot FILE"), &["a three-rod robot"]));
    }
    lines.push(("compare --robot FILE".to_owned(), &["a three-rod robot", "a robot with arms"]));
    lines.push(("study FILE --out -".to_owned(), &["a study"]));
    for command in ["check", "run", "report", "export", "teach", "displacement", "expand", "serve"]
    {
        lines.push((format!("cell {command} FILE"), &["a work cell"]));
    }
    lines.push(("cell check cell.toml FILE".to_owned(), &["a program of a work cell"]));
    lines.push(("cell format FILE".to_owned(), &["a program of a work cell"]));
    #[cfg(feature = "studio")]
    {
        let kinds =
            &["a mechanism", "a model of another program", "a three-rod robot", "a work cell"];
        lines.push(("studio FILE --no-open".to_owned(), kinds));
        lines.push(("studio --cell FILE --no-open".to_owned(), &["a work cell"]));
        lines.push(("studio --mechanism FILE --no-open".to_owned(), &MECHANISMS));
    }
    for (line, accepted) in &lines {
        for (file, noun, used) in &files {
            if accepted.contains(noun) {
                continue;
            }
            let line = line.replace("FILE", file);
            refused(&sandbox, &line, &[&format!("error: {file} is {noun}, "), used]);
            let printed = sandbox.run(&line).stderr;
            assert_eq!(
                printed.lines().filter(|line| !line.starts_with("  ")).count(),
                1,
                "{line}: {printed}"
            );
        }
    }
    refused(&sandbox, "mobility .", &["is a folder, but a file is needed"]);
}

#[test]
fn files_come_from_standard_input_too() {
    let sandbox = Sandbox::new();
    let bennett = sandbox.done("catalogue show bennett");
    let (code, out, _) = with_input(&sandbox, "mobility -", &bennett);
    assert_eq!((code, out), (0, sandbox.done("mobility bennett")));
    let (code, out, _) = with_input(&sandbox, "import - --out -", crate::import::URDF);
    assert_eq!(code, 0);
    assert!(out.contains("kind = \"mechanism\""), "{out}");
    let invalid = bennett.replace("joint", "jiont");
    let (code, _, error) = with_input(&sandbox, "mobility -", &invalid);
    assert_eq!(code, 2);
    assert!(error.contains("standard input:"), "{error}");
    let (code, _, error) = with_input(&sandbox, "cell check - -", "kind = \"cell\"");
    assert_eq!(code, 2);
    assert!(error.contains("only once"), "{error}");
}

#[test]
fn no_command_replaces_a_file_unasked() {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", crate::import::URDF);
    sandbox.write("study.toml", crate::study::SMALL);
    for (line, file) in [
        ("compare --figure file.svg", "file.svg"),
        ("draw bennett --figure file.svg", "file.svg"),
        ("cell teach --figure file.svg", "file.svg"),
        ("import robot.urdf --out file.toml", "file.toml"),
        ("catalogue copy bennett .", "bennett.toml"),
        ("cell example --out .", "example.program"),
        ("study study.toml --out file.csv", "file.csv"),
        ("manual --out .", "jointplay-cell-check.1"),
    ] {
        sandbox.write(file, "mine");
        refused(&sandbox, line, &[file, "--force"]);
        assert_eq!(sandbox.read(file), "mine", "{line}");
        assert_eq!(sandbox.run(&format!("{line} --force")).code, 0, "{line}");
        assert_ne!(sandbox.read(file), "mine", "{line}");
    }
    for line in ["simulate --azimuth-step-deg 360", "move four-bar"] {
        std::fs::create_dir_all(sandbox.file("results")).unwrap();
        sandbox.write("results/notes.txt", "mine");
        refused(&sandbox, &format!("{line} --out results"), &["notes.txt", "--force"]);
        assert_eq!(sandbox.names("results"), ["notes.txt"]);
        sandbox.done(&format!("{line} --out results --force"));
        assert_eq!(sandbox.read("results/notes.txt"), "mine");
        std::fs::remove_dir_all(sandbox.file("results")).unwrap();
    }
}

#[test]
fn usage_errors_are_json_where_json_is_asked_for() {
    let sandbox = Sandbox::new();
    for line in [
        "forward --format json --q-mm 1,2",
        "mobility --format=json --frobnicate",
        "cell check --format json a b c",
    ] {
        let run = sandbox.run(line);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}");
        let error: Value = serde_json::from_str(&run.stderr).unwrap();
        assert_eq!(error["error"]["kind"], "usage", "{line}");
        let message = error["error"]["message"].as_str().unwrap();
        assert!(!message.contains("Usage:") && !message.starts_with("error"), "{message}");
    }
    assert!(sandbox.run("forward --q-mm 1,2").stderr.starts_with("error: "));
}

#[test]
fn every_command_prints_json() {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", crate::import::URDF);
    sandbox.write("one.program", crate::cell::SMALL);
    let list = sandbox.json("catalogue");
    assert_eq!(list, sandbox.json("catalogue list"));
    let entries = list["entries"].as_array().unwrap();
    let bennett = entries.iter().find(|entry| entry["name"] == "bennett").unwrap();
    assert_eq!((&bennett["finite_mobility"], &bennett["kind"]), (&1.into(), &"mechanism".into()));
    let parts = list["parts"].as_array().unwrap();
    assert_eq!(sandbox.json("catalogue parts")["parts"], list["parts"]);
    for part in parts {
        let name = part["name"].as_str().unwrap();
        let shown = sandbox.json(&format!("catalogue show {name}"));
        assert_eq!(shown["parameters"], part["parameters"]);
        let parameter = part["parameters"][0]["name"].as_str().unwrap();
        assert!(sandbox.done(&format!("catalogue parts {name}")).contains(parameter), "{name}");
        assert!(shown["text"].as_str().unwrap().contains("kind = \"part\""), "{name}");
        // A name means one file.
        assert!(entries.iter().all(|entry| entry["name"] != name), "{name}");
    }
    assert!(parts.len() > 9);
    let text = sandbox.done("catalogue show bennett");
    assert_eq!(sandbox.json("catalogue show bennett")["text"], text);
    assert_eq!(sandbox.json("catalogue copy bennett")["file"], "./bennett.toml");
    assert_eq!(sandbox.json("draw bennett")["svg"], sandbox.done("draw bennett"));
    assert_eq!(sandbox.json("draw bennett --figure b.svg")["figure"], "b.svg");
    let imported = sandbox.json("import robot.urdf");
    assert_eq!((&imported["model_format"], &imported["file"]), (&"URDF".into(), &Value::Null));
    assert!(imported["text"].as_str().unwrap().contains("kind = \"mechanism\""), "{imported}");
    assert_eq!(sandbox.json("import robot.urdf --out robot.toml")["file"], "robot.toml");
    assert_eq!(sandbox.json("cell example --out c")["program"], "c/example.program");
    assert_eq!(sandbox.json("cell format one.program")["changed"], false);
    let summary = sandbox.json("simulate --azimuth-step-deg 360 --virtualization planar");
    assert_eq!(summary["poses"], 42);
    for line in
        ["catalogue show benett", "draw benett", "import nothing.urdf", "simulate --robot benett"]
    {
        let run = sandbox.run(&format!("{line} --format json"));
        let error: Value = serde_json::from_str(&run.stderr).unwrap();
        assert_eq!((run.code, &error["error"]["kind"]), (2, &"input".into()), "{line}");
    }
}

#[test]
fn negative_numbers_with_an_exponent_are_values() {
    let sandbox = Sandbox::new();
    let same = |one: &str, other: &str| assert_eq!(sandbox.done(one), sandbox.done(other), "{one}");
    same("inverse --tilt-deg -1.5e-05", "inverse --tilt-deg=-0.000015");
    same("compare --tilt-deg -1e0:1e0:5e-1", "compare --tilt-deg=-1:1:0.5");
    same("draw bennett --view -3e1,20", "draw bennett --view=-30,20");
}

#[test]
fn every_page_of_the_manual_refers_to_pages_that_are_written() {
    let sandbox = Sandbox::new();
    sandbox.done("manual --out pages");
    let names = sandbox.names("pages");
    assert!(names.len() > 25, "{names:?}");
    for name in &names {
        let page = sandbox.read(&format!("pages/{name}"));
        let words = page.split_whitespace().filter_map(|word| word.strip_suffix("(1)"));
        for word in words.filter(|word| word.starts_with("jointplay")) {
            let other = format!("{}.1", word.replace('\\', ""));
            assert!(names.contains(&other), "{name} refers to {other}");
        }
    }
}

#[test]
fn notes_are_left_out_and_details_added_on_request() {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", crate::import::URDF);
    let plain = sandbox.run("compare --figure a.svg -v");
    assert_eq!(plain.code, 0);
    assert!(plain.stderr.contains("a.svg: written"), "{}", plain.stderr);
    assert_eq!(sandbox.run("mobility robot.urdf -q").stderr, "");
    let coloured = sandbox.done("mobility --color always");
    assert!(coloured.contains('\u{1b}'), "{coloured}");
    refused(&sandbox, "mobility -q -v", &["cannot be used with"]);
}

#[cfg(unix)]
#[test]
fn a_cell_names_no_file_outside_its_folder_by_a_link() {
    use std::os::unix::fs::symlink;
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.file("cell")).unwrap();
    let cell = include_str!("../../../jointplay-format/cells/example.toml");
    sandbox.write("cell/example.toml", &cell.replace("\"dual-arm\"", "\"robot.toml\""));
    sandbox.write("cell/example.program", "HOME\n");
    sandbox.write("robot.toml", include_str!("../../../jointplay-format/robots/dual-arm.toml"));
    symlink("../robot.toml", sandbox.file("cell/robot.toml")).unwrap();
    refused(&sandbox, "cell check cell/example.toml", &["leads out of the folder"]);
}

/// Whether a process handles Ctrl-C itself, as the system reports it.
#[cfg(target_os = "linux")]
fn handles_interrupts(process: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    caught.is_some_and(|mask| mask & 0b10 != 0)
}

#[cfg(target_os = "linux")]
#[test]
fn long_motions_can_be_interrupted() {
    let sandbox = Sandbox::new();
    for line in ["move four-bar --drive A=0:3e6 --out path", "draw four-bar --ghost A=3e6"] {
        let mut command = sandbox.command(line);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while !handles_interrupts(child.id()) {
            assert!(child.try_wait().unwrap().is_none(), "{line} ended by itself");
            std::thread::yield_now();
        }
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
        assert!(!sandbox.file("path").exists());
    }
}

#[test]
fn completion_offers_catalogue_names_and_files_in_every_shell() {
    let sandbox = Sandbox::new();
    sandbox.write("bearing.toml", "");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = sandbox.done(&format!("completions {shell}"));
        assert!(script.contains("JOINTPLAY_COMPLETE"), "{shell}: {script}");
        let candidates = |line: &str| {
            let mut command = sandbox.command(&format!("-- jointplay {line}"));
            let index = line.split(' ').count().to_string();
            command.env("JOINTPLAY_COMPLETE", shell).env("_CLAP_IFS", "\n");
            command.env("_CLAP_COMPLETE_INDEX", index);
            String::from_utf8(command.output().unwrap().stdout).unwrap()
        };
        for (line, expected) in [
            ("mobility be", &["bennett", "bennett-network", "bearing.toml"][..]),
            ("catalogue show gpr", &["gpr", "gpr-mechanism"]),
            ("forward --robot gp", &["gpr"]),
            ("study tol", &["tolerances"]),
            ("sim", &["simulate"]),
        ] {
            let found = candidates(line);
            for name in expected {
                assert!(found.contains(name), "{shell}, {line}: {name}: {found}");
            }
        }
        assert!(!candidates("forward --robot gp").contains("gpr-mechanism"), "{shell}");
    }
}

#[test]
fn a_missing_quote_is_the_only_error() {
    let sandbox = Sandbox::new();
    let cell = include_str!("../../../jointplay-format/cells/example.toml");
    let invalid: Vec<String> = cell
        .lines()
        .enumerate()
        .map(
            |(k, line)| {
                if k == 26 { "    [\"hub\", \"upper-a/".to_owned() } else { line.to_owned() }
            },
        )
        .collect();
    sandbox.write("c.toml", &invalid.join("\n"));
    sandbox.write("c.program", "HOME\n");
    let run = sandbox.run("cell check c.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.starts_with("error: c.toml:27:"), "{}", run.stderr);
    assert_eq!(run.stderr.lines().count(), 4, "{}", run.stderr);
}
