//! From the sides of the triangle of ball centres to the displacements of the virtual joints.

use nalgebra::Vector3;

use super::solver::Solver;
use super::{
    MAX_VIRTUAL_JOINTS, Metric, Platform, Sides, Sockets, VirtualJoints, Virtualization, sides_of,
};
use crate::Error;
use crate::error::Unconverged;
use crate::linalg::least_norm_of_three;

/// Largest error of lengths that counts as none, as a share of the longest side: a few hundred times round-off, and 10⁻¹¹ mm on a wafer robot.
///
/// That of solved sides by default, and of poses by polynomials, which are as exact.
pub(crate) const RELATIVE_THRESHOLD: f64 = 1e-13;

/// How the displacements are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    /// Choice among the solutions, and method.
    pub solver: Solver,
    /// How angles weigh against lengths.
    pub metric: Metric,
    /// Most iterations before giving up.
    ///
    /// Newton takes 3 within ±2°; least norm gains a constant factor a step and takes up to 32 at 5° with the offset virtualization.
    pub max_iterations: usize,
    /// Largest side error that counts as solved, as a share of the longest side.
    pub relative_threshold: f64,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            solver: Solver::default(),
            metric: Metric::default(),
            max_iterations: 200,
            relative_threshold: RELATIVE_THRESHOLD,
        }
    }
}

/// Displacements of the virtual joints, with their evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// X, in the order of the virtualization's joints ((m), (rad)).
    pub virtual_joints: VirtualJoints,
    /// Solver used: differs from the one requested where a closed form does not exist.
    pub solver: Solver,
    /// ρ of the metric (m).
    pub characteristic_length: f64,
    /// Iterations done, 0 for a closed form.
    pub iterations: usize,
    /// Largest difference between a side and its virtual length; up to 0.01 % of itself too large (m).
    pub residual: f64,
}

/// Finds X with F(X, L) = 0, F_ij = |p_j(X) − p_i(X)|² − L_ij², always from the nominal X.
///
/// ```text
///    newton:      X ← X   −  J† F
///    least norm:  X ← X_0 +  J† (J (X − X_0) − F)        J = ∂F/∂X,  J† = W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹,  W: the metric
/// ```
/// Newton is the paper's X ← X + ∂X/∂L (L − L(X)) with ∂F/∂L = −2 diag(L) taken midway between L(X) and L, which makes it exact for the squares in F.
/// A start at the last pose instead would make the answer depend on the path.
///
/// # Arguments
/// * `sides` – L_12, L_23, L_31 (m)
///
/// # Errors
/// [`Error::NotConverged`] with the best iterate, [`Error::DependentSides`], [`Error::VirtualJointCount`], [`Error::OutOfRange`] for the metric.
///
/// # Numerics
/// Does not allocate. Newton ends where the sides agree, least norm where also the step is at the threshold.
/// Least norm takes only a share of the step to the least displacement, halved each time that a step reverses the last one: the full step overshoots where angles cost little and displacements are large.
///
/// # Source
/// newton: \[Virtualization\], eq. (6)–(8); least norm: Gauss–Newton on the displacement, own derivation, `docs/explanation/kinematics.md`
// Always: left to itself the compiler copies the solution from call to call, which takes as long as finding it.
#[inline(always)]
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
    let mut pull = if solver == Solver::Newton { 0.0 } else { 1.0 };
    let (mut last_step, mut last_squared) = (step, 0.0);
    let mut iterations = 0;
    for iteration in 0..=options.max_iterations {
        iterations = iteration;
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
        // Whatever `pull` is, the step meets the linearized sides; it covers that share of the distance to the least displacement.
        let mut target = Vector3::from([0, 1, 2].map(|k| gaps[k] * (sides[k] + lengths[k])));
        if pull > 0.0 {
            for ((column, now), start) in columns.iter().zip(x.iter()).zip(nominal.iter()) {
                target += column * (pull * (now - start));
            }
        }
        if !least_norm_of_three(&columns[..count], &compliance[..count], &target, &mut step) {
            return Err(Error::DependentSides { characteristic_length, iterations: iteration });
        }
        let (mut along, mut squared) = (0.0, 0.0);
        for (m, change) in step.iter_mut().enumerate() {
            *change -= pull * (x[m] - nominal[m]);
            along += *change * last_step[m] / compliance[m];
            squared += *change * *change / compliance[m];
            x[m] += *change;
        }
        // A step back over most of the last one: the full step overshoots.
        if along < -0.5 * last_squared {
            pull *= 0.5;
        }
        settled = solver == Solver::Newton || squared <= threshold * threshold;
        (last_step, last_squared) = (step, squared);
    }
    Err(Unconverged { solver, best, residual: least, threshold, iterations }.into())
}

#[inline(always)]
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
        Err(Unconverged { solver, best: virtual_joints, residual, threshold, iterations }.into())
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
    Vector3::from(*wanted) - Vector3::from(*found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpr::Gpr;
    use crate::virtualization::{
        Offset, Planar, Polar, Radial, VirtualJoint, VirtualJointKind, built_in,
    };

    /// A virtualization of any number of joints, whose sockets are no numbers once they leave the nominal place.
    struct Broken {
        joints: Vec<VirtualJoint>,
        closed_form: bool,
    }

    impl Broken {
        fn with(count: usize, closed_form: bool) -> Self {
            let joint = VirtualJoint { symbol: "x", limb: 0, motion: VirtualJointKind::Linear };
            Self { joints: vec![joint; count], closed_form }
        }
    }

    impl Virtualization for Broken {
        fn name(&self) -> &str {
            "broken"
        }
        fn joints(&self) -> &[VirtualJoint] {
            &self.joints
        }
        fn nominal(&self, _platform: &Platform, x: &mut [f64]) {
            x.fill(0.0);
        }
        fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
            let nowhere = if x.iter().any(|&value| value != 0.0) { f64::NAN } else { 0.0 };
            platform.sockets().map(|socket| socket.add_scalar(nowhere))
        }
        fn socket_velocities(&self, platform: &Platform, _x: &[f64], velocities: &mut [Sockets]) {
            velocities.fill(Sockets::default());
            for (k, direction) in platform.directions().iter().enumerate() {
                velocities[k][k] = *direction;
            }
        }
        fn closed_form(&self, _platform: &Platform, _sides: &Sides, x: &mut [f64]) -> bool {
            x.fill(f64::NAN);
            self.closed_form
        }
    }

    const SOLVERS: [Solver; 3] = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm];

    fn sides_at(tilt_angle: f64) -> Sides {
        let gpr = Gpr::paper().without_limit_checks();
        let tilt = crate::spatial::Tilt { azimuth: 0.4, angle: tilt_angle };
        let rods = gpr.inverse(tilt, crate::gpr::AxisHeight(0.5)).unwrap();
        crate::gpr::ball_sides(&gpr.ball_centers(&rods))
    }

    /// Solves on the paper's platform and wants an "unconverged".
    #[track_caller]
    fn check(model: &dyn Virtualization, sides: Sides, options: &SolveOptions) -> Unconverged {
        match solve(model, Gpr::paper().platform(), &sides, options) {
            Err(Error::NotConverged(found)) => *found,
            other => panic!("{} gives {other:?}", model.name()),
        }
    }

    #[test]
    fn too_few_and_too_many_virtual_joints() {
        for found in [0, 2, 13] {
            let platform = *Gpr::paper().platform();
            let model = Broken::with(found, true);
            let error = solve(&model, &platform, &sides_at(0.0), &SolveOptions::default());
            assert_eq!(
                error.unwrap_err().to_string(),
                format!("the virtualization has {found} virtual joints, but needs 3 to 12")
            );
        }
    }

    #[test]
    fn unconverged_solve_returns_the_best_iterate() {
        let (platform, sides) = (*Gpr::paper().platform(), sides_at(0.1));
        let start = largest(&side_gaps(&sides, &sides_of(platform.sockets())));
        for model in built_in() {
            for solver in [Solver::Newton, Solver::LeastNorm] {
                let options = SolveOptions { solver, max_iterations: 1, ..SolveOptions::default() };
                let found = check(model, sides, &options);
                assert_eq!((found.solver, found.iterations), (solver, 1));
                assert!(found.residual < start && found.residual > found.threshold);
                let there = sides_of(&model.sockets(&platform, &found.best));
                assert_eq!(largest(&side_gaps(&sides, &there)), found.residual);

                let none = SolveOptions { max_iterations: 0, ..options };
                assert_eq!(check(model, sides, &none).residual, start);
            }
        }
    }

    #[test]
    fn error_message_names_the_requested_solver() {
        let options =
            SolveOptions { solver: Solver::Newton, max_iterations: 1, ..SolveOptions::default() };
        let found = check(&Polar, sides_at(0.1), &options);
        let message = Error::from(found).to_string();
        assert!(
            message.starts_with("the newton iteration did not converge in 1 steps: the sides are ")
        );
    }

    #[test]
    fn sides_without_a_triangle_do_not_converge() {
        for sides in [[0.1, 0.1, 0.3], [0.1, -0.1, 0.1], [0.1, 0.1, f64::NAN]] {
            for model in built_in() {
                for solver in SOLVERS {
                    let options = SolveOptions { solver, ..SolveOptions::default() };
                    let found = solve(model, Gpr::paper().platform(), &sides, &options);
                    // Iterates may end where the sides are dependent.
                    let refused =
                        matches!(found, Err(Error::NotConverged(_) | Error::DependentSides { .. }));
                    assert!(refused, "{} gives {found:?}", model.name());
                }
            }
        }
    }

    #[test]
    fn models_with_non_finite_sockets_do_not_converge() {
        for closed_form in [false, true] {
            for solver in SOLVERS {
                let options = SolveOptions { solver, ..SolveOptions::default() };
                let found = check(&Broken::with(3, closed_form), sides_at(0.1), &options);
                assert!(found.residual.is_nan() || found.residual > found.threshold);
            }
        }
    }

    /// One rod is 1.26 mm and another 1.39 mm off its socket; with 1 mm to a radian the full step to the least displacement overshoots for ever.
    #[test]
    fn least_displacements_that_overshoot_are_found() {
        let third = 120_f64.to_radians();
        let platform = Platform::new([0.05; 3], [0.0, third, 2.0 * third]).unwrap();
        let mut base_points = *platform.sockets();
        base_points[0].x -= 1.26e-3;
        base_points[2].x += 1.39e-3;
        let options = SolveOptions { solver: Solver::LeastNorm, ..SolveOptions::default() };
        let found = solve(&Offset, &platform, &sides_of(&base_points), &options).unwrap();
        assert!(found.residual <= 1e-14 && found.iterations < options.max_iterations, "{found:?}");
    }

    #[test]
    fn names_of_solvers() {
        assert_eq!(
            SOLVERS.map(|solver| solver.to_string()),
            ["newton", "least-norm", "closed-form"]
        );
        assert_eq!(format!("[{:>8}]", Solver::Newton), "[  newton]");
    }

    #[test]
    fn solution_names_the_solver_used() {
        let (gpr, sides) = (Gpr::paper().without_limit_checks(), sides_at(0.02));
        let used = |model: &dyn Virtualization| {
            solve(model, gpr.platform(), &sides, &SolveOptions::default()).unwrap().solver
        };
        assert_eq!(used(&Radial), Solver::ClosedForm);
        assert_eq!(used(&Planar), Solver::ClosedForm);
        assert_eq!(used(&Polar), Solver::LeastNorm);
        assert_eq!(used(&Offset), Solver::LeastNorm);
    }
}
