//! `jointplay cell optimise`: orders, effectors, blends and speeds of a program.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use jointplay::cell::check::CheckOptions;
use jointplay::cell::optimise::{
    Candidate, Evaluation, Objectives, OptimiseOptions, Search, TimingModel, WaferFlow,
};
use jointplay::cell::program::{AllowedValues, Program, Unit};
use jointplay::cell::workcell::Cell;
use jointplay::cell::{IncrementalPlanner, PlanOptions};
use jointplay::format::number::{counted, number};
use jointplay::format::program;
use jointplay::format::units::{m_from_mm, mm};
use serde::Serialize;

use super::input::{InputArgs, Planned};
use super::optimise_log::{EvaluationLog, Inputs};
use crate::arguments::{finite, length, whole};
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::output;
use crate::progress::Progress;
use jointplay::format::number::fixed;

const LOG: &str = "evaluations.jsonl";
const DOCUMENT: &str = "optimise.json";

/// Search for faster or safer programs with the same wafer flow
///
/// Each wafer visits the same slots in the same order, within the rules of the cell; the order of the hand-offs, the effectors, blend radii and speeds are varied, first those of the whole program, then those of single stations.
/// Listed are the programs without violations that no other exceeds in throughput, minimum distance and slip margin; each was planned and checked as by `jointplay cell check`.
/// Evaluations are logged: the same command continues an interrupted search, and the result is the same.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell optimise
  jointplay cell optimise --blend-mm 0,5,10 --speed-percent 100,90 --rounds 8 --out faster

Exit codes: 0 done, 1 no program without violations, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Optimise {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Folder for the programs, the result and the log
    #[arg(short, long, value_name = "FOLDER", default_value = "cell-optimise")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    /// Blend radii
    #[arg(long, value_name = "MM", value_delimiter = ',', default_value = "0,3,8", value_parser = radius)]
    blend_mm: Vec<f64>,
    /// Speeds as shares of the limits
    #[arg(long, value_name = "PERCENT", value_delimiter = ',', default_value = "100,90,80", value_parser = percent)]
    speed_percent: Vec<f64>,
    /// Largest number of rounds of proposed orders
    #[arg(long, value_name = "N", default_value = "5", value_parser = rounds)]
    rounds: usize,
    /// Number of partial orders that the search keeps
    #[arg(long, value_name = "N", default_value = "64", value_parser = beam)]
    beam: usize,
    /// Largest number of programs with a speed or blend radius of their own at single stations
    #[arg(long, value_name = "N", default_value = "24", value_parser = station_programs)]
    station_programs: usize,
}

/// Result of `cell optimise`.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct OptimiseDocument {
    /// Name of the cell.
    cell: String,
    /// Number of wafers that the program moves.
    wafers: usize,
    /// Number of programs that were planned and checked.
    evaluated: usize,
    /// The program as given, with its own speeds and blends; none with violations.
    given: Option<ObjectivesDocument>,
    /// Programs that no other exceeds in all objectives, by decreasing throughput.
    programs: Vec<ProgramDocument>,
}

/// Objectives of a program.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ObjectivesDocument {
    /// Wafers per hour of the repeated program.
    wafers_per_hour: f64,
    /// Minimum distance of all pairs.
    min_distance_mm: f64,
    /// Share of the friction that remains.
    slip_margin_percent: f64,
}

/// A program that was found, and its objectives.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ProgramDocument {
    /// Name of its file in the folder.
    file: String,
    /// Number of the order of its hand-offs; 0 is that of the given program.
    order_number: usize,
    /// Speed as a share of the limits, but at `stations`.
    speed_percent: f64,
    /// Blend radius, but at `stations`.
    blend_mm: f64,
    /// Stations with settings of their own.
    stations: Vec<StationDocument>,
    #[serde(flatten)]
    objectives: ObjectivesDocument,
}

/// Speed and blend radius of the motions to a station and of the hand-offs there.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct StationDocument {
    /// Name of the station.
    station: String,
    /// Speed as a share of the limits.
    speed_percent: f64,
    /// Blend radius.
    blend_mm: f64,
}

fn radius(text: &str) -> Result<f64, String> {
    within(length(text)?, AllowedValues::BLEND_RADIUS).map(m_from_mm)
}

fn percent(text: &str) -> Result<f64, String> {
    within(finite(text)?, AllowedValues::SPEED).map(|percent| percent / 100.0)
}

/// A value that programs can contain.
fn within(value: f64, AllowedValues { min, max, unit, .. }: AllowedValues) -> Result<f64, String> {
    if (min..=max).contains(&value) {
        return Ok(value);
    }
    let [value, min, max] = [value, min, max].map(number);
    let unit = unit.map_or("", Unit::symbol);
    Err(format!("must be from {min} to {max} {unit}, got {value} {unit}"))
}

fn rounds(text: &str) -> Result<usize, String> {
    whole(text, 0, 100)
}

fn station_programs(text: &str) -> Result<usize, String> {
    whole(text, 0, 10_000)
}

fn beam(text: &str) -> Result<usize, String> {
    whole(text, 1, 10_000)
}

impl Optimise {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let log_path = self.out.join(LOG);
        if !log_path.exists() {
            folder::check_folder(&self.out, self.force)?;
        }
        let planned = self.input.plan()?;
        let (cell, given) = (planned.cell(), &planned.input);
        let flow = WaferFlow::new(cell, &given.program, &planned.motion)
            .map_err(|error| Failure::Usage(format!("{}: {error}", given.label)))?;
        std::fs::create_dir_all(&self.out)
            .map_err(|source| Failure::Write { path: self.out.clone(), source })?;
        let parameters = self.input.settings()?.of_cell;
        let inputs = Inputs {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            cell: given.cell.text.clone(),
            files: given.cell.files.clone(),
            parameters: parameters
                .into_iter()
                .map(|(name, value)| (name, value.to_string()))
                .collect(),
            program: given.text.clone(),
        };
        let mut log = EvaluationLog::open(&log_path, &inputs, self.force)?;
        let mut search = Search::new(cell, &flow, self.options());
        let mut evaluator = Evaluator { planned: &planned, planner: IncrementalPlanner::default() };
        let progress = Progress::new(1);
        let mut count = 0;
        while let Some(candidate) = search.next_candidate() {
            count += 1;
            progress.reporter().stage(&format!("evaluating program {count}"));
            let proposed = search.program(&candidate);
            let text = program::write(&proposed);
            let evaluation = match log.known(&text) {
                Some(known) => known.clone(),
                None => {
                    let found = evaluator.evaluate(&proposed);
                    log.append(&text, &found)?;
                    found
                }
            };
            search.record(evaluation);
        }
        drop(progress);
        let document = self.write(&planned, &search, &flow)?;
        if self.input.format().json() {
            output::json(&document)?;
        } else {
            output::text(&self.text(&document))?;
        }
        if document.programs.is_empty() {
            let text = format!("{}: no program without violations was found", given.label);
            return Err(Failure::Unsolved(text));
        }
        Ok(())
    }

    fn options(&self) -> OptimiseOptions {
        OptimiseOptions {
            beam_width: self.beam,
            rounds: self.rounds,
            blend_radii: self.blend_mm.clone(),
            speeds: self.speed_percent.clone(),
            station_candidates: self.station_programs,
            ..OptimiseOptions::default()
        }
    }

    /// Writes the programs of the front and the document.
    fn write(
        &self,
        planned: &Planned,
        search: &Search<'_>,
        flow: &WaferFlow,
    ) -> Result<OptimiseDocument, Failure> {
        let given = Objectives::of(&planned.report, CheckOptions::default().report_distance);
        let (mut programs, mut files) = (Vec::new(), Vec::new());
        for (number, (candidate, objectives)) in search.front().iter().enumerate() {
            let name = format!("optimised-{}.program", number + 1);
            let text = program::write(&search.program(candidate));
            files.push((name.clone(), text.into_bytes()));
            programs.push(program_document(planned.cell(), name, candidate, objectives));
        }
        let document = OptimiseDocument {
            cell: planned.cell().name.clone(),
            wafers: flow.wafers(),
            evaluated: search.evaluated().len(),
            given: given.as_ref().map(objectives_document),
            programs,
        };
        files.push((DOCUMENT.to_owned(), (output::to_json(&document) + "\n").into_bytes()));
        folder::write(&self.out, &files, ForceArgs::REPLACE)?;
        Ok(document)
    }

    fn text(&self, document: &OptimiseDocument) -> String {
        let mut text = format!(
            "{}: {} moved, {} planned and checked\n",
            document.cell,
            counted(document.wafers, "wafer"),
            counted(document.evaluated, "program")
        );
        text.push_str("  wafers/h  min. distance mm  slip margin %  speed %  blend mm  program\n");
        let objectives = |one: Option<&ObjectivesDocument>| {
            let texts = one.map(|one| {
                let rate = fixed(one.wafers_per_hour, 1);
                [rate, fixed(one.min_distance_mm, 3), fixed(one.slip_margin_percent, 1)]
            });
            let [rate, distance, slip] = texts.unwrap_or_else(|| ["–"; 3].map(str::to_owned));
            format!("  {rate:>8} {distance:>17} {slip:>14}")
        };
        let given = document.given.as_ref();
        let with_violations = if given.is_none() { ", with violations" } else { "" };
        let (own, given) = ("–", objectives(given));
        let _ = writeln!(text, "{given} {own:>8} {own:>9}  as given{with_violations}");
        for one in &document.programs {
            let stations = one.stations.iter().map(|own| {
                let (speed, blend) = (fixed(own.speed_percent, 0), fixed(own.blend_mm, 1));
                format!("; {} {speed} %, {blend} mm", own.station)
            });
            let stations: String = stations.collect();
            let _ = writeln!(
                text,
                "{} {:>8} {:>9}  {}{stations}",
                objectives(Some(&one.objectives)),
                fixed(one.speed_percent, 0),
                fixed(one.blend_mm, 1),
                one.file
            );
        }
        let written = counted(document.programs.len(), "program");
        let _ = writeln!(text, "{written} written into {}", self.out.display());
        text
    }
}

fn objectives_document(objectives: &Objectives) -> ObjectivesDocument {
    ObjectivesDocument {
        wafers_per_hour: objectives.wafers_per_hour,
        min_distance_mm: mm(objectives.clearance),
        slip_margin_percent: 100.0 * objectives.slip_margin,
    }
}

fn program_document(
    cell: &Cell,
    file: String,
    candidate: &Candidate,
    objectives: &Objectives,
) -> ProgramDocument {
    let stations = candidate.stations.iter().map(|(&station, settings)| StationDocument {
        station: cell.stations[station].name.clone(),
        speed_percent: 100.0 * settings.speed,
        blend_mm: mm(settings.blend_radius),
    });
    ProgramDocument {
        file,
        order_number: candidate.order,
        speed_percent: 100.0 * candidate.settings.speed,
        blend_mm: mm(candidate.settings.blend_radius),
        stations: stations.collect(),
        objectives: objectives_document(objectives),
    }
}

/// Plans and checks programs; results of the last one are reused.
struct Evaluator<'p> {
    planned: &'p Planned,
    planner: IncrementalPlanner,
}

impl Evaluator<'_> {
    fn evaluate(&mut self, program: &Program) -> Evaluation {
        let options = PlanOptions::default();
        match self.planner.plan(self.planned.cell(), program, &options) {
            Ok((motion, report)) => Evaluation {
                objectives: Objectives::of(&report, CheckOptions::default().report_distance),
                timing: TimingModel::measure(&motion),
            },
            Err(_) => Evaluation::default(),
        }
    }
}
