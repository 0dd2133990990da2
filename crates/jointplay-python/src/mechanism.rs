//! Any mechanism: its file, its loops, its motions.

use std::path::PathBuf;

use jointplay::format::catalogue;
use jointplay::format::coordinates::{self, Coordinates};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::explain_recognition;
use jointplay::format::mechanism::{
    self, LengthUnit, MAX_BYTES, MechanismFile, ParameterError, Units,
};
use jointplay::format::three_rods;
use jointplay::interop::import::{self, ClosedError, LoopsError};
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{ChangedDimension, Coupling, JointCoordinate, Kinematics, VirtualJoint};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::gpr::PyGpr;
use crate::model::Model;
use crate::numbers::finite;
use crate::skin::{self, fields};
use crate::{errors, files};

/// Values for coordinates by name, `{"crank": 0.5}`.
pub(crate) type Commands = Vec<(usize, f64)>;

/// Text, parameters, text of the joints that close loops, and unit of lengths, for pickling.
type Parts<'a> = (&'a str, &'a [(String, f64)], Option<&'a str>, Option<&'static str>);

/// A mechanism of rigid links and joints, with any number of loops.
///
/// Lengths are in metres and angles in radians, whatever the units of its file; only `parameters` are in those.
/// Made by `from_file`, `from_toml` or `from_catalogue`; a mechanism never changes.
#[pyclass(name = "Mechanism", module = "jointplay", frozen, eq, hash)]
pub(crate) struct PyMechanism {
    pub(crate) file: MechanismFile,
    pub(crate) coordinates: Coordinates,
    text: String,
    parameters: Vec<(String, f64)>,
    /// Text of the file of joints that close the loops of a model.
    closing: Option<String>,
    /// Unit of lengths of an assembly of FreeCAD.
    units: Option<LengthUnit>,
    ignored: Vec<String>,
}

impl PartialEq for PyMechanism {
    fn eq(&self, other: &Self) -> bool {
        self.file.mechanism == other.file.mechanism
    }
}

impl std::hash::Hash for PyMechanism {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.file.mechanism.name().hash(state);
        self.file.mechanism.links().hash(state);
    }
}

#[pymethods]
impl PyMechanism {
    /// The mechanism of a file: TOML, or a model of MuJoCo (MJCF), Gazebo (SDF), ROS (URDF) or FreeCAD (FCStd, ASMT).
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     The file.
    /// parameters : dict of str to float, optional
    ///     Other values for parameters of the file, in its units.
    /// loops : path-like, optional
    ///     For a model, a file with joints that close loops, which URDF cannot write: TOML, `loop_closures.yaml` or `robot.yaml`.
    /// units : {"m", "mm", "um", "in"}, optional
    ///     Unit of lengths of an ASMT assembly of FreeCAD, which does not state it; FreeCAD writes mm.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With line and column, for a file that is no mechanism.
    /// OSError
    ///     For a file that cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, parameters=None, loops=None, units=None))]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        parameters: Option<Bound<'_, PyDict>>,
        loops: Option<PathBuf>,
        units: Option<&str>,
    ) -> PyResult<Self> {
        let text = files::read_text(py, &path, MAX_BYTES as u64)?;
        let label = path.display().to_string();
        let units = units.map(|name| unit(py, name)).transpose()?;
        if units.is_some() && !import::is_assembly(&text) {
            let message = "units are for assemblies of FreeCAD; other files state theirs";
            return Err(errors::input(py, message));
        }
        if import::is_model(&text) {
            if parameters.is_some_and(|given| !given.is_empty()) {
                return Err(errors::input(py, "a model has no parameters"));
            }
            let closing = loops.map(|path| {
                let text = files::read_text(py, &path, MAX_BYTES as u64)?;
                Ok::<_, PyErr>((path.display().to_string(), text))
            });
            let expanded = files::expand_includes(py, &text, &path, MAX_BYTES as u64)?;
            let failed = |error| files::included(py, &path, expanded.locate(error));
            let text = expanded.text.clone();
            return Self::model(py, text, &failed, closing.transpose()?, units);
        }
        if loops.is_some() {
            let message = "loops are for models; a mechanism file writes its own";
            return Err(errors::input(py, message));
        }
        Self::parse(py, text, &label, replaced(parameters)?)
    }

    /// The mechanism of the text of a TOML file; see `from_file`.
    #[staticmethod]
    #[pyo3(signature = (text, *, parameters=None))]
    fn from_toml(
        py: Python<'_>,
        text: String,
        parameters: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::parse(py, text, "text", replaced(parameters)?)
    }

    /// A three-rod robot as a mechanism; the coordinate of a rod is its length less the working height.
    ///
    /// Parameters
    /// ----------
    /// gpr : Gpr
    ///     The robot.
    /// virtualization : {"radial", "polar", "planar"}, optional
    ///     Virtual joints at the sockets; default planar.
    #[staticmethod]
    #[pyo3(signature = (gpr, virtualization=None))]
    fn from_gpr(
        py: Python<'_>,
        gpr: &Bound<'_, PyGpr>,
        virtualization: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let model = Model::of(virtualization, &gpr.get().gpr)?;
        let built_in = model.virtualization().as_built_in();
        let robot = gpr.get().robot();
        let Some(file) = built_in.and_then(|model| three_rods::mechanism_file(&robot, model))
        else {
            let message = "virtualization: a mechanism can have radial, polar or planar";
            return Err(errors::input(py, message));
        };
        let text = mechanism::write(&file.mechanism, None);
        Self::parse(py, text, "robot", Vec::new())
    }

    /// The three-rod robot that this mechanism is, whose closed forms are faster.
    ///
    /// Parameters
    /// ----------
    /// tilt_limit_rad : float
    ///     Largest tilt toward any azimuth, which a mechanism does not state.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     With the reason, for a mechanism that is no such robot.
    fn to_gpr(&self, py: Python<'_>, tilt_limit_rad: &Bound<'_, PyAny>) -> PyResult<PyGpr> {
        let limit = finite(tilt_limit_rad, "tilt_limit_rad")?;
        three_rods::robot(&self.file, limit).map(PyGpr::of).map_err(|error| {
            errors::input(py, &explain_recognition(self.name(), &error, DisplayUnits::Metric))
        })
    }

    /// A mechanism of the catalogue, by its name; `jointplay.catalogue()` lists all.
    #[staticmethod]
    #[pyo3(signature = (name, *, parameters=None))]
    fn from_catalogue(
        py: Python<'_>,
        name: &str,
        parameters: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let Some(entry) = catalogue::find(name).filter(is_mechanism) else {
            return Err(errors::unknown_name(py, "mechanism", name, &names_of_catalogue()));
        };
        Self::parse(py, entry.text.to_owned(), name, replaced(parameters)?)
    }

    /// Name of the mechanism.
    #[getter]
    fn name(&self) -> &str {
        self.file.mechanism.name()
    }

    /// Names of its links, the base first.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.file.mechanism.links())
    }

    /// Names of its joints.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.file.mechanism.joints().iter().map(|joint| &joint.name))
    }

    /// Its couplings: linear relations between joint coordinates.
    #[getter]
    fn couplings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let mechanism = &self.file.mechanism;
        let kinematics = Kinematics::new(mechanism);
        let name = |one: JointCoordinate| {
            let index = kinematics.coordinates_of(one.joint).start + one.freedom;
            self.coordinates.all()[index].name.as_str()
        };
        let coupling = |coupling: &Coupling| {
            let terms = coupling.terms.iter().map(|&(one, ratio)| (name(one), ratio));
            let fields = fields!(py;
                name = coupling.name.as_str(),
                coordinate = name(coupling.follower),
                terms = PyTuple::new(py, terms.collect::<Vec<_>>())?,
                offset = coupling.offset,
            );
            skin::result(py, "Coupling", &fields)
        };
        let all = mechanism.couplings().iter().map(coupling).collect::<PyResult<Vec<_>>>()?;
        PyTuple::new(py, all)
    }

    /// Names of the joint coordinates: that of the joint, with `[k]` where it has several freedoms.
    #[getter]
    pub(crate) fn coordinate_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.names(0..self.coordinates.joints()))
    }

    /// Unit of each joint coordinate, `'m'` or `'rad'`.
    #[getter]
    fn coordinate_units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.units(0..self.coordinates.joints()))
    }

    /// Names of the virtual joints.
    #[getter]
    pub(crate) fn virtual_joint_names<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.names(self.coordinates.joints()..self.coordinates.all().len()))
    }

    /// Unit of each virtual joint, `'m'` or `'rad'`.
    #[getter]
    pub(crate) fn virtual_joint_units<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.units(self.coordinates.joints()..self.coordinates.all().len()))
    }

    /// Names of the coordinates of its motors.
    #[getter]
    fn actuated<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let all = self.coordinates.all();
        PyTuple::new(
            py,
            self.file.mechanism.actuated_coordinates().into_iter().map(|k| &all[k].name),
        )
    }

    /// Parameters of its file by name, in the units of the file.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let listed = PyDict::new(py);
        for (name, value) in &self.file.parameters {
            listed.set_item(name, value)?;
        }
        Ok(listed)
    }

    /// Elements of an imported model that were ignored.
    #[getter]
    fn ignored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.ignored)
    }

    /// Freedoms of all joints together.
    #[getter]
    fn joint_freedoms(&self) -> usize {
        self.file.mechanism.joint_freedoms()
    }

    /// Number of independent loops.
    #[getter]
    fn loops(&self) -> usize {
        self.file.mechanism.loops()
    }

    fn __repr__(&self) -> String {
        format!(
            "Mechanism(name={:?}, links={}, joints={}, loops={})",
            self.name(),
            self.file.mechanism.links().len(),
            self.file.mechanism.joints().len(),
            self.loops()
        )
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts<'_>)> {
        let again = py.get_type::<Self>().getattr("_again")?;
        Ok((
            again,
            (
                &self.text,
                &self.parameters,
                self.closing.as_deref(),
                self.units.map(LengthUnit::name),
            ),
        ))
    }

    /// The mechanism of `__reduce__`.
    #[staticmethod]
    fn _again(
        py: Python<'_>,
        text: String,
        parameters: Vec<(String, f64)>,
        closing: Option<String>,
        units: Option<&str>,
    ) -> PyResult<Self> {
        if import::is_model(&text) {
            let closing = closing.map(|text| ("pickle".to_owned(), text));
            let units = units.map(|name| unit(py, name)).transpose()?;
            let failed = |error| errors::file(py, "pickle", &[error]);
            Self::model(py, text, &failed, closing, units)
        } else {
            Self::parse(py, text, "pickle", parameters)
        }
    }
}

impl PyMechanism {
    fn parse(
        py: Python<'_>,
        text: String,
        label: &str,
        parameters: Vec<(String, f64)>,
    ) -> PyResult<Self> {
        let file = mechanism::parse_with(&text, &parameters)
            .map_err(|found| errors::file(py, label, &found))?;
        let coordinates = Coordinates::of(&file);
        let (closing, units, ignored) = (None, None, Vec::new());
        Ok(Self { file, coordinates, text, parameters, closing, units, ignored })
    }

    /// The text of the file, and the parameters that replace those in it.
    pub(crate) fn source(&self) -> (&str, &[(String, f64)]) {
        (&self.text, &self.parameters)
    }

    /// A model, with the name and the text of a file of joints that close its loops.
    fn model(
        py: Python<'_>,
        text: String,
        failed: &dyn Fn(import::Error) -> PyErr,
        closing: Option<(String, String)>,
        units: Option<LengthUnit>,
    ) -> PyResult<Self> {
        let model = match (&closing, units) {
            (Some((loops, closing)), units) => import::parse_closed(&text, units, closing)
                .map_err(|error| match error {
                    ClosedError::Model(error) => failed(error),
                    ClosedError::Loops(LoopsError::Toml(found)) => errors::file(py, loops, &found),
                    ClosedError::Loops(LoopsError::Yaml(error)) => {
                        errors::file(py, loops, &[error])
                    }
                    other => errors::input(py, &other.to_string()),
                })?,
            (None, Some(unit)) => import::parse_with_unit(&text, unit).map_err(failed)?,
            (None, None) => import::parse(&text).map_err(failed)?,
        };
        let ignored = model.ignored.clone();
        let file = model.into_file();
        let coordinates = Coordinates::of(&file);
        let (closing, parameters) = (closing.map(|(_, text)| text), Vec::new());
        Ok(Self { file, coordinates, text, parameters, closing, units, ignored })
    }

    /// This mechanism with other virtual joints.
    pub(crate) fn with_play(&self, py: Python<'_>, joints: &[VirtualJoint]) -> PyResult<Self> {
        let MechanismFile { mechanism, source, units, .. } = &self.file;
        let (text, units) = match import::is_model(&self.text) {
            true => (mechanism::write(mechanism, source.as_deref()), Units::SI),
            false => (self.text.clone(), *units),
        };
        let text = mechanism::with_virtual_joints(&text, mechanism, units, joints, &[])
            .map_err(|error| errors::file(py, self.name(), &[error]))?;
        let made = Self::parse(py, text, self.name(), self.parameters.clone())?;
        Ok(Self { ignored: self.ignored.clone(), ..made })
    }

    /// The mechanism with other values of a parameter, given by its name and its value.
    pub(crate) fn changed_dimension(
        &self,
        parameter: (&str, f64),
    ) -> Result<ChangedDimension, ParameterError> {
        mechanism::changed_dimension(&self.file, &self.text, &self.parameters, parameter)
    }

    pub(crate) fn names(&self, range: std::ops::Range<usize>) -> Vec<&str> {
        self.coordinates.all()[range].iter().map(|one| one.name.as_str()).collect()
    }

    pub(crate) fn units(&self, range: std::ops::Range<usize>) -> Vec<&'static str> {
        let unit = |quantity| match quantity {
            Coordinate::Slide => "m",
            Coordinate::Turn => "rad",
        };
        self.coordinates.all()[range].iter().map(|one| unit(one.quantity)).collect()
    }

    pub(crate) fn find(&self, py: Python<'_>, name: &str) -> PyResult<usize> {
        self.coordinates.find(&self.file.mechanism, name).map_err(|error| match error {
            coordinates::Error::Unknown { ref known, .. } => {
                errors::unknown_name(py, "joint", name, known)
            }
            other => errors::input(py, &other.to_string()),
        })
    }

    pub(crate) fn commands(
        &self,
        py: Python<'_>,
        at: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Commands> {
        let mut commands = Vec::new();
        for (name, value) in at.iter().copied().flatten() {
            let name = name.extract::<String>()?;
            commands.push((self.find(py, &name)?, finite(&value, &name)?));
        }
        Ok(commands)
    }

    pub(crate) fn kutzbach(&self) -> i64 {
        self.file.mechanism.kutzbach_mobility()
    }
}

/// Values for parameters, as given.
fn replaced(parameters: Option<Bound<'_, PyDict>>) -> PyResult<Vec<(String, f64)>> {
    let items = parameters.iter().flatten();
    let one = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name: String = name.extract()?;
        let value = finite(&value, &name)?;
        Ok((name, value))
    };
    items.map(one).collect()
}

fn is_mechanism(entry: &&'static catalogue::Entry) -> bool {
    entry.kind().as_deref() == Some("mechanism")
}

fn names_of_catalogue() -> Vec<String> {
    let mechanisms = catalogue::entries().iter().filter(is_mechanism);
    mechanisms.map(|entry| entry.name.to_owned()).collect()
}

/// The included mechanisms: titles by name.
#[pyfunction]
#[pyo3(name = "catalogue")]
pub(crate) fn catalogue_of_names(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let listed = PyDict::new(py);
    for entry in catalogue::entries().iter().filter(is_mechanism) {
        listed.set_item(entry.name, entry.title())?;
    }
    Ok(listed)
}

/// A unit of length by its name.
fn unit(py: Python<'_>, name: &str) -> PyResult<LengthUnit> {
    let known = LengthUnit::ALL;
    let found = known.into_iter().find(|(known, _)| *known == name);
    found.map(|(_, unit)| unit).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        errors::input(py, &format!("units must be one of {}, got {name:?}", names.join(", ")))
    })
}
