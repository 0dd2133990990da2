//! The source distribution of the Python package, and wheels for Linux, which are built from it without a network.
//!
//! zig links the wheels, so that they run on systems older than this one.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

use super::folders::{Folders, VERSION};
use super::program::file_name;
use crate::{process, python};

/// Tools that build and check wheels.
const TOOLS: [&str; 4] =
    ["maturin==1.16.0", "ziglang==0.17.1", "auditwheel==6.8.2", "abi3audit==0.0.26"];

/// Platforms of wheels for Linux, and the oldest systems on which they run; those whose standard library is not installed are left to the workflow.
const PLATFORMS: [(&str, &str, &str); 4] = [
    ("x86_64-unknown-linux-gnu", "manylinux2014", "manylinux_2_17_x86_64"),
    ("aarch64-unknown-linux-gnu", "manylinux2014", "manylinux_2_17_aarch64"),
    ("x86_64-unknown-linux-musl", "musllinux_1_2", "musllinux_1_2_x86_64"),
    ("aarch64-unknown-linux-musl", "musllinux_1_2", "musllinux_1_2_aarch64"),
];

/// Builds all that this machine can build, and checks it.
pub(super) fn build(folders: &Folders) -> io::Result<()> {
    let tools = tools(folders)?;
    let maturin = || Command::new(tools.join("maturin"));
    let mut pack = maturin();
    // `maturin sdist` reports an error of cargo in a folder without Cargo.toml, and then omits crates that only features need.
    pack.args(["pep517", "write-sdist", "--sdist-directory"]).arg(&folders.out);
    pack.current_dir(folders.root.join("python")).env("SOURCE_DATE_EPOCH", &folders.time);
    without_errors(&mut pack)?;
    let source = unpacked(folders)?;
    let built = folders.work.join("wheel-build");
    for (platform, oldest, tag) in PLATFORMS {
        if !is_installed(platform)? {
            folders.report_absent(&format!(
                "no wheel for {tag}: the standard library of {platform} is not installed"
            ))?;
            continue;
        }
        let mut build = maturin();
        build.args(["build", "--quiet", "--offline", "--profile", "dist", "--zig"]);
        build.args(["--target", platform, "--compatibility", oldest, "--out"]).arg(&folders.out);
        build.arg("--sbom-include").arg(file_name(&folders.component_list()));
        let from = Folders { root: source.clone(), ..folders.clone() };
        let others = [(libraries(folders), "/cargo"), (built.clone(), "/jointplay/target")];
        from.reproducible(&mut build, &[], &others);
        // Only the libraries in the source may be found.
        build.env("CARGO_HOME", folders.empty("cargo-home")?).env("CARGO_TARGET_DIR", &built);
        process::succeed(build.env("PATH", path(&tools)?).current_dir(&source))?;
        check(&wheel(&folders.out, tag)?, tag, &tools)?;
    }
    Ok(())
}

/// Runs a command that may succeed although a program that it started reports an error.
///
/// # Errors
/// As [`process::succeed`]; the first error that is printed.
fn without_errors(command: &mut Command) -> io::Result<()> {
    let output = command.output()?;
    let printed = String::from_utf8_lossy(&output.stderr);
    print!("{}", String::from_utf8_lossy(&output.stdout));
    eprint!("{printed}");
    let error = printed.lines().find(|line| line.starts_with("error"));
    if output.status.success() && error.is_none() {
        return Ok(());
    }
    let what = error.map_or_else(|| output.status.to_string(), str::to_owned);
    Err(io::Error::other(format!("{}: {what}", command.get_program().display())))
}

/// The wheel for a platform in a folder.
///
/// # Errors
/// If there is none.
pub(super) fn wheel(folder: &Path, tag: &str) -> io::Result<PathBuf> {
    let missing = |error| {
        let step = "run `cargo xtask release --dry-run` first";
        io::Error::other(format!("{}: {error}; {step}", folder.display()))
    };
    for entry in folder.read_dir().map_err(missing)? {
        let path = entry?.path();
        let name = file_name(&path);
        if name.ends_with(".whl") && name.contains(tag) {
            return Ok(path);
        }
    }
    Err(io::Error::other(format!("{} has no wheel for {tag}", folder.display())))
}

/// The folder with the programs of an environment that has the tools.
fn tools(folders: &Folders) -> io::Result<PathBuf> {
    let folder = folders.work.join("wheel-tools");
    let (stamp, wanted) = (folder.join("tools.txt"), TOOLS.join("\n"));
    if fs::read_to_string(&stamp).ok().as_ref() != Some(&wanted) {
        let python = python::find().ok_or_else(|| io::Error::other("there is no Python"))?;
        let _ = fs::remove_dir_all(&folder);
        process::succeed(Command::new(python).args(["-m", "venv"]).arg(&folder))?;
        let mut install = Command::new(folder.join("bin/pip"));
        process::succeed(install.args(["install", "--quiet"]).args(TOOLS))?;
        fs::write(stamp, wanted)?;
    }
    Ok(folder.join("bin"))
}

/// The paths of programs, with those of `tools` first: maturin looks for zig among the packages of Python.
fn path(tools: &Path) -> io::Result<std::ffi::OsString> {
    let others = env::var_os("PATH").unwrap_or_default();
    let all = std::iter::once(tools.to_owned()).chain(env::split_paths(&others));
    env::join_paths(all).map_err(io::Error::other)
}

/// The unpacked source distribution, with the libraries of the step `source`, and the licences and the list of those in the wheel.
fn unpacked(folders: &Folders) -> io::Result<PathBuf> {
    let name = format!("jointplay-{VERSION}");
    let folder = folders.empty("sdist")?;
    let archive = folders.out.join(format!("{name}.tar.gz"));
    process::succeed(Command::new("tar").arg("xzf").arg(archive).arg("-C").arg(&folder))?;
    let source = folder.join(&name);
    let libraries = libraries(folders);
    if !libraries.exists() {
        return Err(io::Error::other("there are no libraries; run the step source first"));
    }
    let settings = format!(
        "[source.crates-io]\nreplace-with = \"vendored\"\n\n[source.vendored]\ndirectory = {:?}\n",
        libraries.display().to_string()
    );
    fs::create_dir_all(source.join(".cargo"))?;
    fs::write(source.join(".cargo/config.toml"), settings)?;
    // Its name is one of those that `license-files` takes into the wheel.
    fs::copy(folders.notices(), source.join("LICENSE-THIRD-PARTY.txt"))?;
    let list = folders.component_list();
    fs::copy(&list, source.join(file_name(&list)))?;
    Ok(source)
}

/// The source of all libraries, an intermediate result of the step `source`.
fn libraries(folders: &Folders) -> PathBuf {
    folders.work.join(format!("jointplay-{VERSION}-vendored")).join("vendor")
}

/// Whether the compiler has the standard library of a platform.
fn is_installed(platform: &str) -> io::Result<bool> {
    let mut rustc = Command::new("rustc");
    let folder = process::output(rustc.args(["--print", "target-libdir", "--target", platform]))?;
    Ok(Path::new(folder.trim()).exists())
}

/// Refuses a wheel that needs a newer system than its name states, or more of Python than its stable interface.
fn check(wheel: &Path, tag: &str, tools: &Path) -> io::Result<()> {
    let mut audit = Command::new(tools.join("auditwheel"));
    let found = process::output(audit.arg("show").arg(wheel))?;
    let found = found.split_whitespace().collect::<Vec<_>>().join(" ");
    let wanted = format!("platform tag: \"{tag}\"");
    if !found.contains(&wanted) {
        return Err(io::Error::other(format!("{}: no {wanted}: {found}", wheel.display())));
    }
    let mut audit = Command::new(tools.join("abi3audit"));
    process::succeed(audit.arg("--strict").arg(wheel).stdout(Stdio::null()))?;
    println!("release: {}: {tag}, stable interface of Python", file_name(wheel));
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_command_that_prints_an_error_fails_although_it_succeeds() {
        let run = |script: &str| {
            let done = without_errors(Command::new("sh").args(["-c", script]));
            done.map_err(|error| error.to_string())
        };
        assert_eq!(run("echo packed; echo Found bindings >&2"), Ok(()));
        let error = "error: manifest path `Cargo.toml` does not exist";
        let found = run(&format!("echo Found bindings >&2; echo '{error}' >&2"));
        assert_eq!(found, Err(format!("sh: {error}")));
        assert!(run("exit 3").unwrap_err().starts_with("sh: exit"));
    }
}
