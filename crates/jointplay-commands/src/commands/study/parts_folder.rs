//! A folder of parts on the disk.
//!
//! Invariant: a part that has a record is complete.
//! Therefore its table is written and synced first; each file is written under another name and renamed.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use jointplay::format::study::StudyFile;
use jointplay::report::study_parts::{
    Gathering, MANIFEST, Manifest, PartFiles, PartNames, PartsError,
};
use jointplay::report::study_table::TableKind;
use jointplay::study::plan::Totals;

use crate::failure::Failure;
use crate::folder::{self, ForceArgs, Staged};
use crate::source::{read_bytes, read_text};
use crate::space;

use super::text;

/// Largest accepted description or record (bytes).
const LARGEST_TEXT: u64 = 1 << 26;

/// A folder of parts.
pub(super) struct PartsFolder {
    path: PathBuf,
    pub(super) manifest: Manifest,
}

impl PartsFolder {
    /// The folder as another run described it; `None` if there is no description.
    pub(super) fn find(path: &Path) -> Result<Option<Self>, Failure> {
        let described = path.join(MANIFEST);
        if !described.exists() {
            return Ok(None);
        }
        let text = read_text(&described, LARGEST_TEXT)?;
        let manifest = Manifest::parse(&text).map_err(within(path))?;
        Ok(Some(Self { path: path.to_owned(), manifest }))
    }

    /// Creates the folder of a study; one that was created meanwhile is used.
    pub(super) fn create(path: &Path, study: StudyFile, kind: TableKind) -> Result<Self, Failure> {
        let refused = |source| Failure::Write { path: path.to_owned(), source };
        std::fs::create_dir_all(path).map_err(refused)?;
        let manifest = Manifest { study, kind };
        let text = manifest.to_json().map_err(within(path))?;
        let new = folder::write_durable(&path.join(MANIFEST), text.as_bytes(), ForceArgs::KEEP);
        match new {
            Ok(()) => Ok(Self { path: path.to_owned(), manifest }),
            // Tasks of a cluster start at the same time.
            Err(Failure::Exists { .. }) => Self::find(path)?.ok_or_else(|| {
                let text =
                    format!("{} disappeared while it was read", path.join(MANIFEST).display());
                Failure::Usage(text)
            }),
            Err(failure) => Err(failure),
        }
    }

    /// Checks that the folder has the parts of this study, in this format if one was requested.
    pub(super) fn check(&self, study: &StudyFile, kind: Option<TableKind>) -> Result<(), Failure> {
        self.manifest.check(study).map_err(within(&self.path))?;
        match kind.filter(|kind| *kind != self.manifest.kind) {
            None => Ok(()),
            Some(wanted) => {
                let (found, wanted) = (self.manifest.kind.ending(), wanted.ending());
                Err(within(&self.path)(PartsError::OtherTable { found, wanted }))
            }
        }
    }

    /// Numbers of the finished parts.
    pub(super) fn done(&self) -> Result<BTreeSet<u64>, Failure> {
        let refused = |source| Failure::Read { path: self.path.clone(), source };
        let mut names = BTreeSet::new();
        for entry in std::fs::read_dir(&self.path).map_err(refused)? {
            if let Ok(name) = entry.map_err(refused)?.file_name().into_string() {
                names.insert(name);
            }
        }
        let numbers = names.iter().filter_map(|name| PartNames::part_of_record(name));
        // A table may have been deleted to compute it again.
        let has_table =
            |part: &u64| names.contains(&PartNames::of(*part, self.manifest.kind).table);
        Ok(numbers.filter(has_table).collect())
    }

    /// Writes a finished part.
    pub(super) fn write(&self, files: &PartFiles) -> Result<(), Failure> {
        let PartFiles { names, table, record } = files;
        let write = |name: &str, bytes: &[u8]| {
            folder::write_durable(&self.path.join(name), bytes, ForceArgs::REPLACE)
        };
        write(&names.table, table)?;
        write(&names.record, record.as_bytes())
    }

    /// Writes the table of all parts, and returns their totals.
    pub(super) fn gather(
        &self,
        out: &Path,
        done: &BTreeSet<u64>,
        force: ForceArgs,
        mut progress: impl FnMut(u64),
    ) -> Result<Totals, Failure> {
        let inside = within(&self.path);
        let mut gathering = Gathering::new(&self.manifest).map_err(&inside)?;
        let parts = self.manifest.study.plan.chunks()?;
        let missing = (0..parts).find(|part| !done.contains(part));
        if let Some(first) = missing {
            let missing = parts - done.range(..parts).count() as u64;
            return Err(inside(PartsError::Missing { missing, parts, first }));
        }
        folder::check_file(out, force)?;
        let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new("."));
        self.check_space(parent, parts)?;
        let name = out.file_name().and_then(|name| name.to_str()).ok_or_else(|| {
            Failure::Usage(format!("--gather {}: the name of a file is needed", out.display()))
        })?;
        let mut staged = Staged::into(parent, force)?;
        let mut totals = None;
        staged.add(name, |writer| {
            writer.write_all(&gathering.head())?;
            for part in 0..parts {
                let names = gathering.next();
                let record = read_text(&self.path.join(names.record), LARGEST_TEXT)?;
                // A longer one is no table of this part.
                let length = gathering.table_length(&record).map_err(&inside)?;
                let table = read_bytes(&self.path.join(names.table), length.max(LARGEST_TEXT))?;
                writer.write_all(&gathering.add(&record, &table).map_err(&inside)?)?;
                progress(part + 1);
            }
            let (foot, all) = gathering.finish().map_err(&inside)?;
            writer.write_all(&foot)?;
            totals = Some(all);
            Ok(())
        })?;
        staged.publish()?;
        Ok(totals.expect("the contents were written"))
    }

    /// Refuses a table that does not fit on its disk.
    fn check_space(&self, folder: &Path, parts: u64) -> Result<(), Failure> {
        let size = |part| {
            let path = self.path.join(PartNames::of(part, self.manifest.kind).table);
            path.metadata().map_or(0, |found| found.len())
        };
        let needed = (0..parts).map(size).sum::<u64>() as f64;
        match space::free(folder).filter(|free| *free < needed) {
            None => Ok(()),
            Some(free) => {
                let (needed, free) = (text::size(needed), text::size(free));
                let source = std::io::Error::new(
                    ErrorKind::StorageFull,
                    format!(
                        "the table needs about {needed}, but only {free} are free; choose another folder"
                    ),
                );
                Err(Failure::Write { path: folder.to_owned(), source })
            }
        }
    }
}

/// An error in a folder of parts.
pub(super) fn within(folder: &Path) -> impl Fn(PartsError) -> Failure + use<> {
    let folder = folder.to_owned();
    move |source| Failure::Parts { folder: folder.clone(), source: Box::new(source) }
}
