//! Files of robots with arms.
//!
//! ```
//! use jointplay_format::{catalogue, cell::robot};
//!
//! let robot = robot::parse(catalogue::find("dual-arm").unwrap().text).unwrap();
//! let axes: Vec<&str> = robot.axes.iter().map(|axis| axis.name.as_str()).collect();
//! assert_eq!(axes, ["q1", "q2", "q3", "T", "RA", "RB"]);
//! ```

use jointplay_cell::robot::{
    Arm, ArmJoint, Axis, Dynamics, Effector, HybridRobot, MotionKind, Part, PlatformModel, RODS,
};
use jointplay_cell::wafer::{Droop, DroopRow, Support};
use jointplay_core::gpr::{Gpr, Limb, Limits};
use nalgebra::Vector2;

use super::explain::explain as explain_cell;
use super::problem::{Fault, Problem};
use super::tree::{Entry, Reader, Span, Table};
use crate::explain::explain;
use crate::units::m_from_mm;
use crate::{catalogue, robot};

/// The `kind` of these files.
pub const KIND: &str = "hybrid";

/// Longest text that is read in bytes.
const MAX_BYTES: usize = 1_000_000;

/// Names of the rods, as axes.
const ROD_NAMES: [&str; RODS] = ["q1", "q2", "q3"];

const MOTIONS: [(&str, MotionKind); 2] = [("turn", MotionKind::Turn), ("slide", MotionKind::Slide)];

/// The names of the robots with arms in the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> {
    let of_kind = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some(KIND);
    catalogue::entries().iter().filter(of_kind).map(|entry| entry.name)
}

/// Reads the file of a robot with arms.
///
/// # Errors
/// All that is wrong with it, in order of place.
pub fn parse(text: &str) -> Result<HybridRobot, Vec<Problem>> {
    let reader = Reader::new(text);
    if text.len() > MAX_BYTES {
        reader.wrong(0..0, Fault::TooLong { found: text.len(), allowed: MAX_BYTES });
        return reader.done(None);
    }
    let file = reader.parse();
    let table = Table::new(&reader, "the robot", file.get_ref(), 0..0);
    let robot = read(&table);
    table.finish();
    // What does not fit together is told of a file in which everything else is right.
    if reader.is_clean()
        && let Some(Err((part, error))) = robot.as_ref().map(HybridRobot::check)
    {
        reader.wrong(place(&table, part), Fault::Unfit(explain_cell(&error)));
    }
    reader.done(robot)
}

fn read(table: &Table) -> Option<HybridRobot> {
    let reader = table.reader;
    let kind = table.needed("kind").and_then(|kind| kind.word(reader, "kind", &[(KIND, ())]));
    let name = table.needed("name").and_then(|name| name.line(reader)).map(str::to_owned);
    let gpr = table.needed("gpr").and_then(|entry| three_rods(reader, entry));
    let rods = table.needed("rods").and_then(|entry| entry.table(reader, "`[rods]`"));
    let rods = rods.and_then(|rods| rod_axes(&rods, gpr.as_ref()?));
    let tables = table.tables("axis");
    tell_twice(table, &tables);
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
    let model = PlatformModel::default();
    Some(HybridRobot { name: name?, gpr: gpr?, model, axes, arms, assumed })
}

/// A three-rod robot by name or as a table.
fn three_rods(reader: &Reader, entry: Entry) -> Option<Gpr> {
    if entry.is_text() {
        let name = entry.text(reader)?;
        let is_gpr = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some("gpr");
        let known = catalogue::entries().iter().filter(is_gpr);
        let Some(found) = known.clone().find(|entry| entry.name == name) else {
            let names: Vec<String> = known.map(|entry| entry.name.to_owned()).collect();
            entry.unknown(reader, "three-rod robot", name, &names);
            return None;
        };
        return robot::parse(found.text).ok().map(|robot| robot.gpr);
    }
    let table = entry.table(reader, "`[gpr]`")?;
    let limbs: Vec<Option<Limb>> = table.tables("limb").iter().map(limb).collect();
    let limits = table.needed("limits").and_then(|entry| entry.table(reader, "`[gpr.limits]`"));
    let limits = limits.and_then(|limits| {
        let rods = limits.needed("rod_mm").and_then(|rods| rods.numbers::<2>(reader, Span::Any));
        let tilt = limits.number("tilt_deg", Span::Positive);
        limits.finish();
        let [rod_min, rod_max] = rods?.map(m_from_mm);
        Some(Limits { rod_min, rod_max, tilt_max: tilt?.to_radians() })
    });
    let working = table.needed("working").and_then(|entry| entry.table(reader, "`[gpr.working]`"));
    let height = working.and_then(|working| {
        let height = working.length("height_mm", Span::Any);
        working.finish();
        height
    });
    table.finish();
    if limbs.len() != 3 {
        let found = limbs.len();
        table.wrong(Fault::Count { key: "limb".to_owned(), found, needed: "3".to_owned() });
        return None;
    }
    let limbs: Vec<Limb> = limbs.into_iter().collect::<Option<_>>()?;
    let made = Gpr::new([limbs[0], limbs[1], limbs[2]], limits?, height?);
    made.map_err(|error| table.wrong(Fault::Unfit(explain(&error)))).ok()
}

fn limb(table: &Table) -> Option<Limb> {
    let radius = table.length("socket_radius_mm", Span::Positive);
    let angle = table.number("socket_angle_deg", Span::Any);
    let point =
        table.entry("base_point_mm").map(|entry| entry.numbers::<2>(table.reader, Span::Any));
    table.finish();
    let mut limb = Limb::under_socket(radius?, angle?.to_radians());
    if let Some(point) = point {
        limb.base_point = Vector2::from(point?.map(m_from_mm));
    }
    Some(limb)
}

fn rod_axes(table: &Table, gpr: &Gpr) -> Option<[Axis; RODS]> {
    let (min, max) = (gpr.limits().rod_min, gpr.limits().rod_max);
    let home = table.length_or("home_mm", Span::Any, gpr.working_height());
    let empty = dynamics(table, "empty", MotionKind::Slide);
    let loaded = dynamics(table, "loaded", MotionKind::Slide);
    table.finish();
    let (empty, loaded) = (empty?, loaded?);
    let kind = MotionKind::Slide;
    Some(ROD_NAMES.map(|name| Axis { name: name.to_owned(), kind, min, max, home, empty, loaded }))
}

fn motor(table: &Table) -> Option<Axis> {
    let reader = table.reader;
    let name = table.name("name");
    let kind = table.needed("kind").and_then(|kind| kind.word(reader, "kind of axis", &MOTIONS));
    let Some(kind) = kind else {
        // Which keys belong here depends on the kind.
        for key in ["range_deg", "range_mm", "home_deg", "home_mm", "empty", "loaded"] {
            let _ = table.entry(key);
        }
        table.finish();
        return None;
    };
    let (range, home) = match kind {
        MotionKind::Turn => ("range_deg", "home_deg"),
        MotionKind::Slide => ("range_mm", "home_mm"),
    };
    let range = table.needed(range).and_then(|range| range.numbers::<2>(reader, Span::Any));
    let home = table.number(home, Span::Any);
    let empty = dynamics(table, "empty", kind);
    let loaded = dynamics(table, "loaded", kind);
    table.finish();
    let [min, max] = range?.map(|value| to_si(kind, value));
    let home = to_si(kind, home?);
    Some(Axis { name: name?, kind, min, max, home, empty: empty?, loaded: loaded? })
}

/// Notes axes whose name is another one's: what drives a joint could not be told.
fn tell_twice(table: &Table, axes: &[Table]) {
    let reader = table.reader;
    let rods = table.entry("rods").map_or(0, |rods| reader.line(rods.span()));
    let mut known: Vec<(&str, usize)> = ROD_NAMES.map(|name| (name, rods)).into();
    for axis in axes {
        let Some(entry) = axis.entry("name") else { continue };
        let Some(name) = entry.value.get_ref().as_str() else { continue };
        match known.iter().find(|(other, _)| *other == name) {
            Some(&(_, first)) => {
                let (what, found) = ("axis".to_owned(), name.to_owned());
                entry.wrong(reader, Fault::Twice { what, found, first });
            }
            None => known.push((name, reader.line(entry.span()))),
        }
    }
}

fn to_si(kind: MotionKind, value: f64) -> f64 {
    match kind {
        MotionKind::Turn => value.to_radians(),
        MotionKind::Slide => m_from_mm(value),
    }
}

fn dynamics(table: &Table, key: &'static str, kind: MotionKind) -> Option<Dynamics> {
    let whose = format!("`{key}` of {}", table.whose);
    let limits = table.needed(key)?.table(table.reader, whose)?;
    let keys = match kind {
        MotionKind::Turn => ["velocity_deg_s", "acceleration_deg_s2", "jerk_deg_s3"],
        MotionKind::Slide => ["velocity_mm_s", "acceleration_mm_s2", "jerk_mm_s3"],
    };
    let values = keys.map(|key| limits.number(key, Span::Positive));
    limits.finish();
    let [velocity, acceleration, jerk] = values;
    let si = |value| to_si(kind, value);
    Some(Dynamics { velocity: si(velocity?), acceleration: si(acceleration?), jerk: si(jerk?) })
}

fn read_arm(table: &Table, axes: &[String]) -> Option<Arm> {
    let reader = table.reader;
    let name = table.name("name");
    let mount = table.point("mount_mm");
    let droop = table.table("droop", "`[arm.droop]`");
    let droop = droop.map_or(Some(Droop::Rigid), |droop| read_droop(&droop));
    let joints = table.tables("joint");
    let last = joints.len().saturating_sub(1);
    let read = |(k, joint): (usize, &Table)| read_joint(joint, axes, k == last);
    let joints: Vec<Option<ArmJoint>> = joints.iter().enumerate().map(read).collect();
    let effectors: Vec<Option<Effector>> =
        table.tables("effector").iter().map(|table| read_effector(reader, table)).collect();
    for key in ["joint", "effector"] {
        let _ = table.needed(key);
    }
    table.finish();
    Some(Arm {
        name: name?,
        mount: mount?.into(),
        joints: joints.into_iter().collect::<Option<_>>()?,
        effectors: effectors.into_iter().collect::<Option<_>>()?,
        droop: droop?,
    })
}

fn read_joint(table: &Table, axes: &[String], is_last: bool) -> Option<ArmJoint> {
    let reader = table.reader;
    let kind = table.needed("kind").and_then(|kind| kind.word(reader, "kind of joint", &MOTIONS));
    let zero = match kind {
        Some(MotionKind::Turn) => table.number_or("zero_deg", Span::Any, 0.0).to_radians(),
        Some(MotionKind::Slide) => table.length_or("zero_mm", Span::Any, 0.0),
        None => {
            let _ = (table.entry("zero_deg"), table.entry("zero_mm"));
            0.0
        }
    };
    let drives = table.needed("drives").and_then(|entry| read_drives(reader, entry, axes));
    let length = if is_last {
        Some(table.length_or("length_mm", Span::NotNegative, 0.0))
    } else {
        table.length("length_mm", Span::NotNegative)
    };
    let offset = table.length_or("offset_mm", Span::Any, 0.0);
    let rise = table.length_or("rise_mm", Span::Any, 0.0);
    table.finish();
    Some(ArmJoint { kind: kind?, zero, drives: drives?, length: length?, offset, rise })
}

/// Axes by name, each with its ratio, in the order of the axes.
fn read_drives(reader: &Reader, entry: Entry, axes: &[String]) -> Option<Vec<(usize, f64)>> {
    let Some(table) = entry.value.get_ref().as_table() else {
        entry.misfit(reader, "a table of axes and their ratios, such as { T = 1, R = -2 }");
        return None;
    };
    let mut drives = Vec::new();
    let mut is_right = true;
    for (name, value) in table {
        let ratio = Entry { key: "drives", value }.number(reader, Span::Any);
        let motors = &axes[RODS..];
        match (motors.iter().position(|axis| axis == name.get_ref()), ratio) {
            (Some(axis), Some(ratio)) => drives.push((RODS + axis, ratio)),
            (None, _) => {
                // An axis that could not be read was told of already.
                if !motors.contains(&String::new()) {
                    let fault = Fault::Unknown {
                        what: "axis".to_owned(),
                        found: name.get_ref().to_string(),
                        nearest: crate::place::nearest(
                            name.get_ref(),
                            motors.iter().map(String::as_str),
                        ),
                        known: motors.to_vec(),
                    };
                    reader.wrong(name.span(), fault);
                }
                is_right = false;
            }
            (Some(_), None) => is_right = false,
        }
    }
    drives.sort_by_key(|&(axis, _)| axis);
    is_right.then_some(drives)
}

fn read_effector(reader: &Reader, table: &Table) -> Option<Effector> {
    let name = table.name("name");
    let center = table.point("wafer_center_mm");
    let heading = table.number_or("heading_deg", Span::Any, 0.0).to_radians();
    let support = table.needed("support").and_then(|entry| entry.table(reader, "`support`"));
    let support = support.and_then(|support| read_support(&support));
    let friction = table.number("friction", Span::NotNegative);
    table.finish();
    Some(Effector {
        name: name?,
        wafer_center: center?.into(),
        heading,
        support: support?,
        friction: friction?,
    })
}

fn read_support(table: &Table) -> Option<Support> {
    #[derive(Clone, Copy)]
    enum Kind {
        Edge,
        ThreePoints,
        TwoRails,
    }
    let kinds =
        [("edge", Kind::Edge), ("three-points", Kind::ThreePoints), ("two-rails", Kind::TwoRails)];
    let kind = table.needed("kind")?.word(table.reader, "kind of support", &kinds)?;
    let support = match kind {
        Kind::Edge => Some(Support::Edge),
        Kind::ThreePoints => {
            table.length("radius_mm", Span::Positive).map(|radius| Support::ThreePoints { radius })
        }
        Kind::TwoRails => table
            .length("distance_mm", Span::Positive)
            .map(|distance| Support::TwoRails { distance }),
    };
    table.finish();
    support
}

fn read_droop(table: &Table) -> Option<Droop> {
    #[derive(Clone, Copy)]
    enum Kind {
        Rigid,
        Table,
        Cantilever,
    }
    let kinds = [("rigid", Kind::Rigid), ("table", Kind::Table), ("cantilever", Kind::Cantilever)];
    let kind = table.needed("kind")?.word(table.reader, "kind of droop", &kinds)?;
    let droop = match kind {
        Kind::Rigid => Some(Droop::Rigid),
        Kind::Table => {
            let rows: Vec<Option<DroopRow>> = table.tables("row").iter().map(droop_row).collect();
            let _ = table.needed("row");
            rows.into_iter().collect::<Option<_>>().map(|rows| Droop::Table { rows })
        }
        Kind::Cantilever => {
            let stiffness = table.number("stiffness_n_m2", Span::Positive);
            let mass = table.number("mass_kg_m", Span::NotNegative);
            let both = stiffness.zip(mass);
            both.map(|(stiffness, mass_per_length)| Droop::Cantilever {
                stiffness,
                mass_per_length,
            })
        }
    };
    table.finish();
    droop
}

fn droop_row(table: &Table) -> Option<DroopRow> {
    let reach = table.length("reach_mm", Span::NotNegative);
    let empty_drop = table.length("empty_drop_mm", Span::Any);
    let empty_slope = table.number("empty_slope_mrad", Span::Any);
    let loaded_drop = table.length("loaded_drop_mm", Span::Any);
    let loaded_slope = table.number("loaded_slope_mrad", Span::Any);
    let load = table.number("load_g", Span::Positive);
    table.finish();
    Some(DroopRow {
        reach: reach?,
        empty_drop: empty_drop?,
        empty_slope: m_from_mm(empty_slope?),
        loaded_drop: loaded_drop?,
        loaded_slope: m_from_mm(loaded_slope?),
        load: m_from_mm(load?),
    })
}

/// What is assumed: keys of the file, each with its reason.
fn assumed(table: &Table) -> Vec<String> {
    const KEYS: [&str; 4] = ["gpr", "rods", "axis", "arm"];
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

/// The part of the file that a fault is about.
fn place(table: &Table, part: Part) -> std::ops::Range<usize> {
    let name = |table: &Table| table.entry("name").map(|entry| entry.span());
    let of_arm = |arm: usize, key, index| nth(&nth(table, "arm", arm)?, key, index);
    let found = match part {
        Part::Robot => name(table),
        Part::Axis(index) if index < RODS => table.entry("rods").map(|entry| entry.span()),
        Part::Axis(index) => nth(table, "axis", index - RODS).and_then(|axis| name(&axis)),
        Part::Arm(index) => nth(table, "arm", index).and_then(|arm| name(&arm)),
        Part::Joint(arm, index) => of_arm(arm, "joint", index).map(|joint| joint.span),
        Part::Effector(arm, index) => of_arm(arm, "effector", index).and_then(|one| name(&one)),
    };
    found.unwrap_or(0..0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DUAL: &str = include_str!("../../../../robots/dual-arm.toml");

    fn told(problems: &[Problem]) -> String {
        problems.iter().map(|problem| problem.with_excerpt("x.toml") + "\n").collect()
    }

    /// Replaces a piece of the file, and reads the first message and what stands above its carets.
    #[track_caller]
    fn refuse(from: &str, to: &str, blamed: &str, message: &str) {
        assert!(DUAL.contains(from), "{from:?} is not in the file");
        let problems = parse(&DUAL.replacen(from, to, 1)).unwrap_err();
        let told = told(&problems);
        let found = problems.iter().find(|problem| problem.to_string().contains(message));
        let found = found.unwrap_or_else(|| panic!("{message:?} is not in\n{told}"));
        let place = &found.place;
        let above: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
        assert_eq!(above, blamed, "{told}");
    }

    #[test]
    fn the_robots_that_come_along() {
        for name in names() {
            let text = catalogue::find(name).unwrap().text;
            let robot = parse(text).unwrap_or_else(|problems| panic!("{}", told(&problems)));
            assert_eq!(robot.gpr, Gpr::paper(), "{name}");
            assert_eq!(robot.assumed.len(), 3, "{name}");
            // Folded over its first axis, where HOME leaves it.
            let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
            assert!(robot.broken_limits(&home).unwrap().is_empty());
            for wafer in robot.forward(&home).unwrap().base_from_wafer.into_iter().flatten() {
                assert!(wafer.translation.vector.xy().norm() < 0.02, "{name} {wafer}");
                assert!(wafer.rotation.angle() < 1e-12, "{name} {wafer}");
            }
        }
    }

    #[test]
    fn a_file_is_read_into_si_units() {
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
    fn a_three_rod_robot_of_its_own() {
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
    fn an_arm_may_droop_by_a_table_and_slide() {
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
    fn bad_files_are_refused_with_their_place() {
        refuse("\"hybrid\"", "\"hybird\"", "\"hybird\"", "did you mean `hybrid`?");
        refuse("gpr = \"gpr\"", "gpr = \"gp\"", "\"gp\"", "known: gpr");
        refuse("gpr = \"gpr\"", "gpr = \"bennett\"", "\"bennett\"", "known: gpr");
        refuse("mount_mm", "mount_m", "mount_m", "did you mean `mount_mm`?");
        refuse("length_mm = 230.0", "length_mm = -1", "-1", "but has to be 0 or more");
        refuse("length_mm = 230.0", "length_mm = nan", "nan", "`length_mm` is NaN");
        refuse("drives = { RA = 1 }", "drives = { R = 1 }", "R", "known: T, RA, RB");
        refuse("drives = { RA = 1 }", "drives = { q1 = 1 }", "q1", "known: T, RA, RB");
        refuse("drives = { RA = 1 }", "drives = [1]", "[1]", "such as { T = 1, R = -2 }");
        refuse("drives = { RA = 1 }", "drives = {}", "[[arm.joint]]", "there are 0, but 1 to 4");
        refuse("drives = { RA = 1 }", "drives = { RA = 0 }", "[[arm.joint]]", "is 0; leave it out");
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
        refuse("[-190.0, 190.0]", "[-190.0]", "[-190.0]", "has 1 entries, but needs 2");
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
            "axis \"RA\" is there twice, first in line",
        );
        refuse(
            "name = \"RB\"",
            "name = \"q2\"",
            "\"q2\"",
            "axis \"q2\" is there twice, first in line",
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
        refuse("friction = 0.5", "friction = -0.5", "-0.5", "0 or more");
        refuse("arm = \"all", "arms = \"all", "arms", "did you mean `arm`?");
        refuse("\"cantilever\"", "\"beam\"", "\"beam\"", "known: rigid, table, cantilever");
        let idle = "[[axis]]\nname = \"W\"\nkind = \"slide\"\nrange_mm = [0, 1]\nhome_mm = 0\nempty = { velocity_mm_s = 1, acceleration_mm_s2 = 1, jerk_mm_s3 = 1 }\nloaded = { velocity_mm_s = 1, acceleration_mm_s2 = 1, jerk_mm_s3 = 1 }\n[[arm]]\nname = \"upper\"";
        refuse("[[arm]]\nname = \"upper\"", idle, "\"W\"", "axis W moves no joint");
        // All that is wrong is told.
        let twice = DUAL.replace("friction = 0.5", "frction = 0.5");
        assert_eq!(parse(&twice).unwrap_err().len(), 4);
    }

    #[test]
    fn an_arm_that_only_turns_is_refused() {
        let text = DUAL.replace("drives = { RB = -1 }", "drives = { T = 1 }");
        let problems =
            parse(&text.replace("drives = { RB = 2 }", "drives = { T = -2 }")).unwrap_err();
        assert!(told(&problems).contains("along 1 of the 2 directions"), "{}", told(&problems));
    }

    #[test]
    fn nothing_panics() {
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
