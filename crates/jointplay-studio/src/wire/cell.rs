//! A cell, its program, and what they come to.

use jointplay::format::cell::Change;
use jointplay::format::place::Place;
use jointplay::nalgebra::Vector3;
use jointplay::report::{CellReport, InstructionReport, ViolationReport};
use jointplay::spatial::Tilt;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::cell_chain::ChainDocument;
use super::cell_parts::{BodyDocument, RobotParts, StationDocument, WaferDocument, ZoneDocument};
use super::{Pair, Triple};
use crate::cell_files::CellFiles;
use crate::problem::Problem;
use crate::strict;

/// The cell that this server was started with.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CellDocument {
    /// What its file is called; `null` for the example, which is not a file.
    #[schema(required = true)]
    pub(crate) file: Option<String>,
    /// Identifies the file among others of the same name: a hash of its path.
    pub(crate) identity: String,
    /// Text of the cell's file.
    pub(crate) cell: String,
    /// Text of the program's file; empty where there is none.
    pub(crate) program: String,
    /// What tells these texts from others.
    pub(crate) version: String,
}

impl CellDocument {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (file, identity, version) = (files.name(), files.identity(), files.version());
        let (cell, program) = files.into_texts();
        Self { file, identity, cell, program, version }
    }
}

/// A cell and a program; what is left out is as in the files, or in the plan that `since` names.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlanRequest {
    /// Text of a cell file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of a program.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Changes of the texts of a plan; whole texts come before them.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) since: Option<SinceFields>,
}

/// Changes of the texts of a plan that the server remembers.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SinceFields {
    /// Key of the plan.
    pub(crate) plan: String,
    /// What is another in the cell's text.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) cell: Option<LinesFields>,
    /// What is another in the program's text.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) program: Option<LinesFields>,
}

/// Lines in place of others; lines end with a line feed each.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinesFields {
    /// How many lines stay before them.
    pub(crate) from: usize,
    /// How many lines go.
    pub(crate) count: usize,
    /// Those in their place.
    pub(crate) lines: Vec<String>,
}

impl LinesFields {
    /// The text with these lines.
    fn of(&self, text: &str, field: &str) -> Result<String, Problem> {
        let mut lines: Vec<&str> = text.split('\n').collect();
        let end = self.from.checked_add(self.count).filter(|&end| end <= lines.len());
        let Some(end) = end else {
            let detail =
                format!("lines {} and {} more are beyond {}", self.from, self.count, lines.len());
            return Err(Problem::field(field, detail));
        };
        lines.splice(self.from..end, self.lines.iter().map(String::as_str));
        Ok(lines.join("\n"))
    }
}

impl SinceFields {
    /// Both texts with their changes, the cell's first.
    pub(crate) fn texts(&self, (cell, program): (&str, &str)) -> Result<(String, String), Problem> {
        let changed = |text: &str, lines: Option<&LinesFields>, field: &str| match lines {
            Some(lines) => lines.of(text, field),
            None => Ok(text.to_owned()),
        };
        let cell = changed(cell, self.cell.as_ref(), "since.cell")?;
        Ok((cell, changed(program, self.program.as_ref(), "since.program")?))
    }
}

/// A cell and a program, to be told sample by sample.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SamplesRequest {
    /// Text of a cell file; without it, that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of a program; without it, that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Samples a second [Hz].
    #[serde(default = "usual_rate")]
    #[schema(required = false, default = 25.0, minimum = 0.1, maximum = 10000)]
    pub(crate) rate_hz: f64,
    /// Others between, so that lines from one to the next are the motion, at peaks of speeds and where accelerations bend.
    #[serde(default)]
    pub(crate) peaks: bool,
    /// From when on; without it, from the start [s].
    #[serde(default)]
    pub(crate) from_s: Option<f64>,
    /// Until when; without it, to the end [s].
    #[serde(default)]
    pub(crate) to_s: Option<f64>,
}

fn usual_rate() -> f64 {
    25.0
}

impl SamplesRequest {
    /// The rate, if a motion can be told at it [Hz].
    pub(crate) fn rate(&self) -> Result<f64, Problem> {
        if (0.1..=10_000.0).contains(&self.rate_hz) {
            return Ok(self.rate_hz);
        }
        let detail = format!("{} samples a second are not within 0.1 to 10000", self.rate_hz);
        Err(Problem::field("rate_hz", detail))
    }
}

/// Which text something is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Of {
    /// The cell's.
    Cell,
    /// The program's.
    Program,
}

/// Something wrong in a text, and where.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ProblemAt {
    /// In which text.
    pub(crate) of: Of,
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column in characters, from 1.
    pub(crate) column: usize,
    /// How many characters are meant.
    pub(crate) width: usize,
    /// What is wrong.
    pub(crate) message: String,
}

impl ProblemAt {
    pub(crate) fn new(of: Of, place: &Place, message: String) -> Self {
        Self { of, line: place.line, column: place.column, width: place.width, message }
    }
}

/// What a program comes to in a cell; long lists are shortened here, and told in pages by paths of their own.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlanDocument {
    /// Hash of both texts, which names this plan as long as the server remembers it.
    pub(crate) key: String,
    /// All that is wrong before anything moves; with any of it there is no report.
    pub(crate) problems: Vec<ProblemAt>,
    /// What `jointplay cell check --format json` says, without its instructions, and with the first of its violations and distances; `null` where nothing moves.
    #[schema(required = true)]
    pub(crate) report: Option<CellReport>,
    /// How many instructions are run.
    pub(crate) instructions: usize,
    /// How many violations there are.
    pub(crate) violations: usize,
    /// When something is broken, by time: stretches near to each other are one [s].
    pub(crate) broken_s: Vec<Pair>,
    /// The motion in windows; none where nothing moves.
    pub(crate) windows: Vec<WindowDocument>,
    /// Key of the picture of the cell standing still; `null` where there is none.
    #[schema(required = true)]
    pub(crate) scene: Option<String>,
    /// What the robot is made of; `null` where the cell cannot be read.
    #[schema(required = true)]
    pub(crate) robot: Option<RobotParts>,
    /// How the robot's frames follow from its axes; `null` where the cell cannot be read.
    #[schema(required = true)]
    pub(crate) chain: Option<ChainDocument>,
    /// Where the stations are; none where the cell cannot be read.
    pub(crate) stations: Vec<StationDocument>,
    /// Wafers, as they are at the start.
    pub(crate) wafers: Vec<WaferDocument>,
    /// Regions with rules.
    pub(crate) zones: Vec<ZoneDocument>,
    /// What may be run into.
    pub(crate) bodies: Vec<BodyDocument>,
    /// Names of effectors.
    pub(crate) effectors: Vec<String>,
}

/// Some motions from rest to rest, one after the other.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct WindowDocument {
    /// Hash of its content, which `cell/windows/{key}` has.
    pub(crate) key: String,
    /// When it starts [s].
    pub(crate) start_s: f64,
    /// Number of its first motion, from 1.
    pub(crate) step: usize,
    /// Number of its first instruction, from 1.
    pub(crate) instruction: usize,
    /// Line of that.
    pub(crate) line: usize,
}

/// Windows of which an overview is asked for.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OverviewRequest {
    /// Key of the plan.
    pub(crate) plan: String,
    /// Indices of windows, from 0.
    pub(crate) windows: Vec<usize>,
}

/// Some instructions of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct InstructionsPage {
    /// How many there are.
    pub(crate) of: usize,
    /// Those of this page.
    pub(crate) instructions: Vec<InstructionReport>,
}

/// Some violations of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ViolationsPage {
    /// How many there are.
    pub(crate) of: usize,
    /// Those of this page.
    pub(crate) violations: Vec<ViolationReport>,
}

/// Violations and pairs of bodies that a plan tells at once.
const TOLD: usize = 200;
/// Stretches of time in which something is broken that a plan tells.
const STRETCHES: usize = 500;

/// The report with its long lists shortened.
pub(crate) fn short(report: &CellReport) -> CellReport {
    fn first<T: Clone>(all: &[T], count: usize) -> Vec<T> {
        all[..count.min(all.len())].to_vec()
    }
    // What is not copied is not long.
    let CellReport { instructions: _, violations, distances, .. } = report;
    CellReport {
        cell: report.cell.clone(),
        robot: report.robot.clone(),
        solver: report.solver.clone(),
        assumed: report.assumed.clone(),
        straight: report.straight.clone(),
        blended: report.blended.clone(),
        compensated: report.compensated.clone(),
        axes: report.axes.clone(),
        nearest: report.nearest.clone(),
        instructions: Vec::new(),
        violations: first(violations, TOLD),
        distances: first(distances, TOLD),
        ..*report
    }
}

/// When something is broken.
pub(crate) fn broken(report: &CellReport) -> Vec<Pair> {
    let near = report.duration_s / (2.0 * STRETCHES as f64);
    let mut found: Vec<Pair> = Vec::new();
    for one in &report.violations {
        match found.last_mut() {
            Some(Pair([_, end])) if one.start_s <= *end + near => *end = end.max(one.end_s),
            _ => found.push(Pair([one.start_s, one.end_s])),
        }
    }
    found
}

/// New values of one station.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StationRequest {
    /// Text of a cell file; without it, that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Which station.
    pub(crate) station: String,
    /// Where the centre of the lowest wafer rests, in the base frame [m]; the places of first and last slot are moved alike.
    #[serde(default)]
    pub(crate) position_m: Option<Triple>,
    /// Turn about the vertical [rad].
    #[serde(default)]
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) yaw_rad: Option<f64>,
    /// How it leans.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) tilt: Option<LeanFields>,
    /// The same by its turns about x and about y.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) tilt_xy: Option<LeanXyFields>,
    /// Whether a station placed by its first and last slot stays so as it leans otherwise, its last slot turned about the first; else the lean takes their place.
    #[serde(default)]
    pub(crate) keep_drift: bool,
    /// Points of its plane, taught in place of a lean.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) taught: Option<TaughtFields>,
    /// The pose of the robot that the values are taught by: it is checked, and a contact needs a confirmation.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) taught_by: Option<TaughtByFields>,
}

/// The pose of the robot that a station is taught by.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TaughtByFields {
    /// Text of a program; without it, that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// The moment of the program that tells which wafers are where [s].
    #[serde(default)]
    #[schema(required = false, default = 0.0)]
    pub(crate) time_s: f64,
    /// Positions of all axes, rods first [m or rad].
    #[schema(max_items = 11)]
    pub(crate) positions: Vec<f64>,
    /// Which effector reaches into the station; without it, the first.
    #[serde(default)]
    pub(crate) effector: Option<String>,
    /// Number of the slot that it reaches into, from 1.
    #[schema(minimum = 1)]
    pub(crate) slot: usize,
    /// Whether the station is taught though bodies touch; the file then has a note of it.
    #[serde(default)]
    pub(crate) confirm_contact: bool,
}

/// A lean by its turns about x and about y.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LeanXyFields {
    /// Turn about x [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Turn about y [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
}

/// Points of a station's plane.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TaughtFields {
    /// The points, three or more, in the base frame [m].
    #[schema(max_items = 1000)]
    pub(crate) points_m: Vec<Triple>,
    /// How far from their plane one may lie [m].
    #[schema(exclusive_minimum = 0, maximum = 1000)]
    pub(crate) threshold_m: f64,
}

/// The most points that are taught.
const MOST_POINTS: usize = 1000;

impl TaughtFields {
    fn change(self) -> Result<Change, Problem> {
        let found = self.points_m.len();
        if found > MOST_POINTS {
            let detail = format!("{found} points are taught, up to {MOST_POINTS} may be");
            return Err(Problem::field("taught.points_m", detail));
        }
        let point = |(i, Triple(point)): (usize, Triple)| {
            for (k, &value) in point.iter().enumerate() {
                super::length(value, &format!("taught.points_m[{i}][{k}]"))?;
            }
            Ok::<_, Problem>(Vector3::from(point))
        };
        let points = self.points_m.into_iter().enumerate().map(point).collect::<Result<_, _>>()?;
        let threshold = super::length(self.threshold_m, "taught.threshold_m")?;
        if threshold <= 0.0 {
            let detail = format!("{threshold} m is not more than nothing");
            return Err(Problem::field("taught.threshold_m", detail));
        }
        Ok(Change::Taught { points, threshold, noise: None })
    }
}

/// A lean.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LeanFields {
    /// Azimuth toward which it leans [rad].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) yaw_rad: f64,
    /// How far [rad].
    #[schema(exclusive_minimum = -1.5707963267948966, exclusive_maximum = 1.5707963267948966)]
    pub(crate) pitch_rad: f64,
}

impl StationRequest {
    /// The changes that are asked for.
    pub(crate) fn changes(&self) -> Result<Vec<Change>, Problem> {
        let mut changes = Vec::new();
        let lean = if self.keep_drift { Change::Turned } else { Change::Tilt };
        if let Some(Triple(position)) = self.position_m {
            for (k, &value) in position.iter().enumerate() {
                super::length(value, &format!("position_m[{k}]"))?;
            }
            changes.push(Change::Position(Vector3::from(position)));
        }
        if let Some(yaw) = self.yaw_rad {
            changes.push(Change::Yaw(super::angle(yaw, "yaw_rad")?));
        }
        if let Some(LeanFields { yaw_rad, pitch_rad }) = self.tilt {
            let yaw = super::angle(yaw_rad, "tilt.yaw_rad")?;
            let pitch = super::pitch(pitch_rad, "tilt.pitch_rad")?;
            changes.push(lean(Tilt { yaw, pitch }));
        }
        if let Some(LeanXyFields { about_x_rad, about_y_rad }) = self.tilt_xy {
            let about_x = super::pitch(about_x_rad, "tilt_xy.about_x_rad")?;
            let about_y = super::pitch(about_y_rad, "tilt_xy.about_y_rad")?;
            let tilt = Tilt::from_about_x_and_y(about_x, about_y);
            super::pitch(tilt.pitch, "tilt_xy")?;
            changes.push(lean(tilt));
        }
        if let Some(taught) = self.taught.clone() {
            changes.push(taught.change()?);
        }
        Ok(changes)
    }
}

/// A text.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CellText {
    /// Text of the cell file with the new values; comments and all else as they were.
    pub(crate) cell: String,
    /// Pairs of names that touch in the pose that the station was taught by, as the note in the file has them.
    pub(crate) touching: Vec<Vec<String>>,
}

/// Both texts, to be kept.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveRequest {
    /// Text of the cell file.
    pub(crate) cell: String,
    /// Text of the program.
    pub(crate) program: String,
    /// Version of the texts that they replace: with it, they are kept only if the files are still those. Without it, they are kept whatever is there.
    #[serde(default)]
    pub(crate) replaces: Option<String>,
}
