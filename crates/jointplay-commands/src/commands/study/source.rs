//! The study file and the robot or mechanism that it names.

use std::path::{Path, PathBuf};

use jointplay::format::study::{self, MAX_BYTES, StudyFile};
use jointplay::format::{catalogue, cell, place};

use crate::failure::Failure;
use crate::source::{self, Kind, STANDARD, Source};

/// The text of a study file, its name in messages, and the name of its table.
pub(super) struct StudySource {
    pub(super) label: String,
    pub(super) stem: String,
    pub(super) text: String,
    /// Folder of the files that the study names; `None` for an example.
    pub(super) folder: Option<PathBuf>,
}

impl StudySource {
    /// Reads a study file, an included example, or standard input.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let label = path.display().to_string();
        if let Some(example) = study::example(&label).filter(|_| !path.exists()) {
            let (stem, text) = (example.name.to_owned(), example.text.to_owned());
            return Ok(Self { label, stem, text, folder: None });
        }
        if !path.exists() && path.extension().is_none() && path != Path::new(STANDARD) {
            if catalogue::find(&label).is_some() {
                Source::read(path, MAX_BYTES)?.require(&[Kind::Study], "a study")?;
            }
            let known: Vec<String> =
                study::examples().iter().map(|example| example.name.to_owned()).collect();
            return Err(Failure::Usage(place::not_known("the study", &label, &known)));
        }
        let source = Source::read(path, MAX_BYTES)?;
        source.require(&[Kind::Study], "a study")?;
        let (label, text) = (source.label, source.text);
        let stem = source::stem(path);
        let folder = Some(path.parent().map(Path::to_owned).unwrap_or_default());
        Ok(Self { label, stem, text, folder })
    }

    /// The study with the files that it names.
    pub(super) fn parse(&self) -> Result<StudyFile, Failure> {
        study::parse(&self.text, &mut |name| read_named(name, self.folder.as_deref()))
            .map_err(|errors| Failure::invalid(&errors, &self.label))
    }
}

/// A file that a study names: an entry of the catalogue, or a file in the folder of the study or below.
fn read_named(name: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    // Names of the catalogue have no ending.
    match folder.filter(|_| name.contains('.')) {
        Some(folder) => jointplay_files::read(folder, name, cell::MAX_MESH_BYTES as u64)
            .map_err(|why| format!("cannot read the file {name:?}: {why}")),
        None => study::included(name),
    }
}
