//! Positions of a mechanism for many values of its commanded coordinates, each from the one before it.

use nalgebra::DVector;

use super::description::Mechanism;
use super::home::close_at_rest;
use super::kinematics::Kinematics;
use super::motion::{LONGEST_STEP, SHORTEST_STEP, on_branch};
use super::position::{DifferentialKinematics, PositionSolver};
use super::relief::{CommandedJoints, ReliefSolver};
use super::system::MechanismSystem;
use crate::Error;
use crate::bulk::{Status, StatusCounts};
use crate::constraint::{System as _, units};

/// First step toward values far away, and distance of values that are near, in radians and characteristic lengths.
const FIRST_STEP: f64 = 0.1;
/// Distance up to which the next values are followed, which takes a thousand steps, in radians and characteristic lengths.
const FARTHEST: f64 = 100.0;
/// Longest step where motions of links are undetermined, so that there is no tangent to follow.
pub(super) const STEP_WITHOUT_TANGENT: f64 = 0.05;

/// Closes the loops of one mechanism for values of its commanded coordinates, again and again; virtual joints take their least displacement.
///
/// One value serves one thread; clone it for more.
#[derive(Debug, Clone)]
pub struct CommandedPositions {
    solver: PositionSolver,
    kinematics: DifferentialKinematics,
    /// Characteristic length of `kinematics` (m).
    length: f64,
    /// Only where commands leave motions undetermined, which must not save displacement of virtual joints.
    undetermined: Option<CommandedJoints>,
}

impl CommandedPositions {
    /// Lays out the solution for given commanded coordinates.
    ///
    /// # Arguments
    /// * `first` – (f + M) a configuration whose loops are closed, or nearly so; determines the characteristic length, except where commands leave motions undetermined (m, rad)
    /// * `commanded` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// [`Error::PartlyCommanded`]; [`Error::TooLarge`] beyond dense algebra; those of [`close_at_rest`] and [`CommandedJoints::new`].
    pub fn new(
        mechanism: &Mechanism,
        first: &DVector<f64>,
        commanded: &[usize],
    ) -> Result<Self, Error> {
        let system = MechanismSystem::new(mechanism, first.clone())?;
        let undetermined = if mechanism.virtual_joints().is_empty() {
            None
        } else {
            // Where rigid links do not close, virtual joints at rest are those of the first configuration.
            let home = match close_at_rest(mechanism, None) {
                Ok(home) => home.coordinates,
                Err(Error::NotAssembled(_)) => {
                    let mut home = first.clone();
                    let joints = mechanism.joint_freedoms();
                    home.rows_range_mut(joints..).fill(0.0);
                    home
                }
                Err(error) => return Err(error),
            };
            let joints = CommandedJoints::new(&MechanismSystem::new(mechanism, home)?, commanded)?;
            Some(joints).filter(|joints| joints.undetermined() > 0)
        };
        let system = match &undetermined {
            Some(joints) => system.with_characteristic_length(joints.characteristic_length())?,
            None => system,
        };
        Ok(Self { undetermined, ..Self::determined(&system, commanded)? })
    }

    /// Lays out the solution for commands that determine all motions, in the metric of a system.
    pub(super) fn determined(
        system: &MechanismSystem<'_>,
        commanded: &[usize],
    ) -> Result<Self, Error> {
        let solver = PositionSolver::new(system, commanded)?;
        let kinematics = DifferentialKinematics::new(system, commanded)?;
        let length = system.characteristic_length();
        Ok(Self { solver, kinematics, length, undetermined: None })
    }

    /// Closes the loops; returns the residual, in radians and characteristic lengths.
    ///
    /// # Arguments
    /// * `mechanism` – that of [`new`](Self::new)
    /// * `values` – of the commanded coordinates (m, rad)
    /// * `coordinates` – (f + M) a configuration nearby; takes the solution, and is unspecified after an error (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NotReached`]; where commands leave motions undetermined, those of [`super::relieve`].
    ///
    /// # Numerics
    /// Joint limits are not checked: see [`Mechanism::beyond_limits`].
    /// Allocates nothing, except where commands leave motions undetermined.
    pub fn solve(
        &mut self,
        mechanism: &Mechanism,
        values: &[f64],
        coordinates: &mut DVector<f64>,
        solver: ReliefSolver,
    ) -> Result<f64, Error> {
        let commanded = self.kinematics.commanded();
        if values.len() != commanded.len() {
            let (what, expected) = ("the vector of commanded values", commanded.len());
            return Err(Error::LengthMismatch { what, found: values.len(), expected });
        }
        match &self.undetermined {
            None => {
                let all = self.kinematics.coordinate_count();
                if coordinates.len() != all {
                    let (what, found) = ("the coordinate vector", coordinates.len());
                    return Err(Error::LengthMismatch { what, found, expected: all });
                }
                commanded.iter().zip(values).for_each(|(&k, &value)| coordinates[k] = value);
                Ok(self.solver.solve(coordinates.as_mut_slice(), solver)?.residual)
            }
            Some(joints) => {
                let relief = joints.relieve(mechanism, values.iter().copied(), solver)?;
                *coordinates = relief.coordinates;
                Ok(relief.residual)
            }
        }
    }

    /// Closes the loops for many configurations, which are independent of each other; rows without a solution are NaN.
    ///
    /// # Arguments
    /// * `mechanism` – that of [`new`](Self::new)
    /// * `rows` – (configurations, f + M) by rows; of each row the commanded coordinates at their values, the others near; takes the solutions (m, rad)
    /// * `residuals` – (configurations) takes the largest mismatches, in radians and characteristic lengths
    /// * `status` – (configurations) whether each is solved, or the reason why not
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] unless all have the same number of configurations; where commands leave motions undetermined, those of [`super::relieve`] that concern all rows alike.
    ///
    /// # Numerics
    /// As [`PositionSolver::solve_many`]; where there are virtual joints, row by row as [`solve`](Self::solve).
    pub fn solve_many(
        &mut self,
        mechanism: &Mechanism,
        rows: &mut [f64],
        solver: ReliefSolver,
        residuals: &mut [f64],
        status: &mut [Status],
    ) -> Result<StatusCounts, Error> {
        let width = self.kinematics.coordinate_count();
        if self.undetermined.is_none()
            || rows.len() != width * status.len()
            || residuals.len() != status.len()
        {
            return self.solver.solve_many(rows, solver, residuals, status);
        }
        let commanded = self.kinematics.commanded().to_vec();
        let results = residuals.iter_mut().zip(&mut *status);
        for (row, (residual, status)) in rows.chunks_exact_mut(width).zip(results) {
            let values: Vec<f64> = commanded.iter().map(|&k| row[k]).collect();
            let mut coordinates = DVector::from_column_slice(row);
            (*residual, *status) = match self.solve(mechanism, &values, &mut coordinates, solver) {
                Ok(residual) => (residual, Status::Solved),
                Err(error) => {
                    coordinates.fill(f64::NAN);
                    (f64::NAN, Status::from_error(&error).ok_or(error)?)
                }
            };
            row.copy_from_slice(coordinates.as_slice());
        }
        Ok(StatusCounts::of(status))
    }

    /// Closes the loops for values of the next configuration: at once where they are near those of the present one, as [`solve`](Self::solve), else on its branch, as [`follow`](Self::follow).
    ///
    /// # Arguments
    /// As [`follow`](Self::follow).
    ///
    /// # Errors
    /// Those of [`follow`](Self::follow).
    ///
    /// # Numerics
    /// Values are near if each differs by 0.1 rad or characteristic lengths at most, and not followed beyond 100 of them.
    pub fn solve_next(
        &mut self,
        mechanism: &Mechanism,
        values: &[f64],
        coordinates: &mut DVector<f64>,
        solver: ReliefSolver,
    ) -> Result<f64, Error> {
        let distance = |(&k, value): (&usize, &f64)| {
            // Lengths that are not those of the mechanism are errors of the solution.
            let by = coordinates.get(k).map_or(0.0, |here| (value - here).abs());
            by / self.kinematics.unit_of(k)
        };
        let farthest =
            self.kinematics.commanded().iter().zip(values).map(distance).fold(0.0, f64::max);
        if farthest <= FIRST_STEP || !farthest.is_finite() {
            self.solve(mechanism, values, coordinates, solver)
        } else if farthest <= FARTHEST || self.undetermined.is_some() {
            self.follow(mechanism, values, coordinates, solver)
        } else {
            Err(Error::NotFollowed { share: 0.0 })
        }
    }

    /// Closes the loops for values far from a configuration, on the branch that the motion toward them stays on; returns the residual, in radians and characteristic lengths.
    ///
    /// The commanded coordinates move along a straight line to their values, all at the same time.
    /// The result depends on the configuration and on the values, not on earlier calls.
    ///
    /// # Arguments
    /// * `mechanism` – that of [`new`](Self::new)
    /// * `values` – of the commanded coordinates (m, rad)
    /// * `coordinates` – (f + M) a closed configuration; takes the solution, or the last configuration on the path (m, rad)
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve), [`Error::NotFollowed`].
    ///
    /// # Numerics
    /// Tangent steps, corrected by [`PositionSolver`]; a step is halved until its correction is small against it, as in [`super::drive`].
    /// Singular configurations are not looked for.
    /// Where commands leave motions undetermined and there are virtual joints, [`solve`](Self::solve) is independent of the start, and called at once.
    pub fn follow(
        &mut self,
        mechanism: &Mechanism,
        values: &[f64],
        coordinates: &mut DVector<f64>,
        solver: ReliefSolver,
    ) -> Result<f64, Error> {
        let commanded = self.kinematics.commanded().to_vec();
        let all = self.kinematics.coordinate_count();
        if self.undetermined.is_some()
            || values.len() != commanded.len()
            || coordinates.len() != all
            || values.iter().any(|value| !value.is_finite())
        {
            return self.solve(mechanism, values, coordinates, solver);
        }
        let kinematics = Kinematics::new(mechanism);
        let scales = units(kinematics.dimensions(), self.length);
        let joints = mechanism.joint_freedoms();
        let size = |by: &DVector<f64>| {
            by.iter().zip(scales.iter()).map(|(value, scale)| (value / scale).powi(2)).sum::<f64>()
        };
        let size = |by: &DVector<f64>| size(by).sqrt();
        let from: Vec<f64> = commanded.iter().map(|&k| coordinates[k]).collect();
        let path: Vec<f64> = values.iter().zip(&from).map(|(to, from)| to - from).collect();
        let mut of_commanded = DVector::zeros(all);
        commanded.iter().zip(&path).for_each(|(&k, &by)| of_commanded[k] = by);
        let length = size(&of_commanded);
        let (mut share, mut step) = (0.0, (FIRST_STEP / length).min(1.0));
        let mut rates = DVector::zeros(all);
        loop {
            let tangent = self
                .kinematics
                .linearize(coordinates.as_slice())
                .and_then(|()| self.kinematics.velocities(&path, rates.as_mut_slice()));
            let has_tangent = tangent.is_ok();
            if !has_tangent {
                rates.copy_from(&of_commanded);
                step = step.min(STEP_WITHOUT_TANGENT / length);
            }
            loop {
                let end = if share + step < 1.0 { share + step } else { 1.0 };
                let by = &rates * (end - share);
                let predicted = kinematics.moved(coordinates, &by);
                let at: Vec<f64> = match end < 1.0 {
                    true => from.iter().zip(&path).map(|(from, path)| from + end * path).collect(),
                    false => values.to_vec(),
                };
                let mut there = predicted.clone();
                let found = self.solve(mechanism, &at, &mut there, solver);
                let mut correction = &there - &predicted;
                let of_joints = kinematics.displacement(&predicted, &there);
                correction.rows_mut(0, joints).copy_from(&of_joints);
                let (correction, size) = (size(&correction), size(&by));
                let stayed = match has_tangent {
                    true => on_branch(correction, size) && size < LONGEST_STEP,
                    false => correction < LONGEST_STEP,
                };
                if let (Ok(residual), true) = (&found, stayed) {
                    *coordinates = there;
                    if end >= 1.0 {
                        return Ok(*residual);
                    }
                    (share, step) = (end, 2.0 * step);
                    break;
                }
                step *= 0.5;
                if step < SHORTEST_STEP {
                    return Err(Error::NotFollowed { share });
                }
            }
        }
    }

    /// Derivatives by the commanded coordinates at a configuration that [`solve`](Self::solve) found last by least norm.
    ///
    /// # Errors
    /// Those of [`DifferentialKinematics::linearize`].
    pub fn linearize(
        &mut self,
        coordinates: &DVector<f64>,
    ) -> Result<&mut DifferentialKinematics, Error> {
        self.kinematics.linearize(coordinates.as_slice())?;
        Ok(&mut self.kinematics)
    }
}
