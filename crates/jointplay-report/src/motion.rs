//! A mechanism on its way.

use std::collections::BTreeSet;

use jointplay_core::mechanism::{DrivenMotion, Stop};

use crate::mechanism::{ByName, UnitsReport, by_name};
use crate::table::{Column, Values};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;

/// What `move` answers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MotionReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// Names of the coordinates that were driven.
    pub driven: Vec<String>,
    /// Names of the coordinates of other motors, which held still.
    pub held: Vec<String>,
    /// Steps done, the shortened ones among them.
    pub steps: usize,
    /// Largest mismatch of a loop on the way, in radians and characteristic lengths.
    pub largest_residual: f64,
    /// Singular configurations on the way.
    pub singular: Vec<SingularReport>,
    /// Largest displacement of each virtual joint on the way, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacements: Option<ByName<f64>>,
    /// Coordinates that went beyond their limits, and virtual joints that went beyond their clearance.
    pub limits_broken: Vec<String>,
    /// `locked`, `singular_start` or `incompatible`; `null` at the end of the way.
    pub stopped: Option<&'static str>,
    /// The same in words, and where.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Values of every coordinate along the way, by name and unit, such as `crank_deg`.
    pub series: ByName<Vec<f64>>,
}

/// A singular configuration.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SingularReport {
    /// Value of each driven coordinate there, by name.
    pub drives: ByName<f64>,
    /// Freedoms to first order there, drives free.
    pub instantaneous_mobility: usize,
    /// The least singular value found there, as a share of the largest.
    pub least_singular_value: f64,
    /// How many branches of the motion meet there; `null` where second order does not tell.
    pub branches: Option<usize>,
    /// Every coordinate there, by name.
    pub coordinates: ByName<f64>,
}

/// Tells a motion.
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
    let where_it_stands = || {
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
                "the start is singular: {free_mobility} {} to first order with the drives held, and none was found that leads on; start from another configuration",
                if free_mobility == 1 { "motion" } else { "motions" }
            ),
        ),
        Stop::Incompatible => (
            "incompatible",
            "the loops do not stay closed: the drives pull against each other or against redundant constraints".to_owned(),
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
        message: reason.map(|reason| format!("stopped at {}: {reason}", where_it_stands())),
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

/// Names of the coordinates that are beyond their limits somewhere on the way, and of virtual joints beyond their clearance.
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
