//! Functional mock-up units of mechanisms and robots.

use std::path::{Path, PathBuf};

use jointplay::format::mechanism;
use jointplay::format::robot::{self, Robot};
use jointplay::interop::fmu::{
    ArchiveError, Binary, Error, FmiVersion, Resources, archive, library_places,
};
use jointplay::interop::import;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors;
use crate::gpr::PyGpr;
use crate::mechanism::PyMechanism;
use crate::model::Model;
use crate::numbers::three;

/// Larger libraries are refused, in bytes.
const LARGEST_LIBRARY: u64 = 1 << 30;

#[pymethods]
impl PyMechanism {
    /// The mechanism as a functional mock-up unit for co-simulation: drives in; poses and virtual joints out.
    ///
    /// The file is that of `jointplay export MECHANISM --to fmu`.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Commanded coordinates of the initial configuration (m, rad).
    /// fmi : {2, 3}, optional
    ///     Version of FMI.
    /// name : str, optional
    ///     Name of the model; that of the mechanism by default.
    /// library : path-like or sequence of path-like, optional
    ///     Libraries for C, one for each platform; by default the one that belongs to the command `jointplay` on the path.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The contents of the file, such as `robot.fmu`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     For a mechanism without drives, or files that are no libraries for units.
    /// NoAnswerError
    ///     Where the drives do not determine all motions, or the initial configuration is beyond limits.
    #[pyo3(signature = (at=None, *, fmi=2, name=None, library=None))]
    fn to_fmu<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        fmi: u8,
        name: Option<&str>,
        library: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let named = self.commands(py, at)?.into_iter();
        let start = named.map(|(k, value)| (self.coordinates.all()[k].name.clone(), value));
        let start = start.collect();
        let (text, parameters) = self.source();
        let resources = if import::is_model(text) {
            Resources {
                start,
                ..Resources::for_model(mechanism::write(&self.file.mechanism, None))
            }
        } else {
            Resources { parameters: parameters.to_vec(), start, ..Resources::for_model(text) }
        };
        unit(py, &resources, name.unwrap_or(self.file.mechanism.name()), fmi, library)
    }
}

#[pymethods]
impl PyGpr {
    /// The robot as a functional mock-up unit for co-simulation: lengths of rods in; pose and virtual joints out.
    ///
    /// Parameters
    /// ----------
    /// rods_m : array of shape (3,), optional
    ///     Initial lengths of the rods (m); by default the working height.
    /// virtualization : {"radial", "polar", "offset", "planar"}, optional
    ///     Virtual joints; default planar.
    /// fmi : {2, 3}, optional
    ///     Version of FMI.
    /// name : str, optional
    ///     Name of the model; that of the robot by default.
    /// library : path-like or sequence of path-like, optional
    ///     See `Mechanism.to_fmu`.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The contents of the file, such as `robot.fmu`.
    #[pyo3(signature = (rods_m=None, *, virtualization=None, fmi=2, name=None, library=None))]
    fn to_fmu<'py>(
        &self,
        py: Python<'py>,
        rods_m: Option<&Bound<'py, PyAny>>,
        virtualization: Option<&Bound<'py, PyAny>>,
        fmi: u8,
        name: Option<&str>,
        library: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        if !self.gpr.checks_limits() {
            let message = "a unit checks limits; use the robot with its limits";
            return Err(errors::input(py, message));
        }
        let model = Model::of(virtualization, &self.gpr)?;
        if matches!(model, Model::Own(_)) {
            let message = "a unit has one of the library's virtualizations, not one of Python";
            return Err(errors::input(py, message));
        }
        let rods = rods_m.map(|rods| {
            let expected = || errors::input(py, "rods_m has to be three rod lengths in metres");
            three(rods).ok_or_else(expected)
        });
        let rods = rods.transpose()?;
        let named = |(k, length): (usize, f64)| (format!("rod {}", k + 1), length);
        let robot = Robot {
            name: self.name.clone(),
            gpr: self.gpr.clone(),
            base_mesh: None,
            platform_mesh: None,
        };
        let resources = Resources {
            start: rods.into_iter().flatten().enumerate().map(named).collect(),
            virtualization: Some(model.virtualization().name().to_owned()),
            ..Resources::for_model(robot::write(&robot))
        };
        unit(py, &resources, name.unwrap_or(&self.name), fmi, library)
    }
}

fn unit<'py>(
    py: Python<'py>,
    resources: &Resources,
    name: &str,
    fmi: u8,
    library: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let version = match fmi {
        2 => FmiVersion::V2,
        3 => FmiVersion::V3,
        other => {
            return Err(errors::input(py, &format!("fmi is the version 2 or 3, not {other}")));
        }
    };
    let paths = match library {
        None => vec![own_library(py)?],
        Some(given) => match given.extract::<PathBuf>() {
            Ok(path) => vec![path],
            Err(_) => given.extract::<Vec<PathBuf>>()?,
        },
    };
    let binaries: Vec<Binary> =
        paths.iter().map(|path| binary(py, path)).collect::<PyResult<_>>()?;
    let bytes = py.detach(|| archive(resources, name, &binaries, version));
    let bytes = bytes.map_err(|error| match error {
        ArchiveError::Model(Error::Core(error)) => errors::core(py, &error),
        ArchiveError::Model(error) if error.is_infeasible() => {
            errors::new(py, "NoAnswerError", &error.to_string(), Ok(PyDict::new(py)))
        }
        other => errors::input(py, &other.to_string()),
    })?;
    Ok(PyBytes::new(py, &bytes))
}

fn binary(py: Python<'_>, path: &Path) -> PyResult<Binary> {
    let bytes = crate::files::read_bytes(py, path, LARGEST_LIBRARY)?;
    Binary::new(bytes).map_err(|error| errors::input(py, &format!("{}: {error}", path.display())))
}

/// The library of the command `jointplay` on the path.
fn own_library(py: Python<'_>) -> PyResult<PathBuf> {
    let which = py.import("shutil")?.call_method1("which", ("jointplay",))?;
    let command: Option<PathBuf> = which.extract()?;
    let places = command.as_deref().and_then(Path::parent).map(library_places);
    let found = places.iter().flatten().find(|place| place.is_file()).cloned();
    found.ok_or_else(|| {
        let message = "a unit needs jointplay's library for C, which is not next to a command `jointplay` on the path: build it from a copy of the repository by `cargo xtask c-library --prefix FOLDER`, and use library=\"FOLDER/lib/…\"";
        errors::input(py, message)
    })
}
