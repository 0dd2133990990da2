//! The unit as one file.

use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::binary::{Binary, BinaryError};
use super::description::{FmiVersion, model_description};
use super::error::Error;
use super::instance::Fmu;
use super::resources::Resources;

/// The entry that describes a unit, by which units are recognised.
pub(crate) const MODEL_DESCRIPTION: &str = "modelDescription.xml";

/// Why a unit cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// A model that cannot be a unit.
    #[error(transparent)]
    Model(#[from] Error),
    /// A library for which the version of FMI has no folder.
    #[error(transparent)]
    Binary(#[from] BinaryError),
    /// Two libraries of one platform.
    #[error("two libraries are for {platform}: give one for each platform")]
    SamePlatform {
        /// The platform, as FMI 3.0 names it.
        platform: &'static str,
    },
    /// Contents beyond the limits of the format.
    #[error("the archive cannot be written: {0}")]
    Zip(#[from] zip::result::ZipError),
}

impl From<std::io::Error> for ArchiveError {
    fn from(error: std::io::Error) -> Self {
        Self::Zip(error.into())
    }
}

/// The identifier of C that names the libraries of a unit.
#[must_use]
pub fn model_identifier(name: &str) -> String {
    let letter = |one: char| if one.is_ascii_alphanumeric() { one } else { '_' };
    let identifier: String = name.chars().map(letter).collect();
    let starts = identifier.chars().next().is_some_and(|one| !one.is_ascii_digit());
    if starts { identifier } else { format!("_{identifier}") }
}

/// A unit as the bytes of its file, the same for the same contents.
///
/// # Arguments
/// * `name` – name of the model
/// * `binaries` – libraries, each for another platform
///
/// # Errors
/// [`ArchiveError`].
pub fn archive(
    resources: &Resources,
    name: &str,
    binaries: &[Binary],
    version: FmiVersion,
) -> Result<Vec<u8>, ArchiveError> {
    let fmu = Fmu::new(resources)?;
    let identifier = model_identifier(name);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file(MODEL_DESCRIPTION, options)?;
    zip.write_all(model_description(&fmu, name, &identifier, version).as_bytes())?;
    for (file, text) in resources.files() {
        zip.start_file(format!("resources/{file}"), options)?;
        zip.write_all(text.as_bytes())?;
    }
    let mut paths = Vec::new();
    for binary in binaries {
        let path = binary.path(&identifier, version)?;
        if paths.contains(&path) {
            return Err(ArchiveError::SamePlatform { platform: binary.platform() });
        }
        zip.start_file(&path, options.unix_permissions(0o755))?;
        zip.write_all(binary.bytes())?;
        paths.push(path);
    }
    Ok(zip.finish()?.into_inner())
}
