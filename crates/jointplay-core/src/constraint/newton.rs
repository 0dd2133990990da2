//! Parts that the Newton and Gauss–Newton iterations of the crate share, and how the iterations differ.
//!
//! | iteration | unknowns | step | ends |
//! | --- | --- | --- | --- |
//! | `mechanism::close` | free joint coordinates, re-based after each step | damped by the residual, refused where it drifts along undetermined motions | at round-off, or at the bottom of a valley |
//! | near misses | displacement | stiff motions only, then minima of a quadratic model of the soft ones | where no step lowers the residual |
//! | `mobility` corrections | displacement, also on a sphere | damped by the residual, until it lowers the residual | at round-off, or after several steps without a gain |
//! | near mobility | coordinates orthogonal to a motion | damped by the residual, halved by [`backtrack`] | at the least residual, which need not be zero |
//! | curves and continuation | displacement | [`newton_at_rank`] | at a given residual |
//! | `SparseSystem::close` | link twists and coordinates | undamped sparse least squares, halved by [`backtrack`] | below a hundredth of the closure tolerance |
//! | `relieve` | passive and virtual joints | least displacement of the virtual joints | as the virtual joints settle |
//! | `PositionSolver`, `virtualization::solve` | the same, without allocation | the same | the same |
//!
//! Damping and ends are different rules and not different constants of one rule, and published results depend on them to the last bit.

use nalgebra::DVector;

use super::{Configuration, ScaledSystem, System};
use crate::Error;
use crate::linalg::Svd;

/// When [`newton_at_rank`] ends.
pub(crate) struct NewtonLimits {
    /// Rank of the Jacobian: singular values beyond it are not used.
    pub(crate) rank: usize,
    /// Largest number of corrections.
    pub(crate) corrections: usize,
}

/// Newton's method with the shortest corrections at a fixed rank: the displacement found, and the decomposition there.
///
/// # Arguments
/// * `start` – dimensionless displacement from `from`
/// * `residual` – dimensionless residual at a configuration
/// * `closed_below` – largest entry of the residual that ends the iteration at a configuration
/// * `admissible` – whether to go on from a displacement; NaN has to be refused
pub(crate) fn newton_at_rank<S: System + ?Sized>(
    system: &ScaledSystem<'_, S>,
    from: &Configuration,
    start: DVector<f64>,
    limits: &NewtonLimits,
    residual: impl Fn(&Configuration) -> DVector<f64>,
    closed_below: impl Fn(&Configuration) -> f64,
    admissible: impl Fn(&DVector<f64>) -> bool,
) -> Result<Option<(DVector<f64>, Svd)>, Error> {
    let mut by = start;
    for _ in 0..limits.corrections {
        let at = system.displaced(from, &by);
        let residual = residual(&at);
        let decomposition = system.decomposed(&at)?;
        if residual.amax() <= closed_below(&at) {
            return Ok(Some((by, decomposition)));
        }
        by -= decomposition.solve(&residual, limits.rank);
        if !admissible(&by) {
            break;
        }
    }
    Ok(None)
}

/// A step that lowers a residual.
pub(crate) struct Gain<T> {
    /// State after the step.
    pub(crate) there: T,
    /// The residual there.
    pub(crate) residual: f64,
}

/// Halves a step until it lowers the residual; `None` where none of `attempts` does.
///
/// # Arguments
/// * `before` – the residual to go below
/// * `step` – what a share of the full step leads to, and the residual there
pub(crate) fn backtrack<T>(
    attempts: usize,
    before: f64,
    mut step: impl FnMut(f64) -> (T, f64),
) -> Option<Gain<T>> {
    let mut share = 1.0;
    for _ in 0..attempts {
        let (there, residual) = step(share);
        if residual < before {
            return Some(Gain { there, residual });
        }
        share *= 0.5;
    }
    None
}
