//! Report on velocities, accelerations and Jacobians of a mechanism.

use jointplay_core::Error;
use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    ChangedDimension, DifferentialKinematics, FrameId, FrameTwist, MechanismSystem, Relief,
    dexterity,
};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;
use jointplay_format::units::mm;
use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};

use crate::beyond::beyond_limits;
use crate::free_motions::FreeMotionsReport;
use crate::limits::LimitReport;
use crate::mechanism::{ByName, UnitsReport, by_name, virtual_by_name};

/// Result of `jacobian`; lengths and angles are in the units of the file, times in seconds.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct JacobianReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of all numbers.
    pub units: UnitsReport,
    /// Coordinates of the configuration by name.
    pub coordinates: ByName<f64>,
    /// Displacements of the virtual joints by name, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub virtual_joints: Option<ByName<f64>>,
    /// Coordinates beyond their limits or clearance.
    pub limits_broken: Vec<LimitReport>,
    /// Names of the commanded coordinates: the columns of all matrices.
    pub commanded: Vec<String>,
    /// Derivative of every coordinate and virtual joint with respect to the commanded ones; of a ball, its angular velocity in the turned frame.
    pub derivatives: ByName<Vec<f64>>,
    /// Links and attached frames.
    pub frames: ByName<FrameReport>,
    /// Velocity of every coordinate and virtual joint, if velocities were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocities: Option<ByName<f64>>,
    /// Acceleration of every coordinate and virtual joint, if velocities or accelerations were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accelerations: Option<ByName<f64>>,
    /// Derivatives by parameters of the file, if any were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameters: Option<ByName<ParameterReport>>,
    /// Singular values of the equations of the loops with the commanded coordinates held, one for each other coordinate, in radians and characteristic lengths, largest first; zeros are freedoms of the virtual joints that the least displacement determines.
    pub singular_values: Vec<f64>,
    /// Characteristic length (mm).
    pub characteristic_length_mm: f64,
}

/// A link or an attached frame.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct FrameReport {
    /// Origin in the base frame.
    pub position: [f64; 3],
    /// Unit quaternion w, x, y, z in the base frame, w ≥ 0.
    pub quaternion: [f64; 4],
    /// Geometric Jacobian by rows: angular velocity x, y, z, then velocity of the origin x, y, z, in the base frame.
    pub jacobian: [Vec<f64>; 6],
    /// Its rate of change along the given velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jacobian_derivative: Option<[Vec<f64>; 6]>,
    /// Singular values of the Jacobian in radians and characteristic lengths, largest first.
    pub singular_values: Vec<f64>,
    /// Largest over smallest of them; `null` where the smallest is zero.
    pub condition_number: Option<f64>,
    /// Product of them.
    pub manipulability: f64,
    /// Velocity, if velocities were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<TwistReport>,
    /// Acceleration, if velocities or accelerations were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<TwistReport>,
}

/// Velocity or acceleration of a frame in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TwistReport {
    /// Angular part x, y, z.
    pub angular: [f64; 3],
    /// Of the origin x, y, z.
    pub linear: [f64; 3],
}

/// Derivatives by a parameter of the file, with the commanded coordinates held, in the units of the file for a change by 1.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ParameterReport {
    /// Derivative of every coordinate and virtual joint; of a ball, its rotation in the turned frame.
    pub coordinates: ByName<f64>,
    /// Rotation and displacement of the reported frames in the base frame.
    pub frames: ByName<TwistReport>,
}

/// Rates of the commanded coordinates.
#[derive(Debug, Clone, Copy)]
pub struct CommandedRates<'a> {
    /// Velocities (m/s, rad/s).
    pub velocities: &'a [f64],
    /// Accelerations (m/s², rad/s²).
    pub accelerations: &'a [f64],
}

/// Why there are no derivatives.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JacobianError {
    /// Of a motion.
    #[error(transparent)]
    Motion(#[from] Error),
    /// Motions with all commanded coordinates held.
    #[error(
        "{}",
        .0.explained(
            "commanded coordinates",
            "command one of their joints for each, or choose a configuration that is not singular"
        )
    )]
    FreeMotions(FreeMotionsReport),
    /// By a parameter.
    #[error("parameter `{parameter}`: {error}")]
    Parameter {
        /// Name of the parameter.
        parameter: String,
        /// Why there are none.
        error: Box<Error>,
    },
}

/// Reports the derivatives of a mechanism at a configuration.
///
/// # Arguments
/// * `system` – at the configuration, with the metric of its virtual displacement
/// * `commanded` – indices of the commanded coordinates
/// * `frames` – frames to report
/// * `relief` – displacements of the virtual joints, if there are any
/// * `rates` – of the commanded coordinates, if any were given
/// * `parameters` – parameters of the file by which derivatives are asked for, with the mechanism for other values
///
/// # Errors
/// [`JacobianError`], with those of [`DifferentialKinematics`].
pub fn jacobian(
    file: &MechanismFile,
    system: &MechanismSystem<'_>,
    commanded: &[usize],
    frames: &[FrameId],
    relief: Option<&Relief>,
    rates: Option<CommandedRates<'_>>,
    parameters: &[(String, ChangedDimension)],
) -> Result<JacobianReport, JacobianError> {
    let coordinates = Coordinates::of(file);
    let mut kinematics = DifferentialKinematics::new(system, commanded)?;
    kinematics.linearize(system.home().as_slice())?;
    kinematics.require_determined().map_err(|error| undetermined(system, commanded, error))?;
    let derivatives = kinematics.coordinate_derivatives()?;
    let in_units = Units { file, coordinates: &coordinates, commanded };
    let derivatives = (0..coordinates.all().len()).map(|k| {
        let row = commanded.iter().enumerate();
        let row =
            row.map(|(j, _)| coordinates.from_si(k, in_units.per_unit(derivatives[(k, j)], j)));
        (coordinates.all()[k].name.clone(), row.collect())
    });
    let derivatives = ByName(derivatives.collect());
    let mut reports = Vec::new();
    for &frame in frames {
        let report =
            in_units.frame(&mut kinematics, frame, system, rates.map(|rates| rates.velocities))?;
        reports.push((file.mechanism.frame_name(frame).to_owned(), report));
    }
    let (mut velocities, mut accelerations) = (None, None);
    if let Some(rates) = rates {
        let mut all = DVector::zeros(coordinates.all().len());
        kinematics.velocities(rates.velocities, all.as_mut_slice())?;
        velocities = Some(every(&coordinates, &all));
        kinematics.accelerations(rates.accelerations, all.as_mut_slice())?;
        accelerations = Some(every(&coordinates, &all));
        for (&frame, (_, report)) in frames.iter().zip(&mut reports) {
            report.velocity = Some(in_units.twist(kinematics.frame_velocity(frame)?));
            report.acceleration = Some(in_units.twist(kinematics.frame_acceleration(frame)?));
        }
    }
    let by_parameters = parameters.iter().map(|(name, changed)| {
        match in_units.parameter(&mut kinematics, system, frames, changed) {
            Ok(report) => Ok((name.clone(), report)),
            Err(error) => {
                Err(JacobianError::Parameter { parameter: name.clone(), error: Box::new(error) })
            }
        }
    });
    let by_parameters = by_parameters.collect::<Result<Vec<_>, _>>()?;
    Ok(JacobianReport {
        name: file.mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        coordinates: by_name(&coordinates, system.home()),
        virtual_joints: relief.map(|relief| virtual_by_name(&coordinates, relief)),
        limits_broken: beyond_limits(&coordinates, &file.mechanism.beyond_limits(system.home())),
        commanded: commanded.iter().map(|&k| coordinates.all()[k].name.clone()).collect(),
        derivatives,
        frames: ByName(reports),
        velocities,
        accelerations,
        parameters: (!parameters.is_empty()).then_some(ByName(by_parameters)),
        singular_values: kinematics.singular_values()?.as_slice().to_vec(),
        characteristic_length_mm: mm(system.characteristic_length()),
    })
}

/// An undetermined motion with the names of its links and joints.
fn undetermined(system: &MechanismSystem<'_>, commanded: &[usize], error: Error) -> JacobianError {
    if !matches!(error, Error::Undetermined(_)) {
        return error.into();
    }
    let mechanism = system.kinematics().mechanism();
    match FreeMotionsReport::new(mechanism, system.home(), commanded) {
        Ok(motions) if motions.count() > 0 => JacobianError::FreeMotions(motions),
        _ => error.into(),
    }
}

/// Rates of all coordinates and virtual joints by name, in the units of the file.
fn every(coordinates: &Coordinates, rates: &DVector<f64>) -> ByName<f64> {
    let named = coordinates.all().iter().enumerate();
    ByName(named.map(|(k, one)| (one.name.clone(), coordinates.from_si(k, rates[k]))).collect())
}

/// Conversion of derivatives to the units of the file.
struct Units<'a> {
    file: &'a MechanismFile,
    coordinates: &'a Coordinates,
    commanded: &'a [usize],
}

impl Units<'_> {
    /// A derivative per metre or radian of a commanded coordinate, per unit of the file.
    fn per_unit(&self, value: f64, column: usize) -> f64 {
        value * self.coordinates.to_si(self.commanded[column], 1.0)
    }

    fn angles(&self, vector: Vector3<f64>) -> [f64; 3] {
        vector.map(|value| self.file.units.angle.from_radians(value)).into()
    }

    fn lengths(&self, vector: Vector3<f64>) -> [f64; 3] {
        vector.map(|value| self.file.units.length.from_meters(value)).into()
    }

    fn twist(&self, twist: FrameTwist) -> TwistReport {
        TwistReport { angular: self.angles(twist.angular), linear: self.lengths(twist.linear) }
    }

    fn rows(&self, matrix: &DMatrix<f64>) -> [Vec<f64>; 6] {
        std::array::from_fn(|row| {
            let entries = (0..matrix.ncols()).map(|column| {
                let value = self.per_unit(matrix[(row, column)], column);
                if row < 3 {
                    self.file.units.angle.from_radians(value)
                } else {
                    self.file.units.length.from_meters(value)
                }
            });
            entries.collect()
        })
    }

    fn parameter(
        &self,
        kinematics: &mut DifferentialKinematics,
        system: &MechanismSystem<'_>,
        frames: &[FrameId],
        changed: &ChangedDimension,
    ) -> Result<ParameterReport, Error> {
        let found = kinematics.dimension_derivatives(system.home().as_slice(), changed)?;
        let mechanism = &self.file.mechanism;
        let named = frames.iter().map(|&frame| {
            let moving = mechanism.moving_frames().position(|one| one == frame);
            // The base does not move.
            let still = FrameTwist { angular: Vector3::zeros(), linear: Vector3::zeros() };
            let twist = moving.map_or(still, |k| found.frames[k]);
            (mechanism.frame_name(frame).to_owned(), self.twist(twist))
        });
        Ok(ParameterReport {
            coordinates: every(self.coordinates, &found.coordinates),
            frames: ByName(named.collect()),
        })
    }

    fn frame(
        &self,
        kinematics: &mut DifferentialKinematics,
        frame: FrameId,
        system: &MechanismSystem<'_>,
        velocities: Option<&[f64]>,
    ) -> Result<FrameReport, Error> {
        let length = system.characteristic_length();
        let dimensions = system.kinematics().dimensions();
        let units: Vec<f64> = self.commanded.iter().map(|&k| dimensions[k].unit(length)).collect();
        let jacobian = kinematics.jacobian(frame)?;
        let derivative = velocities.map(|rates| kinematics.jacobian_derivative(frame, rates));
        let found = dexterity(&jacobian, &units, length)?;
        let pose = kinematics.frame_pose(frame)?;
        let Quaternion { coords } =
            *UnitQuaternion::from_rotation_matrix(&pose.rotation).quaternion();
        let sign = if coords.w < 0.0 { -1.0 } else { 1.0 };
        Ok(FrameReport {
            position: self.lengths(pose.translation.vector),
            quaternion: [coords.w, coords.x, coords.y, coords.z].map(|part| 0.0 + sign * part),
            jacobian: self.rows(&jacobian),
            jacobian_derivative: derivative.transpose()?.map(|matrix| self.rows(&matrix)),
            singular_values: found.singular_values.as_slice().to_vec(),
            condition_number: found.condition_number,
            manipulability: found.manipulability,
            velocity: None,
            acceleration: None,
        })
    }
}
