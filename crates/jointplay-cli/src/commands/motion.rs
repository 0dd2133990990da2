//! `jointplay move`: joints driven along a path.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::constraint::System as _;
use jointplay::format::steps::spread;
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{
    Drive, DrivenMotion, MechanismSystem, SparseSystem, drive_relieved, drive_with_progress,
};
use jointplay::nalgebra::DVector;
use jointplay::plot::results::{Follower, motion};
use jointplay::report::table;
use jointplay::report::{self, MotionReport};

use crate::arguments::finite;
use crate::failure::Failure;
use crate::figure::svg_and_png;
use crate::folder::{self, ForceArgs};
use crate::mechanism_input::{Input, MechanismArgs};
use crate::progress::Progress;
use crate::source;
use jointplay::format::number::fixed;

/// Default number of steps of a path.
const STEPS: usize = 60;
/// Largest number of steps of a path.
const MOST_STEPS: usize = 100_000;

/// Drive joints along a path and solve for the remaining ones
///
/// The loops are closed from the initial guess in the file; the joints are driven to FROM and then, step by step, to TO.
/// Without --drive, the first actuated joint is driven between its limits, or by ±20° or ± a tenth of the characteristic length.
/// If only actuated joints are driven, the other actuated joints are held; otherwise all other joints are solved for.
/// Virtual joints are displaced by the least amount.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay move four-bar
  jointplay move four-bar --drive A=0:360:5 --out four-bar-motion
  jointplay move hexapod --drive P1=0:0.02 --drive P2=0:-0.02:-0.005 --format json

Exit codes: 0 reached the end, 1 stopped before the end, or a joint limit or clearance was exceeded, 2 bad input or usage.")]
pub(crate) struct Move {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Joint coordinate to drive; FROM and STEP are optional, and STEP must divide the range; several coordinates are driven simultaneously
    #[arg(long = "drive", value_name = "JOINT=FROM:TO[:STEP]", value_parser = drive_range)]
    drives: Vec<DriveRange>,
    /// Folder for the series (CSV) and the figure (SVG, PNG); by default none are written
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

/// `JOINT=FROM:TO[:STEP]`, in the unit of the file.
#[derive(Clone, Debug)]
struct DriveRange {
    joint: String,
    from: Option<f64>,
    to: f64,
    step: Option<f64>,
}

fn drive_range(text: &str) -> Result<DriveRange, String> {
    let form = || format!("invalid drive {text:?}: expected JOINT=FROM:TO or JOINT=FROM:TO:STEP");
    let (joint, range) = text.rsplit_once('=').ok_or_else(form)?;
    let parts: Vec<&str> = range.split(':').map(str::trim).collect();
    let (from, to, step) = match parts[..] {
        [from, to] => (from, to, None),
        [from, to, step] => (from, to, Some(finite(step)?)),
        _ => return Err(form()),
    };
    if step == Some(0.0) {
        return Err("STEP must not be 0".to_owned());
    }
    let from = if from.is_empty() { None } else { Some(finite(from)?) };
    Ok(DriveRange { joint: joint.trim().to_owned(), from, to: finite(to)?, step })
}

/// The range of one driven coordinate (m, rad).
struct DriveSegment {
    coordinate: usize,
    from: Option<f64>,
    to: f64,
    step: Option<f64>,
    /// Name in messages.
    name: String,
}

impl Move {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let input = self.mechanism.load()?;
        let start = input.assembled(&[])?.coordinates;
        let legs = self.legs(&input, &start)?;
        let driven: Vec<usize> = legs.iter().map(|leg| leg.coordinate).collect();
        let held = held(&input, &driven);
        if let Some(folder) = &self.out {
            folder::check_folder(folder, self.force)?;
        }
        let moved = drive_path(&input, start, &legs, &held)?;
        let report = report::motion(&input.file, &driven, &held, &moved);
        if let Some(folder) = &self.out {
            let stem = format!("{}-motion", source::stem(self.mechanism.path()));
            write(&input, &report, &driven, folder, &stem, self.force)?;
        }
        self.mechanism.format.print(&report, |report| self.text(&input, report, &driven))?;
        if let Some(message) = report.message {
            return Err(Failure::Stopped(message));
        }
        moved.waypoints.iter().try_for_each(|at| input.within_limits(&at.coordinates))
    }

    fn legs(&self, input: &Input, start: &DVector<f64>) -> Result<Vec<DriveSegment>, Failure> {
        if self.drives.is_empty() {
            return Ok(vec![default_segment(input, start)?]);
        }
        let mut legs: Vec<DriveSegment> = Vec::new();
        for drive in &self.drives {
            let coordinate = input.find(&drive.joint)?;
            if legs.iter().any(|leg| leg.coordinate == coordinate) {
                return Err(Failure::Usage(format!("--drive {} is given twice", drive.joint)));
            }
            let si = |value| input.value(coordinate, value);
            let (from, to) = (drive.from.map(si).transpose()?, si(drive.to)?);
            let step = drive.step.map(si).transpose()?;
            if from.is_some_and(|from| from == to) {
                let text = format!("--drive {}: FROM and TO are equal", drive.joint);
                return Err(Failure::Usage(text));
            }
            legs.push(DriveSegment { coordinate, from, to, step, name: drive.joint.clone() });
        }
        Ok(legs)
    }

    fn text(&self, input: &Input, report: &MotionReport, driven: &[usize]) -> String {
        let mut text = format!("{}, driven\n", report.name);
        for (name, &k) in report.driven.iter().zip(driven) {
            let values = &report.series.0[k].1;
            let number = |value: Option<&f64>| {
                value.map_or(String::new(), |&value| fixed(value, input.coordinates.decimals(k)))
            };
            let (from, to) = (number(values.first()), number(values.last()));
            let _ = writeln!(text, "  {name} from {from} to {to} {}", input.coordinates.unit(k));
        }
        if !report.held.is_empty() {
            let _ = writeln!(text, "  held: {}", report.held.join(", "));
        }
        let _ = writeln!(text, "path");
        let _ = writeln!(text, "  steps                {}", report.steps);
        let _ = writeln!(text, "  largest residual     {:.1e}", report.largest_residual);
        for (k, (name, value)) in report.largest_displacements.iter().flat_map(|d| &d.0).enumerate()
        {
            let k = input.coordinates.joints() + k;
            let number = fixed(*value, input.coordinates.decimals(k));
            let label = if k == input.coordinates.joints() { "virtual joints up to" } else { "" };
            let _ = writeln!(text, "  {label:<20} {name} {number} {}", input.coordinates.unit(k));
        }
        if !report.limits_broken.is_empty() {
            let _ = writeln!(text, "  limits exceeded      {}", report.limits_broken.join(", "));
        }
        let _ = writeln!(text, "dead points and crossings: {}", report.singular.len());
        for singular in &report.singular {
            let at: Vec<String> = singular
                .drives
                .0
                .iter()
                .zip(driven)
                .map(|((name, value), &k)| {
                    let decimals = input.coordinates.decimals(k);
                    format!("{name} = {} {}", fixed(*value, decimals), input.coordinates.unit(k))
                })
                .collect();
            let mobility = singular.instantaneous_mobility;
            let branches = match singular.branches {
                Some(1) => "one branch, on which the driven coordinates reverse".to_owned(),
                Some(count) => format!("{count} branches cross"),
                None => "branches undecided".to_owned(),
            };
            let at = at.join(", ");
            let _ = writeln!(text, "  {at}: instantaneous mobility {mobility}, {branches}");
        }
        if let Some(folder) = &self.out {
            let _ = writeln!(text, "3 files written into {}", folder.display());
        }
        text
    }
}

/// The first actuated joint between its limits, or over a default range.
fn default_segment(input: &Input, start: &DVector<f64>) -> Result<DriveSegment, Failure> {
    let mechanism = &input.file.mechanism;
    let actuated = mechanism.joints().iter().find(|j| j.actuated && j.kind.freedoms() > 0);
    let Some(joint) = actuated else {
        let text = "no joint of this mechanism is actuated; use --drive JOINT=FROM:TO";
        return Err(Failure::Usage(text.to_owned()));
    };
    let named = input.coordinates.all();
    let found = named.iter().position(|one| one.joint == joint.name);
    let coordinate = found.unwrap_or_default();
    if let Some(&[from, to]) = joint.limits.first() {
        let name = joint.name.clone();
        return Ok(DriveSegment { coordinate, from: Some(from), to, step: None, name });
    }
    let reach = match named[coordinate].quantity {
        Coordinate::Turn => 20_f64.to_radians(),
        Coordinate::Slide => {
            if input.is_dense() {
                MechanismSystem::new(mechanism, start.clone())?.characteristic_length() / 10.0
            } else {
                SparseSystem::new(mechanism, start.clone())?.characteristic_length() / 10.0
            }
        }
    };
    let here = start[coordinate];
    let name = joint.name.clone();
    Ok(DriveSegment { coordinate, from: Some(here - reach), to: here + reach, step: None, name })
}

/// Coordinates of the actuators that are held: those not driven, or none if a joint without an actuator is driven.
fn held(input: &Input, driven: &[usize]) -> Vec<usize> {
    let actuated: Vec<usize> = input
        .file
        .mechanism
        .joints()
        .iter()
        .flat_map(|joint| std::iter::repeat_n(joint.actuated, joint.kind.freedoms()))
        .enumerate()
        .filter_map(|(k, actuated)| actuated.then_some(k))
        .collect();
    if driven.iter().all(|k| actuated.contains(k)) {
        actuated.into_iter().filter(|k| !driven.contains(k)).collect()
    } else {
        Vec::new()
    }
}

/// Drives to the start of the path, then along it.
fn drive_path(
    input: &Input,
    start: DVector<f64>,
    legs: &[DriveSegment],
    held: &[usize],
) -> Result<DrivenMotion, Failure> {
    let to_begin: Vec<Drive> = legs
        .iter()
        .map(|leg| {
            let to = leg.from.unwrap_or(start[leg.coordinate]);
            Drive { coordinate: leg.coordinate, to }
        })
        .collect();
    let mut start = start;
    if to_begin.iter().any(|one| one.to != start[one.coordinate]) {
        start = driven_to(input, &start, &to_begin, held, "FROM")?;
    }
    let count = steps(input, &start, legs)?;
    let drives: Vec<Drive> =
        legs.iter().map(|leg| Drive { coordinate: leg.coordinate, to: leg.to }).collect();
    drive_along(input, &start, &drives, held, count.unwrap_or(STEPS), "driving")
}

/// Number of steps of the drives; `None` if no step is given.
fn steps(
    input: &Input,
    start: &DVector<f64>,
    legs: &[DriveSegment],
) -> Result<Option<usize>, Failure> {
    let mut count: Option<(usize, &str)> = None;
    for leg in legs {
        let Some(step) = leg.step else { continue };
        let in_file = |value| input.coordinates.from_si(leg.coordinate, value);
        let from = leg.from.unwrap_or(start[leg.coordinate]);
        let [from, to, step] = [from, leg.to, step].map(in_file).map(rounded);
        let values = spread(from, to, step).map_err(|error| {
            let unit = input.coordinates.unit(leg.coordinate);
            Failure::Usage(format!("--drive {} (in {unit}): {error}", leg.name))
        })?;
        let steps = values.len() - 1;
        if steps > MOST_STEPS {
            let text = format!("a path has at most {MOST_STEPS} steps; use a larger STEP");
            return Err(Failure::Usage(text));
        }
        match count {
            Some((other, name)) if other != steps => {
                return Err(Failure::Usage(format!(
                    "--drive {name} has {other} steps and --drive {} has {steps}: simultaneous drives need the same number of steps; give STEP for one of them only",
                    leg.name
                )));
            }
            _ => count = Some((steps, &leg.name)),
        }
    }
    Ok(count.map(|(steps, _)| steps))
}

/// A number with fifteen digits: a change of units must not add a step to a range by round-off.
fn rounded(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

/// The configuration at the end of drives; `place` is its name in messages.
fn driven_to(
    input: &Input,
    from: &DVector<f64>,
    drives: &[Drive],
    held: &[usize],
    place: &str,
) -> Result<DVector<f64>, Failure> {
    let path = drive_along(input, from, drives, held, STEPS, &format!("to {place}"))?;
    let driven: Vec<usize> = drives.iter().map(|drive| drive.coordinate).collect();
    match (report::motion(&input.file, &driven, held, &path).message, path.waypoints.last()) {
        (Some(message), _) => Err(Failure::Stopped(format!("before {place}: {message}"))),
        (None, Some(last)) => Ok(last.coordinates.clone()),
        (None, None) => Ok(from.clone()),
    }
}

/// The configuration with commanded coordinates driven to their values, and other actuators held as in `jointplay move`.
pub(super) fn driven(
    input: &Input,
    from: &DVector<f64>,
    commands: &[(usize, f64)],
    place: &str,
) -> Result<DVector<f64>, Failure> {
    let drives: Vec<Drive> =
        commands.iter().map(|&(coordinate, to)| Drive { coordinate, to }).collect();
    let driven: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    driven_to(input, from, &drives, &held(input, &driven), place)
}

/// Drives along a path with a progress bar: by dense algebra with virtual joints, or by sparse algebra if there are many loops.
fn drive_along(
    input: &Input,
    from: &DVector<f64>,
    drives: &[Drive],
    held: &[usize],
    count: usize,
    stage: &str,
) -> Result<DrivenMotion, Failure> {
    let mechanism = &input.file.mechanism;
    let mut progress = Progress::new(count);
    progress.stage(stage);
    let mut progress = |done| progress.at(done);
    if !MechanismSystem::fits(mechanism) {
        let system = SparseSystem::new(mechanism, from.clone())?;
        return Ok(system.drive_with_progress(drives, held, count, &mut progress)?);
    }
    let driven = |k: &usize| drives.iter().any(|drive| drive.coordinate == *k);
    let free: Vec<usize> =
        (0..mechanism.joint_freedoms()).filter(|k| !driven(k) && !held.contains(k)).collect();
    let system = MechanismSystem::new(mechanism, from.clone())?;
    if mechanism.virtual_joints().is_empty() {
        Ok(drive_with_progress(&system, drives, &free, count, &mut progress)?)
    } else {
        let home = MechanismSystem::new(mechanism, input.assembled(&[])?.coordinates)?;
        Ok(drive_relieved(&home, &system, drives, &free, count, &mut progress)?)
    }
}

fn write(
    input: &Input,
    report: &MotionReport,
    driven: &[usize],
    folder: &Path,
    stem: &str,
    force: ForceArgs,
) -> Result<(), Failure> {
    let follower = |k: usize| Follower {
        name: input.coordinates.all()[k].name.clone(),
        unit: input.coordinates.unit(k),
        values: report.series.0[k].1.clone(),
    };
    let first = driven.first().copied().unwrap_or_default();
    let others: Vec<Follower> =
        (0..input.coordinates.all().len()).filter(|&k| k != first).map(follower).collect();
    let singular: Vec<f64> = report
        .singular
        .iter()
        .filter_map(|singular| singular.drives.0.first().map(|&(_, value)| value))
        .collect();
    let figure = motion(&report.name, &follower(first), &others, &singular);
    let [svg, png] = svg_and_png(stem, &figure)?;
    let series = table::csv(&report.columns()).into_bytes();
    folder::write(folder, &[(format!("{stem}.csv"), series), svg, png], force)
}
