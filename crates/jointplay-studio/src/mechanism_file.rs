//! The mechanism that the server was started with.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::cell_files::{SaveError, hash, replace, write_temporary};

/// A mechanism: a file, a model with its loops, or an entry of the catalogue.
#[derive(Debug, Clone)]
pub struct MechanismFileOnDisk {
    /// Name of the file or entry.
    pub name: String,
    /// Path of the mechanism file, if it can be saved.
    pub path: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// Text of the file that closes the loops of a model.
    pub loops: Option<String>,
}

impl MechanismFileOnDisk {
    /// Hash of the text.
    pub(crate) fn version(&self) -> String {
        hash(&self.text)
    }
}

/// The mechanism that the server was started with, as last read or saved.
#[derive(Clone)]
pub(crate) struct MechanismSession(Arc<Mutex<MechanismFileOnDisk>>);

impl MechanismSession {
    pub(crate) fn new(file: MechanismFileOnDisk) -> Self {
        Self(Arc::new(Mutex::new(file)))
    }

    /// The mechanism, read from disk again if it is a file.
    pub(crate) fn reload(&self) -> Result<MechanismFileOnDisk, String> {
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(path) = &file.path {
            file.text = read(path)?;
        }
        Ok(file.clone())
    }

    /// Saves a text; with `replaces`, only if the file on disk still has this version.
    pub(crate) fn save(
        &self,
        text: String,
        replaces: Option<&str>,
    ) -> Result<MechanismFileOnDisk, SaveError> {
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(path) = file.path.clone() else {
            let why = format!("{} is not a mechanism file on disk: download the text", file.name);
            return Err(SaveError::Unwritable(why));
        };
        if let Some(version) = replaces {
            let on_disk = read(&path).map_err(SaveError::Changed)?;
            if hash(&on_disk) != version {
                let why = format!(
                    "{} was changed on disk after it was read: reload it, or save without `replaces` to overwrite it",
                    file.name
                );
                return Err(SaveError::Changed(why));
            }
        }
        let temporary = write_temporary(&path, &text).map_err(SaveError::Unwritable)?;
        replace(&temporary, &path).map_err(SaveError::Unwritable)?;
        file.text = text;
        Ok(file.clone())
    }
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))
}
