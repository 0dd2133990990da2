//! Other programs that chores run, and where cargo builds.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, io};

/// Cargo, as it runs this program.
pub(crate) fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// The folder in which cargo builds the workspace at `root`.
pub(crate) fn target(root: &Path) -> PathBuf {
    root.join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// Runs a command.
///
/// # Errors
/// With the command line, if it cannot be started or fails.
pub(crate) fn succeed(command: &mut Command) -> io::Result<()> {
    let what = match command.status() {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => status.to_string(),
        Err(error) => error.to_string(),
    };
    Err(io::Error::other(format!("{}: {what}", line(command))))
}

/// The output of a command, as text.
///
/// # Errors
/// As [`succeed`].
pub(crate) fn output(command: &mut Command) -> io::Result<String> {
    let output = command.stderr(std::process::Stdio::inherit()).output()?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    Err(io::Error::other(format!("{}: {}", line(command), output.status)))
}

fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_name_the_command() {
        assert!(succeed(cargo().arg("--version")).is_ok());
        let refused = output(cargo().arg("no-such-chore")).unwrap_err().to_string();
        assert!(refused.contains("no-such-chore: exit"), "{refused}");
        let absent = succeed(&mut Command::new("no-such-program")).unwrap_err().to_string();
        assert!(absent.starts_with("no-such-program: "), "{absent}");
    }
}
