//! Studies of mechanisms: their numbers, and what is refused.

use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{
    CommandedPositions, Drive, MechanismSystem, ReliefSolver, close_commanded, drive,
    held_actuators,
};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Metric, Radial, SolveOptions, Solver};
use jointplay_format::study::{Source, StudyFile, included, parse};
use jointplay_format::{catalogue, mechanism};
use jointplay_study::plan::{Block, Outcome};

fn study(text: &str) -> StudyFile {
    parse(text, &mut included).unwrap_or_else(|error| panic!("{}", error.with_excerpt("s.toml")))
}

fn computed(study: &StudyFile) -> Block {
    let samples: Vec<u64> = (0..study.plan.samples().unwrap()).collect();
    study.plan.compute(&samples).unwrap()
}

fn column<'a>(study: &StudyFile, block: &'a Block, name: &str) -> &'a [f64] {
    let numbers =
        study.columns.iter().filter(|column| matches!(column.source, Source::Number { .. }));
    let index = numbers.map(|column| &column.name).position(|found| found == name);
    &block.columns[index.unwrap_or_else(|| panic!("no column {name}"))]
}

/// The piston by Pythagoras, for lengths and angles.
#[test]
fn a_slider_crank_follows_its_closed_form() {
    let study = study(
        r#"kind = "study"
mechanism = "slider-crank"
quantities = ["cylinder_um", "mobility"]
[parameters]
rod = [130, 200.5]
crank = [45, 50]
[drives]
"main bearing" = [-500, 0, 12.5, 250]
"#,
    );
    let block = computed(&study);
    assert_eq!(block.samples.len(), 16);
    let names: Vec<&str> = study.columns.iter().map(|column| column.name.as_str()).collect();
    let expected =
        ["sample", "rod", "crank", "main bearing_deg", "cylinder_um", "mobility", "status"];
    assert_eq!(names, expected);
    let of = |name| column(&study, &block, name);
    for i in 0..16 {
        let (rod, crank, turn) = (of("rod")[i], of("crank")[i], of("main bearing_deg")[i]);
        assert_eq!([rod, crank], [[130.0, 200.5][i / 8], [45.0, 50.0][i / 4 % 2]], "in this order");
        let piston = |angle: f64| {
            let across = crank * angle.sin();
            1e-3 * (crank * angle.cos() + (rod * rod - across * across).sqrt())
        };
        let home = 50_f64.to_radians();
        let expected = piston(home + turn) - piston(home);
        assert!((of("cylinder_um")[i] - expected).abs() < 1e-13, "{rod} {crank} {turn}");
        assert_eq!(of("mobility")[i], 1.0);
    }
}

/// The robot as a mechanism has the displacements of the robot itself.
#[test]
fn virtual_joints_are_displaced_as_in_the_three_rod_robot() {
    let gpr = Gpr::paper();
    let tilt = Tilt { azimuth: 0.4, angle: 0.02 };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    let [q1, q2, q3] = rods.map(|rod| 1e3 * (rod - 0.5));
    let study = study(&format!(
        r#"kind = "study"
mechanism = "gpr-mechanism"
quantities = ["displacement_um", "virtual_joints"]
[drives]
"rod 1" = {q1:e}
"rod 2" = {q2:e}
"rod 3" = {q3:e}
"#
    ));
    let block = computed(&study);
    assert_eq!(block.outcomes[0], [Outcome::Pose(jointplay_core::bulk::Status::Solved)]);
    let options = SolveOptions {
        solver: Solver::LeastNorm,
        metric: Metric::PlatformRadius,
        ..SolveOptions::default()
    };
    let pose = gpr.forward(rods, &Radial, &options).unwrap();
    let found: Vec<f64> = block.columns[4..].iter().map(|column| column[0]).collect();
    for (found, expected) in found.iter().zip(pose.solution.virtual_joints.iter()) {
        // The robot counts radii from the centre of the platform.
        assert!((found - (expected - 0.093_218)).abs() < 1e-12, "{found} {expected}");
    }
    let size = found.iter().map(|value| value * value).sum::<f64>().sqrt();
    assert!((block.columns[3][0] - size).abs() < 1e-18);
}

/// A four-bar in millimetres, with a point on its coupler.
const OWN: &str = r#"kind = "mechanism"
name = "four-bar"
units = { length = "mm", angle = "deg" }
base = "ground"
[parameters]
a = 30
b = 80
by = 0
[[joint]]
name = "A"
kind = "revolute"
links = ["ground", "crank"]
point = [0, 0, 0]
axis = [0, 0, 1]
actuated = true
limits = [-10, 170]
[[joint]]
name = "B"
kind = "revolute"
links = ["crank", "coupler"]
point = ["a", "by", 0]
axis = [0, 0, 1]
[[joint]]
name = "C"
kind = "revolute"
links = ["coupler", "rocker"]
point = ["a", "b", 0]
axis = [0, 0, 1]
[[joint]]
name = "D"
kind = "revolute"
links = ["ground", "rocker"]
point = [100, 0, 0]
axis = [0, 0, 1]
[[frame]]
name = "tool"
link = "coupler"
point = ["a", "b", 0]
"#;

fn of_own(text: &str) -> StudyFile {
    parse(text, &mut |_| Ok(OWN.as_bytes().to_vec()))
        .unwrap_or_else(|error| panic!("{}", error.with_excerpt("s.toml")))
}

const OWN_STUDY: &str = r#"kind = "study"
mechanism = "own.toml"
samples = 60
seed = 5
quantities = ["joints", "tool_x_mm", "tool_y_mm", "tool_position_error_um", "tool_orientation_error_urad"]
[parameters]
a = { normal = [30, 0.02] }
[drives]
A = [0, 60, 200]
"#;

#[test]
fn a_sample_depends_on_its_number_alone() {
    let study = of_own(OWN_STUDY);
    let whole = computed(&study);
    assert_eq!(whole.samples.len(), 180);
    assert_eq!(whole.draws[..4], [0, 0, 0, 1]);
    for chosen in [vec![0], vec![179, 3, 3, 90], (60..120).rev().collect::<Vec<u64>>()] {
        let some = study.plan.compute(&chosen).unwrap();
        for (row, &sample) in chosen.iter().enumerate() {
            for (all, some) in whole.columns.iter().zip(&some.columns) {
                let there = usize::try_from(sample).unwrap();
                assert_eq!(all[there].to_bits(), some[row].to_bits(), "sample {sample}");
            }
        }
    }
    // One drive of three is beyond the limits of joint A.
    assert_eq!(whole.beyond_joints, 60);
    // Another tolerance changes no draw.
    let more = of_own(&OWN_STUDY.replace("[drives]", "b = { uniform = [79.9, 80.1] }\n[drives]"));
    let more = computed(&more);
    assert_eq!(more.columns[0], whole.columns[0]);
}

/// At the reference configuration, where the tool is at (a, b), its error is that of a.
#[test]
fn errors_are_distances_from_the_design() {
    let study = of_own(OWN_STUDY);
    let block = computed(&study);
    let of = |name| column(&study, &block, name);
    for i in (0..180).step_by(3) {
        let a = of("a")[i];
        assert!((of("tool_x_mm")[i] - 1e-3 * a).abs() < 1e-15);
        let error = of("tool_position_error_um")[i];
        assert!((error - 1e-3 * (a - 30.0).abs()).abs() < 1e-16, "{error}");
        assert!(of("tool_orientation_error_urad")[i] < 1e-15);
    }
    // Elsewhere the tool is where two circles meet.
    for i in (1..180).step_by(3) {
        let (a, b) = (1e-3 * of("a")[i], 0.08);
        let [x, y] = [of("tool_x_mm")[i], of("tool_y_mm")[i]];
        let crank = 60_f64.to_radians();
        let to_b = (x - a * crank.cos()).hypot(y - a * crank.sin());
        let rocker = (0.1 - a).hypot(b);
        assert!((to_b - b).abs() < 1e-12 && ((x - 0.1).hypot(y) - rocker).abs() < 1e-12);
        assert!(of("tool_orientation_error_urad")[i] > 0.0);
    }
}

/// Two bars; the axis of the first is inclined by a tolerance.
const INCLINED: &str = r#"kind = "mechanism"
name = "inclined"
units = { length = "mm", angle = "deg" }
base = "frame"
[parameters]
skew = 0
[[joint]]
name = "A"
kind = "revolute"
links = ["frame", "arm"]
frames = [{ point = [0, 0, 0], axis = ["sin(skew)", 0, "cos(skew)"] }, { point = [0, 0, 0], axis = [0, 0, 1] }]
actuated = true
[[frame]]
name = "tool"
link = "arm"
point = [200, 0, 0]
"#;

/// The tool is displaced by the length of the arm times the inclination, not turned about the axis by a joint frame that jumps.
#[test]
fn an_inclined_axis_displaces_the_tool_by_its_inclination() {
    let text = r#"kind = "study"
mechanism = "own.toml"
quantities = ["tool_x_mm", "tool_y_mm", "tool_z_mm", "tool_position_error_um"]
[parameters]
skew = [-0.5, -1e-9, 0, 1e-9, 0.5]
[drives]
A = 0
"#;
    let study = parse(text, &mut |_| Ok(INCLINED.as_bytes().to_vec()))
        .unwrap_or_else(|error| panic!("{error}"));
    let block = computed(&study);
    for (i, skew) in [-0.5, -1e-9, 0.0, 1e-9, 0.5_f64].into_iter().enumerate() {
        let of = |name| column(&study, &block, name)[i];
        let skew = skew.to_radians();
        assert!((of("tool_x_mm") - 0.2 * skew.cos()).abs() < 1e-15, "{}", of("tool_x_mm"));
        assert!(of("tool_y_mm").abs() < 1e-15, "{}", of("tool_y_mm"));
        assert!((of("tool_z_mm") + 0.2 * skew.sin()).abs() < 1e-15, "{}", of("tool_z_mm"));
        let chord = 0.4 * (skew / 2.0).abs().sin();
        assert!((of("tool_position_error_um") - chord).abs() < 1e-15);
    }
}

fn statuses(block: &Block) -> Vec<&'static str> {
    block.outcomes[0].iter().map(|outcome| outcome.name()).collect()
}

/// The robot with its rods apart from the sockets of its platform, which are `r` from its centre.
fn with_rods_apart() -> String {
    let text = catalogue::find("gpr-mechanism").unwrap().text;
    let mut text = text.replacen("height = 500", "height = 500\noff = 0", 1);
    for (k, at) in
        ["\"r\", 0", "\"r * cos(120)\", \"r * sin(120)\"", "\"r * cos(240)\", \"r * sin(240)\""]
            .into_iter()
            .enumerate()
    {
        let point =
            format!("links = [\"rod {}\", \"platform\"]\npoint = [{at}, \"height\"]", k + 1);
        assert!(text.contains(&point), "{point}");
        let on_rod = if k == 0 { at.replacen("\"r\"", "\"r + off\"", 1) } else { at.to_owned() };
        let frames = format!(
            "links = [\"rod {}\", \"platform\"]\nframes = [{{ point = [{on_rod}, \"height\"] }}, {{ point = [{at}, \"height\"] }}]",
            k + 1
        );
        text = text.replacen(&point, &frames, 1);
    }
    text
}

const RODS_APART: &str = r#"kind = "study"
mechanism = "m.toml"
quantities = ["virtual_joints"]
[parameters]
off = [0, -0.2, 0.05]
[drives]
"rod 1" = [0, 3]
"rod 2" = 0
"rod 3" = 0
"#;

/// A rod too far outside displaces its own socket by as much, and no other.
#[test]
fn dimensions_that_do_not_close_displace_virtual_joints() {
    let study = parse(RODS_APART, &mut |_| Ok(with_rods_apart().into_bytes()))
        .unwrap_or_else(|error| panic!("{error}"));
    let block = computed(&study);
    assert_eq!(statuses(&block), ["solved"; 6]);
    for (i, off) in [0.0, -0.2, 0.05].into_iter().enumerate() {
        let found: Vec<f64> =
            ["l1_mm", "l2_mm", "l3_mm"].map(|name| column(&study, &block, name)[2 * i]).to_vec();
        assert!((found[0].abs() - 1e-3 * f64::abs(off)).abs() < 1e-11, "{found:?}");
        assert!(found[1].abs() < 1e-11 && found[2].abs() < 1e-11, "{found:?}");
    }
    // Without virtual joints there is no configuration, and with other parameters no mechanism.
    let rigid = with_rods_apart();
    let rigid = rigid[..rigid.find("[[virtual_joint]]").unwrap()].to_owned();
    let level = RODS_APART.replace("[0, 3]", "0").replace("virtual_joints", "joints");
    let statuses_of = |study: &str| {
        statuses(&computed(
            &parse(study, &mut |_| Ok(rigid.clone().into_bytes()))
                .unwrap_or_else(|e| panic!("{e}")),
        ))
    };
    assert_eq!(statuses_of(&level), ["solved", "not converged", "not converged"]);
    let none = level.replace("off = [0, -0.2, 0.05]", "off = [5e11, 1e12]").replace("off =", "r =");
    assert_eq!(statuses_of(&none), ["dimensions that make no mechanism"; 2]);
}

/// Positions that are followed in long steps are those of the motion with its singular values.
#[test]
fn positions_far_away_are_those_of_the_motion() {
    for name in
        ["four-bar", "slider-crank", "hexapod", "3-rps", "sarrus", "bennett", "delta", "tripteron"]
    {
        let file = mechanism::parse(catalogue::find(name).unwrap().text).unwrap();
        let mechanism = &file.mechanism;
        let home = close_commanded(mechanism, &[], None).unwrap().coordinates;
        let actuated = mechanism.actuated_coordinates();
        let Some(&first) = actuated.first() else { continue };
        let system = MechanismSystem::new(mechanism, home.clone()).unwrap();
        let held = held_actuators(mechanism, &[first]);
        let free: Vec<usize> =
            (0..home.len()).filter(|k| *k != first && !held.contains(k)).collect();
        let coordinates = jointplay_format::coordinates::Coordinates::of(&file);
        let unit = match coordinates.all()[first].quantity {
            Coordinate::Slide => 0.05,
            Coordinate::Turn => 0.4,
        };
        for to in [-unit, unit] {
            let to = home[first] + to;
            let motion = drive(&system, &[Drive { coordinate: first, to }], &free, 8).unwrap();
            if motion.stopped.is_some() {
                continue;
            }
            let values: Vec<f64> =
                actuated.iter().map(|&k| if k == first { to } else { home[k] }).collect();
            let mut positions = CommandedPositions::new(mechanism, &home, &actuated).unwrap();
            let mut found = home.clone();
            positions.follow(mechanism, &values, &mut found, ReliefSolver::LeastNorm).unwrap();
            let links = |coordinates| system.kinematics().link_poses(coordinates).unwrap();
            let (here, there) =
                (links(&found), links(&motion.waypoints.last().unwrap().coordinates));
            // Rods between balls spin as they like.
            for (link, (a, b)) in mechanism.links().iter().zip(here.iter().zip(&there)) {
                if !link.starts_with("rod") {
                    assert!(
                        (a.to_homogeneous() - b.to_homogeneous()).amax() < 1e-9,
                        "{name}: {link}"
                    );
                }
            }
        }
    }
}

#[track_caller]
fn refuse(from: &str, to: &str, line: usize, message: &str) {
    assert!(OWN_STUDY.contains(from), "{from:?} is not in the study");
    let Err(errors) = parse(&OWN_STUDY.replacen(from, to, 1), &mut |name| match name {
        "own.toml" => Ok(OWN.as_bytes().to_vec()),
        other => included(other),
    }) else {
        panic!("{to:?} is accepted");
    };
    let is_reported = |error: &jointplay_format::study::Error| {
        error.place.line == line && error.to_string().contains(message)
    };
    assert!(errors.iter().any(is_reported), "{}", errors.with_excerpt("s.toml"));
}

#[test]
fn invalid_studies_are_refused_with_their_places() {
    refuse("own.toml", "gpr", 2, "is a three-rod robot: write `robot = \"gpr\"`");
    refuse("own.toml", "nowhere", 2, "is not in the catalogue");
    refuse("mechanism =", "robot = \"gpr\"\nmechanism =", 2, "either `robot` or `mechanism`");
    refuse("\nA = [0", "\nE = [0", 9, "joint `E` is not known");
    refuse("\nA = [0, 60, 200]", "\nA = []", 9, "`A` is empty");
    refuse("\nA = [0, 60, 200]", "\nA = 1e12", 9, "has to be");
    refuse("\na = {", "\nc = {", 7, "parameter \"c\" is not known");
    refuse("normal = [30, 0.02]", "normal = [30, 0]", 7, "standard deviation of 0");
    refuse("samples = 60\n", "", 5, "random values need `samples`");
    refuse("\"joints\"", "\"jonts\"", 5, "quantity \"jonts\"");
    refuse("\"joints\"", "\"tool_x\"", 5, "`tool_x` needs a unit");
    refuse("\"joints\"", "\"coupler_position_error_um\"", 5, "is not known");
    refuse("\"joints\"", "\"displacement_um\"", 5, "is not known");
    let errors = parse(&OWN_STUDY.replace("own.toml", "nowhere"), &mut included);
    let errors = errors.map(|_| ()).unwrap_err();
    assert_eq!(errors.iter().count(), 1, "{}", errors.with_excerpt("s.toml"));
    let robot = "kind = \"study\"\nrobot = \"hexapod\"\nquantities = [\"rods_mm\"]\n[pose]\nazimuth_deg = 0\ntilt_deg = 0\n";
    let errors = parse(robot, &mut included).map(|_| ()).unwrap_err().to_string();
    assert!(errors.contains("write `mechanism = \"hexapod\"`"), "{errors}");
}

/// Commanded values were written twice when they were asked for too, and parameters could have the names of other columns.
#[test]
fn every_column_has_a_name_of_its_own() {
    let names = |study: &StudyFile| {
        study.columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>().join(" ")
    };
    let with = |quantities: &str| {
        study(&format!(
            "kind = \"study\"\nmechanism = \"slider-crank\"\nquantities = [{quantities}]\n[drives]\n\"main bearing\" = [10, 20]\n"
        ))
    };
    let asked = with(r#""main bearing_deg", "main bearing_rad", "cylinder_mm""#);
    assert_eq!(names(&asked), "sample main bearing_deg main bearing_rad cylinder_mm status");
    let block = computed(&asked);
    // Blocks are in SI units.
    for name in ["main bearing_deg", "main bearing_rad"] {
        assert_eq!(column(&asked, &block, name), [10.0, 20.0].map(f64::to_radians));
    }
    for name in ["sample", "status", "mobility"] {
        let own =
            OWN.replace("\na = ", &format!("\n{name} = ")).replace("\"a\"", &format!("\"{name}\""));
        assert_ne!(own, OWN);
        let text = format!(
            "kind = \"study\"\nmechanism = \"own.toml\"\nquantities = [\"mobility\"]\n[parameters]\n{name} = [30, 31]\n"
        );
        let errors = parse(&text, &mut |_| Ok(own.clone().into_bytes()))
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(errors.contains(&format!("two columns {name:?}")), "{errors}");
    }
}

/// Before, each of the ranges took memory: gigabytes for a mechanism of hundreds of joints.
#[test]
fn ranges_beyond_all_samples_are_not_listed() {
    use jointplay_format::study::Problem;
    use jointplay_study::Error;

    let joint = |k: usize| {
        format!(
            "[[joint]]\nname = \"j{k}\"\nkind = \"revolute\"\nlinks = [\"base\", \"l{k}\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\n"
        )
    };
    let mechanism = format!(
        "kind = \"mechanism\"\nname = \"fan\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nbase = \"base\"\n{}",
        (0..60).map(joint).collect::<String>()
    );
    let drives: String = (0..60).map(|k| format!("j{k} = \"0:1:0.000002\"\n")).collect();
    let text = format!(
        "kind = \"study\"\nmechanism = \"fan.toml\"\nquantities = [\"rank\"]\n[drives]\n{drives}"
    );
    let errors = parse(&text, &mut |_| Ok(mechanism.clone().into_bytes())).err().unwrap();
    let [error] = &errors[..] else { panic!("{}", errors.with_excerpt("s.toml")) };
    let Problem::Plan(Error::TooManySamples { values, .. }) = &*error.problem else {
        panic!("{error}")
    };
    assert_eq!(values[..], [500_001; 4]);
}
