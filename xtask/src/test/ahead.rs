//! Downloads of the steps, made while earlier steps compile.
//!
//! A step that runs alone fetches it itself, and finds it there where it was fetched ahead.

use std::path::Path;
use std::process::Command;

use super::logged::Logged;
use crate::{page, python};

/// Script of each chore that downloads its dependencies where they are missing.
const FETCHES: [(&str, &str); 5] = [
    ("cell", "validation/exported.py"),
    ("c", "crates/jointplay-c/test.py"),
    ("studio", "studio/test_api.py"),
    ("page", "studio/test.mjs"),
    ("python", "python/test.py"),
];

/// All that is being fetched, by the chore that needs it.
#[derive(Default)]
pub(super) struct Ahead(Vec<(&'static str, Logged)>);

impl Ahead {
    /// Starts to fetch; the chore itself reports what cannot be started.
    pub(super) fn start(&mut self, root: &Path) {
        let started = FETCHES.into_iter().filter_map(|(chore, script)| {
            let interpreter = if chore == "page" { page::find()? } else { python::find()? };
            let mut command = Command::new(interpreter);
            command.args([script, "--prepare"]).current_dir(root);
            let folder = root.join("target").join("ahead");
            Some((chore, Logged::start(chore, command, &folder).ok()?))
        });
        self.0.extend(started);
    }

    /// Waits for what a chore needs, and repeats its output; false where it could not be fetched.
    pub(super) fn wait(&mut self, chore: &str) -> bool {
        let place = self.0.iter().position(|(name, _)| *name == chore);
        place.is_none_or(|place| self.0.remove(place).1.wait())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Whether a fetch by cargo is done, and its output.
    fn fetched(word: &str) -> (bool, String) {
        let folder = std::env::temp_dir().join(format!("xtask-ahead-{}", std::process::id()));
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.arg(word);
        let fetch = Logged::start("cell", command, &folder).unwrap();
        let log = fetch.log.clone();
        let mut ahead = Ahead(vec![("cell", fetch)]);
        assert!(ahead.wait("page"), "nothing to wait for");
        let done = ahead.wait("cell");
        let output = fs::read_to_string(log).unwrap();
        assert!(ahead.0.is_empty());
        fs::remove_dir_all(&folder).unwrap();
        (done, output)
    }

    #[test]
    fn a_failure_ahead_fails_the_step_and_is_reported() {
        let (done, output) = fetched("--version");
        assert!(done && output.starts_with("cargo "), "{output}");
        let (done, output) = fetched("no-such-chore");
        assert!(!done && output.contains("no-such-chore"), "{output}");
    }
}
