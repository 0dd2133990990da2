//! Displacements of the virtual joints for commanded joints.

use nalgebra::{DMatrix, DVector};

use super::coupling_conflicts::contradicted;
use super::motion::STEP_THRESHOLD;
use super::second_order_closing::near_miss_at;
use super::singular::DrivenCurve;
use super::{Mechanism, MechanismSystem, close};
use crate::Error;
use crate::constraint::{
    CLOSURE_TOLERANCE, Dimension, System, scaled_jacobian, scaled_residual, units,
};
use crate::linalg::{Svd, svd};
use crate::mobility::{ForcedClosure, RANK_THRESHOLD, finite_mobility};
use crate::sensitivity::{Sensitivity, commanded_sensitivity};

/// Singular values up to this share of the largest are not used to relieve anything.
const RELIEF_THRESHOLD: f64 = 1e-9;
/// Changes of the virtual joints below this, in their metric, are the end.
const SETTLED: f64 = 1e-14;
/// Undetermined joints this near to where they would be nearest home are there, in radians and characteristic lengths.
const AT_HOME: f64 = 1e-12;
/// Longest turn of the passive and virtual joints in one step, all of them together (rad): a longer step might end at a displacement that is least among those a whole turn away.
const LONGEST_STEP: f64 = 0.5;
/// Bounds of the relaxation factor of steps toward home.
const LEAST_FACTOR: f64 = 0.02;
const LARGEST_FACTOR: f64 = 4.0;
/// Steps of the iteration.
const MAX_ITERATIONS: usize = 60;

/// How the virtual joints are chosen among those that close the loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReliefSolver {
    /// The least displacement in the metric.
    #[default]
    LeastNorm,
    /// Steps of least norm from rest, as in the paper: near, not at, the least displacement.
    Newton,
}

/// Displacements of the virtual joints that make the commanded positions possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// (f + M) coordinates: commanded, passive, virtual (m, rad).
    pub coordinates: DVector<f64>,
    /// (M) displacements of the virtual joints (m, rad).
    pub virtual_joints: DVector<f64>,
    /// √(Σ w x²): in metres, turns being weighed by the characteristic length, or by stiffness where every virtual joint has one (m or √J).
    pub size: f64,
    /// Characteristic length of the metric (m).
    pub characteristic_length: f64,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Iterations done.
    pub iterations: usize,
}

impl Relief {
    /// The displacements of the virtual joints at the home of a system.
    pub(super) fn of(system: &MechanismSystem<'_>, residual: f64, iterations: usize) -> Self {
        let virtual_joints = system.at_home().virtual_joints;
        let size = virtual_joints.component_mul(&virtual_weights(system).map(f64::sqrt)).norm();
        Self {
            coordinates: system.home().clone(),
            virtual_joints,
            size,
            characteristic_length: system.characteristic_length(),
            residual,
            iterations,
        }
    }

    /// The mechanism at the displaced configuration, with the characteristic length of the metric.
    ///
    /// # Errors
    /// Those of [`MechanismSystem::new`].
    pub fn system<'m>(&self, mechanism: &'m Mechanism) -> Result<MechanismSystem<'m>, Error> {
        MechanismSystem::new(mechanism, self.coordinates.clone())?
            .with_characteristic_length(self.characteristic_length)
    }

    /// The sensitivity of the virtual joints to the commanded coordinates; of a ball, to those of its rotation vector.
    ///
    /// # Arguments
    /// * `commanded` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// Those of [`MechanismSystem::new`] and [`commanded_sensitivity`].
    pub fn sensitivity(
        &self,
        mechanism: &Mechanism,
        commanded: &[usize],
    ) -> Result<Sensitivity, Error> {
        let system = self.system(mechanism)?;
        let system = system.with_free(&passive(mechanism.joint_freedoms(), commanded));
        let (at, length) = (system.at_home(), self.characteristic_length);
        commanded_sensitivity(&system, &at, commanded, length, RANK_THRESHOLD)
    }
}

/// Weights of the virtual joints: 1 for a slide and ρ² for a turn, or their stiffness where all have one.
#[must_use]
pub fn virtual_weights(system: &MechanismSystem<'_>) -> DVector<f64> {
    system.virtual_joint_stiffness().unwrap_or_else(|| metric_weights(system))
}

/// √(Σ w x²) of displacements of the virtual joints, with w = 1 for a slide and ρ² for a turn, whatever stiffness they have (m).
pub(super) fn size_in_metric(system: &MechanismSystem<'_>, displacements: &DVector<f64>) -> f64 {
    displacements.component_mul(&metric_weights(system).map(f64::sqrt)).norm()
}

/// 1 for a slide and ρ² for a turn.
fn metric_weights(system: &MechanismSystem<'_>) -> DVector<f64> {
    let length = system.characteristic_length();
    let dimensions =
        system.virtual_joint_dimensions().into_iter().map(|dimension| match dimension {
            Dimension::Angle => length * length,
            Dimension::Length | Dimension::SquaredLength => 1.0,
        });
    DVector::from_vec(dimensions.collect())
}

/// Commanded joint coordinates, and the freedoms that the commands leave undetermined.
///
/// With the commanded joints held, the rigid mechanism may still have finite motions: a common heave, or a rod that spins between two balls.
/// Commands do not determine them, so that they are not used to save displacement of virtual joints; the joints stay as near home as closed loops allow.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandedJoints {
    /// (f) closed coordinates, virtual joints at rest (m, rad).
    home: DVector<f64>,
    coordinates: Vec<usize>,
    undetermined: usize,
    /// Whether the loops of the rigid links are open at home.
    is_open: bool,
    /// Coordinates that move least before all others do.
    least: Vec<usize>,
    /// Characteristic length of the metric (m).
    length: f64,
}

impl CommandedJoints {
    /// Commands of some coordinates of a mechanism that is at home before them.
    ///
    /// # Arguments
    /// * `home` – closed, virtual joints at rest; loops that miss are taken as closed where they are
    /// * `coordinates` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// [`Error::NoSuchQuantity`] for an index of no joint coordinate; those of [`finite_mobility`].
    pub fn new(home: &MechanismSystem<'_>, coordinates: &[usize]) -> Result<Self, Error> {
        let joints = home.coordinate_dimensions().len();
        crate::error::indices("joint coordinate", coordinates, joints)?;
        let passive = passive(joints, coordinates);
        let home = &home.clone().with_free(&passive);
        let held = DrivenCurve::new(home, &passive, None);
        let here = held.here();
        let there = ForcedClosure::new(&held, &here);
        let undetermined = finite_mobility(&there, &here, STEP_THRESHOLD)?.lower_bound;
        let (is_open, length) = (!home.is_closed(), home.characteristic_length());
        let (home, coordinates) = (home.home().rows(0, joints).into_owned(), coordinates.to_vec());
        Ok(Self { home, coordinates, undetermined, is_open, least: Vec::new(), length })
    }

    /// The same commands with coordinates that stay nearest home before all others do, such as those of motors.
    #[must_use]
    pub fn with_least(self, coordinates: &[usize]) -> Self {
        Self { least: coordinates.to_vec(), ..self }
    }

    /// Indices of the commanded coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// In how many directions the rigid mechanism can move with the commanded joints held.
    #[must_use]
    pub fn undetermined(&self) -> usize {
        self.undetermined
    }

    /// Characteristic length of the metric, that of home (m).
    #[must_use]
    pub fn characteristic_length(&self) -> f64 {
        self.length
    }

    /// A mechanism where [`relieve`] starts, with the characteristic length of home.
    ///
    /// # Arguments
    /// * `mechanism` – with any virtual joints
    /// * `values` – of the commanded coordinates (m, rad)
    ///
    /// # Errors
    /// Those of [`MechanismSystem::new`].
    pub fn system<'m>(
        &self,
        mechanism: &'m Mechanism,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<MechanismSystem<'m>, Error> {
        let start = self.start(values, mechanism.virtual_joints().len());
        MechanismSystem::new(mechanism, start)?.with_characteristic_length(self.length)
    }

    /// Home with the commanded coordinates at other values and all virtual joints at rest: where [`relieve`] starts.
    ///
    /// # Arguments
    /// * `values` – of the commanded coordinates (m, rad)
    /// * `virtual_joints` – how many the mechanism has
    #[must_use]
    pub fn start(
        &self,
        values: impl IntoIterator<Item = f64>,
        virtual_joints: usize,
    ) -> DVector<f64> {
        let mut start = self.home.clone().resize_vertically(self.home.len() + virtual_joints, 0.0);
        self.coordinates.iter().zip(values).for_each(|(&k, value)| start[k] = value);
        start
    }
}

/// Joint coordinates that are not commanded.
fn passive(joints: usize, commanded: &[usize]) -> Vec<usize> {
    (0..joints).filter(|k| !commanded.contains(k)).collect()
}

/// Finds the passive joints and the virtual joints for commanded coordinates.
///
/// # Arguments
/// * `start` – the commanded coordinates at their values, passive joints near, virtual joints at rest; see [`CommandedJoints::start`]
///
/// # Errors
/// [`Error::NotRelieved`] with what stays open, where these virtual joints cannot make the motion possible; [`Error::NotLeast`] where they can, but the least displacement was not found.
///
/// # Numerics
/// The passive joints are eliminated at each step; what is left is a least-norm problem in the virtual joints alone.
/// Rigid links that do not close have several displacements that are least nearby.
/// From an open home, the iteration starts where the passive joints close the loops best with the virtual joints at rest, so that the displacement does not depend on where home is along a motion that nearly closes.
/// Undetermined motions of the passive joints are excluded from this elimination, and bring the joints as near home as closed loops allow.
/// The characteristic length of the metric is that of the start: that of home in [`CommandedJoints::system`].
/// Joint limits are not checked: see [`super::Mechanism::beyond_limits`].
pub fn relieve(
    start: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
    solver: ReliefSolver,
) -> Result<Relief, Error> {
    let near_miss;
    let passive = passive(start.coordinate_dimensions().len(), &commanded.coordinates);
    let start = &start.clone().with_free(&passive);
    let start = if commanded.is_open {
        near_miss = start.moved_to(near_miss_at(start, &passive)?.coordinates)?;
        &near_miss
    } else {
        start
    };
    let first = relieved_from(start, commanded, solver, LONGEST_STEP)?;
    if first.residual <= CLOSURE_TOLERANCE {
        return Ok(first);
    }
    // From where the loops can be closed at all, by shorter steps.
    let free: Vec<usize> =
        (0..start.home().len()).filter(|k| !commanded.coordinates.contains(k)).collect();
    let closed = close(start, &free, MAX_ITERATIONS)?;
    if !closed.is_closed() {
        let residual = closed.residual.min(first.residual);
        let length = start.characteristic_length();
        let couplings =
            contradicted(start.kinematics(), length, start.home(), &commanded.coordinates)?;
        return Err(Error::NotRelieved { residual, allowed: CLOSURE_TOLERANCE, couplings });
    }
    let near = start.moved_to(closed.coordinates)?;
    let second = relieved_from(&near, commanded, solver, 0.1 * LONGEST_STEP)?;
    if second.residual <= CLOSURE_TOLERANCE {
        return Ok(second);
    }
    Err(Error::NotLeast { iterations: first.iterations + second.iterations })
}

/// The relief that the iteration ends with, closed or not.
fn relieved_from(
    start: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
    solver: ReliefSolver,
    longest: f64,
) -> Result<Relief, Error> {
    let f = start.coordinate_dimensions().len();
    let length = start.characteristic_length();
    let dimensions = start.kinematics().dimensions();
    let mut here = start.clone();
    let mut iterations = 0;
    let mut reached = f64::INFINITY;
    let mut relaxation = Relaxation { factor: 1.0, last: None };
    while iterations < MAX_ITERATIONS {
        iterations += 1;
        let Reduced {
            relieving,
            open,
            residual,
            j_x,
            passive_part,
            passive,
            rank,
            of_passive,
            roots,
        } = reduced(&here, commanded)?;
        let y = here.at_home().virtual_joints.component_mul(&roots);
        let (decomposition, relieving_rank) = decomposed(&relieving, &j_x)?;
        let mut step = match solver {
            ReliefSolver::LeastNorm => {
                decomposition.solve(&(&relieving * &y - &open * &residual), relieving_rank) - &y
            }
            ReliefSolver::Newton => -decomposition.solve(&(&open * &residual), relieving_rank),
        };
        let mut follow = -passive_part.solve(&(&residual + &j_x * &step), rank);
        // Undetermined motions return home.
        let idle = passive_part.null_space(rank);
        let mut homeward = 0.0;
        if commanded.undetermined > 0 && idle.ncols() == commanded.undetermined {
            let away = off_home(&here, commanded, &passive).component_div(&of_passive);
            let by = to_home(&idle, &away, commanded, &passive)?;
            homeward = by.norm();
            follow -= relaxation.relaxed(by);
        }
        // Long slides are as straight as short ones; turns are not.
        let by_virtual_joints = step.component_div(&roots);
        let moved = passive.iter().copied().zip(follow.iter());
        let moved = moved.chain((f..).zip(by_virtual_joints.iter()));
        let turns = moved.filter(|&(k, _)| dimensions[k] == Dimension::Angle);
        let turned = turns.map(|(_, by)| by * by).sum::<f64>().sqrt();
        if turned > longest {
            follow *= longest / turned;
            step *= longest / turned;
        }
        let mut by = DVector::zeros(here.home().len());
        for (&k, value) in passive.iter().zip(follow.component_mul(&of_passive).iter()) {
            by[k] = *value;
        }
        by.rows_mut(f, roots.len()).copy_from(&step.component_div(&roots));
        here = here.moved(&by)?;
        let after = here.mismatch(&here.at_home());
        // By stiffness, a displacement of one length has a size of many.
        let unit = length * roots.iter().copied().fold(1.0, f64::max);
        let settled = step.norm() <= SETTLED * unit.max(y.norm()) && homeward <= AT_HOME;
        let stop = !after.is_finite() || (settled && (after >= reached || after < 1e-15));
        reached = after;
        if stop {
            break;
        }
    }
    let residual = if reached.is_nan() { f64::INFINITY } else { reached };
    Ok(Relief::of(&here, residual, iterations))
}

/// Relaxation of the steps toward home of the undetermined motions.
///
/// A full step neglects the curvature of the motions: where that is large, full steps overshoot more and more.
/// Each factor is the one with which the last step would have ended at home, judged by the change that it made.
///
/// # Source
/// Aitken's Δ² for vectors, \[IronsTuck\]
struct Relaxation {
    factor: f64,
    /// The last full step.
    last: Option<DVector<f64>>,
}

impl Relaxation {
    /// A full step times the factor.
    fn relaxed(&mut self, full: DVector<f64>) -> DVector<f64> {
        if let Some(last) = self.last.take().filter(|last| last.len() == full.len()) {
            let change = &last - &full;
            let factor = self.factor * last.dot(&change) / change.norm_squared();
            // Negative where a motion leads away from home, and no number where nothing changed.
            if factor > 0.0 && factor.is_finite() {
                self.factor = factor.clamp(LEAST_FACTOR, LARGEST_FACTOR);
            }
        }
        let relaxed = &full * self.factor;
        self.last = Some(full);
        relaxed
    }
}

/// (p) the part of the displacement from home that undetermined motions can undo: first of the coordinates that are to move least, then of all.
///
/// # Arguments
/// * `idle` – (p, u) orthonormal undetermined motions
/// * `away` – (p) displacement from home
fn to_home(
    idle: &DMatrix<f64>,
    away: &DVector<f64>,
    commanded: &CommandedJoints,
    passive: &[usize],
) -> Result<DVector<f64>, Error> {
    let least = |(row, k): (usize, &usize)| commanded.least.contains(k).then_some(row);
    let rows: Vec<usize> = passive.iter().enumerate().filter_map(least).collect();
    if rows.is_empty() {
        return Ok(idle * (idle.transpose() * away));
    }
    let of_least = svd(&idle.select_rows(&rows))?;
    // The motions are of unit length: a share that vanishes does so by round-off.
    let rank = of_least.singular_values.iter().filter(|&&value| value > RELIEF_THRESHOLD).count();
    let first = idle * of_least.solve(&away.select_rows(&rows), rank);
    let others = idle * of_least.null_space(rank);
    let second = &others * (others.transpose() * (away - &first));
    Ok(first + second)
}

/// (p) how far passive joints are from home (m, rad); for a ball, the rotation vector from there to here in the turned frame.
fn off_home(
    here: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
    passive: &[usize],
) -> DVector<f64> {
    let away = here.kinematics().displacement(&commanded.home, here.home());
    DVector::from_iterator(passive.len(), passive.iter().map(|&k| away[k]))
}

/// (f + M, n) motion of all coordinates for a radian or characteristic length of each commanded one: virtual joints by least norm, undetermined motions at rest; in radians and characteristic lengths.
///
/// The curvature of the least displacement is neglected.
pub(super) fn rates(
    here: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
) -> Result<DMatrix<f64>, Error> {
    let (f, length) = (here.coordinate_dimensions().len(), here.characteristic_length());
    let Reduced { relieving, open, j_x, passive_part, passive, rank, roots, .. } =
        reduced(here, commanded)?;
    let rows = units(&here.constraint_dimensions(), length);
    let columns = units(here.kinematics().dimensions(), length);
    let of_commanded = columns.select_rows(&commanded.coordinates);
    let jacobian = here.full_jacobian(&here.at_home()).select_columns(&commanded.coordinates);
    let pull = scaled_jacobian(&jacobian, &rows, &of_commanded);
    let (decomposition, relieving_rank) = decomposed(&relieving, &j_x)?;
    let mut rates = DMatrix::zeros(here.home().len(), commanded.coordinates.len());
    for (column, &k) in commanded.coordinates.iter().enumerate() {
        rates[(k, column)] = 1.0;
        let pull = pull.column(column).into_owned();
        let relief = -decomposition.solve(&(&open * &pull), relieving_rank);
        let follow = -passive_part.solve(&(pull + &j_x * &relief), rank);
        passive.iter().zip(follow.iter()).for_each(|(&k, by)| rates[(k, column)] = *by);
        for (m, by) in relief.component_div(&roots).iter().enumerate() {
            rates[(f + m, column)] = by / columns[f + m];
        }
    }
    Ok(rates)
}

/// Mismatch that the passive joints leave open, and the effect of the virtual joints on it.
pub(super) struct Reduced {
    /// (open, M) effect of the virtual joints, in their metric, on the open mismatch.
    pub(super) relieving: DMatrix<f64>,
    /// (open, c) the combinations of constraints that no passive joint can change.
    open: DMatrix<f64>,
    residual: DVector<f64>,
    j_x: DMatrix<f64>,
    passive_part: Svd,
    passive: Vec<usize>,
    /// Singular values of the passive part that are used.
    rank: usize,
    of_passive: DVector<f64>,
    /// (M) y = root · x is in the metric.
    pub(super) roots: DVector<f64>,
}

/// The effect of the virtual joints that passive joints leave, and its rank: below a share of the whole effect it is round-off, also where nothing else is left.
fn decomposed(relieving: &DMatrix<f64>, whole: &DMatrix<f64>) -> Result<(Svd, usize), Error> {
    let decomposition = svd(relieving)?;
    let longest = whole.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let least = RELIEF_THRESHOLD * decomposition.largest().max(longest);
    let rank = decomposition.singular_values.iter().filter(|&&value| value > least).count();
    Ok((decomposition, rank))
}

pub(super) fn reduced(
    here: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
) -> Result<Reduced, Error> {
    let (f, total) = (here.coordinate_dimensions().len(), here.home().len());
    let passive = passive(f, &commanded.coordinates);
    let virtuals: Vec<usize> = (f..total).collect();
    let rows = units(&here.constraint_dimensions(), here.characteristic_length());
    let columns = units(here.kinematics().dimensions(), here.characteristic_length());
    let of_passive = DVector::from_iterator(passive.len(), passive.iter().map(|&k| columns[k]));
    let roots = virtual_weights(here).map(f64::sqrt);
    let at = here.at_home();
    let residual = scaled_residual(&here.residual(&at), &rows);
    let jacobian = here.full_jacobian(&at);
    let j_p = scaled_jacobian(&jacobian.select_columns(&passive), &rows, &of_passive);
    let per_metric = roots.map(|root| 1.0 / root);
    let j_x = scaled_jacobian(&jacobian.select_columns(&virtuals), &rows, &per_metric);
    let passive_part = svd(&j_p)?;
    // Loops that are open, and virtual joints that turn a guide, tie undetermined motions a little: they are the least singular values.
    let determined = passive.len().saturating_sub(commanded.undetermined);
    let rank = passive_part.rank(RELIEF_THRESHOLD).min(determined);
    let open = passive_part.left_null_space(rank).transpose();
    let relieving = &open * &j_x;
    Ok(Reduced { relieving, open, residual, j_x, passive_part, passive, rank, of_passive, roots })
}
