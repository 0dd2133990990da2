//! The robot that the server was started with, and its file.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use jointplay::format::robot::{self, Robot};

use crate::cell_files::SaveError;
use crate::text_file;

/// A robot file: on disk, an entry of the catalogue, or the robot of the paper.
#[derive(Debug, Clone)]
pub struct RobotFileOnDisk {
    /// Name of the file or entry.
    pub name: String,
    /// Path of the file, if it can be saved.
    pub path: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// Values of parameters in place of those of the file, in its units.
    pub parameters: BTreeMap<String, f64>,
}

impl RobotFileOnDisk {
    /// Hash of the text.
    pub(crate) fn version(&self) -> String {
        text_file::version_of(&self.text)
    }

    /// Parameters that are replaced, with their values.
    fn replaced(&self) -> Vec<(String, f64)> {
        self.parameters.iter().map(|(name, &value)| (name.clone(), value)).collect()
    }
}

/// File and robot as last read or saved.
struct Served {
    file: RobotFileOnDisk,
    robot: Arc<Robot>,
}

/// The robot that the server was started with; a saved file replaces it.
#[derive(Clone)]
pub(crate) struct RobotSession(Arc<Mutex<Served>>);

/// A robot without checks of its limits: each endpoint checks them itself, unless the request asks to ignore them.
pub(crate) fn unlimited(robot: Robot) -> Arc<Robot> {
    Arc::new(Robot { gpr: robot.gpr.without_limit_checks(), ..robot })
}

impl RobotSession {
    pub(crate) fn new(robot: Robot) -> Self {
        let file = RobotFileOnDisk {
            name: "robot.toml".to_owned(),
            path: None,
            text: robot::write(&robot),
            parameters: BTreeMap::new(),
        };
        Self(Arc::new(Mutex::new(Served { file, robot: unlimited(robot) })))
    }

    /// The file that the robot was read from.
    pub(crate) fn with_file(self, file: RobotFileOnDisk) -> Self {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).file = file;
        self
    }

    /// The robot of requests that do not name another one.
    pub(crate) fn robot(&self) -> Arc<Robot> {
        Arc::clone(&self.0.lock().unwrap_or_else(PoisonError::into_inner).robot)
    }

    /// The file, read from disk again if it is one.
    pub(crate) fn reload(&self) -> Result<RobotFileOnDisk, String> {
        let mut served = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(path) = &served.file.path {
            served.file.text = text_file::read(path)?;
        }
        Ok(served.file.clone())
    }

    /// Saves a text; with `replaces`, only if the file on disk still has this version.
    ///
    /// A text without errors becomes the robot of this server.
    pub(crate) fn save(
        &self,
        text: String,
        replaces: Option<&str>,
    ) -> Result<RobotFileOnDisk, SaveError> {
        let mut served = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let path = served.file.path.as_deref();
        text_file::save((&served.file.name, "a robot file"), path, &text, replaces)?;
        served.file.text = text;
        if let Ok(robot) = robot::parse_with(&served.file.text, &served.file.replaced()) {
            served.robot = unlimited(robot);
        }
        Ok(served.file.clone())
    }
}
