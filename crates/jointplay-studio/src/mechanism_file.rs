//! The mechanism that the server was started with.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use crate::cell_files::SaveError;
use crate::text_file;

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
        text_file::version_of(&self.text)
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
            file.text = text_file::read(path)?;
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
        let path = file.path.as_deref();
        text_file::save((&file.name, "a mechanism file"), path, &text, replaces)?;
        file.text = text;
        Ok(file.clone())
    }
}
