//! `jointplay cell export`: trajectories in formats of other programs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::number::{counted, number};
use jointplay::format::place;
use jointplay::interop::export::dialect::{DIALECTS, Dialect, MAX_BYTES};
use jointplay::interop::export::{self, MotionExport};
#[cfg(feature = "parquet")]
use jointplay::report::TableError;
use jointplay::report::table;
use serde::Serialize;

use super::input::{InputArgs, Planned};
use super::text::violations;
use crate::arguments::finite;
use crate::failure::Failure;
use crate::folder::{self, Contents, ForceArgs, Staged, WrittenFile};
use crate::output;
use crate::progress::Progress;
use crate::source::{STANDARD, label, read_text};

/// A sampling rate (Hz).
#[derive(Clone, Copy)]
pub(super) struct Rate(pub(super) f64);

pub(super) fn rate(text: &str) -> Result<Rate, String> {
    let value = finite(text)?;
    if (0.1..=100_000.0).contains(&value) {
        Ok(Rate(value))
    } else {
        Err(format!("sampling rate must be from 0.1 to 100000 Hz, got {} Hz", number(value)))
    }
}

/// Export the trajectory of a program: tables, glTF, MCAP, SolidWorks, controller text
///
/// Every file has exactly the duration of the trajectory.
/// A program with violations is exported only with --despite-errors; names and contents of the files then contain a warning.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell export
  jointplay cell export --to gltf --rate 60 --out scene
  jointplay cell export --to text --dialect points --out controller

Exit codes: 0 written, 1 not safe to run or unreachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Export {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Formats, separated by commas; parquet and mcap need a build with the feature of that name
    #[arg(long, value_enum, value_delimiter = ',', default_value = "csv,gltf,solidworks,text")]
    to: Vec<Kind>,
    /// Dialect of the controller text: an included one (neutral, points), or a dialect file
    #[arg(long, value_name = "DIALECT", default_value = "neutral")]
    dialect: PathBuf,
    /// Sampling rate
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = rate)]
    rate: Rate,
    /// Folder for the files
    #[arg(short, long, value_name = "FOLDER", default_value = "cell-export")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    /// Export a program with violations
    #[arg(long)]
    despite_errors: bool,
}

/// Part of the names of files that must not be run.
const MARK: &str = "-not-safe-to-run";

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// samples as comma-separated values
    Csv,
    /// samples as Parquet
    #[cfg(feature = "parquet")]
    Parquet,
    /// animated 3D scene of the cell, one binary glTF file
    Gltf,
    /// joint states, trajectories and transforms, for Foxglove and ROS 2
    #[cfg(feature = "mcap")]
    Mcap,
    /// time series of each axis, and a macro that loads them
    Solidworks,
    /// controller text, by --dialect
    Text,
}

/// The name of a file without its ending, and the dialect of controller text.
struct TextName<'a> {
    stem: &'a str,
    dialect: &'a Dialect,
}

/// The files written.
#[derive(Serialize)]
struct Written {
    result: &'static str,
    violations: usize,
    duration_s: f64,
    rate_hz: f64,
    files: Vec<PathBuf>,
}

impl Export {
    pub(super) fn run(&self) -> Result<(), Failure> {
        folder::check_folder(&self.out, self.force)?;
        let dialect = dialect(&self.dialect)?;
        let planned = self.input.plan()?;
        if !planned.passed() && !self.despite_errors {
            let count = counted(planned.report.violations.len(), "violation");
            return Err(Failure::Unsolved(format!(
                "{}: {count}, not safe to run\n{}nothing is exported; use --despite-errors to export it anyway",
                planned.input.label,
                violations(&planned)
            )));
        }
        let files = self.files(&planned, &dialect)?;
        let written = Written {
            result: planned.document().result,
            violations: planned.report.violations.len(),
            duration_s: planned.motion.duration(),
            rate_hz: self.rate.0,
            files: files.iter().map(|file| file.path.clone()).collect(),
        };
        if self.input.format().json() {
            output::json(&written)
        } else {
            output::text(&text(&written, &files))
        }
    }

    /// Writes the files of all formats.
    fn files(&self, planned: &Planned, dialect: &Dialect) -> Result<Vec<WrittenFile>, Failure> {
        let motion_export = planned.motion_export();
        let mut kinds = self.to.clone();
        kinds.dedup();
        let mark = if motion_export.violation_notes.is_empty() { "" } else { MARK };
        let stem = format!("{}{mark}", planned.input.cell.stem);
        let progress = Progress::new(kinds.len());
        let reporter = progress.reporter();
        reporter.stage("writing");
        reporter.parts(kinds.len());
        let mut staged = Staged::into(&self.out, self.force)?;
        for kind in kinds {
            self.file(kind, &motion_export, &TextName { stem: &stem, dialect }, &mut staged)?;
            reporter.part_done();
        }
        staged.publish()
    }

    fn file(
        &self,
        kind: Kind,
        motion_export: &MotionExport<'_>,
        &TextName { stem, dialect }: &TextName<'_>,
        staged: &mut Staged,
    ) -> Result<(), Failure> {
        let Rate(rate) = self.rate;
        match kind {
            Kind::Csv => csv(staged, &format!("{stem}.csv"), motion_export, rate),
            #[cfg(feature = "parquet")]
            Kind::Parquet => parquet(staged, &format!("{stem}.parquet"), motion_export, rate),
            Kind::Gltf => staged.add(&format!("{stem}.glb"), |writer| {
                Ok(writer.write_all(&export::gltf(motion_export, rate)?)?)
            }),
            #[cfg(feature = "mcap")]
            Kind::Mcap => mcap(staged, &format!("{stem}.mcap"), motion_export, rate),
            Kind::Solidworks => {
                for (axis, name) in export::motors(motion_export).iter().enumerate() {
                    staged.add(name, |mut writer| {
                        Ok(export::motor(motion_export, rate, axis, &mut writer)??)
                    })?;
                }
                let (name, text) = export::loader(motion_export);
                staged.add(&name, |writer| Ok(writer.write_all(text.as_bytes())?))
            }
            Kind::Text => {
                let name = format!("{stem}-{}.{}", dialect.name, dialect.extension);
                staged.add(&name, |writer| {
                    dialect.write_in_parts(motion_export, rate, |part| {
                        Ok::<_, Contents>(writer.write_all(part.as_bytes())?)
                    })
                })
            }
        }
    }
}

/// The samples of a trajectory as comma-separated values.
pub(super) fn csv(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<(), Failure> {
    staged.add(name, |mut writer| {
        let mut header = true;
        export::samples_in_parts(motion_export, rate, |columns| {
            table::write_csv(columns, std::mem::take(&mut header), &mut writer)?;
            Ok::<_, Contents>(())
        })
    })
}

/// An included dialect, or the dialect in a file.
fn dialect(path: &Path) -> Result<Dialect, Failure> {
    let label = label(path);
    let known = DIALECTS.iter().find(|entry| entry.name == label && !path.exists());
    let text = match known {
        Some(entry) => entry.text.to_owned(),
        None if !path.exists() && path.extension().is_none() && path != Path::new(STANDARD) => {
            let names = DIALECTS.map(|entry| entry.name.to_owned());
            return Err(Failure::Usage(place::not_known("the dialect", &label, &names)));
        }
        None => read_text(path, MAX_BYTES as u64)?,
    };
    Dialect::parse(&text).map_err(|errors| Failure::invalid(&errors, &label))
}

#[cfg(feature = "parquet")]
fn parquet(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<(), Failure> {
    let failed = |error: TableError| match error {
        TableError::Write(source) => Contents::Write(source),
        _ => Contents::Other(Failure::Parquet),
    };
    staged.add(name, |writer| {
        // The writer needs the columns of the first part.
        let mut file = None;
        let mut writer = Some(writer);
        export::samples_in_parts(motion_export, rate, |columns| {
            if let Some(writer) = writer.take() {
                file = Some(table::ParquetTable::new(columns, writer).map_err(failed)?);
            }
            file.as_mut().map_or(Ok(()), |file| file.push(columns)).map_err(failed)
        })?;
        file.map_or(Ok(()), |file| file.finish().map(drop)).map_err(failed)
    })
}

#[cfg(feature = "mcap")]
fn mcap(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<(), Failure> {
    staged.add(name, |writer| Ok(writer.write_all(&export::mcap::write(motion_export, rate)?)?))
}

fn text(written: &Written, files: &[WrittenFile]) -> String {
    let mut text = format!(
        "trajectory of {:.3} s at {} samples/s\n",
        written.duration_s,
        number(written.rate_hz)
    );
    if written.violations > 0 {
        text.push_str("NOT SAFE TO RUN: every file contains this warning\n");
    }
    for WrittenFile { path, length } in files {
        text.push_str(&format!("  {:<44} {length:>12} bytes\n", path.display()));
    }
    text
}
