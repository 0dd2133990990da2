//! Studies of the three-rod robot.

use std::collections::BTreeMap;
use std::sync::Arc;

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{
    Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};
use jointplay_study::plan::{Plan, RodsFrom, Study as _, TiltForm, Tilts, Tolerances, Variation};

use super::Problem;
use super::fact::Fact;
use super::file::StudyFile;
use super::names::{self, Column};
use super::quantity::quantities;
use super::sources::{Sources, text_of};
use super::spread::{self, Allowed};
use super::tree::{Table, count, entries, report_twice};
use crate::mechanism;
use crate::number::number;
use crate::robot::{self, Robot};
use crate::units::{deg, m_from_mm, mm};

/// The longest length that a study may name (mm): a kilometre, far from where squares overflow.
const LONGEST_MM: f64 = 1e6;
/// The steepest angle that may be asked for (deg); at a right angle there are no rods.
const STEEPEST_DEG: f64 = 89.999;
/// The most turns that an azimuth may count (deg).
const AZIMUTHS_DEG: f64 = 1e6;

/// A virtualization of the library.
type Model = &'static (dyn Virtualization + Sync);

/// All virtualizations, by name.
const MODELS: [(&str, Model); 4] =
    [("radial", &Radial), ("polar", &Polar), ("offset", &Offset), ("planar", &Planar)];

/// Reads a study of the three-rod robot.
pub(super) fn read(
    top: &Table,
    name: Option<String>,
    text: &str,
    sources: &mut Sources,
) -> Option<StudyFile> {
    let reader = top.reader;
    let robot = read_robot(top, sources);
    let models = models(top);
    let solver = solver(top);
    let metric = metric(top);
    let draws = count(top, "samples", 1);
    let seed = count(top, "seed", 0);
    // Without valid virtualizations, the quantities of all are known.
    let known = models.clone().unwrap_or_else(|| MODELS.map(|(_, model)| model).to_vec());
    let quantities = quantities(top, &names::terms(&known), &names::groups());
    let pose_table = top.needed("pose").and_then(|entry| entry.table(reader, "`[pose]`"));
    let pose = pose_table.as_ref().and_then(pose);
    let tolerances = match top.entry("tolerances") {
        None => Some(Default::default()),
        Some(entry) => entry.table(reader, "`[tolerances]`").and_then(|table| tolerances(&table)),
    };
    let robot = robot?;
    let (tilt, height) = pose?;
    let (tolerances, rods_from) = tolerances?;
    let (draws, seed) = (draws?, seed?);
    let height = height.unwrap_or_else(|| Variation::Values(vec![robot.gpr.working_height()]));
    let mut options = SolveOptions::default();
    options.solver = solver?.unwrap_or(options.solver);
    options.metric = metric?.unwrap_or(options.metric);
    let mut plan = Plan {
        gpr: robot.gpr,
        height,
        tilt,
        tolerances,
        rods_from,
        draws: draws.unwrap_or(1),
        seed: seed.unwrap_or(0),
        models: models?,
        options,
        wanted: Vec::new(),
    };
    let span = top.entry("samples").or(top.entry("pose")).map_or(0..0, |entry| entry.span());
    match draws {
        None if plan.draws_anything() => {
            reader.report(first_random(top, pose_table.as_ref()?, &plan), Problem::NoSamples);
            return None;
        }
        Some(_) if !plan.draws_anything() => {
            reader.report(span, Problem::NothingRandom);
            return None;
        }
        _ => {}
    }
    let columns = names::columns(&mut plan, &quantities?);
    plan.samples().map_err(|error| reader.report(span, Problem::Plan(error))).ok()?;
    Some(StudyFile {
        name: name?,
        text: text.to_owned(),
        mechanism: robot.name,
        files: BTreeMap::new(),
        facts: facts(&plan, &columns),
        plan: Arc::new(plan),
        columns,
    })
}

fn read_robot(top: &Table, sources: &mut Sources) -> Option<Robot> {
    let entry = top.entry("robot");
    let name = match &entry {
        Some(entry) => entry.text(top.reader)?,
        None => "gpr",
    };
    let report = |problem: Problem| top.report_at("robot", problem);
    let text = text_of(name, sources).map_err(|message| report(Problem::Robot { message })).ok()?;
    if let Some(kind) = mechanism::kind_of(&text).filter(|kind| kind != "gpr") {
        let message = format!(
            "robot {name:?} is of the kind {kind:?}, but `robot` names three-rod robots, of the kind \"gpr\"; for a mechanism, write `mechanism = {name:?}`"
        );
        report(Problem::Robot { message });
        return None;
    }
    let invalid = |errors| report(Problem::RobotFile { name: name.to_owned(), errors });
    robot::parse(&text).map_err(invalid).ok()
}

fn models(top: &Table) -> Option<Vec<Model>> {
    let reader = top.reader;
    let Some(list) = top.entry("virtualizations") else { return Some(vec![&Planar]) };
    let list = entries(&list, reader)?;
    let mut names = Vec::new();
    let read = list.iter().map(|entry| {
        let model = entry.word(reader, "virtualization", &MODELS)?;
        let name = entry.text(reader)?;
        if names.contains(&name) {
            report_twice(entry, reader, name);
            return None;
        }
        names.push(name);
        Some(model)
    });
    let read: Vec<_> = read.collect();
    read.into_iter().collect()
}

fn solver(top: &Table) -> Option<Option<Solver>> {
    let Some(entry) = top.entry("solver") else { return Some(None) };
    let known = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm]
        .map(|solver| (solver.to_string(), solver));
    let known = known.each_ref().map(|(name, solver)| (name.as_str(), *solver));
    entry.word(top.reader, "solver", &known).map(Some)
}

fn metric(top: &Table) -> Option<Option<Metric>> {
    let Some(entry) = top.entry("metric") else { return Some(None) };
    let metric = match (entry.value.get_ref().as_str(), entry.any_number()) {
        (Some("paper"), _) => Metric::Paper,
        (Some("radius"), _) => Metric::PlatformRadius,
        (_, Some(length)) if (1e-9..=1e9).contains(&length) => Metric::Length(m_from_mm(length)),
        _ => {
            entry.report(top.reader, Problem::Metric);
            return None;
        }
    };
    Some(Some(metric))
}

/// Tilt and height of a pose; no height if the file has none.
fn pose(table: &Table) -> Option<(Tilts, Option<Variation>)> {
    let reader = table.reader;
    let keys = [
        ("azimuth_deg", AZIMUTHS_DEG),
        ("tilt_deg", STEEPEST_DEG),
        ("tilt_x_deg", STEEPEST_DEG),
        ("tilt_y_deg", STEEPEST_DEG),
    ];
    let read = keys.map(|(key, most)| {
        let angles = Allowed { bounds: (-most, most), to_si: &f64::to_radians };
        table.entry(key).map(|entry| spread::read(reader, &angles, &entry))
    });
    let heights = Allowed { bounds: (-LONGEST_MM, LONGEST_MM), to_si: &m_from_mm };
    let height = table.entry("height_mm").map(|entry| spread::read(reader, &heights, &entry));
    table.finish();
    let tilt = match read {
        [Some(azimuth), Some(tilt_angle), None, None] => {
            Tilts { form: TiltForm::AzimuthAngle, first: azimuth?, second: tilt_angle? }
        }
        [None, None, Some(x), Some(y)] => {
            Tilts { form: TiltForm::AboutXAndY, first: x?, second: y? }
        }
        found => {
            let found = keys.iter().zip(found).filter(|(_, value)| value.is_some());
            let found = found.map(|((key, _), _)| (*key).to_owned()).collect();
            table.report(Problem::Tilt { found });
            return None;
        }
    };
    let height = match height {
        Some(height) => Some(height?),
        None => None,
    };
    Some((tilt, height))
}

fn tolerances(table: &Table) -> Option<(Tolerances, RodsFrom)> {
    const KEYS: [&str; 4] = ["socket_radius_mm", "socket_angle_deg", "base_x_mm", "base_y_mm"];
    let reader = table.reader;
    let [radius, angle, x, y] = KEYS.map(|name| {
        let entry = table.entry(name)?;
        let (most, to_si): (f64, &dyn Fn(f64) -> f64) = match name {
            "socket_angle_deg" => (360.0, &f64::to_radians),
            _ => (LONGEST_MM, &m_from_mm),
        };
        let spread = spread::read(reader, &Allowed { bounds: (-most, most), to_si }, &entry);
        if spread.as_ref().is_some_and(|spread| !spread.is_random()) {
            entry.report(reader, Problem::NotDrawn { key: name.to_owned() });
            return Some(None);
        }
        Some(spread)
    });
    if [&radius, &angle, &x, &y].iter().all(|found| found.is_none()) {
        let known = KEYS.map(str::to_owned).to_vec();
        table.report(Problem::NoTolerances { known });
    }
    let rods_from = table.entry("rods_from").map(|entry| {
        let known = [("nominal", RodsFrom::Nominal), ("as-built", RodsFrom::AsBuilt)];
        entry.word(reader, "rods_from", &known)
    });
    table.finish();
    // Outer: whether the key is present; inner: whether its value is valid.
    let optional = |found: Option<Option<Variation>>| match found {
        Some(None) => None,
        found => Some(found.flatten()),
    };
    let tolerances = Tolerances {
        socket_radius: optional(radius)?,
        socket_angle: optional(angle)?,
        base_x: optional(x)?,
        base_y: optional(y)?,
    };
    let rods_from = rods_from.unwrap_or(Some(RodsFrom::default()))?;
    tolerances.any().then_some((tolerances, rods_from))
}

/// Where the file has its first random value.
fn first_random(top: &Table, pose: &Table, plan: &Plan) -> std::ops::Range<usize> {
    let span = |table: &Table, key| table.entry(key).map(|entry| entry.span());
    let spreads = [
        (&plan.tilt.first, span(pose, "azimuth_deg").or(span(pose, "tilt_x_deg"))),
        (&plan.tilt.second, span(pose, "tilt_deg").or(span(pose, "tilt_y_deg"))),
        (&plan.height, span(pose, "height_mm")),
    ];
    let random = spreads.into_iter().find(|(spread, _)| spread.is_random());
    random.and_then(|(_, span)| span).or_else(|| span(top, "tolerances")).unwrap_or(0..0)
}

/// Facts that determine the numbers of a study.
fn facts(plan: &Plan, columns: &[Column]) -> Vec<Fact> {
    let names: Vec<&str> = plan.models.iter().map(|model| model.name()).collect();
    let columns: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let [first, second] = match plan.tilt.form {
        TiltForm::AzimuthAngle => ["azimuth_deg", "tilt_deg"],
        TiltForm::AboutXAndY => ["tilt_x_deg", "tilt_y_deg"],
    };
    let Tolerances { socket_radius, socket_angle, base_x, base_y } = &plan.tolerances;
    let tolerance =
        |key: &'static str, values: &Option<Variation>, in_file: fn(f64) -> f64| match values {
            Some(values) => Fact::varied(key, values, in_file),
            None => Fact::text(key, "none"),
        };
    let metric = match plan.options.metric {
        Metric::Paper => Fact::text("metric", "paper"),
        Metric::PlatformRadius => Fact::text("metric", "radius"),
        Metric::Length(length) => Fact {
            key: "metric",
            exact: length.to_string(),
            shown: Some(format!("{} mm", number(mm(length)))),
        },
    };
    let rods_from = match plan.rods_from {
        RodsFrom::Nominal => "nominal",
        RodsFrom::AsBuilt => "as-built",
    };
    vec![
        Fact::not_shown("robot", dimensions(&plan.gpr)),
        Fact::varied("height_mm", &plan.height, mm),
        Fact::varied(first, &plan.tilt.first, deg),
        Fact::varied(second, &plan.tilt.second, deg),
        tolerance("socket_radius_mm", socket_radius, mm),
        tolerance("socket_angle_deg", socket_angle, deg),
        tolerance("base_x_mm", base_x, mm),
        tolerance("base_y_mm", base_y, mm),
        Fact::text("rods_from", rods_from),
        Fact::text("samples", plan.draws.to_string()),
        Fact::text("seed", plan.seed.to_string()),
        Fact::text("virtualizations", names.join(", ")),
        Fact::text("solver", plan.options.solver.to_string()),
        metric,
        Fact::text("columns", columns.join(", ")),
    ]
}

/// All numbers of a robot (m, rad).
fn dimensions(gpr: &Gpr) -> String {
    let mut numbers = Vec::new();
    for limb in gpr.limbs() {
        numbers.extend([limb.base_point.x, limb.base_point.y]);
        numbers.extend([limb.socket_radius, limb.socket_angle]);
    }
    let limits = gpr.limits();
    numbers.extend([limits.rod_min, limits.rod_max, limits.tilt_max, gpr.working_height()]);
    numbers.extend(gpr.ball_clearance());
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
