//! The log of evaluations of a search, from which another run resumes.
//!
//! Its first line identifies cell, program and version; each further line is one evaluated program.
//! A line that was cut off by a killed run ends the log.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use jointplay::cell::optimise::{Evaluation, Objectives, Signature, TimingSample};
use jointplay::cell::robot::EffectorId;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::folder::ForceArgs;

/// Inputs of a search; a log of other inputs is not used.
#[derive(PartialEq, Serialize, Deserialize)]
pub(super) struct Inputs {
    pub(super) version: String,
    pub(super) cell: String,
    /// Names of the files that the cell refers to, with hashes of their contents.
    pub(super) files: BTreeMap<String, u64>,
    /// Parameters of the cell that are set, with their values.
    pub(super) parameters: BTreeMap<String, String>,
    pub(super) program: String,
}

#[derive(Serialize, Deserialize)]
struct Line {
    program: String,
    /// Wafers per hour, clearance in m, slip margin; none with violations.
    objectives: Option<[Exact; 3]>,
    timing: Vec<Timing>,
}

/// A number as text, which keeps every bit.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
struct Exact(f64);

impl From<Exact> for String {
    fn from(number: Exact) -> Self {
        number.0.to_string()
    }
}

impl TryFrom<String> for Exact {
    type Error = std::num::ParseFloatError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse().map(Self)
    }
}

#[derive(Serialize, Deserialize)]
struct Timing {
    previous: Option<HandoffKind>,
    handoff: HandoffKind,
    travel_s: Exact,
    in_station_s: Exact,
}

#[derive(Serialize, Deserialize)]
struct HandoffKind {
    picks: bool,
    arm: usize,
    effector: usize,
    station: usize,
}

/// Evaluations of earlier runs, and the file to which new ones are appended.
pub(super) struct EvaluationLog {
    path: PathBuf,
    file: File,
    known: BTreeMap<String, Evaluation>,
}

impl EvaluationLog {
    /// Opens a log and reads its evaluations; a log of other inputs is refused, or replaced with `force`.
    pub(super) fn open(path: &Path, inputs: &Inputs, force: ForceArgs) -> Result<Self, Failure> {
        let failed = |source| Failure::Write { path: path.to_owned(), source };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed(error)),
        };
        let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let header = lines.next().and_then(|line| serde_json::from_str::<Inputs>(line).ok());
        let is_same = header.as_ref() == Some(inputs);
        if !(text.is_empty() || is_same || force.is_given()) {
            return Err(Failure::Usage(format!(
                "{} belongs to another cell, program or version: choose another folder with --out, or use --force to start again",
                path.display()
            )));
        }
        let mut known = BTreeMap::new();
        let mut kept = String::new();
        if is_same {
            for line in lines {
                let Ok(read) = serde_json::from_str::<Line>(line) else { break };
                kept += line;
                known.insert(read.program.clone(), read.evaluation());
            }
        }
        let header = serde_json::to_string(inputs).map_err(|error| failed(error.into()))?;
        let mut file = OpenOptions::new()
            .create(true)
            .write(true)
            .truncate(true)
            .open(path)
            .map_err(failed)?;
        write!(file, "{header}\n{kept}").map_err(failed)?;
        Ok(Self { path: path.to_owned(), file, known })
    }

    /// Evaluation of a program by an earlier run.
    pub(super) fn known(&self, program: &str) -> Option<&Evaluation> {
        self.known.get(program)
    }

    /// Appends an evaluation, which is on the disk afterwards.
    pub(super) fn append(&mut self, program: &str, evaluation: &Evaluation) -> Result<(), Failure> {
        let failed = |source| Failure::Write { path: self.path.clone(), source };
        let line = Line::new(program, evaluation);
        let mut text = serde_json::to_string(&line).map_err(|error| failed(error.into()))?;
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(failed)?;
        self.file.sync_data().map_err(failed)
    }
}

impl Line {
    fn new(program: &str, evaluation: &Evaluation) -> Self {
        let kind = |one: Signature| HandoffKind {
            picks: one.picks,
            arm: one.effector.arm,
            effector: one.effector.effector,
            station: one.station,
        };
        let timing = evaluation.timing.iter().map(|one| Timing {
            previous: one.previous.map(kind),
            handoff: kind(one.signature),
            travel_s: Exact(one.travel),
            in_station_s: Exact(one.in_station),
        });
        let values =
            |one: Objectives| [one.wafers_per_hour, one.clearance, one.slip_margin].map(Exact);
        Self {
            program: program.to_owned(),
            objectives: evaluation.objectives.map(values),
            timing: timing.collect(),
        }
    }

    fn evaluation(&self) -> Evaluation {
        let signature = |one: &HandoffKind| Signature {
            picks: one.picks,
            effector: EffectorId { arm: one.arm, effector: one.effector },
            station: one.station,
        };
        let timing = self.timing.iter().map(|one| TimingSample {
            previous: one.previous.as_ref().map(signature),
            signature: signature(&one.handoff),
            travel: one.travel_s.0,
            in_station: one.in_station_s.0,
        });
        let objectives = |[rate, clearance, slip]: [Exact; 3]| Objectives {
            wafers_per_hour: rate.0,
            clearance: clearance.0,
            slip_margin: slip.0,
        };
        Evaluation { objectives: self.objectives.map(objectives), timing: timing.collect() }
    }
}
