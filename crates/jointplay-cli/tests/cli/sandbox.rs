//! Runs of the command in a temporary folder.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A folder to run in, removed afterwards.
pub(crate) struct Sandbox(tempfile::TempDir);

/// The result of a run.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Sandbox {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.file(name)).unwrap()
    }

    /// The JSON part of a binary glTF file.
    pub(crate) fn scene(&self, name: &str) -> Value {
        let bytes = std::fs::read(self.file(name)).unwrap();
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice(&bytes[20..20 + length]).unwrap()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.file(name), text).unwrap();
    }

    /// Names in a folder of the sandbox, in order.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.file(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jointplay"));
        // What is in quotes of one kind is one argument.
        let mut rest = line;
        while let Some(start) = rest.find(['"', '\'']) {
            let quote = &rest[start..=start];
            let (quoted, after) = rest[start + 1..].split_once(quote).expect("a closing quote");
            command.args(rest[..start].split_whitespace()).arg(quoted);
            rest = after;
        }
        command.args(rest.split_whitespace());
        command.current_dir(self.path());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Run {
        let Output { status, stdout, stderr } = self.command(line).output().unwrap();
        Run {
            code: status.code().expect("not killed"),
            stdout: String::from_utf8(stdout).unwrap(),
            stderr: String::from_utf8(stderr).unwrap(),
        }
    }

    /// Standard output of a run that succeeds.
    #[track_caller]
    pub(crate) fn done(&self, line: &str) -> String {
        let run = self.run(line);
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{line}");
        run.stdout
    }

    /// The JSON that a run answers with.
    #[track_caller]
    pub(crate) fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.done(&format!("{line} --format json"))).unwrap()
    }
}

/// Repeats an attempt to disturb a run, each time with four times the samples, until the run has not ended before: how long a number of samples takes depends on the machine.
#[track_caller]
pub(crate) fn until_disturbed(samples: u64, attempt: impl Fn(u64) -> bool) {
    let disturbed = (0..5).any(|k| attempt(samples << (2 * k)));
    assert!(disturbed, "all runs ended before they were disturbed");
}

/// Three numbers of a JSON array.
pub(crate) fn three(value: &Value) -> [f64; 3] {
    let numbers: Vec<f64> = value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    numbers.try_into().unwrap()
}

/// Settings for snapshots in which round-off is masked, since it differs from machine to machine.
pub(crate) fn without_round_off() -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r"\d\.\d+e-1[0-9]|\b0\.0{6}\b", "[round-off]");
    settings
}
