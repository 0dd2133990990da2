//! The flags of `jointplay study`, and the run from study file to table.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::study::{self, StudyFile};
use jointplay::report::TableError;
use jointplay::report::study_table::{Table, TableKind};
use jointplay::report::{self, SHARES, TotalsReport};
use jointplay::study::parallel::MOST_THREADS;
use jointplay::study::plan::{self, Block, Study};
use serde::Serialize;

use super::destination::Destination;
use super::estimate::{Estimate, rough_size};
use super::interrupt;
use super::part_file::{self, PartFile};
use super::parts::PartsArgs;
use super::source::StudySource;
use super::text;
use crate::console;
use crate::failure::Failure;
use crate::output::{self, FormatArgs};
use crate::progress::Progress;
use crate::source::STANDARD;
use crate::space;

/// Compute a table over many poses, robots, mechanisms or programs of work cells, as described by a study file
///
/// A study file lists the varied parameters and the computed quantities: grids or random samples of poses, nominal robots or robots with manufacturing tolerances, one or several virtualizations; of any mechanism its dimensions, drives, positions, virtual displacements and mobility; of a work cell the places of its stations, parameters of cell and program, cycle time, distances and margins.
/// The result is one table in CSV or Parquet format.
/// Memory use does not depend on the number of samples.
/// The bytes of the table depend only on the study file: not on the number of threads, and not on interruptions.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay study                                      the first example: centre shift over the workspace
  jointplay study --example                            print its study file, as a template
  jointplay study tolerances --out robots.csv          ten thousand robots with tolerances
  jointplay study slider-crank                         a mechanism: dimensions and drives
  jointplay study station-positions                    a work cell: places of a station, cycle time and margins
  jointplay study tolerances --dry-run                 expected duration, size and columns
  jointplay study tolerances --parts run --part 0/64   the first of 64 shares of the parts, as a task of a cluster
  jointplay study --parts run --status                 number of finished parts, and the missing ones
  jointplay study --parts run --gather robots.parquet  table and summary of all parts

Ctrl-C stops a study after the current chunk; the finished chunks stay in TABLE.part, and --resume continues.
Included examples: center-shift, play-over-the-workspace, slider-crank, station-positions, tolerances.
With --parts, chunks of 65,536 samples (2048 of mechanisms, 64 of cells) become files of their own, on any number of machines; finished ones are not computed again.
The gathered table has the bytes of a run on one machine.
Exit codes: 0 done, also with unsolved samples, whose number is printed, 1 no sample could be solved or parts are missing, 2 bad input or usage, 130 interrupted.")]
pub(crate) struct StudyCommand {
    /// Study file (TOML), or the name of an included example [default: the first example]
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Table to write: a file ending in .csv or .parquet, or - for CSV on standard output [default: STUDY.csv]
    #[arg(long, value_name = "TABLE", conflicts_with = "parts")]
    out: Option<PathBuf>,
    /// Number of threads, from 1 to 1024; at most one per 4096 samples is used [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// Continue an interrupted run
    #[arg(long, conflicts_with_all = ["force", "dry_run", "example", "parts"])]
    resume: bool,
    /// Replace an existing table or the table of an interrupted run; start even if the disk is too small
    #[arg(long)]
    force: bool,
    /// Report the number of samples, the columns, and the expected size and duration; compute nothing
    #[arg(long, conflicts_with_all = ["example", "parts"])]
    dry_run: bool,
    /// Print the study file and exit
    #[arg(long, conflicts_with = "parts")]
    example: bool,
    #[command(flatten)]
    parts: PartsArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

/// The study file that is printed.
#[derive(Serialize)]
struct Example<'a> {
    /// Name of the file without its extension, or of the included example.
    name: &'a str,
    text: &'a str,
}

/// Tables of at least this size are announced before the computation starts (bytes).
const ANNOUNCED_SIZE: f64 = 1e10;

impl StudyCommand {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if let Some(folder) = self.parts.folder() {
            let threads = |plan: &dyn Study| self.pool(plan);
            let file = self.file.as_deref();
            return self.parts.run(folder, file, threads, self.force, self.format);
        }
        let first = Path::new(study::examples()[0].name);
        let source = StudySource::read(self.file.as_deref().unwrap_or(first))?;
        if self.example {
            return match self.format.json() {
                true => output::json(&Example { name: &source.stem, text: &source.text }),
                false => output::raw(&source.text),
            };
        }
        let file = source.parse()?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.csv", source.stem)));
        let to_standard_output = out == Path::new(STANDARD);
        let kind =
            if to_standard_output { Some(TableKind::Csv) } else { TableKind::from_path(&out) };
        let kind = kind.ok_or_else(|| {
            let shown = out.display();
            Failure::Usage(format!("--out {shown}: the name of a table ends in .csv or .parquet"))
        })?;
        let table = Table::new(kind, file.columns.clone())?;
        let pool = self.pool(&*file.plan)?;
        if self.dry_run {
            let estimate = pool.install(|| Estimate::measure(&file, &table))?;
            return text::dry_run(&file, &out, &estimate, self.format.json());
        }
        let mut destination = if to_standard_output {
            if self.resume {
                let text = "--resume needs a table in a file, not on standard output";
                return Err(Failure::Usage(text.to_owned()));
            }
            Destination::standard_output(&file, &table)?
        } else {
            pool.install(|| self.check_space(&file, &table, &out))?;
            let part = if self.resume {
                PartFile::resume(&out, &file, kind, &table)?
            } else {
                PartFile::begin(&out, &file, kind, &table, self.force)?
            };
            Destination::File(Box::new(part))
        };
        interrupt::listen()?;
        let report = pool.install(|| compute(&file, &table, &mut destination))?;
        destination.finish(&table)?;
        text::print_summary(&report, (!to_standard_output).then_some(&*out), self.format.json())
    }

    /// The threads of a computation.
    fn pool(&self, plan: &dyn Study) -> Result<rayon::ThreadPool, Failure> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.unwrap_or(cores).min(plan.most_threads()?))
            .build()
            .map_err(|error| Failure::Usage(format!("cannot start the threads: {error}")))
    }

    /// Refuses a table that does not fit on its disk.
    fn check_space(&self, file: &StudyFile, table: &Table, out: &Path) -> Result<(), Failure> {
        let rough = rough_size(file)?;
        let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        // The table of an interrupted run takes its space already.
        let written = if self.resume { part_file::written(out) } else { 0.0 };
        let Some(free) = space::free(folder).filter(|free| rough > 0.1 * free) else {
            return Ok(());
        };
        let needed = Estimate::measure(file, table)?.bytes - written;
        if needed <= free {
            return Ok(());
        }
        let (needed, free) = (text::size(needed), text::size(free));
        let text = format!(
            "the table needs about {needed}, but only {free} are free in {}",
            folder.display()
        );
        if self.force || self.resume {
            console::note(&format!("warning: {text}"));
            return Ok(());
        }
        Err(Failure::Usage(format!(
            "{text}: reduce the number of samples or columns, choose another --out, or use --force to start anyway"
        )))
    }
}

fn threads(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=MOST_THREADS).contains(count));
    count.ok_or_else(|| format!("the number of threads must be from 1 to {MOST_THREADS}"))
}

/// Computes the remaining samples of a study.
fn compute(
    file: &StudyFile,
    table: &Table,
    destination: &mut Destination,
) -> Result<TotalsReport, Failure> {
    let plan = &*file.plan;
    let count = plan.samples()?;
    let begun = destination.samples();
    let expected = rough_size(file)?;
    if expected > ANNOUNCED_SIZE {
        console::note(&format!("{count} samples will take about {}", text::size(expected)));
    }
    let mut progress = Progress::of_samples(count, begun);
    let done = plan::run(
        plan,
        destination.chunks(),
        |blocks: &[Block]| Ok(table.encode(blocks)?),
        |blocks, encoded| {
            destination.append(table, blocks, &encoded)?;
            progress.samples(destination.samples());
            Ok(!interrupt::requested() || destination.samples() == count)
        },
    );
    let (rate, time) = progress.pace();
    drop(progress);
    if let Err(failure) = done {
        if let Some(part) = destination.save(table) {
            console::note(&format!(
                "the finished samples are in {}; the same command with --resume continues",
                part.display()
            ));
        }
        return Err(failure);
    }
    let samples = destination.samples();
    if samples < count {
        return Err(Failure::Interrupted(destination.interrupt(table, count)?));
    }
    if samples > begun {
        console::note(&format!(
            "{} samples in {time:.2} s, {} samples/s",
            samples - begun,
            output::short(rate)
        ));
    }
    let quantiles = plan::quantiles(plan, &SHARES)?;
    Ok(report::totals(file, destination.totals(), &quantiles))
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        match error {
            #[cfg(not(feature = "parquet"))]
            TableError::WithoutParquet => Self::NoParquet,
            other => Self::Usage(other.to_string()),
        }
    }
}
