//! A cell, its program, and what they come to.

use jointplay::cell::cell::Cell;
use jointplay::cell::motion::Motion;
use jointplay::cell::program::Phase;
use jointplay::format::cell::Change;
use jointplay::format::place::Place;
use jointplay::format::report::CellReport;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::Tilt;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::Triple;
use super::cell_parts::{BodyDocument, RobotParts, StationDocument, WaferDocument, ZoneDocument};
use crate::cell::CellFiles;
use crate::problem::Problem;
use crate::strict;

/// The cell that this server was started with.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CellDocument {
    /// What its file is called; `null` for the example, which is not a file.
    #[schema(required = true)]
    pub(crate) file: Option<String>,
    /// Text of the cell's file.
    pub(crate) cell: String,
    /// Text of the program's file; empty where there is none.
    pub(crate) program: String,
    /// What tells these texts from others.
    pub(crate) version: String,
}

impl CellDocument {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (file, version) = (files.name(), files.version());
        let (cell, program) = files.into_texts();
        Self { file, cell, program, version }
    }
}

/// A cell and a program; what is left out is as in the files.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CellRequest {
    /// Text of a cell file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of a program.
    #[serde(default)]
    pub(crate) program: Option<String>,
}

/// A cell and a program, to be told sample by sample.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MotionRequest {
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
    /// Of samples: others between, so that lines from one to the next are the motion, at peaks of speeds and where accelerations bend.
    #[serde(default)]
    pub(crate) peaks: bool,
}

fn usual_rate() -> f64 {
    25.0
}

impl MotionRequest {
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

/// What a program comes to in a cell.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlanDocument {
    /// All that is wrong before anything moves; with any of it there is no report.
    pub(crate) problems: Vec<ProblemAt>,
    /// What `jointplay cell check --format json` says; `null` where nothing moves.
    #[schema(required = true)]
    pub(crate) report: Option<CellReport>,
    /// The motions, one after the other; a wait that takes no time is none.
    pub(crate) steps: Vec<StepDocument>,
    /// What the robot is made of; `null` where the cell cannot be read.
    #[schema(required = true)]
    pub(crate) robot: Option<RobotParts>,
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

/// A motion from rest to rest.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StepDocument {
    /// Number of its instruction in the order of running, from 1.
    pub(crate) instruction: usize,
    /// Line of that.
    pub(crate) line: usize,
    /// What part of it this is.
    pub(crate) phase: &'static str,
    /// When it starts [s].
    pub(crate) start_s: f64,
    /// When it ends [s].
    pub(crate) end_s: f64,
    /// Effectors that carry a wafer meanwhile.
    pub(crate) loaded: Vec<String>,
    /// Axes that move in it.
    pub(crate) moving: Vec<String>,
}

/// What each motion is, how long it takes and who carries.
pub(crate) fn steps(cell: &Cell, motion: &Motion) -> Vec<StepDocument> {
    let name = |id: &jointplay::cell::robot::EffectorId| {
        cell.robot.arms[id.arm].effectors[id.effector].name.clone()
    };
    let of = |(k, step): (usize, &jointplay::cell::program::Step)| StepDocument {
        instruction: step.instruction + 1,
        line: step.place.line,
        phase: match step.phase {
            Phase::Move => "move",
            Phase::TuckIn => "tuck in",
            Phase::Turn => "turn",
            Phase::Enter => "enter",
            Phase::Extend => "extend",
            Phase::Lift => "lift",
            Phase::Lower => "lower",
            Phase::Retract => "retract",
            Phase::Level => "level",
            Phase::Wait => "wait",
        },
        start_s: motion.times[k],
        end_s: motion.times[k + 1],
        loaded: step.loaded.iter().map(name).collect(),
        moving: cell
            .robot
            .axes
            .iter()
            .zip(step.from.iter().zip(&step.to))
            .filter(|(_, (from, to))| from != to)
            .map(|(axis, _)| axis.name.clone())
            .collect(),
    };
    motion.steps.iter().enumerate().filter(|&(k, _)| motion.lasts(k)).map(of).collect()
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
        Ok(Change::Taught { points, threshold })
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
