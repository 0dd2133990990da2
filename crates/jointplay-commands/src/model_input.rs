//! Models of other programs, with the files that they include.

use std::path::Path;

use jointplay::format::mechanism::{LengthUnit, MAX_BYTES};
use jointplay::interop::import::{self, Expanded, Imported, IncludeError};

use crate::failure::Failure;
use crate::source::Source;

/// Imports a model of another program.
///
/// # Arguments
/// * `unit` – unit of lengths of an assembly of FreeCAD
pub(crate) fn imported(source: &Source, unit: Option<LengthUnit>) -> Result<Imported, Failure> {
    let model = expanded(source)?;
    let read = match unit {
        Some(unit) => import::parse_with_unit(&model.text, unit),
        None => import::parse(&model.text),
    };
    read.map_err(|error| located(source, &model.locate(error)))
}

/// A model with the files of its folder that it includes.
pub(crate) fn expanded(source: &Source) -> Result<Expanded, Failure> {
    let mut read = |name: &str| {
        let folder = source.folder.as_deref().ok_or("standard input has no folder")?;
        let bytes = jointplay_files::read(folder, name, MAX_BYTES as u64)
            .map_err(|refused| refused.to_string())?;
        String::from_utf8(bytes).map_err(|_| "it is not text in UTF-8".to_owned())
    };
    import::expand_includes(&source.text, &mut read).map_err(|error| located(source, &error))
}

/// An error of a model, or of a file that it includes.
pub(crate) fn located(source: &Source, IncludeError { file, error }: &IncludeError) -> Failure {
    let folder = source.folder.as_deref().unwrap_or(Path::new(""));
    match file {
        None => Failure::at(error, &source.label),
        Some(file) => Failure::at(error, &folder.join(file).display().to_string()),
    }
}
