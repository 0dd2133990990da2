//! Whether the unpacked archives are enough: their dependencies resolve, the command installs and serves its page, examples run, tests pass.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::archives::Unpacked;
use crate::process::{self, cargo, succeed};

/// Longest wait for an answer of the studio's server.
const TIMEOUT: Duration = Duration::from_secs(30);

/// Whether cargo resolves the dependencies of the unpacked crates.
pub(super) fn resolves(unpacked: &Unpacked) -> bool {
    let metadata = cargo_metadata::MetadataCommand::new().current_dir(&unpacked.folder).exec();
    match metadata {
        Ok(metadata) => {
            let members = metadata.workspace_packages();
            println!("package: {} crates package and resolve", members.len());
            members.len() == unpacked.packages.len()
        }
        Err(error) => {
            eprintln!("package: the unpacked crates do not resolve: {error}");
            false
        }
    }
}

/// Whether the command can be installed from the archives, answers, and serves its page, and whether the first example runs.
pub(super) fn works(unpacked: &Unpacked) -> bool {
    match installed(unpacked) {
        Ok(()) => true,
        Err(error) => {
            eprintln!("package: {error}");
            false
        }
    }
}

/// Whether the tests in the archives pass.
pub(super) fn passes(unpacked: &Unpacked) -> bool {
    let mut test = cargo();
    test.args(["test", "--workspace", "--all-features"]).env("CARGO_TARGET_DIR", target(unpacked));
    // Debugging information doubles time and size of the build.
    test.env("CARGO_PROFILE_DEV_DEBUG", "0").env("CARGO_INCREMENTAL", "0");
    let passed = succeed(test.env("PROPTEST_RNG_SEED", "1").current_dir(&unpacked.folder));
    passed.inspect_err(|error| eprintln!("package: {error}")).is_ok()
}

/// Where cargo builds the unpacked crates.
fn target(unpacked: &Unpacked) -> PathBuf {
    unpacked.folder.with_file_name("archives-build")
}

fn installed(unpacked: &Unpacked) -> io::Result<()> {
    let target = target(unpacked);
    let prefix = unpacked.folder.join("installed");
    let mut install = cargo();
    install.args(["install", "--quiet", "--features", "parquet,mcap", "--path"]);
    install.arg(unpacked.of("jointplay-cli")).arg("--root").arg(&prefix);
    succeed(install.env("CARGO_TARGET_DIR", &target).current_dir(&unpacked.folder))?;
    let command = prefix.join("bin").join(format!("jointplay{}", std::env::consts::EXE_SUFFIX));
    exercise(|| Command::new(&command))?;
    let mut example = cargo();
    example.args(["run", "--quiet", "--release", "-p", "jointplay", "--example", "01_first_pose"]);
    succeed(example.env("CARGO_TARGET_DIR", &target).current_dir(&unpacked.folder))
}

/// Runs an installed command, `command` without arguments, as its users do: a mechanism of the catalogue, the example cell, and the studio with its page.
///
/// # Errors
/// If a command fails, or the page is missing or incomplete.
pub(crate) fn exercise(command: impl Fn() -> Command) -> io::Result<()> {
    for line in ["--version", "mobility hexapod", "study tolerances --dry-run", "cell check"] {
        succeed(command().args(line.split(' ')).stdout(Stdio::null()))?;
    }
    let mut studio = command();
    studio.args(["studio", "--no-open", "--port", "0"]).stdout(Stdio::piped());
    let mut server = process::start(&mut studio)?;
    let answered = page_of(&mut server);
    process::stop(server)?;
    answered
}

/// Loads the page of a server that was just started, and every script and style that it names.
fn page_of(server: &mut std::process::Child) -> io::Result<()> {
    let output = server.stdout.take().ok_or_else(|| io::Error::other("no output"))?;
    let mut address = None;
    for line in BufReader::new(output).lines() {
        let line = line?;
        address = line.split("http://").nth(1).map(|rest| rest.trim_end_matches('/').to_owned());
        if address.is_some() {
            break;
        }
    }
    let address = address.ok_or_else(|| io::Error::other("the studio prints no address"))?;
    let address = address.split_whitespace().next().unwrap_or_default().trim_end_matches('/');
    let page = get(address, "/")?;
    let names: Vec<&str> = page.split('"').filter(|word| word.contains("assets/")).collect();
    if names.is_empty() {
        return Err(io::Error::other("the page of the studio names no script"));
    }
    for name in names {
        get(address, &format!("/{}", name.trim_start_matches(['.', '/'])))?;
    }
    Ok(())
}

/// The answer to a request, which has to be 200.
fn get(address: &str, path: &str) -> io::Result<String> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n")?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    let answer = String::from_utf8_lossy(&answer).into_owned();
    if answer.starts_with("HTTP/1.1 200") {
        Ok(answer)
    } else {
        let status = answer.lines().next().unwrap_or("no answer");
        Err(io::Error::other(format!("http://{address}{path}: {status}")))
    }
}
