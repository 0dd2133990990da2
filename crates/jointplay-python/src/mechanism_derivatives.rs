//! Velocities, accelerations and Jacobians of any mechanism.

use jointplay::Error;
use jointplay::constraint::System as _;
use jointplay::mechanism::{
    ChangedDimension, Closure, DifferentialKinematics, FrameTwist, MechanismSystem, Relief,
    dexterity,
};
use jointplay::nalgebra::{DMatrix, DVector};
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::mechanism::{Commands, PyMechanism};
use crate::skin::{self, fields};
use crate::{errors, mechanism_results as results};

/// A configuration whose derivatives are asked for.
struct Place {
    commanded: Vec<usize>,
    posed: Closure,
    /// Characteristic length of the metric of the virtual joints (m).
    length: f64,
}

#[pymethods]
impl PyMechanism {
    /// Geometric Jacobian of a link or an attached frame, with loops closed and virtual joints at their least displacement.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     The link or the attached frame.
    /// at : dict of str to float, optional
    ///     Joint coordinates of the configuration (m, rad).
    /// commanded : sequence of str, optional
    ///     Coordinates of the columns; by default those of the actuated joints.
    /// velocities : dict of str to float, optional
    ///     Velocities of commanded coordinates, for the rate of change of the Jacobian (m/s, rad/s).
    ///
    /// Raises
    /// ------
    /// UndeterminedError
    ///     Where commanded coordinates do not determine the motion; with singular values.
    /// DependentCommandsError
    ///     Where the loops do not allow them to move independently.
    #[pyo3(signature = (name, at=None, *, commanded=None, velocities=None))]
    fn jacobian<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        name: &str,
        at: Option<&Bound<'py, PyDict>>,
        commanded: Option<Vec<String>>,
        velocities: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let frame = this.frame(py, name)?;
        let commanded = this.commanded_coordinates(py, commanded)?;
        let rates = velocities.map(|given| this.rates(py, Some(given), &commanded)).transpose()?;
        let at = this.commands(py, at)?;
        let found = py.detach(|| {
            let place = this.place(&at, commanded)?;
            let system = this.system_at(&place)?;
            let mut kinematics = DifferentialKinematics::new(&system, &place.commanded)?;
            kinematics.linearize(place.posed.coordinates.as_slice())?;
            let matrix = kinematics.jacobian(frame)?;
            let all = kinematics.coordinate_derivatives()?;
            let derivative =
                rates.map(|rates| kinematics.jacobian_derivative(frame, &rates)).transpose()?;
            let dimensions = system.kinematics().dimensions();
            let units: Vec<f64> =
                place.commanded.iter().map(|&k| dimensions[k].unit(place.length)).collect();
            let dexterity = dexterity(&matrix, &units, place.length)?;
            let pose = kinematics.frame_pose(frame)?.to_homogeneous();
            let loops = kinematics.singular_values()?;
            Ok((place, matrix, all, derivative, dexterity, pose, loops))
        });
        let (place, matrix, all, derivative, dexterity, pose, loops) =
            found.map_err(|error: Error| errors::core(py, &error))?;
        let names = this.names(0..this.coordinates.all().len());
        let units = this.units(0..this.coordinates.all().len());
        let pose = DMatrix::from_fn(4, 4, |row, column| pose[(row, column)]);
        let posed = &place.posed;
        let fields = fields!(py;
            name = name,
            configuration =
                results::configuration(py, slf, &posed.coordinates, posed.residual, posed.iterations)?,
            commanded = PyTuple::new(py, place.commanded.iter().map(|&k| names[k]))?,
            commanded_units = PyTuple::new(py, place.commanded.iter().map(|&k| units[k]))?,
            pose = array(py, &pose),
            matrix = array(py, &matrix),
            derivative = derivative.map(|derivative| array(py, &derivative)),
            coordinate_derivatives = array(py, &all),
            singular_values = PyArray1::from_slice(py, dexterity.singular_values.as_slice()),
            condition_number = dexterity.condition_number,
            manipulability = dexterity.manipulability,
            loop_singular_values = PyArray1::from_slice(py, loops.as_slice()),
            characteristic_length_m = place.length,
        );
        skin::result(py, "Jacobian", &fields)
    }

    /// Velocities of all coordinates, links and frames for those of commanded coordinates; accelerations without any commanded one.
    ///
    /// Parameters
    /// ----------
    /// velocities : dict of str to float
    ///     Velocities of commanded coordinates, 0 for those not named (m/s, rad/s).
    /// at : dict of str to float, optional
    ///     Joint coordinates of the configuration (m, rad).
    /// commanded : sequence of str, optional
    ///     The commanded coordinates; by default those of the actuated joints.
    ///
    /// Raises
    /// ------
    /// UndeterminedError
    ///     Where commanded coordinates do not determine the motion; with singular values.
    /// DependentCommandsError
    ///     Where the loops do not allow these velocities together.
    #[pyo3(signature = (velocities, at=None, *, commanded=None))]
    fn velocities<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        velocities: &Bound<'py, PyDict>,
        at: Option<&Bound<'py, PyDict>>,
        commanded: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        Self::moving(slf, py, Some(velocities), None, at, commanded)
    }

    /// Accelerations of all coordinates, links and frames for those of commanded coordinates.
    ///
    /// Parameters
    /// ----------
    /// accelerations : dict of str to float
    ///     Accelerations of commanded coordinates, 0 for those not named (m/s², rad/s²).
    /// velocities : dict of str to float, optional
    ///     Velocities of commanded coordinates, 0 for those not named (m/s, rad/s).
    /// at : dict of str to float, optional
    ///     Joint coordinates of the configuration (m, rad).
    /// commanded : sequence of str, optional
    ///     The commanded coordinates; by default those of the actuated joints.
    ///
    /// Raises
    /// ------
    /// UndeterminedError
    ///     Where commanded coordinates do not determine the motion; with singular values.
    /// DependentCommandsError
    ///     Where the loops do not allow these rates together.
    #[pyo3(signature = (accelerations, velocities=None, at=None, *, commanded=None))]
    fn accelerations<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        accelerations: &Bound<'py, PyDict>,
        velocities: Option<&Bound<'py, PyDict>>,
        at: Option<&Bound<'py, PyDict>>,
        commanded: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        Self::moving(slf, py, velocities, Some(accelerations), at, commanded)
    }

    /// Derivatives of all coordinates, links and frames by parameters of the file, with commanded coordinates held and loops closed.
    ///
    /// They are per unit of the parameter in the file.
    /// The geometry is differentiated by central differences at fixed coordinates, the loops by their derivatives.
    ///
    /// Parameters
    /// ----------
    /// parameters : sequence of str, optional
    ///     Names of parameters; by default all of the file.
    /// at : dict of str to float, optional
    ///     Joint coordinates of the configuration (m, rad).
    /// commanded : sequence of str, optional
    ///     The coordinates that are held; by default those of the actuated joints.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     For a parameter with no derivative: the file is invalid for other values, the loops close for one value only, or the value is at a kink.
    /// UndeterminedError
    ///     Where commanded coordinates do not determine the configuration; with singular values.
    #[pyo3(signature = (parameters=None, at=None, *, commanded=None))]
    fn parameter_derivatives<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        parameters: Option<Vec<String>>,
        at: Option<&Bound<'py, PyDict>>,
        commanded: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let commanded = this.commanded_coordinates(py, commanded)?;
        let at = this.commands(py, at)?;
        let changed = this.changed(py, parameters)?;
        let mechanism = &this.file.mechanism;
        let found = py.detach(|| {
            let of_motion = |error: Error| Box::new((None, error));
            let place = this.place(&at, commanded).map_err(of_motion)?;
            let system = this.system_at(&place).map_err(of_motion)?;
            let mut kinematics =
                DifferentialKinematics::new(&system, &place.commanded).map_err(of_motion)?;
            kinematics.linearize(place.posed.coordinates.as_slice()).map_err(of_motion)?;
            kinematics.require_determined().map_err(of_motion)?;
            let mut all = Vec::new();
            for (name, changed) in &changed {
                let found =
                    kinematics.dimension_derivatives(place.posed.coordinates.as_slice(), changed);
                all.push(found.map_err(|error| Box::new((Some(name.clone()), error)))?);
            }
            Ok((place, all))
        });
        let (place, all) = found.map_err(|failed: Box<(Option<String>, Error)>| {
            let (parameter, error) = *failed;
            match parameter {
                Some(name) => errors::input(py, &format!("parameter `{name}`: {error}")),
                None => errors::core(py, &error),
            }
        })?;
        let frames = PyDict::new(py);
        for (k, frame) in mechanism.moving_frames().enumerate() {
            let matrix = DMatrix::from_fn(6, all.len(), |row, column| {
                let twist = &all[column].frames[k];
                if row < 3 { twist.angular[row] } else { twist.linear[row - 3] }
            });
            frames.set_item(mechanism.frame_name(frame), array(py, &matrix))?;
        }
        let count = this.coordinates.all().len();
        let matrix = DMatrix::from_fn(count, all.len(), |row, column| all[column].coordinates[row]);
        let posed = &place.posed;
        let fields = fields!(py;
            configuration =
                results::configuration(py, slf, &posed.coordinates, posed.residual, posed.iterations)?,
            parameters = PyTuple::new(py, changed.iter().map(|(name, _)| name))?,
            names = PyTuple::new(py, this.names(0..count))?,
            units = PyTuple::new(py, this.units(0..count))?,
            coordinates = array(py, &matrix),
            frames = frames,
        );
        skin::result(py, "ParameterDerivatives", &fields)
    }
}

impl PyMechanism {
    /// The mechanism with other values of parameters, of all of them without names.
    fn changed(
        &self,
        py: Python<'_>,
        names: Option<Vec<String>>,
    ) -> PyResult<Vec<(String, ChangedDimension)>> {
        let parameters = &self.file.parameters;
        let known: Vec<String> = parameters.iter().map(|(name, _)| name.clone()).collect();
        let changed = names.unwrap_or_else(|| known.clone()).into_iter().map(|name| {
            let Some((_, value)) = parameters.iter().find(|(one, _)| *one == name) else {
                return Err(errors::unknown_name(py, "parameter", &name, &known));
            };
            let changed = self.changed_dimension((&name, *value));
            let changed = changed.map_err(|error| errors::input(py, &error.to_string()))?;
            Ok((name, changed))
        });
        changed.collect()
    }

    /// Velocities and accelerations of everything.
    fn moving<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        velocities: Option<&Bound<'py, PyDict>>,
        accelerations: Option<&Bound<'py, PyDict>>,
        at: Option<&Bound<'py, PyDict>>,
        commanded: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let commanded = this.commanded_coordinates(py, commanded)?;
        let first = this.rates(py, velocities, &commanded)?;
        let second = this.rates(py, accelerations, &commanded)?;
        let at = this.commands(py, at)?;
        let mechanism = &this.file.mechanism;
        let found = py.detach(|| {
            let place = this.place(&at, commanded)?;
            let system = this.system_at(&place)?;
            let mut kinematics = DifferentialKinematics::new(&system, &place.commanded)?;
            kinematics.linearize(place.posed.coordinates.as_slice())?;
            let mut velocities = DVector::zeros(kinematics.coordinate_count());
            let mut accelerations = velocities.clone();
            kinematics.velocities(&first, velocities.as_mut_slice())?;
            kinematics.accelerations(&second, accelerations.as_mut_slice())?;
            let mut frames = Vec::new();
            for frame in mechanism.moving_frames() {
                let rates =
                    [kinematics.frame_velocity(frame)?, kinematics.frame_acceleration(frame)?];
                frames.push((mechanism.frame_name(frame), rates));
            }
            Ok((place, velocities, accelerations, frames))
        });
        let (place, velocities, accelerations, frames) =
            found.map_err(|error: Error| errors::core(py, &error))?;
        let [frame_velocities, frame_accelerations] = [0, 1].map(|order| {
            let listed = PyDict::new(py);
            let set = |(name, rates): &(&str, [FrameTwist; 2])| {
                let FrameTwist { angular, linear } = rates[order];
                let entries = [angular.x, angular.y, angular.z, linear.x, linear.y, linear.z];
                listed.set_item(*name, PyArray1::from_slice(py, &entries))
            };
            frames.iter().try_for_each(set).map(|()| listed)
        });
        let all = 0..this.coordinates.all().len();
        let posed = &place.posed;
        let fields = fields!(py;
            configuration =
                results::configuration(py, slf, &posed.coordinates, posed.residual, posed.iterations)?,
            names = PyTuple::new(py, this.names(all.clone()))?,
            units = PyTuple::new(py, this.units(all))?,
            velocities = PyArray1::from_slice(py, velocities.as_slice()),
            accelerations = PyArray1::from_slice(py, accelerations.as_slice()),
            frame_velocities = frame_velocities?,
            frame_accelerations = frame_accelerations?,
        );
        skin::result(py, "Rates", &fields)
    }

    /// The coordinates of some names; those of the actuated joints without names.
    fn commanded_coordinates(
        &self,
        py: Python<'_>,
        names: Option<Vec<String>>,
    ) -> PyResult<Vec<usize>> {
        let Some(names) = names else {
            let actuated = self.file.mechanism.actuated_coordinates();
            return if actuated.is_empty() {
                let message = "no joint of this mechanism is actuated: name the commanded ones, such as commanded=[\"crank\"]";
                Err(errors::input(py, message))
            } else {
                Ok(actuated)
            };
        };
        let mut commanded = Vec::new();
        for name in &names {
            let k = self.find(py, name)?;
            if commanded.contains(&k) {
                return Err(errors::input(py, &format!("commanded names {name:?} twice")));
            }
            commanded.push(k);
        }
        Ok(commanded)
    }

    /// Rates of commanded coordinates, 0 for those not named.
    fn rates(
        &self,
        py: Python<'_>,
        given: Option<&Bound<'_, PyDict>>,
        commanded: &[usize],
    ) -> PyResult<Vec<f64>> {
        let mut rates = vec![0.0; commanded.len()];
        for (k, value) in self.commands(py, given)? {
            let Some(j) = commanded.iter().position(|&one| one == k) else {
                let all = self.names(0..self.coordinates.all().len());
                let known: Vec<&str> = commanded.iter().map(|&k| all[k]).collect();
                let message =
                    format!("{:?} is not commanded; commanded are {}", all[k], known.join(", "));
                return Err(errors::input(py, &message));
            };
            rates[j] = value;
        }
        Ok(rates)
    }

    /// The configuration for commanded values, virtual joints at the least displacement for the coordinates whose rates are commanded.
    fn place(&self, at: &Commands, commanded: Vec<usize>) -> Result<Place, Error> {
        let posed = self.posed(at, None)?;
        let mechanism = &self.file.mechanism;
        if mechanism.virtual_joints().is_empty() {
            let length =
                MechanismSystem::new(mechanism, posed.coordinates.clone())?.characteristic_length();
            return Ok(Place { commanded, posed, length });
        }
        let commands: Commands = commanded.iter().map(|&k| (k, posed.coordinates[k])).collect();
        let Relief { coordinates, residual, iterations, characteristic_length, .. } =
            self.relieved(&commands)?;
        let posed = Closure { coordinates, residual, iterations, is_searched: false };
        Ok(Place { commanded, posed, length: characteristic_length })
    }

    fn system_at(&self, place: &Place) -> Result<MechanismSystem<'_>, Error> {
        let system = MechanismSystem::new(&self.file.mechanism, place.posed.coordinates.clone())?;
        system.with_characteristic_length(place.length)
    }
}

fn array<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> Bound<'py, PyArray2<f64>> {
    let array = Array2::from_shape_fn(matrix.shape(), |(row, column)| matrix[(row, column)]);
    PyArray2::from_owned_array(py, array)
}
