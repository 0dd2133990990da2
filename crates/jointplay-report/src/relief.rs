//! Report on the play that a command of a mechanism requires.

use jointplay_core::mechanism::{Relief, VirtualMotion};

use crate::beyond::beyond_limits;
use crate::limits::LimitReport;
use crate::mechanism::{ByName, UnitsReport, by_name};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;
use jointplay_format::units::mm;

/// Result of `sensitivity` for a mechanism.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ReliefReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// Coordinates by name.
    pub coordinates: ByName<f64>,
    /// Joint coordinates beyond their limits.
    pub limits_broken: Vec<LimitReport>,
    /// Names of the commanded coordinates: the columns of the sensitivity; its rows are the virtual joints.
    pub commanded: Vec<String>,
    /// The virtual joints, in the order of the file.
    pub virtual_joints: Vec<VirtualJointReport>,
    /// Size of the displacement, in `size_unit`.
    pub size: f64,
    /// `um`, with rotations multiplied by the characteristic length; `sqrt(J)` if every virtual joint has a stiffness.
    pub size_unit: &'static str,
    /// Largest closure residual of a loop, in radians and characteristic lengths.
    pub residual: f64,
    /// Singular values of the derivative of the virtual joints with respect to the commanded coordinates, largest first; dimensionless, with rotations multiplied by the characteristic length.
    pub singular_values: Vec<f64>,
    /// Characteristic length by which rotations are multiplied (mm).
    pub characteristic_length_mm: f64,
}

/// A virtual joint and its clearance.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct VirtualJointReport {
    /// Name of the virtual joint.
    pub name: String,
    /// Displacement from rest, in `unit`.
    pub displacement: f64,
    /// Clearance in both directions, in `unit`; `null` if unknown.
    pub clearance: Option<f64>,
    /// `um` or `mrad`.
    pub unit: &'static str,
    /// Whether the displacement exceeds the clearance.
    pub over: bool,
}

/// Reports the play that a command requires.
///
/// # Arguments
/// * `commanded` – indices of the commanded coordinates
/// * `singular_values` – of ∂X/∂P for the commanded coordinates
#[must_use]
pub fn relief(
    file: &MechanismFile,
    relief: &Relief,
    commanded: &[usize],
    singular_values: &[f64],
) -> ReliefReport {
    let coordinates = Coordinates::of(file);
    let joints = file.mechanism.virtual_joints();
    let reports = joints.iter().zip(relief.virtual_joints.iter()).map(|(joint, &x)| {
        let (factor, unit) = match joint.motion {
            VirtualMotion::Slide(_) => (1e6, "um"),
            VirtualMotion::Turn { .. } => (1e3, "mrad"),
        };
        VirtualJointReport {
            name: joint.name.clone(),
            displacement: x * factor,
            clearance: joint.clearance.map(|clearance| clearance * factor),
            unit,
            over: joint.clearance.is_some_and(|clearance| x.abs() > clearance),
        }
    });
    let elastic = joints.iter().all(|joint| joint.stiffness.is_some());
    let of_joints = relief.coordinates.rows(0, coordinates.joints()).into_owned();
    let (factor, size_unit) = if elastic { (1.0, "sqrt(J)") } else { (1e6, "um") };
    ReliefReport {
        name: file.mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        coordinates: by_name(&coordinates, &relief.coordinates),
        limits_broken: beyond_limits(&coordinates, &file.mechanism.beyond_limits(&of_joints)),
        commanded: commanded.iter().map(|&k| coordinates.all()[k].name.clone()).collect(),
        virtual_joints: reports.collect(),
        size: relief.size * factor,
        size_unit,
        residual: relief.residual,
        singular_values: singular_values.to_vec(),
        characteristic_length_mm: mm(relief.characteristic_length),
    }
}
