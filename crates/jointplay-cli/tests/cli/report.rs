//! `jointplay cell report`: the page, the comparison and the PDF.

use crate::sandbox::Sandbox;

/// A cell with two stations, and a name that HTML would take for an element.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run("cell example --out .").code, 0);
    let cell = sandbox.read("example.toml");
    let name = cell.lines().find(|line| line.starts_with("name = ")).unwrap();
    sandbox.write("cell.toml", &cell.replacen(name, "name = \"<script> & \\\"quotes\\\"\"", 1));
    sandbox.write("slow.program", "SPEED 70 % # <b>\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\n");
    sandbox.write("fast.program", "TRANSFER LP1 SLOT 1 TO ALIGN WITH A # <b>\n");
    sandbox
}

#[test]
fn a_report_is_one_page_without_other_files_or_scripts() {
    let sandbox = sandbox();
    let line = format!(
        "cell report {} fast.program --before slow.program",
        sandbox.file("cell.toml").display()
    );
    let run = sandbox.run(&line);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = sandbox.read("cell-report.html");
    for expected in [
        "program fast.program",
        "Check passed",
        "Before and after",
        "arm with A",
        "Values without a known source",
        "Planes of the taught stations",
        "&lt;script&gt; &amp; &quot;quotes&quot;",
        "TRANSFER LP1 SLOT 1 TO ALIGN WITH A # &lt;b&gt;",
    ] {
        assert!(page.contains(expected), "{expected}");
    }
    for foreign in ["<script", "<b>&", "src=", "@import", "url("] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let links = page.matches("http").count();
    assert_eq!(links, page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count());
    // An existing file is kept.
    let again = sandbox.run("cell report cell.toml fast.program");
    assert_eq!(again.code, 2);
    assert!(again.stderr.contains("cell-report.html"), "{}", again.stderr);
}

#[test]
fn the_figures_of_a_report_are_those_of_the_check() {
    let sandbox = sandbox();
    let check = sandbox.json("cell check cell.toml slow.program");
    let report = sandbox.json("cell report cell.toml fast.program --before slow.program");
    let value = |of: &str, name: &str| {
        let figures = report[of].as_array().unwrap();
        let found = figures.iter().find(|one| one["name"] == name).unwrap();
        found["value"].as_f64().unwrap()
    };
    assert_eq!(value("before", "duration"), check["duration_s"].as_f64().unwrap());
    let nearest = check["nearest"][0]["distance_mm"].as_f64().unwrap();
    assert_eq!(value("before", "smallest distance"), nearest);
    assert!(value("key_figures", "duration") < value("before", "duration"));
    assert_eq!(report["file"], "cell-report.html");
}

#[test]
fn the_earlier_program_can_have_its_own_values_of_parameters() {
    let sandbox = sandbox();
    let text = "PARAMETER lot = 1 FROM 1 TO 3\nREPEAT lot AS n\n  TRANSFER LP1 SLOT n TO LP2 SLOT n WITH A\nEND\n";
    sandbox.write("lot.program", text);
    let durations = |options: &str| {
        let options = format!("cell report cell.toml lot.program --force {options}");
        let report = sandbox.json(&options);
        ["key_figures", "before"].map(|of| {
            let figures = report[of].as_array().unwrap();
            figures.iter().find(|one| one["name"] == "duration").unwrap()["value"].as_f64().unwrap()
        })
    };
    let [after, before] = durations("--set lot=2 --before lot.program --before-set lot=1");
    assert!(after > 1.5 * before, "{after} {before}");
    // Without values of its own, the earlier program has those of the other.
    assert_eq!(durations("--set lot=2 --before lot.program"), [after, after]);
    let refused = sandbox.run("cell report cell.toml lot.program --before-set lot=1");
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("--before <PROGRAM>"), "{}", refused.stderr);
}

#[test]
fn a_report_on_violations_lists_them_and_exits_with_1() {
    let sandbox = sandbox();
    let cell = sandbox.read("cell.toml");
    let wall = "\n[[body]]\nname = \"post\"\nposition_mm = [150.0, 150.0, 600.0]\nbox = { size_mm = [60.0, 60.0, 900.0] }\n";
    sandbox.write("blocked.toml", &(cell + wall));
    sandbox.write("turn.program", "MOVE T -90 deg\nMOVE T 90 deg\n");
    let run = sandbox.run("cell report blocked.toml turn.program");
    let page = sandbox.read("cell-report.html");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(page.contains("not safe to run") && !page.contains("Check passed"));
    assert!(page.contains("Violations by cause"));
    assert!(page.contains("<span class=\"violation\">"));
}

#[cfg(unix)]
#[test]
fn a_report_is_printed_by_a_browser_or_not_written() {
    use std::os::unix::fs::PermissionsExt as _;
    let sandbox = sandbox();
    let browser = |script: &str| {
        sandbox.write("browser", &format!("#!/bin/sh\n{script}\n"));
        let path = sandbox.file("browser");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        let line = "cell report cell.toml fast.program --browser browser --out report.pdf";
        sandbox.run(line)
    };
    for (script, message) in [
        ("echo 'no display' >&2; exit 3", "no display"),
        ("exit 0", "it wrote no file"),
        (
            "for a in \"$@\"; do case $a in --print-to-pdf=*) echo html > \"${a#*=}\";; esac; done",
            "is not a PDF",
        ),
    ] {
        let run = browser(script);
        assert_ne!(run.code, 0, "{script}");
        assert!(run.stderr.contains(message), "{script}: {}", run.stderr);
        assert!(!sandbox.file("report.pdf").exists(), "{script}");
    }
    // The page is the last argument.
    let copy = "for a in \"$@\"; do case $a in --print-to-pdf=*) pdf=${a#*=};; esac; page=$a; done; (echo %PDF-1.4; cat \"$page\") > \"$pdf\"";
    let run = browser(copy);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let printed = sandbox.read("report.pdf");
    assert!(printed.starts_with("%PDF-1.4\n<!DOCTYPE html>"), "{}", &printed[..60]);
    let missing = sandbox.run("cell report cell.toml fast.program --browser nowhere --out b.pdf");
    assert_eq!(missing.code, 2);
    assert!(missing.stderr.contains("nowhere"), "{}", missing.stderr);
    let unknown = sandbox.run("cell report --out report.docx");
    assert_eq!(unknown.code, 2);
}
