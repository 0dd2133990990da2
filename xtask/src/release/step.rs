//! A step of a release.

use std::io;

use super::folders::Folders;

/// A step of a release.
pub(super) struct Step {
    pub(super) name: &'static str,
    pub(super) run: fn(&Folders) -> io::Result<()>,
}

impl Step {
    /// Runs the step; its files are in the folder of its results.
    ///
    /// # Errors
    /// As the step, with its name.
    pub(super) fn write(&self, folders: &Folders) -> io::Result<()> {
        println!("\n=== {}", self.name);
        folders
            .run(self.name, self.run)
            .map_err(|error| io::Error::other(format!("{}: {error}", self.name)))
    }
}
