//! Steps that run concurrently with others, since each keeps one processor busy at most.

use std::env;
use std::path::Path;
use std::process::Command;

use super::logged::Logged;

/// Chores that were started before their turn.
#[derive(Default)]
pub(super) struct Concurrent(Vec<(&'static str, Logged)>);

impl Concurrent {
    /// Starts a chore of this program, given by its words; in its turn, [`Self::finish`] waits for it.
    pub(super) fn start(&mut self, chore: &'static str, root: &Path) {
        let Ok(this) = env::current_exe() else { return };
        let mut command = Command::new(this);
        command.args(chore.split(' ')).current_dir(root);
        let folder = root.join("target").join("concurrent");
        self.0.extend(Logged::start(chore, command, &folder).ok().map(|started| (chore, started)));
    }

    /// Waits for a chore, and repeats its output; `None` if it was not started, so that it has to run now.
    pub(super) fn finish(&mut self, chore: &str) -> Option<bool> {
        let place = self.0.iter().position(|(name, _)| *name == chore)?;
        Some(self.0.remove(place).1.wait())
    }
}
