//! Other programs that chores run, and where cargo builds.

use std::path::{Path, PathBuf};
use std::process::{Child, Command};
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

/// The output of a command, as text; what it reports on its progress is shown only if it fails.
///
/// # Errors
/// As [`succeed`].
pub(crate) fn output_without_progress(command: &mut Command) -> io::Result<String> {
    let output = command.output()?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let progress = String::from_utf8_lossy(&output.stderr);
    Err(io::Error::other(format!("{}: {}\n{progress}", line(command), output.status)))
}

/// Starts a command; [`stop`] ends it.
pub(crate) fn start(command: &mut Command) -> io::Result<Child> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    command.spawn()
}

/// Ends a command of [`start`], with the processes that it has started where the system has groups of them.
pub(crate) fn stop(mut child: Child) -> io::Result<()> {
    #[cfg(unix)]
    succeed(Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]))?;
    #[cfg(not(unix))]
    child.kill()?;
    child.wait().map(drop)
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
        let explained =
            output_without_progress(cargo().arg("no-such-chore")).unwrap_err().to_string();
        assert!(explained.starts_with(&refused), "{explained}");
        assert!(explained.contains("no such command"), "{explained}");
        let absent = succeed(&mut Command::new("no-such-program")).unwrap_err().to_string();
        assert!(absent.starts_with("no-such-program: "), "{absent}");
    }

    #[cfg(unix)]
    #[test]
    fn a_stopped_command_leaves_no_process() {
        let mut shell = Command::new("sh");
        shell.args(["-c", "sleep 600 & echo $!; wait"]).stdout(std::process::Stdio::piped());
        let mut shell = start(&mut shell).unwrap();
        let mut process = String::new();
        let output = shell.stdout.take().unwrap();
        io::BufRead::read_line(&mut io::BufReader::new(output), &mut process).unwrap();
        stop(shell).unwrap();
        let state = format!("/proc/{}/stat", process.trim());
        let runs = || std::fs::read_to_string(&state).is_ok_and(|state| !state.contains(") Z "));
        for _ in 0..500 {
            if !runs() {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        panic!("the process of a stopped command runs");
    }
}
