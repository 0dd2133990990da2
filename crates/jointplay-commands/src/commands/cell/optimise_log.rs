//! The log of evaluations of a search, from which another run resumes.
//!
//! Its first line identifies cell, program and version; each further line is one evaluated program.
//! New lines are appended, and complete ones never rewritten; a last line that a killed run cut off is removed.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use jointplay::cell::optimise::{Evaluation, Objectives, Signature, TimingSample};
use jointplay::cell::robot::EffectorId;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::file_lock::lock;
use crate::folder::ForceArgs;

/// Inputs of a search; a log of other inputs is not used.
#[derive(PartialEq, Serialize, Deserialize)]
pub(super) struct Inputs {
    pub(super) version: String,
    pub(super) cell: String,
    /// Names of the files that the cell refers to, with SHA-256 of their contents.
    pub(super) files: BTreeMap<String, String>,
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

/// The complete lines of a log.
#[derive(Default)]
struct CompleteLines {
    known: BTreeMap<String, Evaluation>,
    /// Length of header and evaluations (bytes); 0 without a header.
    length: u64,
}

impl CompleteLines {
    /// Reads the bytes of a log; one of other inputs, or with an invalid line, is refused.
    ///
    /// # Arguments
    /// * `header` – the first line of a log of these inputs
    fn read(bytes: &[u8], inputs: &Inputs, header: &str, path: &Path) -> Result<Self, Failure> {
        // Empty, or of a run that was killed while it wrote the header.
        if bytes.len() < header.len() && header.as_bytes().starts_with(bytes) {
            return Ok(Self::default());
        }
        let lines = bytes.split_inclusive(|&byte| byte == b'\n');
        let mut lines = lines.filter(|line| line.ends_with(b"\n"));
        let first = lines.next().unwrap_or_default();
        let found = serde_json::from_slice::<Inputs>(first).ok();
        if found.as_ref() != Some(inputs) {
            return Err(Failure::Usage(format!(
                "{} belongs to another cell, program or version: choose another folder with --out, or use --force to start again",
                path.display()
            )));
        }
        let (mut known, mut length) = (BTreeMap::new(), first.len() as u64);
        for (number, line) in (2..).zip(lines) {
            let read: Line = serde_json::from_slice(line).map_err(|source| {
                Failure::EvaluationLine { path: path.to_owned(), line: number, source }
            })?;
            length += line.len() as u64;
            let evaluation = read.evaluation();
            known.insert(read.program, evaluation);
        }
        Ok(Self { known, length })
    }
}

impl EvaluationLog {
    /// Opens a log and reads its evaluations; a log of other inputs or with an invalid line is refused, or replaced with `force`.
    ///
    /// The log stays locked: a log that another run writes is refused.
    pub(super) fn open(path: &Path, inputs: &Inputs, force: ForceArgs) -> Result<Self, Failure> {
        let unwritable = |source| Failure::Write { path: path.to_owned(), source };
        let unreadable = |source| Failure::Read { path: path.to_owned(), source };
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = file.map_err(unwritable)?;
        lock(&file, path)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(unreadable)?;
        let json = serde_json::to_string(inputs).map_err(|error| unwritable(error.into()))?;
        let header = format!("{json}\n");
        let complete = match CompleteLines::read(&bytes, inputs, &header, path) {
            Err(_) if force.is_given() => CompleteLines::default(),
            read => read?,
        };
        if complete.length < bytes.len() as u64 {
            file.set_len(complete.length).map_err(unwritable)?;
        }
        file.seek(SeekFrom::Start(complete.length)).map_err(unwritable)?;
        if complete.length == 0 {
            file.write_all(header.as_bytes()).map_err(unwritable)?;
            file.sync_data().map_err(unwritable)?;
        }
        Ok(Self { path: path.to_owned(), file, known: complete.known })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn inputs(program: &str) -> Inputs {
        Inputs {
            version: "1".to_owned(),
            cell: "kind = \"cell\"".to_owned(),
            files: BTreeMap::new(),
            parameters: BTreeMap::new(),
            program: program.to_owned(),
        }
    }

    fn open(path: &Path, force: ForceArgs) -> Result<EvaluationLog, Failure> {
        EvaluationLog::open(path, &inputs("HOME"), force)
    }

    /// A log with evaluations of these programs, closed again.
    fn logged(path: &Path, programs: &[&str]) {
        let mut log = open(path, ForceArgs::KEEP).unwrap();
        for program in programs {
            log.append(program, &Evaluation::default()).unwrap();
        }
    }

    #[track_caller]
    fn refused(result: Result<EvaluationLog, Failure>, reason: &str) {
        let error = result.err().expect("the log is refused").to_string();
        assert!(error.contains(reason), "{error}");
    }

    #[test]
    fn a_resumed_log_keeps_its_lines_and_loses_only_one_that_was_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.jsonl");
        logged(&path, &["A", "B"]);
        let whole = std::fs::read(&path).unwrap();
        // Cut off within a letter of two bytes.
        let cut_off = [&whole[..], "{\"program\":\"ü".as_bytes()].concat();
        std::fs::write(&path, &cut_off[..cut_off.len() - 1]).unwrap();
        let log = open(&path, ForceArgs::KEEP).unwrap();
        assert!(log.known("A").is_some() && log.known("B").is_some());
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        drop(log);
        logged(&path, &["C"]);
        let longer = std::fs::read(&path).unwrap();
        assert!(longer.starts_with(&whole) && longer.len() > whole.len());
        // Killed while the header was written.
        std::fs::write(&path, &whole[..10]).unwrap();
        logged(&path, &["A", "B"]);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }

    #[test]
    fn an_invalid_line_in_the_middle_is_refused_and_nothing_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.jsonl");
        logged(&path, &["A", "B", "C"]);
        let text = std::fs::read_to_string(&path).unwrap().replace("\"B\"", "B");
        std::fs::write(&path, &text).unwrap();
        refused(open(&path, ForceArgs::KEEP), "line 3, column ");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        let log = open(&path, ForceArgs::REPLACE).unwrap();
        assert!(log.known("A").is_none(), "the search starts again");
    }

    #[test]
    fn a_log_of_another_program_or_in_use_by_another_run_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.jsonl");
        logged(&path, &["A"]);
        let text = std::fs::read(&path).unwrap();
        let other = || EvaluationLog::open(&path, &inputs("WAIT 1 s"), ForceArgs::KEEP);
        refused(other(), "belongs to another cell, program or version");
        let running = open(&path, ForceArgs::KEEP).unwrap();
        for force in [ForceArgs::KEEP, ForceArgs::REPLACE] {
            refused(open(&path, force), "another run is writing");
        }
        drop(running);
        assert_eq!(std::fs::read(&path).unwrap(), text);
    }
}
