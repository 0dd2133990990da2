//! The table of a study while it is not whole, and the marker from which another run can go on.
//!
//! `TABLE.part` holds the chunks so far, `TABLE.part.json` says how many these are.
//! A marker speaks of chunks only that are on the disk: the table is synced first, then the marker is written under a temporary name, synced and renamed.
//! What stands in the table beyond its marker is cut off by whoever goes on.
//! The whole table gets its name last, and the marker goes after that.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jointplay::format::study::{StudyFile, parse};
use jointplay::report::study_table::{Encoded, Index, Marker, Table, TableKind};
use jointplay::study::plan::{Block, Totals};

use crate::failure::Failure;
use crate::source::read_text;

/// So often is marked how far a run has come: what is done since then is lost to a power cut or a kill.
const MARK_EVERY: Duration = Duration::from_millis(500);
/// Or so many times as long as the last marking took: the end of a long Parquet table takes its time.
const MARK_PAUSE: u32 = 20;
/// Larger markers are refused unread [bytes].
const LARGEST_MARKER: u64 = 1 << 32;

/// A table on its way.
pub(super) struct PartFile {
    out: PathBuf,
    path: PathBuf,
    marker_path: PathBuf,
    file: File,
    index: Index,
    marker: Marker,
    seed: u64,
    marked: Instant,
    /// How long the last marking took.
    marking: Duration,
    replace: bool,
}

impl PartFile {
    /// Begins a table.
    pub(super) fn begin(
        out: &Path,
        study: &StudyFile,
        kind: TableKind,
        table: &Table,
        replace: bool,
    ) -> Result<Self, Failure> {
        let (path, marker_path) = names(out);
        if out.is_dir() {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "a folder is in its place");
            return Err(Failure::Write { path: out.to_owned(), source });
        }
        if out.exists() && !replace {
            return Err(Failure::Misused(format!(
                "{} exists: choose another --out, or replace it with --force",
                out.display()
            )));
        }
        if path.exists() && !replace {
            // First of all: another run may be writing it.
            let running = OpenOptions::new().read(true).write(true).open(&path);
            lock(&running.map_err(failed(&path))?, &path)?;
        }
        if marker_path.exists() && !replace {
            return Err(Failure::Misused(format!(
                "{} is what an interrupted run left: --resume goes on with it, --force begins again",
                path.display()
            )));
        }
        if path.exists() && !replace {
            return Err(Failure::Misused(format!(
                "{} is in the way, and no run that could be gone on with has left it: move it, or say --force to replace it",
                path.display()
            )));
        }
        // Locked before it is emptied: another run may be at it.
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let file = file.map_err(failed(&path))?;
        lock(&file, &path)?;
        if marker_path.exists() {
            std::fs::remove_file(&marker_path).map_err(failed(&marker_path))?;
        }
        file.set_len(0).map_err(failed(&path))?;
        let totals = Totals::new(study.plan.wanted.len(), study.plan.models.len());
        let mut part = Self {
            out: out.to_owned(),
            path,
            marker_path,
            file,
            index: Index::default(),
            marker: Marker::new(study, kind, totals),
            seed: study.plan.seed,
            marked: Instant::now(),
            marking: Duration::ZERO,
            replace,
        };
        part.write(&table.head())?;
        part.mark(table)?;
        Ok(part)
    }

    /// Takes up a table that an interrupted run left.
    pub(super) fn resume(
        out: &Path,
        study: &StudyFile,
        kind: TableKind,
        table: &Table,
    ) -> Result<Self, Failure> {
        let (path, marker_path) = names(out);
        if !marker_path.exists() {
            let (out, marker) = (out.display(), marker_path.display());
            return Err(Failure::Misused(format!(
                "there is nothing to go on with: no interrupted run has left {marker}, from which {out} would be completed; begin without --resume"
            )));
        }
        let wrong = |why: String| Failure::Marker { path: marker_path.clone(), why };
        let text = read_text(&marker_path, LARGEST_MARKER)?;
        let marker = Marker::parse(&text).map_err(|error| wrong(error.to_string()))?;
        let begun = parse(&marker.study, |_| Ok(marker.robot.clone()))
            .map_err(|error| wrong(format!("the study in it cannot be read: {error}")))?;
        let differences = begun.differences(study);
        if !differences.is_empty() {
            return Err(wrong(format!(
                "the study is not the one that was begun; --force begins again\n  {}",
                differences.join("\n  ")
            )));
        }
        if marker.kind != kind {
            let (found, here) = (marker.kind.ending(), kind.ending());
            return Err(wrong(format!("it is of a table of {found}, not of {here}")));
        }
        // Killed after the last renaming: the table is whole, only its marker is left.
        let whole = marker.bytes + marker.foot.len() as u64;
        let named = !path.exists() && out.metadata().is_ok_and(|found| found.len() == whole);
        let path = if named { out.to_owned() } else { path };
        let file = OpenOptions::new().read(true).write(true).open(&path).map_err(failed(&path))?;
        lock(&file, &path)?;
        let length = file.metadata().map_err(failed(&path))?.len();
        if length < marker.bytes {
            let (shown, needed) = (path.display(), marker.bytes);
            return Err(wrong(format!(
                "{shown} has {length} bytes, but {needed} were written; --force begins again"
            )));
        }
        let index = table.index(&marker.foot)?;
        let mut part = Self {
            out: out.to_owned(),
            path,
            marker_path,
            file,
            index,
            marker,
            seed: study.plan.seed,
            marked: Instant::now(),
            marking: Duration::ZERO,
            replace: false,
        };
        part.cut().map_err(failed(&part.path))?;
        Ok(part)
    }

    /// How many chunks are done.
    pub(super) fn chunks(&self) -> u64 {
        self.marker.chunks
    }

    /// How many samples are done.
    pub(super) fn samples(&self) -> u64 {
        self.marker.totals.samples
    }

    /// The columns so far.
    pub(super) fn totals(&self) -> &Totals {
        &self.marker.totals
    }

    /// Adds a chunk.
    pub(super) fn append(
        &mut self,
        table: &Table,
        blocks: &[Block],
        encoded: &Encoded,
    ) -> Result<(), Failure> {
        let at = self.marker.bytes;
        for bytes in &encoded.parts {
            if let Err(failure) = self.write(bytes) {
                // Only whole chunks stay, so that what is there is a table.
                self.marker.bytes = at;
                drop(self.cut());
                return Err(failure);
            }
        }
        table.note(&mut self.index, encoded, at)?;
        blocks.iter().for_each(|block| self.marker.totals.add(block));
        self.marker.chunks += 1;
        if self.marked.elapsed() >= MARK_EVERY.max(self.marking * MARK_PAUSE) {
            self.mark(table)?;
        }
        Ok(())
    }

    /// Marks as much as can be marked after a failure; says what the table so far is called.
    pub(super) fn keep(&mut self, table: &Table) -> String {
        // An older marker stands where this one cannot.
        drop(self.mark(table));
        self.path.display().to_string()
    }

    /// Ends what is done as a table, to be gone on with later; says what it is called, and what it is to become.
    pub(super) fn interrupt(&mut self, table: &Table) -> Result<(String, String), Failure> {
        self.mark(table)?;
        // Not counted by the marker: whoever goes on cuts it off.
        let foot = table.foot(&self.index)?;
        self.file.write_all(&foot).map_err(failed(&self.path))?;
        self.file.sync_all().map_err(failed(&self.path))?;
        Ok((self.path.display().to_string(), self.out.display().to_string()))
    }

    /// Ends the table, which is whole, and gives it its name.
    pub(super) fn finish(mut self, table: &Table) -> Result<(), Failure> {
        self.mark(table)?;
        let foot = table.foot(&self.index)?;
        self.write(&foot)?;
        self.file.sync_all().map_err(failed(&self.path))?;
        if self.path != self.out && self.out.exists() && !self.replace {
            return Err(Failure::Misused(format!(
                "{} was created meanwhile; the whole table is {}",
                self.out.display(),
                self.path.display()
            )));
        }
        std::fs::rename(&self.path, &self.out).map_err(failed(&self.out))?;
        sync_folder(&self.out);
        std::fs::remove_file(&self.marker_path).map_err(failed(&self.marker_path))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.file.write_all(bytes).map_err(failed(&self.path))?;
        self.marker.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Cuts off what stands beyond the whole chunks.
    fn cut(&mut self) -> io::Result<()> {
        self.file.set_len(self.marker.bytes)?;
        self.file.seek(SeekFrom::Start(self.marker.bytes)).map(|_| ())
    }

    /// Marks how far the run has come.
    fn mark(&mut self, table: &Table) -> Result<(), Failure> {
        let start = Instant::now();
        self.file.sync_data().map_err(failed(&self.path))?;
        self.marker.foot = table.foot(&self.index)?;
        let json = self.marker.to_json(self.seed);
        let mut new = self.marker_path.clone().into_os_string();
        new.push(".new");
        let write = || {
            let mut file = File::create(&new)?;
            file.write_all(json.as_bytes())?;
            file.sync_all()?;
            std::fs::rename(&new, &self.marker_path)
        };
        if let Err(source) = write() {
            drop(std::fs::remove_file(&new));
            return Err(failed(&self.marker_path)(source));
        }
        sync_folder(&self.marker_path);
        self.marked = Instant::now();
        self.marking = self.marked - start;
        Ok(())
    }
}

/// Size of what an interrupted run left of a table [bytes]; 0 if there is nothing.
pub(super) fn written(out: &Path) -> f64 {
    let (path, _) = names(out);
    path.metadata().map_or(0.0, |found| found.len() as f64)
}

/// Names of the table on its way and of its marker.
fn names(out: &Path) -> (PathBuf, PathBuf) {
    let with = |ending: &str| {
        let mut name = out.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    (with(".part"), with(".part.json"))
}

/// Keeps other runs from the same table.
fn lock(file: &File, path: &Path) -> Result<(), Failure> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(Failure::Misused(format!(
            "another run is writing {}: let it end, or choose another --out",
            path.display()
        ))),
        Err(TryLockError::Error(source)) => Err(failed(path)(source)),
    }
}

/// Makes a change of names last through a power cut, where folders can be synced.
fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        drop(folder.sync_all());
    }
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> Failure + use<> {
    let path = path.to_owned();
    move |source| Failure::Write { path, source }
}
