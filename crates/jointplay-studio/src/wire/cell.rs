//! Documents of a cell, its program and their plan.

use std::collections::BTreeMap;

use jointplay::format::cell::Change;
use jointplay::format::place::Place;
use jointplay::format::program::keywords;
use jointplay::interop::export::dialect::DIALECTS;
use jointplay::nalgebra::Vector3;
use jointplay::report::{CellReport, InstructionReport, ScheduleReport, ViolationReport};
use jointplay::spatial::Tilt;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::cell_chain::ChainDocument;
use super::cell_parts::{BodyDocument, RobotParts, StationDocument, WaferDocument, ZoneDocument};
use super::program_parameters::ParameterValue;
use super::{Pair, Triple};
use crate::cell_files::CellFiles;
use crate::problem::Problem;

/// The cell that this server was started with.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CellDocument {
    /// Name of the cell file; `null` for the built-in example.
    #[schema(required = true)]
    pub(crate) file: Option<String>,
    /// Hash of the path of the cell file.
    pub(crate) identity: String,
    /// Text of the cell file.
    pub(crate) cell: String,
    /// Text of the program file; empty if there is none.
    pub(crate) program: String,
    /// Hash of both texts.
    pub(crate) version: String,
    /// Reserved words of the program language, in upper case.
    pub(crate) keywords: Vec<&'static str>,
    /// Names of the dialects of controller text.
    pub(crate) dialects: Vec<&'static str>,
}

impl CellDocument {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (file, identity, version) = (files.name(), files.identity(), files.version());
        let (cell, program) = files.into_texts();
        let dialects = DIALECTS.map(|entry| entry.name).into();
        Self { file, identity, cell, program, version, keywords: keywords().collect(), dialects }
    }
}

/// A cell and a program; a missing text is that of the file, or of the plan in `since`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlanRequest {
    /// Text of a cell file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of a program.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Values of parameters of the program.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) parameters: BTreeMap<String, ParameterValue>,
    /// Changes of the texts of a kept plan; complete texts take precedence.
    pub(crate) since: Option<SinceFields>,
}

/// Changes of the texts of a kept plan.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SinceFields {
    /// Key of the plan.
    pub(crate) plan: String,
    /// Change of the text of the cell.
    pub(crate) cell: Option<LinesFields>,
    /// Change of the text of the program.
    pub(crate) program: Option<LinesFields>,
}

/// A change of a text: lines replaced by other lines; each line ends with a line feed.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinesFields {
    /// Number of unchanged lines before the change.
    pub(crate) from: usize,
    /// Number of replaced lines.
    pub(crate) count: usize,
    /// The new lines.
    pub(crate) lines: Vec<String>,
}

impl LinesFields {
    /// The changed text.
    fn apply(&self, text: &str, field: &str) -> Result<String, Problem> {
        let mut lines: Vec<&str> = text.split('\n').collect();
        let end = self.from.checked_add(self.count).filter(|&end| end <= lines.len());
        let Some(end) = end else {
            let detail = format!(
                "the range from line {} with {} lines exceeds the {} lines of the text",
                self.from,
                self.count,
                lines.len()
            );
            return Err(Problem::field(field, detail));
        };
        lines.splice(self.from..end, self.lines.iter().map(String::as_str));
        Ok(lines.join("\n"))
    }
}

impl SinceFields {
    /// Both changed texts, the cell first.
    pub(crate) fn texts(&self, (cell, program): (&str, &str)) -> Result<(String, String), Problem> {
        let changed = |text: &str, lines: Option<&LinesFields>, field: &str| match lines {
            Some(lines) => lines.apply(text, field),
            None => Ok(text.to_owned()),
        };
        let cell = changed(cell, self.cell.as_ref(), "since.cell")?;
        Ok((cell, changed(program, self.program.as_ref(), "since.program")?))
    }
}

/// The text of a diagnostic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SourceText {
    /// The cell file.
    Cell,
    /// The program.
    Program,
}

/// An error in a text, with its position.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct Diagnostic {
    /// The text.
    pub(crate) source: SourceText,
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column in characters, from 1.
    pub(crate) column: usize,
    /// Number of characters.
    pub(crate) width: usize,
    /// Description of the error.
    pub(crate) message: String,
}

impl Diagnostic {
    pub(crate) fn new(source: SourceText, place: &Place, message: String) -> Self {
        Self { source, line: place.line, column: place.column, width: place.width, message }
    }
}

/// Plan of a program in a cell. Long lists are truncated; other endpoints return them in pages.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlanDocument {
    /// Hash of both texts, the key of this plan while the server keeps it.
    pub(crate) key: String,
    /// All errors that prevent a motion; with any of them there is no report.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Report as from `jointplay cell check --format json`, without instructions and stays of wafers, and with the first violations and distances only; `null` without a motion.
    #[schema(required = true)]
    pub(crate) report: Option<CellReport>,
    /// Number of executed instructions.
    pub(crate) instructions: usize,
    /// Number of violations.
    pub(crate) violations: usize,
    /// Time intervals with violations; adjacent intervals are merged (s).
    pub(crate) violations_s: Vec<Pair>,
    /// The motion in windows; empty without a motion.
    pub(crate) windows: Vec<WindowDocument>,
    /// Key of the 3D scene of the cell; `null` for an invalid cell.
    #[schema(required = true)]
    pub(crate) scene: Option<String>,
    /// Parts of the robot; `null` for an invalid cell.
    #[schema(required = true)]
    pub(crate) robot: Option<RobotParts>,
    /// Largest displacement of the virtual joints that the cell allows (m); `null` for an invalid cell.
    #[schema(required = true)]
    pub(crate) play_budget_m: Option<f64>,
    /// Kinematic chain of the robot; `null` for an invalid cell.
    #[schema(required = true)]
    pub(crate) chain: Option<ChainDocument>,
    /// The stations; empty for an invalid cell.
    pub(crate) stations: Vec<StationDocument>,
    /// The wafers at the start of the program.
    pub(crate) wafers: Vec<WaferDocument>,
    /// The zones.
    pub(crate) zones: Vec<ZoneDocument>,
    /// The collision bodies.
    pub(crate) bodies: Vec<BodyDocument>,
    /// Names of effectors.
    pub(crate) effectors: Vec<String>,
}

/// A window: a sequence of motions from rest to rest.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct WindowDocument {
    /// Hash of its contents, which `cell/windows/{key}` returns.
    pub(crate) key: String,
    /// Start time (s).
    pub(crate) start_s: f64,
    /// Number of its first motion, from 1.
    pub(crate) step: usize,
    /// Number of its first instruction, from 1.
    pub(crate) instruction: usize,
    /// Line of its first instruction, from 1.
    pub(crate) line: usize,
}

/// Windows of a plan whose overview is requested.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OverviewRequest {
    /// Key of the plan.
    pub(crate) plan: String,
    /// Indices of windows, from 0; at most as many as the plan has.
    pub(crate) windows: Vec<usize>,
}

/// One page of the instructions of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct InstructionsPage {
    /// Total number.
    pub(crate) total: usize,
    /// Entries of this page.
    pub(crate) instructions: Vec<InstructionReport>,
}

/// One page of the violations of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ViolationsPage {
    /// Total number.
    pub(crate) total: usize,
    /// Entries of this page.
    pub(crate) violations: Vec<ViolationReport>,
}

/// Maximum number of violations and of distances in a plan.
const MAX_LISTED: usize = 200;
/// Maximum number of merged violation intervals in a plan.
const MAX_INTERVALS: usize = 500;

/// The report with truncated lists.
pub(crate) fn truncated(report: &CellReport) -> CellReport {
    fn first<T: Clone>(all: &[T], count: usize) -> Vec<T> {
        all[..count.min(all.len())].to_vec()
    }
    // The fields that are not copied below are short.
    let CellReport { instructions: _, violations, violation_groups, distances, .. } = report;
    CellReport {
        cell: report.cell.clone(),
        robot: report.robot.clone(),
        solver: report.solver.clone(),
        assumed: report.assumed.clone(),
        straight: report.straight.clone(),
        blended: report.blended.clone(),
        compensated: report.compensated.clone(),
        axes: report.axes.clone(),
        schedule: ScheduleReport { wafers: Vec::new(), ..report.schedule.clone() },
        nearest: report.nearest.clone(),
        instructions: Vec::new(),
        violations: first(violations, MAX_LISTED),
        violation_groups: first(violation_groups, MAX_LISTED),
        remedies: report.remedies.clone(),
        not_checked: report.not_checked.clone(),
        bodies_in_zones: report.bodies_in_zones.clone(),
        distances: first(distances, MAX_LISTED),
        ..*report
    }
}

/// The time intervals with violations, adjacent ones merged.
pub(crate) fn violation_intervals(report: &CellReport) -> Vec<Pair> {
    let near = report.duration_s / (2.0 * MAX_INTERVALS as f64);
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
    /// Text of the cell; default: that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Name of the station.
    pub(crate) station: String,
    /// Centre of the lowest wafer in the base frame (m); a station defined by its first and last slot is translated.
    #[serde(default)]
    pub(crate) position_m: Option<Triple>,
    /// Heading (rad).
    #[serde(default)]
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) heading_rad: Option<f64>,
    /// Tilt.
    pub(crate) tilt: Option<TiltFields>,
    /// Tilt as rotation vector.
    pub(crate) tilt_xy: Option<TiltXyFields>,
    /// Whether a station defined by its first and last slot keeps this definition when its tilt changes: the last slot is rotated about the first one. Otherwise the tilt replaces the definition.
    #[serde(default)]
    pub(crate) keep_carrier_axis: bool,
    /// Taught points of its plane, which replace the tilt.
    pub(crate) taught: Option<TaughtFields>,
    /// Wafers at the start.
    pub(crate) wafers: Option<WafersFields>,
    /// Robot pose by which the values are taught. It is checked; a contact requires a confirmation.
    pub(crate) taught_by: Option<TaughtByFields>,
}

/// Robot pose by which a station is taught.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TaughtByFields {
    /// Text of the program; default: that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Time of the program that determines the locations of the wafers (s).
    #[serde(default)]
    #[schema(required = false, default = 0.0)]
    pub(crate) time_s: f64,
    /// Positions of all axes, rods first (m or rad).
    #[schema(max_items = 11)]
    pub(crate) positions: Vec<f64>,
    /// Effector that reaches into the station; default: the first one.
    #[serde(default)]
    pub(crate) effector: Option<String>,
    /// Number of the slot, from 1.
    #[schema(minimum = 1)]
    pub(crate) slot: usize,
    /// Whether the station is taught in contact; a comment in the file records this.
    #[serde(default)]
    pub(crate) confirm_contact: bool,
}

/// Slots of a station that hold a wafer at the start.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WafersFields {
    /// Whether all slots hold one.
    #[serde(default)]
    pub(crate) all: bool,
    /// Numbers of the slots, from 1, unless all hold one.
    #[serde(default)]
    #[schema(max_items = 1000)]
    pub(crate) slots: Vec<usize>,
}

/// A tilt as rotation vector.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltXyFields {
    /// Component about x (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Component about y (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
}

/// Taught points of the plane of a station.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TaughtFields {
    /// The points, three or more, in the base frame (m).
    #[schema(max_items = 1000)]
    pub(crate) points_m: Vec<Triple>,
    /// Maximum distance of a point from the plane (m).
    #[schema(exclusive_minimum = 0, maximum = 1000)]
    pub(crate) threshold_m: f64,
}

/// Maximum number of taught points.
const MAX_POINTS: usize = 1000;

impl TaughtFields {
    fn change(self) -> Result<Change, Problem> {
        let found = self.points_m.len();
        if found > MAX_POINTS {
            let detail = format!("{found} points are given, at most {MAX_POINTS} are allowed");
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
            let detail = format!("threshold must be positive, got {threshold} m");
            return Err(Problem::field("taught.threshold_m", detail));
        }
        Ok(Change::Taught { points, threshold, noise: None })
    }
}

/// A tilt.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltFields {
    /// Azimuth of the tilt (rad).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) azimuth_rad: f64,
    /// Angle of the tilt (rad).
    #[schema(exclusive_minimum = -1.5707963267948966, exclusive_maximum = 1.5707963267948966)]
    pub(crate) angle_rad: f64,
}

impl StationRequest {
    /// The requested changes.
    pub(crate) fn changes(&self) -> Result<Vec<Change>, Problem> {
        let mut changes = Vec::new();
        let tilt_change = if self.keep_carrier_axis { Change::Turned } else { Change::Tilt };
        if let Some(Triple(position)) = self.position_m {
            for (k, &value) in position.iter().enumerate() {
                super::length(value, &format!("position_m[{k}]"))?;
            }
            changes.push(Change::Position(Vector3::from(position)));
        }
        if let Some(heading) = self.heading_rad {
            changes.push(Change::Heading(super::angle(heading, "heading_rad")?));
        }
        if let Some(TiltFields { azimuth_rad, angle_rad }) = self.tilt {
            let azimuth = super::angle(azimuth_rad, "tilt.azimuth_rad")?;
            let angle = super::tilt_angle(angle_rad, "tilt.angle_rad")?;
            changes.push(tilt_change(Tilt { azimuth, angle }));
        }
        if let Some(TiltXyFields { about_x_rad, about_y_rad }) = self.tilt_xy {
            let about_x = super::tilt_angle(about_x_rad, "tilt_xy.about_x_rad")?;
            let about_y = super::tilt_angle(about_y_rad, "tilt_xy.about_y_rad")?;
            let tilt = Tilt::from_about_x_and_y(about_x, about_y);
            super::tilt_angle(tilt.angle, "tilt_xy")?;
            changes.push(tilt_change(tilt));
        }
        if let Some(taught) = self.taught.clone() {
            changes.push(taught.change()?);
        }
        if let Some(WafersFields { all, slots }) = &self.wafers {
            changes.push(Change::Wafers((!all).then(|| slots.clone())));
        }
        Ok(changes)
    }
}

/// Text of a changed cell file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CellText {
    /// Text of the cell file with the new values.
    pub(crate) cell: String,
    /// Names of the pairs in contact in the pose by which the station was taught.
    pub(crate) contacts: Vec<Vec<String>>,
}

/// Both texts, to be saved.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveRequest {
    /// Text of the cell file.
    pub(crate) cell: String,
    /// Text of the program.
    pub(crate) program: String,
    /// Version of the texts that they replace: the texts are saved only if the files still have it. Default: the files are overwritten.
    #[serde(default)]
    pub(crate) replaces: Option<String>,
}
