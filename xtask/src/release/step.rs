//! A step of a release.

use std::io;

use super::folders::Folders;

/// A step of a release.
pub(super) struct Step {
    pub(super) name: &'static str,
    /// Names of the steps whose results it uses.
    pub(super) needs: &'static [&'static str],
    pub(super) run: fn(&Folders) -> io::Result<()>,
}

impl Step {
    /// Runs the step; its files are in the folder of its results.
    ///
    /// # Errors
    /// As the step, with its name, or if a step that it needs has no results of this commit.
    pub(super) fn write(&self, folders: &Folders) -> io::Result<()> {
        println!("\n=== {}", self.name);
        self.needs
            .iter()
            .try_for_each(|need| folders.require(need))
            .and_then(|()| folders.run(self.name, self.run))
            .map_err(|error| io::Error::other(format!("{}: {error}", self.name)))
    }
}

/// Tries all, also after a failure, and prints each error when it occurs.
///
/// # Errors
/// With all errors.
pub(super) fn all(actions: impl IntoIterator<Item = io::Result<()>>) -> io::Result<()> {
    let mut errors = Vec::new();
    for error in actions.into_iter().filter_map(Result::err) {
        println!("release: {error}");
        errors.push(error.to_string());
    }
    if errors.is_empty() {
        return Ok(());
    }
    Err(io::Error::other(format!("not complete:\n  {}", errors.join("\n  "))))
}

#[cfg(test)]
mod tests {
    use super::super::folders::tests::folders;
    use super::*;

    #[test]
    fn a_step_without_the_results_that_it_needs_fails_and_the_others_run() {
        let folders = folders("steps");
        let write = |folders: &Folders| std::fs::write(folders.out.join("file"), "1");
        let steps = [
            Step { name: "broken", needs: &[], run: |_| Err(io::Error::other("no tool")) },
            Step { name: "dependent", needs: &["broken"], run: write },
            Step { name: "other", needs: &[], run: write },
            Step { name: "last", needs: &["other"], run: write },
        ];
        let error = all(steps.iter().map(|step| step.write(&folders))).unwrap_err().to_string();
        let finished = steps.each_ref().map(|step| folders.is_finished(step.name));
        // Results of another commit are not used.
        let later = Folders { commit: "b".to_owned(), ..folders.clone() };
        let stale = steps[3].write(&later).unwrap_err().to_string();
        std::fs::remove_dir_all(&folders.root).unwrap();
        assert_eq!(finished, [false, false, true, true]);
        assert!(error.contains("broken: no tool\n"), "{error}");
        assert!(
            error.contains("dependent: the step broken has no results of this commit"),
            "{error}"
        );
        assert!(stale.contains("the step other has no results of this commit"), "{stale}");
    }
}
