//! An incomplete table of a study on the disk, and the marker from which another run can resume.
//!
//! `TABLE.part` holds the finished chunks, and the marker `TABLE.part.json` their number.
//! Invariant: the marker counts only chunks that are on the disk.
//! Therefore the table is synced first; then the marker is written under a temporary name, synced and renamed.
//! A resumed run truncates the table to the length in the marker.
//! The complete table is renamed first, and the marker is removed afterwards.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jointplay::format::study::StudyFile;
use jointplay::report::study_table::{Encoded, Index, Marker, Table, TableKind};
use jointplay::study::plan::{Block, Totals};

use crate::failure::Failure;
use crate::file_lock::lock;
use crate::source::read_text;

/// Interval between two markers; a power cut or a kill loses the chunks since the last one.
const MARK_EVERY: Duration = Duration::from_millis(500);
/// Lower bound of the interval, in durations of the last marking: the footer of a long Parquet table takes time to write.
const MARK_PAUSE: u32 = 20;
/// Largest accepted marker (bytes).
const LARGEST_MARKER: u64 = 1 << 32;

/// An incomplete table and its marker.
pub(super) struct PartFile {
    out: PathBuf,
    path: PathBuf,
    marker_path: PathBuf,
    file: File,
    index: Index,
    marker: Marker,
    seed: u64,
    marked: Instant,
    /// Duration of the last marking.
    marking: Duration,
    replace: bool,
}

/// The files of an interrupted study.
pub(super) struct Files<'a> {
    /// The incomplete table.
    pub(super) part: &'a Path,
    /// The table that it becomes once complete.
    pub(super) table: &'a Path,
}

impl PartFile {
    /// Starts a table.
    pub(super) fn begin(
        out: &Path,
        study: &StudyFile,
        kind: TableKind,
        table: &Table,
        replace: bool,
    ) -> Result<Self, Failure> {
        let Names { path, marker: marker_path } = names(out);
        if out.is_dir() {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "a folder is in its place");
            return Err(Failure::Write { path: out.to_owned(), source });
        }
        if out.exists() && !replace {
            return Err(Failure::Usage(format!(
                "{} exists: choose another --out, or use --force to replace it",
                out.display()
            )));
        }
        if path.exists() && !replace {
            // Checked first: another run may be writing it.
            let running = OpenOptions::new().read(true).write(true).open(&path);
            lock(&running.map_err(failed(&path))?, &path)?;
        }
        if marker_path.exists() && !replace {
            return Err(Failure::Usage(format!(
                "{} is the table of an interrupted run: use --resume to continue it, or --force to start again",
                path.display()
            )));
        }
        if path.exists() && !replace {
            return Err(Failure::Usage(format!(
                "{} exists and does not belong to an interrupted run: move it, or use --force to replace it",
                path.display()
            )));
        }
        // Locked before it is truncated: another run may be writing it.
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let file = file.map_err(failed(&path))?;
        lock(&file, &path)?;
        if marker_path.exists() {
            std::fs::remove_file(&marker_path).map_err(failed(&marker_path))?;
        }
        file.set_len(0).map_err(failed(&path))?;
        let totals = Totals::for_study(&*study.plan);
        let mut part = Self {
            out: out.to_owned(),
            path,
            marker_path,
            file,
            index: Index::default(),
            marker: Marker::new(study, kind, totals),
            seed: study.plan.seed(),
            marked: Instant::now(),
            marking: Duration::ZERO,
            replace,
        };
        part.write(&table.head())?;
        part.mark(table)?;
        Ok(part)
    }

    /// Resumes the table of an interrupted run.
    pub(super) fn resume(
        out: &Path,
        study: &StudyFile,
        kind: TableKind,
        table: &Table,
    ) -> Result<Self, Failure> {
        let Names { path, marker: marker_path } = names(out);
        if !marker_path.exists() {
            let (out, marker) = (out.display(), marker_path.display());
            return Err(Failure::Usage(format!(
                "nothing to resume: there is no {marker}, from which {out} would be completed; run without --resume"
            )));
        }
        let invalid = |why: String| Failure::Marker { path: marker_path.clone(), why };
        let text = read_text(&marker_path, LARGEST_MARKER)?;
        let marker = Marker::parse(&text).map_err(|error| invalid(error.to_string()))?;
        let begun = marker.study_file().map_err(|error| invalid(error.to_string()))?;
        let differences = begun.differences(study);
        if !differences.is_empty() {
            return Err(invalid(format!(
                "the study differs from the one that was started; use --force to start again\n  {}",
                differences.join("\n  ")
            )));
        }
        if marker.kind != kind {
            let (found, here) = (marker.kind.ending(), kind.ending());
            return Err(invalid(format!("it belongs to a {found} table, not to a {here} table")));
        }
        // Killed after the table was renamed: the table is complete, and only the marker is left.
        let whole = marker.bytes.saturating_add(marker.foot.len() as u64);
        let named = !path.exists() && out.metadata().is_ok_and(|found| found.len() == whole);
        let path = if named { out.to_owned() } else { path };
        let file = OpenOptions::new().read(true).write(true).open(&path).map_err(failed(&path))?;
        lock(&file, &path)?;
        let length = file.metadata().map_err(failed(&path))?.len();
        if length < marker.bytes {
            let (shown, needed) = (path.display(), marker.bytes);
            return Err(invalid(format!(
                "{shown} has {length} bytes, but {needed} bytes were written; use --force to start again"
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
            seed: study.plan.seed(),
            marked: Instant::now(),
            marking: Duration::ZERO,
            replace: false,
        };
        part.truncate().map_err(failed(&part.path))?;
        Ok(part)
    }

    /// Number of chunks written.
    pub(super) fn chunks(&self) -> u64 {
        self.marker.chunks
    }

    /// Statistics of the columns written so far.
    pub(super) fn totals(&self) -> &Totals {
        &self.marker.totals
    }

    /// Appends one chunk.
    pub(super) fn append(
        &mut self,
        table: &Table,
        blocks: &[Block],
        encoded: &Encoded,
    ) -> Result<(), Failure> {
        let at = self.marker.bytes;
        for bytes in &encoded.parts {
            if let Err(failure) = self.write(bytes) {
                // Only complete chunks stay, so that the file is a table.
                self.marker.bytes = at;
                drop(self.truncate());
                return Err(failure);
            }
        }
        table.note(&mut self.index, encoded, at)?;
        self.marker.totals.add(&Totals::of_chunk(blocks));
        self.marker.chunks += 1;
        if self.marked.elapsed() >= MARK_EVERY.max(self.marking * MARK_PAUSE) {
            self.mark(table)?;
        }
        Ok(())
    }

    /// Marks the chunks written before a failure; the path of the incomplete table.
    pub(super) fn save(&mut self, table: &Table) -> &Path {
        // If marking fails, the previous marker stays valid.
        drop(self.mark(table));
        &self.path
    }

    /// Closes the incomplete table so that it can be read, and resumed later.
    pub(super) fn interrupt(&mut self, table: &Table) -> Result<Files<'_>, Failure> {
        self.mark(table)?;
        // The marker does not count the footer; a resumed run truncates it.
        let foot = table.foot(&self.index)?;
        self.file.write_all(&foot).map_err(failed(&self.path))?;
        self.file.sync_all().map_err(failed(&self.path))?;
        Ok(Files { part: &self.path, table: &self.out })
    }

    /// Closes the complete table and gives it its final name.
    pub(super) fn finish(mut self, table: &Table) -> Result<(), Failure> {
        self.mark(table)?;
        let foot = table.foot(&self.index)?;
        self.write(&foot)?;
        self.file.sync_all().map_err(failed(&self.path))?;
        if self.path != self.out && self.out.exists() && !self.replace {
            return Err(Failure::Usage(format!(
                "{} was created meanwhile; the complete table is {}",
                self.out.display(),
                self.path.display()
            )));
        }
        std::fs::rename(&self.path, &self.out).map_err(failed(&self.out))?;
        jointplay_files::sync_folder(&self.out);
        std::fs::remove_file(&self.marker_path).map_err(failed(&self.marker_path))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.file.write_all(bytes).map_err(failed(&self.path))?;
        self.marker.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Removes everything beyond the complete chunks.
    fn truncate(&mut self) -> io::Result<()> {
        self.file.set_len(self.marker.bytes)?;
        self.file.seek(SeekFrom::Start(self.marker.bytes)).map(|_| ())
    }

    /// Writes the marker.
    fn mark(&mut self, table: &Table) -> Result<(), Failure> {
        let start = Instant::now();
        self.file.sync_data().map_err(failed(&self.path))?;
        self.marker.foot = table.foot(&self.index)?;
        let json = self.marker.to_json(self.seed);
        jointplay_files::write_durable(&self.marker_path, json.as_bytes())
            .map_err(failed(&self.marker_path))?;
        self.marked = Instant::now();
        self.marking = self.marked - start;
        Ok(())
    }
}

/// Size of the table of an interrupted run (bytes); 0 without one.
pub(super) fn written(out: &Path) -> f64 {
    let Names { path, .. } = names(out);
    path.metadata().map_or(0.0, |found| found.len() as f64)
}

/// The paths of an incomplete table and of its marker.
struct Names {
    path: PathBuf,
    marker: PathBuf,
}

fn names(out: &Path) -> Names {
    let with = |ending: &str| {
        let mut name = out.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    Names { path: with(".part"), marker: with(".part.json") }
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> Failure + use<> {
    let path = path.to_owned();
    move |source| Failure::Write { path, source }
}
