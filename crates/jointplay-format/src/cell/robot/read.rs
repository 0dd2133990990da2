//! From text to a robot with arms.

use jointplay_cell::robot::{Arm, Axis, HybridRobot, RODS, RobotPart};

use super::super::explain::explain as explain_cell;
use super::super::problem::{Errors, Fault};
use super::super::tree::Table;
use super::arm::read_arm;
use super::axes::{motor, report_duplicate_names, rod_axes};
use super::base::{platform, three_rods};
use super::words::{KIND, ROD_NAMES};
use crate::display_units::DisplayUnits;
use crate::toml_reader::read_document;

/// Longest accepted text (bytes).
const MAX_BYTES: usize = 1_000_000;

/// Reads the file of a robot with arms.
///
/// # Errors
/// All errors of the file, in order of place.
pub fn parse(text: &str) -> Result<HybridRobot, Errors> {
    read_document(text, MAX_BYTES, "the robot", |table| {
        let _ = table.needed("kind");
        from_table(table)
    })
}

/// Reads a robot from a table, of a file of its own or of a cell file, with its contradictions checked.
pub(in super::super) fn from_table(table: &Table) -> Option<HybridRobot> {
    let robot = read(table);
    table.finish();
    let robot = robot?;
    if let Err((part, error)) = robot.check() {
        table
            .reader
            .report(place(table, part), Fault::Unfit(explain_cell(&error, DisplayUnits::Metric)));
        return None;
    }
    Some(robot)
}

fn read(table: &Table) -> Option<HybridRobot> {
    let reader = table.reader;
    let kind = match table.entry("kind") {
        Some(kind) => kind.word(reader, "kind", &[(KIND, ())]),
        None => Some(()),
    };
    let name = table.needed("name").and_then(|name| name.line(reader)).map(str::to_owned);
    let gpr = table.needed("gpr").and_then(|entry| three_rods(reader, entry));
    let model = platform(table);
    let rods = table.needed("rods").and_then(|entry| entry.table(reader, "`[rods]`"));
    let rods = rods.and_then(|rods| rod_axes(&rods, gpr.as_ref()?));
    let tables = table.tables("axis");
    report_duplicate_names(table, &tables);
    let motors: Vec<Option<Axis>> = tables.iter().map(motor).collect();
    let mut names: Vec<String> = ROD_NAMES.map(str::to_owned).into();
    names.extend(motors.iter().map(|axis| axis.as_ref().map_or("", |axis| &axis.name).to_owned()));
    let arms: Vec<Option<Arm>> =
        table.tables("arm").iter().map(|arm| read_arm(arm, &names)).collect();
    for key in ["axis", "arm"] {
        let _ = table.needed(key);
    }
    let assumed = assumed(table);
    kind?;
    let mut axes: Vec<Axis> = rods?.into();
    axes.extend(motors.into_iter().collect::<Option<Vec<_>>>()?);
    let arms = arms.into_iter().collect::<Option<Vec<_>>>()?;
    Some(HybridRobot {
        name: name?,
        gpr: gpr?.without_limit_checks(),
        model: model?,
        axes,
        arms,
        assumed,
    })
}

/// Assumed parts of the robot: keys of the file, each with its reason.
fn assumed(table: &Table) -> Vec<String> {
    const KEYS: [&str; 5] = ["gpr", "platform", "rods", "axis", "arm"];
    let Some(reasons) = table.table("assumed", "`[assumed]`") else { return Vec::new() };
    let reason = |key: &'static str| {
        let reason = reasons.entry(key)?.line(table.reader)?;
        Some(format!("{key}: {reason}"))
    };
    let assumed = KEYS.into_iter().filter_map(reason).collect();
    reasons.finish();
    assumed
}

/// One of the tables of `[[key]]`.
fn nth<'r, 'a>(table: &Table<'r, 'a>, key: &'static str, index: usize) -> Option<Table<'r, 'a>> {
    let list = table.entry(key)?.list(table.reader)?;
    list.get(index)?.table(table.reader, "")
}

/// The part of the file that an error refers to.
fn place(table: &Table, part: RobotPart) -> std::ops::Range<usize> {
    let name = |table: &Table| table.entry("name").map(|entry| entry.span());
    let of_arm = |arm: usize, key, index| nth(&nth(table, "arm", arm)?, key, index);
    let found = match part {
        RobotPart::Robot => name(table),
        RobotPart::Axis(index) if index < RODS => table.entry("rods").map(|entry| entry.span()),
        RobotPart::Axis(index) => nth(table, "axis", index - RODS).and_then(|axis| name(&axis)),
        RobotPart::Arm(index) => nth(table, "arm", index).and_then(|arm| name(&arm)),
        RobotPart::Joint(arm, index) => of_arm(arm, "joint", index).map(|joint| joint.span),
        RobotPart::Effector(arm, index) => {
            of_arm(arm, "effector", index).and_then(|one| name(&one))
        }
    };
    found.unwrap_or(0..0)
}

#[cfg(test)]
mod tests {
    use super::super::included::names;
    use super::*;
    use crate::catalogue;
    use jointplay_cell::robot::PlatformModel;
    use jointplay_cell::wafer::{Droop, DroopRow, Support};
    use jointplay_core::gpr::Gpr;
    use jointplay_core::virtualization::{BuiltIn, Metric, SolveOptions, Solver};
    use nalgebra::{Matrix3, Vector2};

    const DUAL: &str = include_str!("../../../robots/dual-arm.toml");

    fn rendered(problems: &Errors) -> String {
        problems.iter().map(|problem| problem.with_excerpt("x.toml") + "\n").collect()
    }

    /// Replaces a part of the file, and checks an error message and the text above its carets.
    #[track_caller]
    fn refuse(from: &str, to: &str, blamed: &str, message: &str) {
        assert!(DUAL.contains(from), "{from:?} is not in the file");
        let problems = parse(&DUAL.replacen(from, to, 1)).unwrap_err();
        let rendered = rendered(&problems);
        let found = problems.iter().find(|problem| problem.to_string().contains(message));
        let found = found.unwrap_or_else(|| panic!("{message:?} is not in\n{rendered}"));
        let place = &found.place;
        let above: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
        assert_eq!(above, blamed, "{rendered}");
    }

    #[test]
    fn included_robots_are_valid_and_home_is_within_limits() {
        for name in names() {
            let text = catalogue::find(name).unwrap().text;
            let robot = parse(text).unwrap_or_else(|problems| panic!("{}", rendered(&problems)));
            assert_eq!(robot.gpr, Gpr::paper().without_limit_checks(), "{name}");
            assert_eq!(robot.assumed.len(), 3, "{name}");
            // At HOME the arms are folded over their first axis.
            let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
            assert!(robot.limit_violations(&home).unwrap().is_empty());
            for wafer in robot.forward(&home).unwrap().base_from_wafer.into_iter().flatten() {
                assert!(wafer.translation.vector.xy().norm() < 0.02, "{name} {wafer}");
                // Not by the angle: for a unit in the last place, the arc cosine of the trace is 2·10⁻⁸.
                let turned = wafer.rotation.matrix() - Matrix3::identity();
                assert!(turned.norm() < 1e-12, "{name} {wafer}");
            }
        }
    }

    #[test]
    fn values_are_converted_to_si_units() {
        let robot = parse(DUAL).unwrap();
        let [upper, lower] = robot.arms.as_slice() else { panic!() };
        assert_eq!((upper.mount, lower.joints[0].offset), ([0.0, 0.0, 0.06], -0.175));
        assert_eq!(upper.joints[1].drives, [(4, 1.0)]);
        assert_eq!(lower.joints[2].drives, [(5, 2.0)]);
        assert_eq!(upper.joints[2].zero, std::f64::consts::PI);
        assert_eq!(upper.effectors[0].wafer_center, [0.3, -0.175, 0.01]);
        assert_eq!(upper.effectors[0].support, Support::ThreePoints { radius: 0.12 });
        let droop = Droop::Cantilever { stiffness: 1500.0, mass_per_length: 2.5 };
        assert_eq!(lower.droop, droop);
        assert_eq!(robot.axes[0].empty.jerk, 15.0);
        assert_eq!(robot.axes[3].min, f64::to_radians(-190.0));
        assert!(robot.assumed[0].starts_with("rods: speeds"));
    }

    #[test]
    fn a_three_rod_robot_is_read_from_a_table() {
        let gpr = "gpr = { limb = [
            { socket_radius_mm = 93.218, socket_angle_deg = 0 },
            { socket_radius_mm = 93.218, socket_angle_deg = 120 },
            { socket_radius_mm = 93.218, socket_angle_deg = 240, base_point_mm = [-46, -81] },
        ], limits = { rod_mm = [246, 754], tilt_deg = 1.5 }, working = { height_mm = 500 } }";
        let robot = parse(&DUAL.replacen("gpr = \"gpr\"", gpr, 1)).unwrap();
        assert_eq!(robot.gpr.base_points()[2], Vector2::new(-0.046, -0.081));
        assert_eq!(robot.gpr.limits(), Gpr::paper().limits());
        let bad = gpr.replace("angle_deg = 120", "angle_deg = 0");
        refuse("gpr = \"gpr\"", &bad, "{ limb = [", "lie on one line");
        let bad = gpr.replace("{ socket_radius_mm = 93.218, socket_angle_deg = 120 },", "");
        refuse("gpr = \"gpr\"", &bad, "{ limb = [", "`limb` has 2 entries, but needs 3");
    }

    #[test]
    fn the_platform_model_follows_virtualization_solver_and_metric() {
        let chosen = |keys: &str| {
            let text = DUAL.replacen("[rods]", &format!("[platform]\n{keys}\n[rods]"), 1);
            parse(&text).unwrap_or_else(|problems| panic!("{}", rendered(&problems))).model
        };
        assert_eq!(parse(DUAL).unwrap().model, PlatformModel::default());
        assert_eq!(chosen("virtualization = \"planar\""), PlatformModel::default());
        let newton = chosen("virtualization = \"planar\"\nsolver = \"newton\"");
        assert_eq!(newton.options.solver, Solver::Newton);
        let radial = chosen("virtualization = \"radial\"");
        let model = PlatformModel { virtualization: BuiltIn::Radial, ..PlatformModel::default() };
        assert_eq!(radial, model);
        for (metric, expected) in [
            ("", Metric::Paper),
            ("metric = \"paper\"", Metric::Paper),
            ("metric = \"radius\"", Metric::PlatformRadius),
            ("metric = 93.5", Metric::Length(0.0935)),
        ] {
            let polar = chosen(&format!("virtualization = \"polar\"\n{metric}"));
            assert_eq!(polar.virtualization, BuiltIn::Polar);
            let options = SolveOptions { solver: Solver::LeastNorm, ..Default::default() };
            assert_eq!(polar.options, SolveOptions { metric: expected, ..options });
        }
        // The robot uses the chosen virtualization: polar and radial move the centre to different points.
        let at = |keys: &str| {
            let text = DUAL.replacen("[rods]", &format!("[platform]\n{keys}\n[rods]"), 1);
            let robot = parse(&text).unwrap();
            let home = [0.499, 0.501, 0.5, 0.0, 0.0, 0.0];
            robot.forward(&home).unwrap().platform.center_shift()
        };
        let [planar, polar, radial] =
            ["planar", "polar", "radial"].map(|name| at(&format!("virtualization = \"{name}\"")));
        assert!(planar.norm() < 1e-12 && polar.norm() > 1e-7, "{planar} {polar}");
        assert!((polar + radial).norm() < 0.01 * radial.norm(), "{polar} {radial}");
        let refused = |keys: &str, blamed: &str, message: &str| {
            refuse("[rods]", &format!("[platform]\n{keys}\n[rods]"), blamed, message);
        };
        refused("", "[platform]", "`[platform]` needs `virtualization`");
        refused("virtualization = 1", "1", "has to be a text");
        let known = "did you mean `planar`?); known: radial, polar, offset, planar";
        refused("virtualization = \"planer\"", "\"planer\"", known);
        let solver = |solver: &str| format!("virtualization = \"polar\"\nsolver = \"{solver}\"");
        let none = "a solver of polar, \"closed-form\" is not known (did you mean `least-norm`?); known: newton";
        refused(&solver("closed-form"), "\"closed-form\"", none);
        refused(&solver("newtn"), "\"newtn\"", "did you mean `newton`?");
        let radial = "virtualization = \"radial\"\n";
        refused(&format!("{radial}metric = 1.0"), "1.0", "only polar and offset have angles");
        let polar = "virtualization = \"polar\"\n";
        refused(&format!("{polar}metric = \"raduis\""), "\"raduis\"", "did you mean `radius`?");
        refused(&format!("{polar}metric = -1"), "-1", "from 1e-9 to 1000000000");
        refused(&format!("{polar}metric = true"), "true", "has to be a number");
        refused(&format!("{polar}solvers = 1"), "solvers", "did you mean `solver`?");
    }

    #[test]
    fn droop_tables_are_read_and_slides_cannot_drive_rotary_joints() {
        let cantilever =
            "droop = { kind = \"cantilever\", stiffness_n_m2 = 1500.0, mass_kg_m = 2.5 }";
        let row = "droop = { kind = \"table\", row = [{ reach_mm = 300, empty_drop_mm = 0.1, empty_slope_mrad = 0.2, loaded_drop_mm = 0.3, loaded_slope_mrad = 0.4, load_g = 128 }] }";
        let robot = parse(&DUAL.replacen(cantilever, row, 1)).unwrap();
        let expected = DroopRow {
            reach: 0.3,
            empty_drop: 1e-4,
            empty_slope: 2e-4,
            loaded_drop: 3e-4,
            loaded_slope: 4e-4,
            load: 0.128,
        };
        assert_eq!(robot.arms[0].droop, Droop::Table { rows: vec![expected] });
        let slide = DUAL
            .replace(
                "kind = \"turn\"\nrange_deg = [-45.0, 80.0]\nhome_deg = -40.0",
                "kind = \"slide\"\nrange_mm = [-100, 500]\nhome_mm = 10",
            )
            .replace("_deg_s = 300", "_mm_s = 300")
            .replace(
                "acceleration_deg_s2 = 1200.0, jerk_deg_s3",
                "acceleration_mm_s2 = 1200.0, jerk_mm_s3",
            )
            .replace("_deg_s = 150", "_mm_s = 150")
            .replace(
                "acceleration_deg_s2 = 400.0, jerk_deg_s3",
                "acceleration_mm_s2 = 400.0, jerk_mm_s3",
            );
        let problems = parse(&slide).unwrap_err();
        assert_eq!(
            problems[0].to_string(),
            "axis RA: it slides, but the value of joint 2 of arm upper turns; an axis drives its like"
        );
        assert_eq!(problems[0].place.text, "[[arm.joint]]");
    }

    #[test]
    fn invalid_files_are_rejected_with_the_place_of_each_error() {
        refuse("\"hybrid\"", "\"hybird\"", "\"hybird\"", "did you mean `hybrid`?");
        refuse("gpr = \"gpr\"", "gpr = \"gp\"", "\"gp\"", "known: gpr");
        refuse("gpr = \"gpr\"", "gpr = \"bennett\"", "\"bennett\"", "known: gpr");
        refuse("mount_mm", "mount_m", "mount_m", "did you mean `mount_mm`?");
        refuse("length_mm = 230.0", "length_mm = -1", "-1", "but has to be 0 or more");
        refuse("length_mm = 230.0", "length_mm = nan", "nan", "`length_mm` is not a number");
        refuse("drives = { RA = 1 }", "drives = { R = 1 }", "R", "known: T, RA, RB");
        refuse("drives = { RA = 1 }", "drives = { q1 = 1 }", "q1", "known: T, RA, RB");
        refuse("drives = { RA = 1 }", "drives = [1]", "[1]", "such as { T = 1, R = -2 }");
        refuse("drives = { RA = 1 }", "drives = {}", "[[arm.joint]]", "there are 0, but 1 to 4");
        refuse("drives = { RA = 1 }", "drives = { RA = 0 }", "[[arm.joint]]", "is 0; remove it");
        refuse(
            "kind = \"turn\"\nrange",
            "kind = \"trun\"\nrange",
            "\"trun\"",
            "known: turn, slide",
        );
        refuse(
            "range_deg = [-190.0, 190.0]",
            "range_mm = [-190, 190]",
            "range_mm",
            "did you mean `range_deg`?",
        );
        refuse("[-190.0, 190.0]", "[190.0, -190.0]", "\"T\"", "reversed: least 190°, most -190°");
        refuse("[-190.0, 190.0]", "[-190.0]", "[-190.0]", "has 1 entry, but needs 2");
        refuse("home_deg = 0.0", "home_deg = 200.0", "\"T\"", "has to lie from -190° to 190°");
        refuse("home_mm = 500.0", "home_mm = 800.0", "[rods]", "has to lie from 246 mm to 754 mm");
        refuse("velocity_deg_s = 180.0", "velocity_deg_s = 280.0", "\"T\"", "from 0°/s to 270°/s");
        refuse(
            "velocity_deg_s = 180.0",
            "velocity_mm_s = 180.0",
            "velocity_mm_s",
            "did you mean `velocity_deg_s`?",
        );
        refuse(
            "name = \"RB\"",
            "name = \"RA\"",
            "\"RA\"",
            "axis \"RA\" is defined twice, first in line",
        );
        refuse(
            "name = \"RB\"",
            "name = \"q2\"",
            "\"q2\"",
            "axis \"q2\" is defined twice, first in line",
        );
        refuse("name = \"lower\"", "name = \"upper\"", "\"upper\"", "two arms are called");
        refuse("name = \"B\"", "name = \"A\"", "\"A\"", "two effectors are called");
        refuse("name = \"B\"", "name = \"B b\"", "\"B b\"", "a name is letters");
        refuse(
            "\"three-points\"",
            "\"three\"",
            "\"three\"",
            "known: edge, three-points, two-rails",
        );
        refuse("radius_mm = 120.0 }", "diameter_mm = 120.0 }", "diameter_mm", "unknown key");
        refuse("friction = 0.5", "friction = -0.5", "-0.5", "from 0 to 10");
        refuse("arm = \"all", "arms = \"all", "arms", "did you mean `arm`?");
        refuse("\"cantilever\"", "\"beam\"", "\"beam\"", "known: rigid, table, cantilever");
        let idle = "[[axis]]\nname = \"W\"\nkind = \"slide\"\nrange_mm = [0, 1]\nhome_mm = 0\nempty = { velocity_mm_s = 1, acceleration_mm_s2 = 1, jerk_mm_s3 = 1 }\nloaded = { velocity_mm_s = 1, acceleration_mm_s2 = 1, jerk_mm_s3 = 1 }\n[[arm]]\nname = \"upper\"";
        refuse("[[arm]]\nname = \"upper\"", idle, "\"W\"", "axis W moves no joint");
        // The reader reports all errors.
        let twice = DUAL.replace("friction = 0.5", "frction = 0.5");
        assert_eq!(parse(&twice).unwrap_err().len(), 4);
    }

    #[test]
    fn an_arm_that_only_rotates_is_rejected() {
        let text = DUAL.replace("drives = { RB = -1 }", "drives = { T = 1 }");
        let problems =
            parse(&text.replace("drives = { RB = 2 }", "drives = { T = -2 }")).unwrap_err();
        assert!(
            rendered(&problems).contains("along 1 of the 2 directions"),
            "{}",
            rendered(&problems)
        );
    }

    #[test]
    fn truncated_files_do_not_panic() {
        for cut in (0..DUAL.len()).step_by(61) {
            for part in [&DUAL[..cut], &DUAL[cut..]] {
                for problem in parse(part).err().into_iter().flatten() {
                    let _ = problem.with_excerpt("x");
                }
            }
        }
        assert!(parse("").is_err() && parse("axis = 3\narm = [1, [2]]\nrods = 1").is_err());
    }
}
