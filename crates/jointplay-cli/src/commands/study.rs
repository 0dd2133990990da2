//! `jointplay study`: studies of any length, over all cores, that can be interrupted and taken up again.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;
use jointplay::format::catalogue;
use jointplay::format::study::{self, MAX_BYTES, StudyFile};
use jointplay::report::TableError;
use jointplay::report::study_table::{Table, TableKind};
use jointplay::report::{self, SHARES, TotalsReport};
use jointplay::study::parallel::MOST_THREADS;
use jointplay::study::plan::{self, Block};

use super::study_file::{self, PartFile};
use super::study_text;
use crate::arguments::TextFormat;
use crate::console;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::source::{self, Kind, STANDARD};
use crate::space;

/// Compute a study of any length from a file that says what is varied and what is wanted
///
/// Grids or random samples of poses, of a robot as designed or of robots with manufacturing tolerances, under one or several virtualizations, as a table of CSV or Parquet.
/// Memory does not grow with the length.
/// The same study gives the same bytes, whatever the threads, and whether or not it was interrupted.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay study                                      the first example: where the centre goes
  jointplay study --example                            its file, to begin one of your own with
  jointplay study misbuilt --out misbuilt-robots.csv   ten thousand robots with tolerances
  jointplay study misbuilt --dry-run                   how long, how large, which columns

Ctrl-C ends a study after the chunk that it is at: what is done stands in FILE.part, and --resume goes on.
Examples that come along: center-shift, misbuilt, play-over-the-workspace.
Exit codes: 0 done, 1 no sample has an answer, 2 bad input or usage, 130 interrupted.")]
pub(crate) struct StudyCommand {
    /// Study file (TOML), or the name of an example; without it, the first example
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Table to write, ending in .csv or .parquet; without it, the name of the study with .csv
    #[arg(long, value_name = "TABLE")]
    out: Option<PathBuf>,
    /// Number of threads, from 1 to 1024 and at most one for 4096 samples; without it, one for each core
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// Go on with a run that was interrupted
    #[arg(long, conflicts_with_all = ["force", "dry_run", "example"])]
    resume: bool,
    /// Replace a table that is there, or the rest of an interrupted run; begin a table that does not fit on the disk
    #[arg(long)]
    force: bool,
    /// Say how many samples and columns there are, how large the table will be and how long it takes; compute nothing
    #[arg(long, conflicts_with = "example")]
    dry_run: bool,
    /// Print the study file instead
    #[arg(long)]
    example: bool,
    /// How the summary is printed
    #[arg(long, value_enum, default_value = "text")]
    format: TextFormat,
}

/// Samples that a dry run computes to measure time and size.
const TRIED: u64 = 8192;
/// Tables from this size on are announced [bytes].
const LARGE: f64 = 1e10;
/// About as much as a number takes in a table [bytes].
const CELL: f64 = 15.0;

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

impl StudyCommand {
    pub(crate) fn json(&self) -> bool {
        self.format == TextFormat::Json
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        let source = self.source()?;
        if self.example {
            return output::raw(&source.text);
        }
        let file = study::parse(&source.text, |name| robot_text(name, source.folder.as_deref()))
            .map_err(|error| Failure::at(&error, &source.label))?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.csv", source.stem)));
        let kind = TableKind::of(&out).ok_or_else(|| {
            let shown = out.display();
            Failure::Misused(format!("--out {shown}: a table ends in .csv or in .parquet"))
        })?;
        let table = Table::new(kind, file.columns.clone())?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = self.threads.unwrap_or(cores).min(file.plan.most_threads()?);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Failure::Misused(format!("cannot start the threads: {error}")))?;
        if self.dry_run {
            let expected = pool.install(|| Expected::of(&file, &table))?;
            return study_text::dry_run(&file, &out, &expected, self.json());
        }
        pool.install(|| self.check_space(&file, &table, &out))?;
        let mut part = if self.resume {
            PartFile::resume(&out, &file, kind, &table)?
        } else {
            PartFile::begin(&out, &file, kind, &table, self.force)?
        };
        listen()?;
        let report = pool.install(|| compute(&file, &table, &mut part))?;
        part.finish(&table)?;
        if self.json() {
            output::json(&report)?;
        } else {
            output::text(&study_text::summary(&report, &out))?;
        }
        if report.virtualizations.iter().all(|model| model.solved == 0) {
            let shown = out.display();
            return Err(Failure::Unsolved(format!(
                "no sample has an answer; {shown} has the reasons"
            )));
        }
        Ok(())
    }

    /// Refuses a table that does not fit on its disk.
    fn check_space(&self, file: &StudyFile, table: &Table, out: &Path) -> Result<(), Failure> {
        let rough = file.plan.samples()? as f64 * file.columns.len() as f64 * CELL;
        let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        // What an interrupted run left is part of the table already.
        let written = if self.resume { study_file::written(out) } else { 0.0 };
        let Some(free) = space::free(folder).filter(|free| rough > 0.1 * free) else {
            return Ok(());
        };
        let needed = Expected::of(file, table)?.bytes - written;
        if needed <= free {
            return Ok(());
        }
        let (needed, free) = (study_text::size(needed), study_text::size(free));
        let text = format!(
            "the table will take about {needed}, but only {free} are free in {}",
            folder.display()
        );
        if self.force || self.resume {
            tell(&format!("warning: {text}"));
            return Ok(());
        }
        Err(Failure::Misused(format!(
            "{text}: take fewer samples or columns, or another --out; --force begins it nevertheless"
        )))
    }

    fn source(&self) -> Result<Source, Failure> {
        let path = match &self.file {
            Some(path) => path.clone(),
            None => PathBuf::from(study::examples()[0].name),
        };
        let label = path.display().to_string();
        if let Some(example) = study::example(&label).filter(|_| !path.exists()) {
            let (stem, text) = (example.name.to_owned(), example.text.to_owned());
            return Ok(Source { label, stem, text, folder: None });
        }
        if !path.exists() && path.extension().is_none() && path != Path::new(STANDARD) {
            if catalogue::find(&label).is_some() {
                source::Source::read(&path, MAX_BYTES)?.require(&[Kind::Study], "a study")?;
            }
            let known: Vec<String> =
                study::examples().iter().map(|example| example.name.to_owned()).collect();
            return Err(Failure::Misused(jointplay::format::place::not_known(
                "the study",
                &label,
                &known,
            )));
        }
        let source = source::Source::read(&path, MAX_BYTES)?;
        source.require(&[Kind::Study], "a study")?;
        let (label, text) = (source.label, source.text);
        let stem = source::stem(&path);
        let folder = Some(path.parent().map(Path::to_owned).unwrap_or_default());
        Ok(Source { label, stem, text, folder })
    }
}

fn threads(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=MOST_THREADS).contains(count));
    count.ok_or_else(|| format!("a number from 1 to {MOST_THREADS} is needed"))
}

/// A study file, where it is from, and what its table is called.
struct Source {
    label: String,
    stem: String,
    text: String,
    /// Where robot files of the study lie; `None` for an example.
    folder: Option<PathBuf>,
}

/// The text of the robot that a study names: of the catalogue, or of a file beside the study.
fn robot_text(name: &str, folder: Option<&Path>) -> Result<String, String> {
    let Some(folder) = folder.filter(|_| name.ends_with(".toml")) else {
        return study::robot_of(name);
    };
    let refused =
        |why: &dyn std::fmt::Display| format!("cannot read the robot file {name:?}: {why}");
    let bytes =
        jointplay_files::read(folder, name, MAX_BYTES as u64).map_err(|why| refused(&why))?;
    String::from_utf8(bytes).map_err(|_| refused(&"it is not text in UTF-8"))
}

/// Ends the study after the chunk that it is at when Ctrl-C is pressed, and at once when it is pressed again.
fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            // What is done is marked; the next run goes on from there.
            #[expect(clippy::exit, reason = "whoever presses twice does not want to wait")]
            std::process::exit(130);
        }
    })
    .map_err(|error| Failure::Misused(format!("cannot listen for Ctrl-C: {error}")))
}

/// Computes what is left of a study.
fn compute(file: &StudyFile, table: &Table, part: &mut PartFile) -> Result<TotalsReport, Failure> {
    let plan = &file.plan;
    let count = plan.samples()?;
    let begun = part.samples();
    let expected = count as f64 * file.columns.len() as f64 * CELL;
    if expected > LARGE {
        tell(&format!("{count} samples will take about {}", study_text::size(expected)));
    }
    let mut progress = Progress::of_samples(count, begun);
    let done = plan::run(
        plan,
        part.chunks(),
        |blocks: &[Block]| Ok(table.encode(blocks)?),
        |blocks, encoded| {
            part.append(table, blocks, &encoded)?;
            progress.samples(part.samples());
            Ok(!STOP.load(Ordering::SeqCst) || part.samples() == count)
        },
    );
    let (rate, time) = progress.pace();
    drop(progress);
    if let Err(failure) = done {
        let part = part.keep(table);
        tell(&format!("what is done stays in {part}: the same command with --resume goes on"));
        return Err(failure);
    }
    let samples = part.samples();
    if samples < count {
        let (part, out) = part.interrupt(table)?;
        return Err(Failure::Interrupted(format!(
            "{samples} of {count} samples are done and stand in {part}; the same command with --resume goes on to {out}"
        )));
    }
    if samples > begun {
        tell(&format!(
            "{} samples in {time:.2} s, {} a second",
            samples - begun,
            output::short(rate)
        ));
    }
    let quantiles = plan::quantiles(plan, &SHARES)?;
    Ok(report::totals(file, part.totals(), &quantiles))
}

/// Says something on standard error.
fn tell(line: &str) {
    console::note(line);
}

/// What a study will take.
pub(super) struct Expected {
    pub(super) samples: u64,
    /// [bytes].
    pub(super) bytes: f64,
    /// [s].
    pub(super) time: f64,
}

impl Expected {
    /// From a few samples, spread over the whole study.
    fn of(file: &StudyFile, table: &Table) -> Result<Self, Failure> {
        let samples = file.plan.samples()?;
        let tried = samples.min(TRIED);
        // Stretches of samples that follow each other, as they will be computed.
        let stretch = tried.min(64);
        let stretches = tried.div_ceil(stretch);
        let chosen: Vec<u64> = (0..stretches)
            .flat_map(|k| {
                let whole = u128::from(samples - stretch) * u128::from(k);
                let first = whole / u128::from((stretches - 1).max(1));
                let first = u64::try_from(first).expect("at most the number of samples");
                first..first + stretch
            })
            .collect();
        let start = Instant::now();
        let block = plan::compute(&file.plan, &chosen)?;
        let encoded = table.encode(&[block])?;
        let time = start.elapsed().as_secs_f64();
        let bytes: usize = encoded.parts.iter().map(Vec::len).sum();
        let share = samples as f64 / chosen.len() as f64;
        let threads = rayon::current_num_threads() as f64;
        Ok(Self { samples, bytes: bytes as f64 * share, time: time * share / threads })
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        match error {
            #[cfg(not(feature = "parquet"))]
            TableError::WithoutParquet => Self::NoParquet,
            other => Self::Misused(other.to_string()),
        }
    }
}
