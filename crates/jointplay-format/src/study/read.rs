//! From text to a study.

use jointplay_core::virtualization::{
    Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};
use jointplay_study::plan::{Plan, RodsFrom, TiltForm, Tilts, Tolerances, Variation};
use serde::Deserialize;
use toml::{Spanned, Value};

use super::names::{self, Asked, Column};
use super::spread::{self, Key};
use super::{Error, Problem};
use crate::place::nearest;
use crate::robot::{self, Robot};
use crate::units::m_from_mm;
use crate::{catalogue, mechanism, place};

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// The longest length that a study may name (mm): a kilometre, far from where squares overflow.
const LONGEST_MM: f64 = 1e6;
/// The steepest angle that may be asked for (deg); at a right angle there are no rods.
const STEEPEST_DEG: f64 = 89.999;
/// The most turns that a yaw may count (deg).
const YAWS_DEG: f64 = 1e6;

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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    kind: Spanned<String>,
    name: Option<Spanned<String>>,
    robot: Option<Spanned<String>>,
    virtualizations: Option<Spanned<Vec<Spanned<String>>>>,
    solver: Option<Spanned<String>>,
    metric: Option<Spanned<Value>>,
    samples: Option<Spanned<i64>>,
    seed: Option<Spanned<i64>>,
    quantities: Spanned<Vec<Spanned<String>>>,
    pose: Spanned<PoseTable>,
    tolerances: Option<Spanned<TolerancesTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseTable {
    yaw_deg: Option<Spanned<Value>>,
    pitch_deg: Option<Spanned<Value>>,
    tilt_x_deg: Option<Spanned<Value>>,
    tilt_y_deg: Option<Spanned<Value>>,
    height_mm: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TolerancesTable {
    socket_radius_mm: Option<Spanned<Value>>,
    socket_angle_deg: Option<Spanned<Value>>,
    base_x_mm: Option<Spanned<Value>>,
    base_y_mm: Option<Spanned<Value>>,
    rods_from: Option<Spanned<String>>,
}

/// The text of a robot of the catalogue.
///
/// # Errors
/// That there is none of this name, and which there are.
pub fn robot_of(name: &str) -> Result<String, String> {
    match catalogue::find(name) {
        Some(entry) => Ok(entry.text.to_owned()),
        None => Err(format!(
            "robot {name:?} is not in the catalogue; a study takes \"gpr\", or a file beside it whose name ends in .toml"
        )),
    }
}

/// Reads a study file.
///
/// # Arguments
/// * `robot` – gives the text of the robot that the study names, or says why not
///
/// # Errors
/// [`Error`] with the place: TOML that is malformed, keys that are missing or unknown, names that are not known, values that cannot be.
pub fn parse(
    text: &str,
    robot: impl FnOnce(&str) -> Result<String, String>,
) -> Result<StudyFile, Error> {
    if text.len() > MAX_BYTES {
        let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
        return Err(Error::at("", 0..0, problem));
    }
    let file: File = place::read(text)?;
    let wrong = |span, problem| Error::at(text, span, problem);
    word(text, "kind", &file.kind, &[("study", ())])?;
    let name = match file.name.as_ref() {
        Some(name) if name.get_ref().chars().any(char::is_control) => {
            return Err(wrong(name.span(), Problem::Name { found: name.get_ref().clone() }));
        }
        name => name.map_or("study", |name| name.get_ref()).to_owned(),
    };
    let (robot, robot_text) = read_robot(text, file.robot.as_ref(), robot)?;
    let models = models(text, file.virtualizations.as_ref())?;
    let options = options(text, file.solver.as_ref(), file.metric.as_ref())?;
    let (tilt, height) = pose(text, &file.pose, robot.gpr.working_height())?;
    let (tolerances, rods_from) = tolerances(text, file.tolerances.as_ref())?;
    let seed = count(text, "seed", file.seed.as_ref(), 0)?.unwrap_or(0);
    let draws = count(text, "samples", file.samples.as_ref(), 1)?;
    let mut plan = Plan {
        gpr: robot.gpr,
        height,
        tilt,
        tolerances,
        rods_from,
        draws: draws.unwrap_or(1),
        seed,
        models,
        options,
        wanted: Vec::new(),
    };
    match &file.samples {
        None if plan.draws_anything() => {
            return Err(wrong(first_random(&file, &plan), Problem::NoSamples));
        }
        Some(samples) if !plan.draws_anything() => {
            return Err(wrong(samples.span(), Problem::NothingRandom));
        }
        _ => {}
    }
    let asked = quantities(text, &file.quantities, &plan)?;
    let columns = names::columns(&mut plan, &asked);
    let span = file.samples.as_ref().map_or(file.pose.span(), Spanned::span);
    plan.samples().map_err(|error| wrong(span, Problem::Plan(error)))?;
    Ok(StudyFile { name, text: text.to_owned(), robot: robot.name, robot_text, plan, columns })
}

/// A word of a closed list.
fn word<T: Clone>(
    text: &str,
    what: &'static str,
    found: &Spanned<String>,
    known: &[(&str, T)],
) -> Result<T, Error> {
    let name = found.get_ref();
    known.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone()).ok_or_else(|| {
        let problem = Problem::Unknown {
            what,
            found: name.clone(),
            nearest: nearest(name, known.iter().map(|(known, _)| *known)),
            known: known.iter().map(|(known, _)| (*known).to_owned()).collect(),
        };
        Error::at(text, found.span(), problem)
    })
}

fn read_robot(
    text: &str,
    named: Option<&Spanned<String>>,
    robot: impl FnOnce(&str) -> Result<String, String>,
) -> Result<(Robot, String), Error> {
    let name = named.map_or("gpr", |name| name.get_ref());
    let span = named.map_or(0..0, Spanned::span);
    let wrong = |problem| Error::at(text, span.clone(), problem);
    let robot_text = robot(name).map_err(|message| wrong(Problem::Robot { message }))?;
    if let Some(kind) = mechanism::kind_of(&robot_text).filter(|kind| kind != "gpr") {
        let message = format!(
            "robot {name:?} is of the kind {kind:?}; a study takes three-rod robots, of the kind \"gpr\""
        );
        return Err(wrong(Problem::Robot { message }));
    }
    let read = robot::parse(&robot_text).map_err(|error| {
        let line = error.place.line;
        wrong(Problem::RobotFile { name: name.to_owned(), line, source: error.problem })
    })?;
    Ok((read, robot_text))
}

fn models(
    text: &str,
    names: Option<&Spanned<Vec<Spanned<String>>>>,
) -> Result<Vec<&'static (dyn Virtualization + Sync)>, Error> {
    let known: [(&str, &'static (dyn Virtualization + Sync)); 4] =
        [("radial", &Radial), ("polar", &Polar), ("offset", &Offset), ("planar", &Planar)];
    let key = "virtualizations";
    let Some(names) = names else { return Ok(vec![&Planar]) };
    if names.get_ref().is_empty() {
        return Err(Error::at(text, names.span(), Problem::Empty { key }));
    }
    let mut models = Vec::new();
    for (k, name) in names.get_ref().iter().enumerate() {
        if names.get_ref()[..k].iter().any(|before| before.get_ref() == name.get_ref()) {
            let problem = Problem::Twice { key, found: name.get_ref().clone() };
            return Err(Error::at(text, name.span(), problem));
        }
        models.push(word(text, "virtualization", name, &known)?);
    }
    Ok(models)
}

fn options(
    text: &str,
    solver: Option<&Spanned<String>>,
    metric: Option<&Spanned<Value>>,
) -> Result<SolveOptions, Error> {
    let mut options = SolveOptions::default();
    if let Some(solver) = solver {
        let known = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm]
            .map(|solver| (solver.to_string(), solver));
        let known = known.each_ref().map(|(name, solver)| (name.as_str(), *solver));
        options.solver = word(text, "solver", solver, &known)?;
    }
    if let Some(metric) = metric {
        let length = match metric.get_ref() {
            Value::Integer(length) => Some(*length as f64),
            Value::Float(length) => Some(*length),
            _ => None,
        };
        options.metric = match (metric.get_ref().as_str(), length) {
            (Some("paper"), _) => Metric::Paper,
            (Some("radius"), _) => Metric::PlatformRadius,
            (_, Some(length)) if (1e-9..=1e9).contains(&length) => {
                Metric::Length(m_from_mm(length))
            }
            _ => return Err(Error::at(text, metric.span(), Problem::Metric)),
        };
    }
    Ok(options)
}

fn pose(
    text: &str,
    table: &Spanned<PoseTable>,
    working_height: f64,
) -> Result<(Tilts, Variation), Error> {
    let pose = table.get_ref();
    let angle = |name, most: f64| Key { name, bounds: (-most, most), to_si: f64::to_radians };
    let keys = [
        (angle("yaw_deg", YAWS_DEG), &pose.yaw_deg),
        (angle("pitch_deg", STEEPEST_DEG), &pose.pitch_deg),
        (angle("tilt_x_deg", STEEPEST_DEG), &pose.tilt_x_deg),
        (angle("tilt_y_deg", STEEPEST_DEG), &pose.tilt_y_deg),
    ];
    let (form, first, second) = match keys.each_ref().map(|(_, value)| value.as_ref()) {
        [Some(yaw), Some(pitch), None, None] => (TiltForm::YawPitch, (0, yaw), (1, pitch)),
        [None, None, Some(x), Some(y)] => (TiltForm::AboutXAndY, (2, x), (3, y)),
        found => {
            let found = keys.iter().zip(found).filter(|(_, value)| value.is_some());
            let found = found.map(|((key, _), _)| key.name.to_owned()).collect();
            return Err(Error::at(text, table.span(), Problem::Tilt { found }));
        }
    };
    let read = |(k, value): (usize, _)| spread::read(text, &keys[k].0, value);
    let tilt = Tilts { form, first: read(first)?, second: read(second)? };
    let height = match &pose.height_mm {
        Some(height) => {
            let bounds = (-LONGEST_MM, LONGEST_MM);
            spread::read(text, &Key { name: "height_mm", bounds, to_si: m_from_mm }, height)?
        }
        None => Variation::Values(vec![working_height]),
    };
    Ok((tilt, height))
}

fn tolerances(
    text: &str,
    table: Option<&Spanned<TolerancesTable>>,
) -> Result<(Tolerances, RodsFrom), Error> {
    let Some(spanned) = table else { return Ok(Default::default()) };
    let table = spanned.get_ref();
    let drawn = |name, most: f64, to_si, value: &Option<Spanned<Value>>| {
        let Some(value) = value else { return Ok(None) };
        let spread = spread::read(text, &Key { name, bounds: (-most, most), to_si }, value)?;
        if spread.is_random() {
            Ok(Some(spread))
        } else {
            Err(Error::at(text, value.span(), Problem::NotDrawn { key: name }))
        }
    };
    let tolerances = Tolerances {
        socket_radius: drawn("socket_radius_mm", LONGEST_MM, m_from_mm, &table.socket_radius_mm)?,
        socket_angle: drawn("socket_angle_deg", 360.0, f64::to_radians, &table.socket_angle_deg)?,
        base_x: drawn("base_x_mm", LONGEST_MM, m_from_mm, &table.base_x_mm)?,
        base_y: drawn("base_y_mm", LONGEST_MM, m_from_mm, &table.base_y_mm)?,
    };
    if !tolerances.any() {
        let known = ["socket_radius_mm", "socket_angle_deg", "base_x_mm", "base_y_mm"];
        let known = known.map(str::to_owned).to_vec();
        return Err(Error::at(text, spanned.span(), Problem::NoTolerances { known }));
    }
    let rods_from = match &table.rods_from {
        Some(found) => {
            let known = [("nominal", RodsFrom::Nominal), ("as-built", RodsFrom::AsBuilt)];
            word(text, "rods_from", found, &known)?
        }
        None => RodsFrom::default(),
    };
    Ok((tolerances, rods_from))
}

fn count(
    text: &str,
    key: &'static str,
    found: Option<&Spanned<i64>>,
    least: i64,
) -> Result<Option<u64>, Error> {
    let Some(found) = found else { return Ok(None) };
    match u64::try_from(*found.get_ref()) {
        Ok(count) if *found.get_ref() >= least => Ok(Some(count)),
        _ => {
            let problem = Problem::Count { key, found: *found.get_ref(), least };
            Err(Error::at(text, found.span(), problem))
        }
    }
}

fn quantities(
    text: &str,
    names: &Spanned<Vec<Spanned<String>>>,
    plan: &Plan,
) -> Result<Vec<Asked>, Error> {
    let key = "quantities";
    if names.get_ref().is_empty() {
        return Err(Error::at(text, names.span(), Problem::Empty { key }));
    }
    let mut all: Vec<Asked> = Vec::new();
    for name in names.get_ref() {
        let wrong = |problem| Error::at(text, name.span(), problem);
        let asked = names::resolve(name.get_ref(), &plan.models).map_err(wrong)?;
        // The same quantity may stand in two units, but not twice in one: columns have names of their own.
        if asked.iter().any(|asked| all.contains(asked)) {
            return Err(wrong(Problem::Twice { key, found: name.get_ref().clone() }));
        }
        all.extend(asked);
    }
    Ok(all)
}

/// Where the file says the first of what is random.
fn first_random(file: &File, plan: &Plan) -> std::ops::Range<usize> {
    let pose = file.pose.get_ref();
    let given = |value: &Option<Spanned<Value>>| value.as_ref().map(Spanned::span);
    let spreads = [
        (&plan.tilt.first, given(&pose.yaw_deg).or(given(&pose.tilt_x_deg))),
        (&plan.tilt.second, given(&pose.pitch_deg).or(given(&pose.tilt_y_deg))),
        (&plan.height, given(&pose.height_mm)),
    ];
    let random = spreads.into_iter().find(|(spread, _)| spread.is_random());
    let tolerances = || file.tolerances.as_ref().map(Spanned::span);
    random.and_then(|(_, span)| span).or_else(tolerances).unwrap_or(0..0)
}

impl StudyFile {
    /// What decides the numbers of this study, by key; two studies that agree in all have the same table.
    fn facts(&self) -> Vec<(&'static str, String)> {
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
