//! Report on a driven motion of a mechanism.

use std::collections::BTreeSet;

use jointplay_core::Error;
use jointplay_core::mechanism::{DrivePath, DrivenMotion, MechanismSystem, Stop, Waypoint};

use crate::free_motions::FreeMotionsReport;
use crate::limits::LimitReport;
use crate::mechanism::{ByName, UnitsReport, by_name};
use crate::poses::PosesReport;
use crate::table::{Column, Values};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;
use jointplay_format::number::rounded;

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
    /// Motions that the driven and held coordinates leave free, at the configuration with the fewest; `null` if they were not determined, as for large mechanisms that have some.
    pub free_motions: Option<FreeMotionsReport>,
    /// Number of steps of the solver, including shortened ones.
    pub solver_steps: usize,
    /// Largest closure residual of a loop during the motion, in radians and characteristic lengths.
    pub largest_residual: f64,
    /// Singular configurations during the motion.
    pub singular: Vec<SingularReport>,
    /// Largest displacement of each virtual joint during the motion, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacements: Option<ByName<f64>>,
    /// Coordinates that exceed their limits, and virtual joints that exceed their clearance.
    pub limits_broken: Vec<String>,
    /// The first configuration beyond limits, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_beyond_limits: Option<FirstBeyondReport>,
    /// `locked`, `singular_start`, `incompatible` or `beyond_limits`; `null` if the motion is complete.
    pub stopped: Option<&'static str>,
    /// Message with the reason and the place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Commands to poses, as given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pose_commands: Vec<String>,
    /// The last possible poses as commands, if the motion stopped before the commanded ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_pose: Option<String>,
    /// Parameter of the curve at each configuration, if the drives follow one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter: Option<MotionParameter>,
    /// Values of every coordinate during the motion, by name and unit, such as `crank_deg`.
    pub series: ByName<Vec<f64>>,
    /// Poses of links and attached frames during the motion, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poses: Option<PosesReport>,
}

/// Parameter of a curve along a motion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MotionParameter {
    /// Its name.
    pub name: String,
    /// Its values at the points of the path, which have equal shares of it; in a report, at each configuration.
    pub values: Vec<f64>,
}

impl MotionParameter {
    /// Time from its first to its last value, where its name has the unit `s`, such as `time_s` (s).
    #[must_use]
    pub fn seconds(&self) -> Option<f64> {
        let (first, last) = (self.values.first()?, self.values.last()?);
        self.name.ends_with("_s").then_some((last - first).abs())
    }

    /// Its value at a share of the path, straight between points.
    #[must_use]
    pub fn value_at(&self, share: f64) -> f64 {
        let segments = self.values.len().saturating_sub(1);
        let (first, within) = DrivePath::locate(share, segments);
        match (self.values.get(first), self.values.get(first + 1)) {
            (Some(from), Some(to)) => from + (to - from) * within,
            (Some(&only), None) => only,
            (None, _) => f64::NAN,
        }
    }
}

/// The first configuration of a motion beyond joint limits or clearances.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FirstBeyondReport {
    /// Place along the motion: the parameter of the curve, or the driven coordinates.
    pub place: String,
    /// Coordinates beyond their limits there.
    pub limits_broken: Vec<LimitReport>,
}

/// A singular configuration.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SingularReport {
    /// Value of each driven coordinate, by name.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, f64>))]
    pub drives: ByName<f64>,
    /// Value of the parameter of the curve, if the drives follow one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter: Option<f64>,
    /// Instantaneous mobility with free drives.
    pub instantaneous_mobility: usize,
    /// Smallest singular value, as a share of the largest.
    pub least_singular_value: f64,
    /// Number of branches of the motion that meet here; `null` if second order does not determine it.
    pub branches: Option<usize>,
    /// Whether the driven coordinates reverse on the only branch, as at a dead point, or continue; `null` if several branches meet, or it is undecided.
    pub drives_reverse: Option<bool>,
    /// Values of all coordinates, by name.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, f64>))]
    pub coordinates: ByName<f64>,
}

/// Reports a motion.
///
/// # Arguments
/// * `driven`, `held` – indices of coordinates
/// * `parameter` – of the curve that the drives follow, at the points of their path
#[must_use]
pub fn motion(
    file: &MechanismFile,
    driven: &[usize],
    held: &[usize],
    parameter: Option<&MotionParameter>,
    motion: &DrivenMotion,
) -> MotionReport {
    let coordinates = Coordinates::of(file);
    let name = |&k: &usize| coordinates.all()[k].name.clone();
    let drives = |values: &nalgebra::DVector<f64>| {
        ByName(driven.iter().map(|&k| (name(&k), coordinates.from_si(k, values[k]))).collect())
    };
    let singular = motion.singular.iter().map(|there| SingularReport {
        drives: drives(&there.coordinates),
        parameter: parameter.map(|parameter| parameter.value_at(there.share)),
        instantaneous_mobility: there.instantaneous_mobility,
        least_singular_value: there.least_singular_value,
        branches: there.branches,
        drives_reverse: there.drives_reverse,
        coordinates: by_name(&coordinates, &there.coordinates),
    });
    let series = (0..coordinates.all().len()).map(|k| {
        let values = motion.waypoints.iter().map(|at| coordinates.from_si(k, at.coordinates[k]));
        (coordinates.column(k), values.collect())
    });
    let place = |at: &Waypoint| {
        if let Some(parameter) = parameter {
            return format!("{} = {}", parameter.name, rounded(parameter.value_at(at.share), 6));
        }
        let values = drives(&at.coordinates).0.into_iter();
        let at = values.zip(driven).map(|((name, value), &k)| {
            format!("{name} = {value:.*} {}", coordinates.decimals(k), coordinates.unit(k))
        });
        at.collect::<Vec<_>>().join(", ")
    };
    let first_beyond_limits = motion.waypoints.iter().find_map(|at| {
        let beyond = file.mechanism.beyond_limits(&at.coordinates);
        let limits_broken = crate::beyond::beyond_limits(&coordinates, &beyond);
        (!beyond.is_empty()).then(|| FirstBeyondReport { place: place(at), limits_broken })
    });
    let at_end = motion.waypoints.last().map_or(String::new(), place);
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
        Stop::Incompatible if driven.is_empty() => (
            "incompatible",
            "no configuration has the commanded poses beyond: they are out of reach, or contradict each other, the loops or the joints".to_owned(),
        ),
        Stop::Incompatible => (
            "incompatible",
            "the loops do not stay closed: the drives act against each other or against redundant constraints".to_owned(),
        ),
        Stop::NotLeast => (
            "not_least",
            "the loops can be closed beyond, but the configuration of least displacement was not found; command more coordinates, or take more steps".to_owned(),
        ),
        Stop::BeyondLimits { coordinate } => {
            let name = &coordinates.all()[coordinate].name;
            ("beyond_limits", format!("{name} would have to leave its limits"))
        }
    });
    let (stopped, reason) = why.unzip();
    MotionReport {
        name: file.mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        driven: driven.iter().map(name).collect(),
        held: held.iter().map(name).collect(),
        free_motions: None,
        solver_steps: motion.steps,
        largest_residual: motion.waypoints.iter().map(|at| at.residual).fold(0.0, f64::max),
        singular: singular.collect(),
        largest_displacements: largest_displacements(&coordinates, motion),
        limits_broken: beyond_limits(file, &coordinates, motion),
        stopped,
        first_beyond_limits,
        message: reason.map(|reason| format!("stopped at {at_end}: {reason}")),
        pose_commands: Vec::new(),
        nearest_pose: None,
        parameter: parameter.map(|parameter| MotionParameter {
            name: parameter.name.clone(),
            values: motion.waypoints.iter().map(|at| parameter.value_at(at.share)).collect(),
        }),
        series: ByName(series.collect()),
        poses: None,
    }
}

impl MotionReport {
    /// The same report with the motions that driven and held coordinates leave free, of mechanisms that are small enough for dense algebra.
    ///
    /// # Arguments
    /// * `commanded` – indices of the driven and held coordinates
    ///
    /// # Errors
    /// Those of [`FreeMotionsReport::new`].
    pub fn with_free_motions(
        self,
        file: &MechanismFile,
        motion: &DrivenMotion,
        commanded: &[usize],
    ) -> Result<Self, Error> {
        let mechanism = &file.mechanism;
        let regular = motion.waypoints.iter().min_by_key(|at| at.free_mobility);
        let found = match regular {
            Some(at) if at.free_mobility == 0 => Some(FreeMotionsReport::default()),
            Some(at) if MechanismSystem::fits(mechanism) => {
                Some(FreeMotionsReport::new(mechanism, &at.coordinates, commanded)?)
            }
            _ => None,
        };
        Ok(Self { free_motions: found, ..self })
    }

    /// The same report with the poses of all links and attached frames.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a motion with coordinates that are not finite.
    pub fn with_poses(self, file: &MechanismFile, motion: &DrivenMotion) -> Result<Self, Error> {
        let along: Vec<_> = motion.waypoints.iter().map(|at| &at.coordinates).collect();
        Ok(Self { poses: Some(PosesReport::along(file, &along)?), ..self })
    }

    /// The same report for a motion by commands to poses.
    ///
    /// # Arguments
    /// * `nearest` – the last possible poses as commands, if the motion stopped
    #[must_use]
    pub fn with_pose_commands(self, commands: Vec<String>, nearest: Option<String>) -> Self {
        Self { pose_commands: commands, nearest_pose: nearest, ..self }
    }

    /// The parameter of the curve and the series as columns of a table, then the poses.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let column = |(name, values): &(String, Vec<f64>)| Column {
            name: name.clone(),
            values: Values::Real(values.clone()),
        };
        let poses = self.poses.iter().flat_map(PosesReport::columns);
        let parameter =
            self.parameter.iter().map(|one| column(&(one.name.clone(), one.values.clone())));
        parameter.chain(self.series.0.iter().map(column)).chain(poses).collect()
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
