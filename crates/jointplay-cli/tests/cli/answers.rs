//! Answers of `forward`, `inverse`, `mobility`, `sensitivity` and `compare`, as text and as JSON.

use crate::sandbox::{Sandbox, three};
use serde_json::Value;

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}

/// The reference tilt: rods of azimuth 0°, tilt angle 2° at 500 mm.
const TILTED: &str =
    "--q-mm 496.74475570951826,501.62762214524087,501.62762214524087 --ignore-limits";

#[test]
fn forward_has_every_key() {
    let pose =
        Sandbox::new().json(&format!("forward {TILTED} --virtualization polar --solver newton"));
    near(three(&pose["virtual_joints"]["l_mm"])[0], 93.246425437, 1e-9);
    near(three(&pose["virtual_joints"]["l_mm"])[1], 93.246415634, 1e-9);
    near(three(&pose["virtual_joints"]["phi_deg"])[1].to_radians(), 5.27578962e-4, 1e-12);
    near(three(&pose["sides_mm"])[1], 93.218 * 3_f64.sqrt(), 1e-9);
    assert_eq!(pose["virtualization"], "polar");
    assert_eq!(pose["solver"], "newton");
    assert_eq!(pose["characteristic_length_mm"], 1.0);
    assert!(pose["iterations"].as_u64().unwrap() <= 3);
    assert!(pose["residual_mm"].as_f64().unwrap() < 1e-9);
    let platform = &pose["platform"];
    near(platform["tilt_deg"].as_f64().unwrap(), 2.0, 1e-10);
    near(platform["azimuth_deg"].as_f64().unwrap(), 0.0, 1e-10);
    near(platform["torsion_deg"].as_f64().unwrap(), 0.0, 1e-8);
    // 28.3951 µm along the platform, seen from above.
    near(three(&platform["origin_mm"])[0], 0.0283951 * 2_f64.to_radians().cos(), 1e-7);
    near(three(&platform["normal"])[2], 2_f64.to_radians().cos(), 1e-12);
    near(three(&platform["rotation"][2])[2], 2_f64.to_radians().cos(), 1e-12);
    assert_eq!(pose["limits_broken"][0]["limit"], "tilt");
}

#[test]
fn figures_of_coarse_comparisons_have_smooth_curves() {
    let sandbox = Sandbox::new();
    let points = |tilt_angle: &str| {
        sandbox.done(&format!("compare --tilt-deg {tilt_angle} --figure f.svg --force"));
        let svg = sandbox.read("f.svg");
        let paths = svg.split("<path d=\"M").skip(1).map(|path| path.split('"').next().unwrap());
        paths.map(|path| path.split(['L', ' ']).count()).max().unwrap()
    };
    // Four tilt angles in the answer, but 31 in the figure.
    assert!(points("0:1.5:0.5") > 30, "{}", points("0:1.5:0.5"));
    let answer = sandbox.json("compare --tilt-deg 0:1.5:0.5");
    assert_eq!(answer["tilt_deg"].as_array().unwrap().len(), 4);
}

#[test]
fn each_virtualization_names_its_joints() {
    let sandbox = Sandbox::new();
    let joints = |name: &str| {
        let pose = sandbox.json(&format!("forward --virtualization {name}"));
        pose["virtual_joints"].as_object().unwrap().keys().cloned().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(joints("radial"), "l_mm");
    assert_eq!(joints("polar"), "l_mm phi_deg");
    assert_eq!(joints("offset"), "dr_mm dphi_deg");
    assert_eq!(joints("planar"), "u_mm v_mm");
}

#[test]
fn inverse_and_forward_agree() {
    let sandbox = Sandbox::new();
    for model in ["radial", "polar", "offset", "planar"] {
        for height_of in ["axis", "center"] {
            let model = format!("--virtualization {model} --solver newton --metric radius");
            let found = sandbox.json(&format!(
                "inverse --azimuth-deg 17 --tilt-deg -1.5 --height-mm 510.25 --height-of {height_of} {model}"
            ));
            let q = three(&found["q_mm"]).map(|q| q.to_string()).join(",");
            let again = sandbox.json(&format!("forward --q-mm {q} {model}"));
            assert_eq!(found, again, "every number reads back as itself");
            let height = &found["platform"][format!("{height_of}_height_mm")];
            near(height.as_f64().unwrap(), 510.25, 1e-10);
            near(found["platform"]["tilt_deg"].as_f64().unwrap(), 1.5, 1e-10);
            near(found["platform"]["azimuth_deg"].as_f64().unwrap(), -163.0, 1e-9);
        }
    }
}

#[test]
fn a_missing_closed_form_names_the_solver_used() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.json("forward --virtualization radial")["solver"], "closed-form");
    assert_eq!(sandbox.json("forward --virtualization polar")["solver"], "least-norm");
    assert!(
        sandbox.done("forward --virtualization polar").contains("no closed-form solution exists")
    );
}

#[test]
fn mobility_counts_and_measures() {
    let sandbox = Sandbox::new();
    let numbers = |line: &str| {
        let found = sandbox.json(line);
        let number = |key: &str| found[key].as_i64().unwrap_or_else(|| panic!("{key} in {found}"));
        let keys = [
            "kutzbach_mobility",
            "instantaneous_mobility",
            "finite_mobility",
            "rank",
            "redundancy",
        ];
        assert_eq!(found["singular_values"].as_array().unwrap().len(), 12);
        assert!(found["threshold"].as_f64().unwrap() > 0.0);
        keys.map(number)
    };
    assert_eq!(numbers("mobility"), [0, 3, 1, 9, 3]);
    assert_eq!(numbers("mobility --q-mm 500,500,500.000001"), [0, 1, 1, 11, 1]);
    assert_eq!(numbers("mobility --q-mm 500,501,502"), [0, 1, 1, 11, 1]);
    for (model, joints) in [("radial", 3), ("polar", 6), ("offset", 6), ("planar", 6)] {
        for rods in ["500,500,500", "500,501,502"] {
            let found = sandbox.json(&format!("mobility --q-mm {rods} --virtualization {model}"));
            assert_eq!(
                (&found["augmented_rank"], &found["augmented_mobility"]),
                (&12.into(), &joints.into())
            );
        }
    }
    assert_eq!(sandbox.json("mobility").get("augmented_rank"), None);
}

#[test]
fn sensitivity_of_the_level_robot() {
    let sandbox = Sandbox::new();
    let values = |flags: &str| -> Vec<f64> {
        let found = sandbox.json(&format!("sensitivity --q-mm 500,500,500 {flags}"));
        found["singular_values"].as_array().unwrap()[..3]
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    let check = |flags: &str, expected: [f64; 3]| {
        for (found, expected) in values(flags).into_iter().zip(expected) {
            near(found, expected, 1e-7);
        }
    };
    let root = 2_f64.sqrt();
    check("--virtualization radial", [root, root, 1.0]);
    check("--virtualization offset", [root, root, 1.0]);
    check("--virtualization polar", [1.0, 0.0151702, 0.0151702]);
    check("--virtualization polar --metric radius", [1.0, 1.0, 1.0]);
    check("--virtualization planar", [1.0, 1.0, 1.0]);
}

/// A tilt of 1.5° takes at least 20.8 µm.
#[test]
fn sensitivity_fails_where_the_balls_have_too_little_clearance() {
    let sandbox = Sandbox::new();
    let robot = jointplay::format::robot::PAPER;
    for (clearance_um, code) in [(1.0, 1), (1000.0, 0)] {
        sandbox
            .write("r.toml", &format!("{robot}\n[ball]\nclearance_radius_um = {clearance_um}\n"));
        let run = sandbox.run("sensitivity --robot r.toml");
        assert_eq!(run.code, code, "{clearance_um}: {}", run.stderr);
        assert!(run.stdout.contains("radial clearance"), "{}", run.stdout);
        assert_eq!(run.stderr.contains("the balls need"), code == 1, "{}", run.stderr);
    }
}

#[test]
fn sensitivity_reports_the_exact_displacement_with_its_bounds() {
    let found = Sandbox::new().json("sensitivity --tilt-deg 1.5 --azimuth-deg 40");
    let truth = found["displacement_mm"].as_f64().unwrap();
    let bounds: Vec<(&str, f64, f64, bool)> = found["bounds"]
        .as_array()
        .unwrap()
        .iter()
        .map(|b| {
            let number = |key: &str| b[key].as_f64().unwrap();
            let at = b["derivatives_at"].as_str().unwrap();
            (at, number("lower_mm"), number("upper_mm"), b["held"].as_bool().unwrap())
        })
        .collect();
    assert_eq!(bounds.iter().map(|b| b.0).collect::<Vec<_>>(), ["start", "midpoint", "end"]);
    assert_eq!(bounds.iter().map(|b| b.3).collect::<Vec<_>>(), [false, true, false]);
    near(bounds[0].2, 0.0, 1e-12);
    // The planar chord is exact and its singular values are nearly one: the bounds enclose the truth tightly, but for round-off.
    assert!(bounds[1].1 <= truth * (1.0 + 1e-9) && truth <= bounds[1].2 * (1.0 + 1e-3));
    near(bounds[2].1 / truth, 2.0, 1e-3);
    let shares = |key: &str| three(&found[key]).iter().sum::<f64>();
    near(shares("rod_shares"), 1.0, 1e-12);
    near(shares("side_shares"), 1.0, 1e-12);
}

#[test]
fn compare_shows_shifts_of_opposite_sign() {
    let sandbox = Sandbox::new();
    let found = sandbox.json("compare --tilt-deg 0:2:0.5 --ignore-limits");
    let last = |model: &Value| model["center_shift_x_um"][4].as_f64().unwrap();
    let models = found["models"].as_array().unwrap();
    let names: Vec<&str> = models.iter().map(|m| m["virtualization"].as_str().unwrap()).collect();
    assert_eq!(names, ["radial", "polar", "offset", "planar"]);
    // (R/2)(1 − cos α), exactly.
    let exact = 93.218e3 / 2.0 * (1.0 - 2_f64.to_radians().cos());
    near(last(&models[0]), -exact, 1e-9);
    near(last(&models[1]), 28.3778 * 2_f64.to_radians().cos(), 1e-4);
    near(last(&models[3]), 0.0, 1e-9);
    near(found["approximate_gap_um"][4].as_f64().unwrap(), 56.82, 0.01);
    let answer = sandbox.done("compare");
    assert_eq!(sandbox.names(""), [""; 0], "a question writes no file unasked");
    let drawn = sandbox.done("compare --figure shifts.svg");
    assert_eq!(drawn, format!("{answer}figure: shifts.svg\n"));
    assert!(sandbox.read("shifts.svg").contains("centre shift (µm)"));
    sandbox.done("compare --figure a.png");
    assert!(std::fs::read(sandbox.file("a.png")).unwrap().starts_with(b"\x89PNG"));
    // The answer is printed where the figure cannot be written.
    sandbox.write("mine.svg", "mine");
    for figure in ["mine.svg", "nowhere/shifts.svg"] {
        let refused = sandbox.run(&format!("compare --figure {figure}"));
        assert_eq!((refused.code, &refused.stdout), (2, &answer));
        assert!(refused.stderr.contains(figure), "{}", refused.stderr);
    }
    assert_eq!(sandbox.read("mine.svg"), "mine");
}

#[test]
fn texts() {
    let sandbox = Sandbox::new();
    crate::sandbox::without_round_off().bind(|| {
        for line in [
            "forward --q-mm 500,501,502",
            "forward --q-mm 500,501,502 --virtualization polar",
            "inverse --azimuth-deg 17 --tilt-deg 2 --ignore-limits --virtualization radial --height-of center",
            "mobility",
            "mobility --q-mm 500,501,502 --virtualization offset",
            "sensitivity",
            "compare --azimuth-deg 30",
            "--help",
            "simulate --help",
            "forward --help",
        ] {
            insta::assert_snapshot!(line.replace([' ', ',', '-'], "_"), sandbox.done(line), line);
        }
    });
}
