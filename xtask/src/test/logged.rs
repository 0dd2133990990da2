//! A program that runs in the background, with its output in a file.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A program that was started and not yet waited for.
pub(super) struct Logged {
    child: Child,
    /// Its output.
    pub(super) log: PathBuf,
}

impl Logged {
    /// Starts a program, whose output is written to a file of this name in a folder.
    ///
    /// # Errors
    /// Those of the file and of the start.
    pub(super) fn start(name: &str, mut command: Command, folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let log = folder.join(name).with_extension("txt");
        let file = File::create(&log)?;
        command.stdin(Stdio::null()).stdout(file.try_clone()?).stderr(file);
        Ok(Self { child: command.spawn()?, log })
    }

    /// Waits for its end, and repeats its output; true if it succeeded.
    pub(super) fn wait(mut self) -> bool {
        let done = self.child.wait().is_ok_and(|status| status.success());
        print!("{}", fs::read_to_string(&self.log).unwrap_or_default());
        done
    }
}

impl Drop for Logged {
    /// Nothing is left half made behind a run that has ended.
    fn drop(&mut self) {
        let _ = self.child.wait();
    }
}
