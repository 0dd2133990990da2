//! The paper's studies as files: complete, reproducible, and never over files of others.

use std::collections::BTreeMap;
use std::process::Stdio;

use crate::sandbox::Sandbox;
use serde_json::Value;

/// Rows of a table by their tilt, without the sample number.
fn rows(csv: &str) -> BTreeMap<(String, String), String> {
    csv.lines()
        .skip(1)
        .map(|line| {
            let (_, rest) = line.split_once(',').unwrap();
            let mut cells = rest.splitn(3, ',');
            let mut next = || cells.next().unwrap().to_owned();
            ((next(), next()), next())
        })
        .collect()
}

#[test]
fn the_first_try_writes_everything() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("simulate");
    let names = sandbox.names("paper-study");
    for model in ["radial", "polar", "offset", "planar"] {
        assert!(names.contains(&format!("samples-{model}.csv")), "{names:?}");
        assert!(text.contains(model));
    }
    let figures = [
        "fig05-rods",
        "fig06-polar-linear",
        "fig07-polar-angular",
        "fig08-fig11-sides",
        "fig09-offset-linear",
        "fig10-offset-angular",
    ];
    for figure in figures.iter().flat_map(|figure| [(*figure).to_owned(), format!("{figure}-zoom")])
    {
        let svg = sandbox.read(&format!("paper-study/{figure}.svg"));
        let axis = if figure.ends_with("-zoom") {
            ">tilt angle (deg)</text>"
        } else {
            "tilt direction (deg)"
        };
        assert!(svg.contains("<text") && svg.contains(axis), "{figure}");
        assert!(!svg.contains("NaN"), "{figure}");
        let png = std::fs::read(sandbox.file(&format!("paper-study/{figure}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"), "{figure}");
    }
    let csv = sandbox.read("paper-study/samples-polar.csv");
    assert_eq!(csv.lines().count(), 778);
    assert_eq!(
        csv.lines().next().unwrap(),
        "sample,azimuth_deg,tilt_deg,q1_mm,q2_mm,q3_mm,L12_mm,L23_mm,L31_mm,\
         l1_mm,l2_mm,l3_mm,phi1_deg,phi2_deg,phi3_deg,x_mm,y_mm,z_mm,torsion_deg,iterations,residual_mm"
    );
    assert!(csv.lines().nth(1).unwrap().starts_with("0,0.0,-2.0,503.25"));
    assert!(names.contains(&"summary.json".to_owned()));
    // Every figure's name is explained, and none is drawn twice.
    let explained = sandbox.read("paper-study/README.md");
    let mut pictures = std::collections::BTreeMap::new();
    for name in names.iter().filter(|name| name.ends_with(".svg")) {
        let stem = name.trim_end_matches(".svg").trim_end_matches("-zoom");
        assert!(
            stem.starts_with("radial") || stem.starts_with("planar") || explained.contains(stem)
        );
        let svg = sandbox.read(&format!("paper-study/{name}"));
        assert_eq!(pictures.insert(svg, name.clone()), None, "{name}");
    }
    assert!(!text.contains("(ns)"), "a time changes from run to run");
}

#[test]
fn coincident_curves_are_named_and_drawn_once() {
    let sandbox = Sandbox::new();
    sandbox.done("simulate --virtualization polar");
    let zoom = sandbox.read("paper-study/fig06-polar-linear-zoom.svg");
    assert!(zoom.contains("l₁, l₂, l₃ (equal within 1e-5 mm)"), "{zoom}");
    assert!(zoom.contains("tilt direction 40°"));
    // Ten values for each step of the table: no visible corners.
    let longest = zoom.split(" d=\"").map(|path| path.find('"').unwrap_or(0)).max().unwrap();
    assert!(longest > 10 * 20 * "1.00 1.00".len(), "{longest}");
}

#[test]
fn the_summary_confirms_the_paper() {
    let sandbox = Sandbox::new();
    sandbox.done("simulate");
    let summary: Value = serde_json::from_str(&sandbox.read("paper-study/summary.json")).unwrap();
    assert_eq!(summary["poses"], 777);
    assert_eq!(summary["beyond_limits_on_purpose"], true);
    let side = 93.218 * 3_f64.sqrt();
    for study in summary["studies"].as_array().unwrap() {
        let name = study["virtualization"].as_str().unwrap();
        assert_eq!(study["singular_passes"], 37);
        assert!(study["most_iterations"].as_u64().unwrap() <= 3, "{name}");
        assert!(study["largest_residual_mm"].as_f64().unwrap() < 1e-9, "{name}");
        assert_eq!(study["samples_beyond_tilt_limit"], 37 * 6);
        let bounds = &study["bounds"];
        assert_eq!(
            (&bounds["poses"], &bounds["held_at_start"]),
            (&740.into(), &0.into()),
            "{name}"
        );
        assert_eq!(bounds["held_at_midpoint"], 740, "{name}");
        for series in study["series"].as_array().unwrap() {
            let what = series["name"].as_str().unwrap();
            let pass = series["at_singular_passes"].as_array().unwrap();
            let (least, most) = (pass[0].as_f64().unwrap(), pass[1].as_f64().unwrap());
            let expected = match what.chars().next().unwrap() {
                'q' => 500.0,
                'L' => side,
                'l' => 93.218,
                _ => 0.0,
            };
            let tolerance = if what.starts_with('L') { 1e-12 } else { 0.0 };
            assert!(
                (least - expected).abs() <= tolerance && (most - expected).abs() <= tolerance,
                "{name} {what}"
            );
            // At a pass every side has its extremum of the row; a rod runs through.
            let extrema = ["minimum_at_passes", "maximum_at_passes", "constant_at_passes"]
                .map(|key| series[key].as_u64().unwrap());
            match what.chars().next().unwrap() {
                'q' => assert_eq!(extrema[..2], [0, 0], "{name} {what}"),
                'L' => assert_eq!(extrema.iter().sum::<u64>(), 37, "{name} {what} {extrema:?}"),
                _ => {}
            }
        }
    }
}

#[test]
fn same_flags_same_bytes() {
    let (first, second) = (Sandbox::new(), Sandbox::new());
    first.done("simulate --azimuth-step-deg 30");
    second.done("simulate --azimuth-step-deg 30");
    second.done("simulate --azimuth-step-deg 30 --force");
    assert_eq!(first.names("paper-study"), second.names("paper-study"));
    for name in &first.names("paper-study") {
        let read = |sandbox: &Sandbox| {
            std::fs::read(sandbox.file(&format!("paper-study/{name}"))).unwrap()
        };
        assert!(read(&first) == read(&second), "{name} differs from run to run");
    }
}

#[test]
fn the_order_of_the_samples_changes_no_sample() {
    let sandbox = Sandbox::new();
    sandbox.done("simulate --azimuth-step-deg 30 --out a");
    sandbox.done("simulate --azimuth-step-deg 30 --out b --order serpentine");
    for model in ["radial", "polar", "offset", "planar"] {
        let (a, b) = (
            sandbox.read(&format!("a/samples-{model}.csv")),
            sandbox.read(&format!("b/samples-{model}.csv")),
        );
        assert_ne!(a, b);
        assert_eq!(rows(&a), rows(&b), "{model}");
    }
}

#[test]
fn a_second_run_replaces_its_own_files_on_request_only() {
    let sandbox = Sandbox::new();
    let fast = "simulate --azimuth-step-deg 180 --tilt-deg -1:1:1";
    sandbox.done(fast);
    let all = sandbox.names("paper-study").len();
    sandbox.write("paper-study/.jointplay-partial-killed", "half");
    assert_eq!(sandbox.run(&format!("{fast} --virtualization radial")).code, 2);
    assert_eq!(sandbox.names("paper-study").len(), all + 1);
    sandbox.done(&format!("{fast} --virtualization radial --force"));
    let names = sandbox.names("paper-study");
    assert!(names.len() < all && !names.contains(&"samples-polar.csv".to_owned()), "{names:?}");
    assert!(!names.iter().any(|name| name.starts_with('.')), "{names:?}");

    sandbox.write("paper-study/notes.txt", "mine");
    sandbox.write("paper-study/samples-mine.csv", "mine");
    let before = sandbox.read("paper-study/samples-radial.csv");
    let refused = sandbox.run("simulate --azimuth-step-deg 90");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("contains files"), "{}", refused.stderr);
    assert!(refused.stderr.contains("--force"), "{}", refused.stderr);
    assert_eq!(sandbox.read("paper-study/samples-radial.csv"), before);

    sandbox.done("simulate --azimuth-step-deg 90 --force");
    assert!(sandbox.names("paper-study").contains(&"notes.txt".to_owned()));
    assert_eq!(sandbox.read("paper-study/notes.txt"), "mine");
    assert_eq!(sandbox.read("paper-study/samples-mine.csv"), "mine");
    assert_ne!(sandbox.read("paper-study/samples-radial.csv"), before);
}

#[test]
fn a_folder_is_ours_only_by_its_own_summary() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.file("study")).unwrap();
    sandbox.write("study/summary.json", "my data");
    sandbox.write("study/samples-polar.parquet", "my data");
    let refused = sandbox.run("simulate --out study");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("samples-polar.parquet, summary.json"), "{}", refused.stderr);
    assert_eq!(sandbox.read("study/summary.json"), "my data");

    // A folder in the place of a file: nothing at all is written.
    std::fs::create_dir_all(sandbox.file("other/fig05-rods.svg")).unwrap();
    let refused = sandbox.run("simulate --out other --force");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("a folder has this name"), "{}", refused.stderr);
    assert_eq!(sandbox.names("other"), ["fig05-rods.svg"]);
}

#[test]
fn a_table_as_short_as_one_pose() {
    let sandbox = Sandbox::new();
    sandbox.done("simulate --azimuth-step-deg 360 --tilt-deg 1 --out one");
    assert_eq!(sandbox.read("one/samples-planar.csv").lines().count(), 3);
}

#[test]
fn the_table_reads_well() {
    let sandbox = Sandbox::new();
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r"\d\.\d+e-\d+", "[small]");
    settings.add_filter(r"(time per pose \(ns\)) .*", "$1 [measured]");
    settings.add_filter(r" +(\[small\])", " $1");
    settings.bind(|| insta::assert_snapshot!("simulate", sandbox.done("simulate")));
}

#[test]
fn a_closed_pipe_is_no_error() {
    let sandbox = Sandbox::new();
    for (line, code) in [
        ("--help", 0),
        ("mobility", 0),
        ("completions bash", 0),
        ("simulate --azimuth-step-deg 180 --tilt-deg 1", 0),
        // The answer is no, also where the reader stops early.
        ("move 3-rps --drive P1=0:300", 1),
    ] {
        let mut child =
            sandbox.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(!stderr.contains("panicked"), "{line}: {stderr}");
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
    }
}

#[test]
fn the_manual_has_a_page_for_each_command() {
    let sandbox = Sandbox::new();
    assert!(sandbox.done("manual").starts_with(".ie"));
    sandbox.done("manual --out man");
    let pages = sandbox.names("man");
    assert!(
        pages.contains(&"jointplay.1".to_owned())
            && pages.contains(&"jointplay-simulate.1".to_owned())
    );
    assert!(sandbox.read("man/jointplay-simulate.1").contains("azimuth"));
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_instead_of_csv() {
    let sandbox = Sandbox::new();
    sandbox.done("simulate --azimuth-step-deg 90 --table parquet");
    let bytes = std::fs::read(sandbox.file("paper-study/samples-polar.parquet")).unwrap();
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    assert!(!sandbox.names("paper-study").iter().any(|name| name.ends_with(".csv")));
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_build_without_parquet_names_the_feature() {
    let run = Sandbox::new().run("simulate --table parquet");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("--features parquet"), "{}", run.stderr);
}
