//! Closed configurations of a mechanism for commanded coordinates.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use jointplay::Error;
use jointplay::mechanism::{
    Closure, DrivePath, DrivenMotion, MechanismSystem, Relief, close_at_rest, drive_from,
    pose_commanded, relieve_commanded,
};
use jointplay::nalgebra::DVector;
use pyo3::prelude::*;

use crate::mechanism::PyMechanism;

impl PyMechanism {
    /// Whether the mechanism is small enough for dense algebra.
    pub(crate) fn is_dense(&self) -> bool {
        MechanismSystem::fits(&self.file.mechanism)
    }

    /// The configuration that displacements of virtual joints are counted from.
    pub(crate) fn at_rest(&self) -> Result<Closure, Error> {
        close_at_rest(&self.file.mechanism, None)
    }

    /// The closed configuration with these coordinates held, by virtual joints where it takes them.
    pub(crate) fn posed(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
    ) -> Result<Closure, Error> {
        Ok(pose_commanded(&self.file.mechanism, commands, tolerance)?.closed)
    }

    /// Least displacement of the virtual joints that makes the commanded coordinates possible.
    pub(crate) fn relieved(&self, commands: &[(usize, f64)]) -> Result<Relief, Error> {
        relieve_commanded(&self.file.mechanism, commands, None)
    }

    /// Drives along a path: by dense algebra with virtual joints, or by sparse algebra if there are many loops.
    pub(crate) fn along(
        &self,
        from: &DVector<f64>,
        path: &DrivePath,
        held: &[usize],
        steps: usize,
    ) -> Result<DrivenMotion, Error> {
        drive_from(&self.file.mechanism, from, path, held, steps, None, &mut signals())
    }
}

/// Time between two looks at whether a signal came.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(50);

/// Ends a motion where a signal of Python raises an exception, which [`crate::errors::core`] passes on.
fn signals() -> impl FnMut(usize) -> ControlFlow<()> {
    let mut last = Instant::now();
    move |_| {
        if last.elapsed() < BETWEEN_SIGNALS {
            return ControlFlow::Continue(());
        }
        last = Instant::now();
        Python::attach(|py| match py.check_signals() {
            Ok(()) => ControlFlow::Continue(()),
            Err(raised) => {
                raised.restore(py);
                ControlFlow::Break(())
            }
        })
    }
}
