//! From text to a study.

use jointplay_core::virtualization::{
    Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};
use jointplay_study::plan::{Plan, RodsFrom, TiltForm, Tilts, Tolerances, Variation};

use super::names::{self, Asked, Column};
use super::spread::{self, Key};
use super::tree::{Entry, Reader, Table};
use super::{Errors, Problem};
use crate::file_problem::FileProblem;
use crate::robot::{self, Robot};
use crate::units::m_from_mm;
use crate::{catalogue, mechanism};

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

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

/// A study as read.
#[derive(Clone)]
pub struct StudyFile {
    /// What the file calls it.
    pub name: String,
    /// The file (TOML).
    pub text: String,
    /// The robot, as its own file calls it.
    pub robot: String,
    /// The file of the robot (TOML).
    pub robot_text: String,
    /// What is computed.
    pub plan: Plan,
    /// The columns of its table.
    pub columns: Vec<Column>,
}

/// The text of a robot of the catalogue.
///
/// # Errors
/// That there is none of this name, and which there are.
pub fn robot_of(name: &str) -> Result<String, String> {
    match catalogue::find(name) {
        Some(entry) => Ok(entry.text.to_owned()),
        None => Err(format!(
            "robot {name:?} is not in the catalogue; a study takes \"gpr\", or a file in its folder whose name ends in .toml"
        )),
    }
}

/// Reads a study file.
///
/// # Arguments
/// * `robot` – returns the text of the robot that the study names, or the reason why it cannot
///
/// # Errors
/// All errors in the order of their places: invalid TOML, missing and unknown keys, unknown names, values out of range.
pub fn parse(
    text: &str,
    robot: impl FnOnce(&str) -> Result<String, String>,
) -> Result<StudyFile, Errors> {
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return reader.done(None);
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a study", document.get_ref(), 0..0);
    if !reader.is_clean() || has_other_kind(&top) {
        return reader.done(None);
    }
    let study = read(&top, text, robot);
    top.finish();
    reader.done(study)
}

/// Whether the file names another kind, which is reported; the keys of such a file are not checked.
fn has_other_kind(top: &Table) -> bool {
    let Some(kind) = top.needed("kind") else { return false };
    kind.word(top.reader, "kind", &[("study", ())]).is_none() && kind.is_text()
}

fn read(
    top: &Table,
    text: &str,
    robot: impl FnOnce(&str) -> Result<String, String>,
) -> Option<StudyFile> {
    let reader = top.reader;
    let name = top.entry("name").map_or(Some("study".to_owned()), |entry| {
        let name = entry.text(reader)?.to_owned();
        if name.chars().any(char::is_control) {
            entry.report(reader, Problem::Name { found: name });
            return None;
        }
        Some(name)
    });
    let robot = read_robot(top, robot);
    let models = models(top);
    let solver = solver(top);
    let metric = metric(top);
    let draws = count(top, "samples", 1);
    let seed = count(top, "seed", 0);
    // Without valid virtualizations, the quantities of all are known.
    let known = models.clone().unwrap_or_else(|| MODELS.map(|(_, model)| model).to_vec());
    let quantities = quantities(top, &known);
    let pose_table = top.needed("pose").and_then(|entry| entry.table(reader, "`[pose]`"));
    let pose = pose_table.as_ref().and_then(pose);
    let tolerances = match top.entry("tolerances") {
        None => Some(Default::default()),
        Some(entry) => entry.table(reader, "`[tolerances]`").and_then(|table| tolerances(&table)),
    };
    let (robot, robot_text) = robot?;
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
    let (name, text) = (name?, text.to_owned());
    Some(StudyFile { name, text, robot: robot.name, robot_text, plan, columns })
}

fn read_robot(
    top: &Table,
    robot: impl FnOnce(&str) -> Result<String, String>,
) -> Option<(Robot, String)> {
    let entry = top.entry("robot");
    let name = match &entry {
        Some(entry) => entry.text(top.reader)?,
        None => "gpr",
    };
    let report = |problem: Problem| top.report_at("robot", problem);
    let text = robot(name).map_err(|message| report(Problem::Robot { message })).ok()?;
    if let Some(kind) = mechanism::kind_of(&text).filter(|kind| kind != "gpr") {
        let message = format!(
            "robot {name:?} is of the kind {kind:?}; a study takes three-rod robots, of the kind \"gpr\""
        );
        report(Problem::Robot { message });
        return None;
    }
    let invalid = |errors| report(Problem::RobotFile { name: name.to_owned(), errors });
    let read = robot::parse(&text).map_err(invalid).ok()?;
    Some((read, text))
}

/// The entries of a list with at least one.
fn entries<'r, 'a>(entry: &Entry<'r, 'a>, reader: &Reader) -> Option<Vec<Entry<'r, 'a>>> {
    let list = entry.list(reader)?;
    if list.is_empty() {
        entry.report(reader, Problem::Empty { key: entry.key.to_owned() });
        return None;
    }
    Some(list)
}

/// Reports the same entry a second time.
fn report_twice(entry: &Entry, reader: &Reader, found: &str) {
    let problem = Problem::Twice { key: entry.key.to_owned(), found: found.to_owned() };
    entry.report(reader, problem);
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
    let angle = |name, most: f64| Key { name, bounds: (-most, most), to_si: f64::to_radians };
    let keys = [
        angle("azimuth_deg", AZIMUTHS_DEG),
        angle("tilt_deg", STEEPEST_DEG),
        angle("tilt_x_deg", STEEPEST_DEG),
        angle("tilt_y_deg", STEEPEST_DEG),
    ];
    let read =
        keys.map(|key| table.entry(key.name).map(|entry| spread::read(reader, &key, &entry)));
    let bounds = (-LONGEST_MM, LONGEST_MM);
    let key = Key { name: "height_mm", bounds, to_si: m_from_mm };
    let height = table.entry(key.name).map(|entry| spread::read(reader, &key, &entry));
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
            let found = found.map(|(key, _)| key.name.to_owned()).collect();
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
        let (most, to_si): (f64, fn(f64) -> f64) = match name {
            "socket_angle_deg" => (360.0, f64::to_radians),
            _ => (LONGEST_MM, m_from_mm),
        };
        let spread = spread::read(reader, &Key { name, bounds: (-most, most), to_si }, &entry);
        if spread.as_ref().is_some_and(|spread| !spread.is_random()) {
            entry.report(reader, Problem::NotDrawn { key: name });
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

/// A whole number of at least `least`, if the key is present.
fn count(top: &Table, key: &'static str, least: i64) -> Option<Option<u64>> {
    let Some(entry) = top.entry(key) else { return Some(None) };
    let found = entry.integer(top.reader)?;
    match u64::try_from(found) {
        Ok(count) if found >= least => Some(Some(count)),
        _ => {
            let (key, needed) = (key.to_owned(), format!("at least {least}"));
            let problem = FileProblem::OutOfRange { key, value: found as f64, needed };
            entry.report(top.reader, problem);
            None
        }
    }
}

fn quantities(top: &Table, models: &[Model]) -> Option<Vec<Asked>> {
    let reader = top.reader;
    let list = entries(&top.needed("quantities")?, reader)?;
    let mut all: Vec<Asked> = Vec::new();
    let mut are_valid = true;
    for entry in list {
        let found = entry.text(reader).and_then(|name| {
            let asked = names::resolve(name, models);
            let asked = asked.map_err(|problem| entry.report(reader, problem)).ok()?;
            // The same quantity may have two units, but not one unit twice: columns have names of their own.
            if asked.iter().any(|asked| all.contains(asked)) {
                report_twice(&entry, reader, name);
                return None;
            }
            Some(asked)
        });
        are_valid &= found.is_some();
        all.extend(found.unwrap_or_default());
    }
    are_valid.then_some(all)
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

impl StudyFile {
    /// What decides the numbers of this study, by key; two studies that agree in all have the same table.
    #[must_use]
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let plan = &self.plan;
        let names: Vec<&str> = plan.models.iter().map(|model| model.name()).collect();
        let columns: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
        vec![
            ("robot", format!("{:?}", plan.gpr)),
            ("height", format!("{:?}", plan.height)),
            ("tilt", format!("{:?}", plan.tilt)),
            ("tolerances", format!("{:?}", plan.tolerances)),
            ("rods_from", format!("{:?}", plan.rods_from)),
            ("samples", plan.draws.to_string()),
            ("seed", plan.seed.to_string()),
            ("virtualizations", names.join(", ")),
            ("solver", plan.options.solver.to_string()),
            ("metric", format!("{:?}", plan.options.metric)),
            ("columns", columns.join(", ")),
        ]
    }

    /// In what another study differs from this one, in words; nothing where both have the same table.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        /// Longer values are not shown.
        const LONGEST: usize = 60;
        let pairs = self.facts().into_iter().zip(other.facts());
        pairs
            .filter(|((_, a), (_, b))| a != b)
            .map(|((key, a), (_, b))| {
                if a.len() + b.len() < 2 * LONGEST {
                    format!("{key}: {a} there, {b} here")
                } else {
                    format!("{key}: not the same")
                }
            })
            .collect()
    }
}
