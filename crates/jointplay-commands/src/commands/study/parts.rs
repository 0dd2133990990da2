//! Studies in parts: shares of the parts as tasks of a cluster, what is finished, and the table of all.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::study::StudyFile;
use jointplay::report::study_parts::{self, PartFiles, PartWriter};
use jointplay::report::study_table::TableKind;
use jointplay::report::{self, SHARES};
use jointplay::study::plan::{self, Study};
use rayon::ThreadPool;

use super::interrupt;
use super::parts_folder::{PartsFolder, within};
use super::source::StudySource;
use super::text;
use crate::console;
use crate::failure::Failure;
use crate::folder::ForceArgs;
use crate::output::{self, FormatArgs};
use crate::progress::Progress;

/// The flags of studies in parts.
#[derive(Args)]
pub(super) struct PartsArgs {
    /// Compute into a folder with one file per chunk of samples, described by its study.json; without FILE, the study of the folder
    #[arg(long, value_name = "FOLDER")]
    parts: Option<PathBuf>,
    /// Compute the parts i with i mod N = K, which are the share of task K of N [default: 0/1, all parts]
    #[arg(long, value_name = "K/N", value_parser = share, requires = "parts")]
    part: Option<Share>,
    /// Format of the parts' tables [default: parquet, or csv in a build without it]
    #[arg(long, value_enum, value_name = "FORMAT", requires = "parts")]
    part_format: Option<PartFormat>,
    /// Report the number of finished parts and the missing ones; exit code 1 if any is missing
    #[arg(long, requires = "parts", conflicts_with_all = ["part", "gather"])]
    status: bool,
    /// Write the table of all parts, with the bytes of a run on one machine, and print its summary
    #[arg(long, value_name = "TABLE", requires = "parts", conflicts_with = "part")]
    gather: Option<PathBuf>,
}

/// Format of the tables of parts.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PartFormat {
    /// comma-separated values
    Csv,
    /// Parquet
    Parquet,
}

impl PartFormat {
    fn kind(self) -> TableKind {
        match self {
            Self::Csv => TableKind::Csv,
            Self::Parquet => TableKind::Parquet,
        }
    }

    /// The format if none is chosen.
    fn usual() -> TableKind {
        if cfg!(feature = "parquet") { TableKind::Parquet } else { TableKind::Csv }
    }
}

/// The parts i with i mod `of` = `task`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Share {
    task: u64,
    of: u64,
}

fn share(text: &str) -> Result<Share, String> {
    let share = text
        .split_once('/')
        .and_then(|(task, of)| Some(Share { task: task.parse().ok()?, of: of.parse().ok()? }));
    share.filter(|share| share.task < share.of).ok_or_else(|| {
        "a share is K/N with whole numbers, K from 0 to N − 1, such as 3/64".to_owned()
    })
}

impl PartsArgs {
    /// The folder, if the study is in parts.
    pub(super) fn folder(&self) -> Option<&Path> {
        self.parts.as_deref()
    }

    /// Computes a share, reports the status or gathers.
    ///
    /// # Arguments
    /// * `file` – the study file, if there is one
    /// * `pool` – the threads for a plan
    pub(super) fn run(
        &self,
        path: &Path,
        file: Option<&Path>,
        pool: impl Fn(&dyn Study) -> Result<ThreadPool, Failure>,
        force: bool,
        format: FormatArgs,
    ) -> Result<(), Failure> {
        let found = PartsFolder::find(path)?;
        let study = match (file, &found) {
            (Some(file), _) => Some(StudySource::read(file)?.parse()?),
            (None, Some(_)) => None,
            (None, None) => {
                return Err(Failure::Usage(format!(
                    "{} has no study.json: give a folder with parts of a study, or name the study file",
                    path.display()
                )));
            }
        };
        if self.gather.is_none() && force {
            return Err(Failure::Usage("--force is for --gather and its table".to_owned()));
        }
        let wanted = self.part_format.map(PartFormat::kind);
        if let (Some(folder), Some(study)) = (&found, &study) {
            folder.check(study, wanted)?;
        }
        if self.status {
            return status(path, found.as_ref(), study, format);
        }
        let folder = match (found, study) {
            (Some(folder), _) => {
                folder.check(&folder.manifest.study, wanted)?;
                folder
            }
            (None, Some(study)) => {
                let kind = wanted.unwrap_or_else(PartFormat::usual);
                // Before the folder is created.
                PartWriter::new(&study, kind).map_err(within(path))?;
                let folder = PartsFolder::create(path, study.clone(), kind)?;
                folder.check(&study, wanted)?;
                folder
            }
            (None, None) => unreachable!("a study was read where there is no folder"),
        };
        let pool = pool(&*folder.manifest.study.plan)?;
        match &self.gather {
            Some(out) => pool.install(|| gather(&folder, path, out, force, format)),
            None => {
                let share = self.part.unwrap_or(Share { task: 0, of: 1 });
                interrupt::listen()?;
                pool.install(|| compute(&folder, path, share, format))
            }
        }
    }
}

/// Reports what is finished.
fn status(
    path: &Path,
    found: Option<&PartsFolder>,
    study: Option<StudyFile>,
    format: FormatArgs,
) -> Result<(), Failure> {
    let done = found.map_or(Ok(Default::default()), PartsFolder::done)?;
    let study = study.or_else(|| found.map(|folder| folder.manifest.study.clone()));
    let study = study.expect("a study was read where there is no folder");
    let report = study_parts::status(&study, &done).map_err(within(path))?;
    format.print(&report, text::status)?;
    match report.missing_ranges.first() {
        None => Ok(()),
        Some(&[first, _]) => {
            let (missing, parts) = (report.missing, report.parts);
            let source = study_parts::PartsError::Missing { missing, parts, first };
            Err(within(path)(source))
        }
    }
}

/// Computes the parts of a share that are not finished.
fn compute(
    folder: &PartsFolder,
    path: &Path,
    share: Share,
    format: FormatArgs,
) -> Result<(), Failure> {
    let plan = &*folder.manifest.study.plan;
    let done = folder.done()?;
    let writer =
        PartWriter::new(&folder.manifest.study, folder.manifest.kind).map_err(within(path))?;
    let (parts, samples) = (plan.chunks()?, plan.samples()?);
    let own = || {
        // Lazily: a share may have more parts than memory has room for numbers.
        let step = usize::try_from(share.of).unwrap_or(usize::MAX);
        (share.task..parts).step_by(step)
    };
    let total = parts.saturating_sub(share.task).div_ceil(share.of);
    let present = done.range(..parts).filter(|part| *part % share.of == share.task).count() as u64;
    let missing = own().filter(|part| !done.contains(part));
    let chunk = plan.portions().chunk;
    let rows = |part: u64| chunk.min(samples - part * chunk);
    let last = parts.checked_sub(1).filter(|last| last % share.of == share.task);
    let cut = |done: bool| last.map_or(0, |last| if done { chunk - rows(last) } else { 0 });
    let own_samples = total * chunk - cut(true);
    let begun = present * chunk - cut(last.is_some_and(|last| done.contains(&last)));
    let mut progress = Progress::of_samples(own_samples, begun);
    let (mut computed, mut at) = (0, begun);
    plan::run_chunks(
        plan,
        missing,
        |part, blocks| writer.files(part, blocks).map_err(within(path)),
        |part, _, files: PartFiles| {
            folder.write(&files)?;
            computed += 1;
            at += rows(part);
            progress.samples(at);
            Ok::<_, Failure>(!interrupt::requested())
        },
    )?;
    let (rate, time) = progress.pace();
    drop(progress);
    if computed > 0 {
        console::note(&format!(
            "{} samples in {time:.2} s, {} samples/s",
            at - begun,
            output::short(rate)
        ));
    }
    let of_share = format!(" of the share {}/{}", share.task, share.of);
    if present + computed < total {
        return Err(Failure::Interrupted(format!(
            "{} of {}; the same command continues",
            present + computed,
            text::finished(total, &of_share)
        )));
    }
    let report = serde_json::json!({
        "study": folder.manifest.study.name,
        "folder": path.display().to_string(),
        "share": [share.task, share.of],
        "parts": total,
        "computed": computed,
        "present": present,
    });
    format.print(&report, |_| {
        format!(
            "{}: {}\n  computed {computed}, found {present}\n",
            folder.manifest.study.name,
            text::finished(total, &of_share)
        )
    })
}

/// Writes the table of all parts and prints its summary.
fn gather(
    folder: &PartsFolder,
    path: &Path,
    out: &Path,
    force: bool,
    format: FormatArgs,
) -> Result<(), Failure> {
    let shown = out.display();
    let kind = TableKind::from_path(out).ok_or_else(|| {
        Failure::Usage(format!("--gather {shown}: the name of a table ends in .csv or .parquet"))
    })?;
    let study = &folder.manifest.study;
    folder.check(study, None)?;
    let held = folder.manifest.kind;
    if kind != held {
        let (held, wanted) = (held.ending(), kind.ending());
        return Err(Failure::Usage(format!(
            "--gather {shown}: the parts are {held} tables; choose a name that ends in .{held}, or compute them again with --part-format {wanted}"
        )));
    }
    let done = folder.done()?;
    let parts = study.plan.chunks()?;
    let mut progress = Progress::new(usize::try_from(parts).unwrap_or(usize::MAX));
    progress.stage("parts");
    let force = if force { ForceArgs::REPLACE } else { ForceArgs::KEEP };
    let show = |part| progress.at(usize::try_from(part).unwrap_or(usize::MAX));
    let totals = folder.gather(out, &done, force, show)?;
    drop(progress);
    console::detail(&format!("{}: {parts} parts", path.display()));
    let quantiles = plan::quantiles(&*study.plan, &SHARES)?;
    let report = report::totals(study, &totals, &quantiles);
    text::print_summary(&report, Some(out), format.json())
}
