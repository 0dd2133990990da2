//! Wheels of the Python package, which include the command, and its source distribution.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

use super::place::{Place, VERSION};
use crate::{process, python};

/// Tools that build the wheel: zig links against the C library of old systems.
const TOOLS: [&str; 2] = ["maturin==1.16.0", "ziglang==0.17.0"];

/// The first program of the README.
const FIRST: &str = "\
import jointplay as jp
gpr = jp.Gpr.paper()
rods = gpr.inverse(azimuth_rad=0.3, tilt_rad=[0.01, 0.02])
poses = gpr.forward(rods.rods_m, 'planar')
assert abs(poses.tilt_rad - [0.01, 0.02]).max() < 1e-12
";

/// Builds the source distribution and the wheel for Linux, and tries the wheel out in a new environment.
pub(super) fn build(place: &Place) -> io::Result<()> {
    let python = python::find().ok_or_else(|| io::Error::other("no Python"))?;
    let tools = environment(place, python, "python-tools")?;
    pip(&tools, TOOLS.map(Path::new).as_slice())?;
    let wheels = place.empty("wheels")?;
    let source = place.root.join("python");
    // Shipped with the wheel; not part of the repository.
    let notices = source.join("LICENSE-THIRD-PARTY.txt");
    fs::copy(place.notices(), &notices)?;
    let built = wheel(place, &tools, &source, &wheels);
    fs::remove_file(notices)?;
    built?;
    let files: Vec<PathBuf> =
        wheels.read_dir()?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    let wheel = files.iter().find(|file| file.extension().is_some_and(|end| end == "whl"));
    let wheel = wheel.ok_or_else(|| io::Error::other("maturin made no wheel"))?;
    try_out(place, python, wheel)?;
    files.iter().try_for_each(|file| place.keep(file))
}

fn wheel(place: &Place, tools: &Path, source: &Path, wheels: &Path) -> io::Result<()> {
    let mut maturin = Command::new(tools.join("bin/maturin"));
    maturin.args(["build", "--quiet", "--locked", "--sdist", "--profile", "dist", "--zig"]);
    maturin.args(["--compatibility", "manylinux2014", "--out"]).arg(wheels).current_dir(source);
    // Where maturin finds zig.
    let path = std::env::var("PATH").unwrap_or_default();
    maturin.env("PATH", format!("{}:{path}", tools.join("bin").display()));
    process::succeed(place.reproducible(&mut maturin, ""))
}

/// Installs the wheel into a new environment and runs what its users run first.
fn try_out(place: &Place, python: &str, wheel: &Path) -> io::Result<()> {
    let clean = environment(place, python, "python-clean")?;
    pip(&clean, &[wheel])?;
    let command = clean.join("bin/jointplay");
    let version = process::output(Command::new(&command).arg("--version"))?;
    if version.trim() != format!("jointplay {VERSION}") {
        return Err(io::Error::other(format!("the command of the wheel is {version}")));
    }
    crate::package::exercise(&command)?;
    process::succeed(Command::new(clean.join("bin/python")).args(["-c", FIRST]))
}

/// A new environment of Python.
fn environment(place: &Place, python: &str, name: &str) -> io::Result<PathBuf> {
    let folder = place.empty(name)?;
    process::succeed(Command::new(python).args(["-m", "venv"]).arg(&folder))?;
    Ok(folder)
}

fn pip(environment: &Path, packages: &[&Path]) -> io::Result<()> {
    let mut pip = Command::new(environment.join("bin/python"));
    pip.args(["-m", "pip", "install", "--quiet"]).args(packages);
    process::succeed(pip.stdin(Stdio::null()))
}
