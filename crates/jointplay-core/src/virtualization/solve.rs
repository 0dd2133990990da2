//! From the sides of the triangle of ball centres to the displacements of the virtual joints.

use nalgebra::Vector3;

use super::{
    MAX_VIRTUAL_JOINTS, Metric, Platform, Sides, Sockets, VirtualJoints, Virtualization, sides_of,
};
use crate::Error;
use crate::error::Unconverged;
use crate::linalg::least_norm_of_three;

/// Which displacements, of all that produce the sides, are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// The paper's iteration from the nominal X: a solution near, not at, the least displacement; two or three steps.
    Newton,
    /// The exact least displacement in the metric, by iteration; a few steps more.
    LeastNorm,
    /// The exact least displacement in closed form; where the virtualization has none, [`Self::LeastNorm`].
    #[default]
    ClosedForm,
}

impl std::fmt::Display for Solver {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(match self {
            Self::Newton => "newton",
            Self::LeastNorm => "least-norm",
            Self::ClosedForm => "closed-form",
        })
    }
}

/// How the displacements are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    /// Which solution, and how.
    pub solver: Solver,
    /// How angles weigh against lengths.
    pub metric: Metric,
    /// Most iterations before giving up.
    ///
    /// Newton takes 3 within ±2°; least norm gains a constant factor a step and takes up to 32 at 5° with the offset virtualization.
    pub max_iterations: usize,
    /// Largest side error that counts as solved, as a share of the longest side.
    ///
    /// 10⁻¹³ is a few hundred times round-off, and 10⁻¹¹ mm on a wafer robot.
    pub relative_threshold: f64,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            solver: Solver::default(),
            metric: Metric::default(),
            max_iterations: 200,
            relative_threshold: 1e-13,
        }
    }
}

/// Displacements of the virtual joints, with their evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// X, in the order of the virtualization's joints ([m], [rad]).
    pub virtual_joints: VirtualJoints,
    /// What was used: differs from the solver asked for where a closed form does not exist.
    pub solver: Solver,
    /// ρ of the metric [m].
    pub characteristic_length: f64,
    /// Iterations done, 0 for a closed form.
    pub iterations: usize,
    /// Largest difference between a side and its virtual length [m].
    pub residual: f64,
}

/// Finds X with F(X, L) = 0, F_ij = |p_j(X) − p_i(X)|² − L_ij², always from the nominal X.
///
/// ```text
///    newton:      X ← X   −  J† F
///    least norm:  X ← X_0 +  J† (J (X − X_0) − F)        J = ∂F/∂X,  J† = W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹,  W: the metric
/// ```
/// Newton is the paper's X ← X + ∂X/∂L (L − L(X)) with ∂F/∂L = −2 diag(L) taken half way between L(X) and L, which makes it exact for the squares in F.
/// A start at the last pose instead would make the answer depend on the path.
///
/// # Arguments
/// * `sides` – L_12, L_23, L_31 [m]
///
/// # Errors
/// [`Error::NotConverged`] with the best iterate, [`Error::VirtualJointCount`], [`Error::OutOfRange`] for the metric.
///
/// # Numerics
/// Does not allocate. Newton ends where the sides agree, least norm where also the step is at the threshold.
///
/// # Source
/// newton: [Virtualization], eq. (6)–(8); least norm: Gauss–Newton on the displacement, own derivation, `docs/theory.md`
#[inline]
pub fn solve<V: Virtualization + ?Sized>(
    virtualization: &V,
    platform: &Platform,
    sides: &Sides,
    options: &SolveOptions,
) -> Result<Solution, Error> {
    let count = virtualization.joints().len();
    if !(3..=MAX_VIRTUAL_JOINTS).contains(&count) {
        return Err(Error::VirtualJointCount { found: count, min: 3, max: MAX_VIRTUAL_JOINTS });
    }
    let characteristic_length = options.metric.characteristic_length(platform)?;
    if options.solver == Solver::ClosedForm {
        let mut x = VirtualJoints::zeros(count);
        if virtualization.closed_form(platform, sides, &mut x) {
            let gaps = side_gaps(sides, &sides_of(&virtualization.sockets(platform, &x)));
            let (threshold, residual) = (threshold(sides, options), largest(&gaps));
            return accept(x, Solver::ClosedForm, characteristic_length, 0, residual, threshold);
        }
    }
    let solver = if options.solver == Solver::Newton { Solver::Newton } else { Solver::LeastNorm };
    iterate(virtualization, platform, sides, options, solver, characteristic_length)
}

fn iterate<V: Virtualization + ?Sized>(
    virtualization: &V,
    platform: &Platform,
    sides: &Sides,
    options: &SolveOptions,
    solver: Solver,
    characteristic_length: f64,
) -> Result<Solution, Error> {
    let joints = virtualization.joints();
    let count = joints.len();
    let mut compliance = [1.0; MAX_VIRTUAL_JOINTS];
    for (c, joint) in compliance.iter_mut().zip(joints) {
        let weight = joint.motion.weight(characteristic_length);
        *c = 1.0 / (weight * weight);
    }
    let threshold = threshold(sides, options);
    let mut nominal = VirtualJoints::zeros(count);
    virtualization.nominal(platform, &mut nominal);
    let mut x = nominal;
    let mut step = VirtualJoints::zeros(count);
    let mut velocities = [Sockets::default(); MAX_VIRTUAL_JOINTS];
    let mut columns = [Vector3::zeros(); MAX_VIRTUAL_JOINTS];
    let (mut best, mut least) = (x, f64::INFINITY);
    let mut settled = solver == Solver::Newton;
    for iteration in 0..=options.max_iterations {
        let sockets = virtualization.sockets(platform, &x);
        let lengths = sides_of(&sockets);
        let gaps = side_gaps(sides, &lengths);
        let residual = largest(&gaps);
        if residual < least {
            (best, least) = (x, residual);
        }
        if settled && residual <= threshold {
            return accept(x, solver, characteristic_length, iteration, residual, threshold);
        }
        if iteration == options.max_iterations || !residual.is_finite() {
            break;
        }

        virtualization.socket_velocities(platform, &x, &mut velocities[..count]);
        let edges = [0, 1, 2].map(|k| (sockets[(k + 1) % 3] - sockets[k]) * 2.0);
        for (column, velocity) in columns.iter_mut().zip(&velocities[..count]) {
            *column = Vector3::from(
                [0, 1, 2].map(|k| edges[k].dot(&(velocity[(k + 1) % 3] - velocity[k]))),
            );
        }
        let mut target = Vector3::from([0, 1, 2].map(|k| gaps[k] * (sides[k] + lengths[k])));
        if solver == Solver::LeastNorm {
            for ((column, now), start) in columns.iter().zip(x.iter()).zip(nominal.iter()) {
                target += column * (now - start);
            }
        }
        if !least_norm_of_three(&columns[..count], &compliance[..count], &target, &mut step) {
            break;
        }
        let start = if solver == Solver::Newton { &x } else { &nominal };
        let mut change = 0.0_f64;
        let mut next = x;
        for (m, value) in next.iter_mut().enumerate() {
            *value = start[m] + step[m];
            change = change.max((*value - x[m]).abs() / compliance[m].sqrt());
        }
        x = next;
        settled = solver == Solver::Newton || change <= threshold;
    }
    Err(Box::new(Unconverged {
        solver,
        best,
        residual: least,
        threshold,
        iterations: options.max_iterations,
    })
    .into())
}

#[inline]
fn accept(
    virtual_joints: VirtualJoints,
    solver: Solver,
    characteristic_length: f64,
    iterations: usize,
    residual: f64,
    threshold: f64,
) -> Result<Solution, Error> {
    if residual <= threshold {
        Ok(Solution { virtual_joints, solver, characteristic_length, iterations, residual })
    } else {
        Err(Box::new(Unconverged { solver, best: virtual_joints, residual, threshold, iterations })
            .into())
    }
}

#[inline]
fn threshold(sides: &Sides, options: &SolveOptions) -> f64 {
    options.relative_threshold * sides[0].max(sides[1]).max(sides[2])
}

/// The largest magnitude; NaN if any is, which a plain maximum would drop.
#[inline]
fn largest(gaps: &Vector3<f64>) -> f64 {
    gaps[0].abs().max(gaps[1].abs()).max(gaps[2].abs()) + 0.0 * gaps.sum()
}

#[inline]
fn side_gaps(wanted: &Sides, found: &Sides) -> Vector3<f64> {
    Vector3::from([0, 1, 2].map(|k| wanted[k] - found[k]))
}
