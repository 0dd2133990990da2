//! Report on a driven motion of a mechanism.

use std::collections::BTreeSet;

use jointplay_core::mechanism::{DrivenMotion, Stop};

use crate::mechanism::{ByName, UnitsReport, by_name};
use crate::table::{Column, Values};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;

/// Result of `move`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MotionReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// Names of the driven coordinates.
    pub driven: Vec<String>,
    /// Names of the coordinates of other motors, which are locked.
    pub held: Vec<String>,
    /// Number of steps, including shortened ones.
    pub steps: usize,
    /// Largest closure residual of a loop during the motion, in radians and characteristic lengths.
    pub largest_residual: f64,
    /// Singular configurations during the motion.
    pub singular: Vec<SingularReport>,
    /// Largest displacement of each virtual joint during the motion, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacements: Option<ByName<f64>>,
    /// Coordinates that exceed their limits, and virtual joints that exceed their clearance.
    pub limits_broken: Vec<String>,
    /// `locked`, `singular_start` or `incompatible`; `null` if the motion is complete.
    pub stopped: Option<&'static str>,
    /// Message with the reason and the place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Values of every coordinate during the motion, by name and unit, such as `crank_deg`.
    pub series: ByName<Vec<f64>>,
}

/// A singular configuration.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SingularReport {
    /// Value of each driven coordinate, by name.
    pub drives: ByName<f64>,
    /// Instantaneous mobility with free drives.
    pub instantaneous_mobility: usize,
    /// Smallest singular value, as a share of the largest.
    pub least_singular_value: f64,
    /// Number of branches of the motion that meet here; `null` if second order does not determine it.
    pub branches: Option<usize>,
    /// Values of all coordinates, by name.
    pub coordinates: ByName<f64>,
}

/// Reports a motion.
///
/// # Arguments
/// * `driven`, `held` – indices of coordinates
#[must_use]
pub fn motion(
    file: &MechanismFile,
    driven: &[usize],
    held: &[usize],
    motion: &DrivenMotion,
) -> MotionReport {
    let coordinates = Coordinates::of(file);
    let name = |&k: &usize| coordinates.all()[k].name.clone();
    let drives = |values: &nalgebra::DVector<f64>| {
        ByName(driven.iter().map(|&k| (name(&k), coordinates.from_si(k, values[k]))).collect())
    };
    let singular = motion.singular.iter().map(|there| SingularReport {
        drives: drives(&there.coordinates),
        instantaneous_mobility: there.instantaneous_mobility,
        least_singular_value: there.least_singular_value,
        branches: there.branches,
        coordinates: by_name(&coordinates, &there.coordinates),
    });
    let series = (0..coordinates.all().len()).map(|k| {
        let values = motion.waypoints.iter().map(|at| coordinates.from_si(k, at.coordinates[k]));
        (coordinates.column(k), values.collect())
    });
    let place = || {
        let values = motion.waypoints.last().map(|last| drives(&last.coordinates));
        let values = values.into_iter().flat_map(|values| values.0);
        let at = values.zip(driven).map(|((name, value), &k)| {
            format!("{name} = {value:.*} {}", coordinates.decimals(k), coordinates.unit(k))
        });
        at.collect::<Vec<_>>().join(", ")
    };
    let why = motion.stopped.map(|stop| match stop {
        Stop::Locked => (
            "locked",
            "a dead point, where the mechanism cannot follow its drives any further".to_owned(),
        ),
        Stop::SingularStart { free_mobility } => (
            "singular_start",
            format!(
                "the start is singular: {free_mobility} instantaneous {} with locked drives, and no continuation was found; start from another configuration",
                if free_mobility == 1 { "motion" } else { "motions" }
            ),
        ),
        Stop::Incompatible => (
            "incompatible",
            "the loops do not stay closed: the drives act against each other or against redundant constraints".to_owned(),
        ),
    });
    let (stopped, reason) = why.unzip();
    MotionReport {
        name: file.mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        driven: driven.iter().map(name).collect(),
        held: held.iter().map(name).collect(),
        steps: motion.steps,
        largest_residual: motion.waypoints.iter().map(|at| at.residual).fold(0.0, f64::max),
        singular: singular.collect(),
        largest_displacements: largest_displacements(&coordinates, motion),
        limits_broken: beyond_limits(file, &coordinates, motion),
        stopped,
        message: reason.map(|reason| format!("stopped at {}: {reason}", place())),
        series: ByName(series.collect()),
    }
}

impl MotionReport {
    /// The series as columns of a table.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let column = |(name, values): &(String, Vec<f64>)| Column {
            name: name.clone(),
            values: Values::Real(values.clone()),
        };
        self.series.0.iter().map(column).collect()
    }
}

fn largest_displacements(coordinates: &Coordinates, motion: &DrivenMotion) -> Option<ByName<f64>> {
    let named = coordinates.all().iter().enumerate().skip(coordinates.joints());
    let largest = named.map(|(k, one)| {
        let values = motion.waypoints.iter().map(|at| at.coordinates[k].abs());
        (one.name.clone(), coordinates.from_si(k, values.fold(0.0, f64::max)))
    });
    let largest: Vec<_> = largest.collect();
    (!largest.is_empty()).then_some(ByName(largest))
}

/// Names of the coordinates that exceed their limits during the motion, and of virtual joints that exceed their clearance.
fn beyond_limits(
    file: &MechanismFile,
    coordinates: &Coordinates,
    motion: &DrivenMotion,
) -> Vec<String> {
    let beyond =
        motion.waypoints.iter().flat_map(|at| file.mechanism.beyond_limits(&at.coordinates));
    let all: BTreeSet<usize> = beyond.map(|one| one.coordinate).collect();
    all.into_iter().map(|k| coordinates.all()[k].name.clone()).collect()
}
