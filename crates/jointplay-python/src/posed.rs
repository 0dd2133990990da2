//! Closed configurations of a mechanism for commanded coordinates.

use jointplay::Error;
use jointplay::mechanism::{
    Closure, CommandedJoints, DrivePath, DrivenMotion, MechanismSystem, Relief, ReliefSolver,
    SparseSystem, Unassembled, assemble, drive_along, drive_relieved, guess, relieve,
};
use jointplay::nalgebra::DVector;

use crate::mechanism::PyMechanism;

/// Other starts tried where the guess of a file does not close.
pub(crate) const STARTS: usize = 30;
/// Corrections at most of a mechanism with many loops, which is closed from its guess or not at all.
const CORRECTIONS: usize = 200;

/// A closed configuration, virtual joints displaced where they had to be.
pub(crate) struct Posed {
    /// (f + M) (m, rad).
    pub(crate) values: DVector<f64>,
    pub(crate) residual: f64,
    pub(crate) iterations: usize,
}

impl PyMechanism {
    /// Whether the mechanism is small enough for dense algebra.
    pub(crate) fn is_dense(&self) -> bool {
        MechanismSystem::fits(&self.file.mechanism)
    }

    /// The guesses of the file, with these coordinates at their values.
    pub(crate) fn start(&self, commands: &[(usize, f64)]) -> DVector<f64> {
        let mut start = guess(&self.file.mechanism);
        commands.iter().for_each(|&(k, value)| start[k] = value);
        start
    }

    /// The closed configuration nearest the guesses, with these coordinates held.
    pub(crate) fn assembled(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
    ) -> Result<Closure, Error> {
        self.closed(commands, tolerance, |found| found.accepted(tolerance))
    }

    /// The closed configuration with these coordinates held: from the guesses, or an accepted one.
    fn closed(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
        accepted: impl Fn(&Unassembled) -> Option<&Closure>,
    ) -> Result<Closure, Error> {
        if !self.is_dense() && tolerance.is_none() {
            return self.sparse(commands).map(|(system, iterations)| system.closure(iterations));
        }
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        match assemble(&self.file.mechanism, &self.start(commands), &held, STARTS) {
            Err(Error::NotAssembled(found)) => match found.accepted(tolerance) {
                Some(closure) => Ok(closure.clone()),
                None => Err(Error::NotAssembled(found)),
            },
            other => other,
        }
    }

    /// The same by sparse algebra, and the corrections done.
    pub(crate) fn sparse(
        &self,
        commands: &[(usize, f64)],
    ) -> Result<(SparseSystem<'_>, usize), Error> {
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let mut system = SparseSystem::new(&self.file.mechanism, self.start(commands))?;
        let iterations = system.close(&held, CORRECTIONS)?;
        Ok((system, iterations))
    }

    /// The closed configuration with these coordinates held, by virtual joints where it takes them.
    pub(crate) fn posed(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
    ) -> Result<Posed, Error> {
        let has_play = !self.file.mechanism.virtual_joints().is_empty();
        let is_relieved = has_play && !commands.is_empty();
        // Play near the guess, rather than another configuration far from it.
        let within =
            |found: &Unassembled| tolerance.and_then(|tolerance| found.within(tolerance)).is_some();
        let closed = self.closed(commands, tolerance, |found| {
            found.accepted(tolerance).filter(|_| !is_relieved || within(found))
        });
        match closed {
            Err(Error::NotAssembled(_)) if is_relieved => {
                let Relief { coordinates, residual, iterations, .. } = self.relieved(commands)?;
                Ok(Posed { values: coordinates, residual, iterations })
            }
            closed => closed.map(|closed| Posed {
                values: closed.coordinates,
                residual: closed.residual,
                iterations: closed.iterations,
            }),
        }
    }

    /// Least displacement of the virtual joints that makes the commanded coordinates possible.
    pub(crate) fn relieved(&self, commands: &[(usize, f64)]) -> Result<Relief, Error> {
        let (coordinates, values): (Vec<usize>, Vec<f64>) = commands.iter().copied().unzip();
        let commanded = self.commanded(&coordinates)?;
        self.relieved_at(&commanded, values, ReliefSolver::LeastNorm)
    }

    /// Commands of some coordinates, from the closed configuration nearest the guesses of the file.
    pub(crate) fn commanded(&self, coordinates: &[usize]) -> Result<CommandedJoints, Error> {
        let home = self.assembled(&[], None)?.coordinates;
        CommandedJoints::new(&MechanismSystem::new(&self.file.mechanism, home)?, coordinates)
    }

    /// The relief for values of commanded coordinates (m, rad).
    pub(crate) fn relieved_at(
        &self,
        commanded: &CommandedJoints,
        values: impl IntoIterator<Item = f64>,
        solver: ReliefSolver,
    ) -> Result<Relief, Error> {
        let mechanism = &self.file.mechanism;
        let start = commanded.start(values, mechanism.virtual_joints().len());
        relieve(&MechanismSystem::new(mechanism, start)?, commanded, solver)
    }

    /// Drives along a path: by dense algebra with virtual joints, or by sparse algebra if there are many loops.
    pub(crate) fn along(
        &self,
        from: &DVector<f64>,
        path: &DrivePath,
        held: &[usize],
        steps: usize,
    ) -> Result<DrivenMotion, Error> {
        let mechanism = &self.file.mechanism;
        if !self.is_dense() {
            let system = SparseSystem::new(mechanism, from.clone())?;
            return system.drive_along(path, held, steps, &mut |_| ());
        }
        let driven = path.coordinates();
        let free: Vec<usize> = (0..mechanism.joint_freedoms())
            .filter(|k| !driven.contains(k) && !held.contains(k))
            .collect();
        let system = MechanismSystem::new(mechanism, from.clone())?;
        if mechanism.virtual_joints().is_empty() {
            drive_along(&system, path, &free, steps, &mut |_| ())
        } else {
            let home = MechanismSystem::new(mechanism, self.assembled(&[], None)?.coordinates)?;
            drive_relieved(&home, &system, path, &free, steps, &mut |_| ())
        }
    }
}
