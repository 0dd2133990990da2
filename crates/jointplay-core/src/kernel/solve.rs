//! From the sides of many triangles of balls to the virtual joints.
//!
//! What [`solve`](crate::virtualization::solve) does for one pose, with the same steps; poses that do not converge within a few steps are left to it.

use pulp::Simd;

use super::found::{
    Ahead, Found, Gaps, LEAST_NORM_STEPS, LEAST_PIVOT, Laid, NEWTON_STEPS, squared, unless, upright,
};
use super::geometry::{Geometry, Task};
use super::lanes::{Lanes, Mask};
use super::model::{self, Model};
use super::polar;
use super::pose::PlatformPoses;
use super::shape::{Balls, Response, Shape, Three, first_step, missing, within};
use super::symmetric::{Solution, solve_symmetric};
use crate::virtualization::Solver;

/// How a kernel finds the virtual joints.
///
/// A type, so that a loop over poses can be compiled for each: with all of them in one loop the registers do not suffice.
pub(crate) trait Method: Copy {
    /// Whether [`Self::ahead`] computes anything.
    const AHEAD: bool = false;

    /// What is computed of a block while the blocks before are finished.
    #[inline(always)]
    fn ahead<S: Simd, M: Model>(&self, _task: &Task<'_>, balls: &Balls<S>) -> Ahead<S> {
        Ahead::none(balls.mean)
    }

    /// # Arguments
    /// * `ahead` – from [`Self::ahead`]
    fn found<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
        ahead: Ahead<S>,
    ) -> Found<S>;

    /// The platforms for the virtual joints found.
    #[inline(always)]
    fn placed<S: Simd, M: Model>(
        &self,
        geometry: &Geometry,
        balls: &Balls<S>,
        found: &Found<S>,
    ) -> PlatformPoses<S> {
        placed::<S, M>(geometry, balls, found)
    }
}

/// The platforms for virtual joints.
#[inline(always)]
pub(super) fn placed<S: Simd, M: Model>(
    geometry: &Geometry,
    balls: &Balls<S>,
    found: &Found<S>,
) -> PlatformPoses<S> {
    if let Some(laid) = &found.laid {
        return PlatformPoses::laid(geometry, balls, laid);
    }
    let shape = Shape::at::<M>(geometry, found.a, found.b);
    PlatformPoses::new(geometry, balls, &shape)
}

/// See [`Solver::ClosedForm`]; for virtualizations that have one.
#[derive(Clone, Copy)]
pub(crate) struct ClosedForm;

impl Method for ClosedForm {
    const AHEAD: bool = true;

    #[inline(always)]
    fn ahead<S: Simd, M: Model>(&self, task: &Task<'_>, balls: &Balls<S>) -> Ahead<S> {
        let [scale, per_square] =
            if M::TOWARD_SOCKET { per_sum(balls) } else { per_fit(task, balls) };
        Ahead { scale, per_square, factors: balls.plane.factors() }
    }

    #[inline(always)]
    fn found<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
        ahead: Ahead<S>,
    ) -> Found<S> {
        if M::TOWARD_SOCKET { radial(task, balls, ahead) } else { planar(task, balls, ahead) }
    }
}

/// The virtual joints by the solver of a task.
#[inline(always)]
pub(crate) fn solved<S: Simd, M: Model>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    match task.solver {
        Solver::Newton => newton::<S, M>(task, balls),
        Solver::ClosedForm if M::CLOSED_FORM => {
            let ahead = ClosedForm.ahead::<S, M>(task, balls);
            ClosedForm.found::<S, M>(task, balls, ahead)
        }
        _ => least_norm::<S, M>(task, balls),
    }
}

/// Newton's method from nominal, see [`Solver::Newton`](crate::virtualization::Solver::Newton).
#[inline(always)]
pub(super) fn newton<S: Simd, M: Model>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    if M::AROUND_CENTER {
        return polar::newton(task, balls);
    }
    let zero = balls.mean.like(0.0);
    let one = balls.mean.like(1.0);
    let at_start = balls.missing_at_start(task.geometry);
    let bounds = balls.bounds(task.threshold);
    let mut met = within(&at_start, &bounds);
    let mut shape = Shape::start::<M>(task.geometry, zero);
    let (by_a, by_b, independent) = begin::<S, M>(task, &shape, &unless(met, at_start));
    let mut doubtful = !(independent | met);
    shape.advance::<M>(task.geometry, by_a, by_b);
    let mut iterations = met.select(zero, one);
    let mut missing = shape.missing(balls);
    met = met | within(&missing, &bounds);
    for _ in 1..task.max_iterations.min(NEWTON_STEPS) {
        if met.all() {
            break;
        }
        let response = shape.response::<M>();
        // Nothing is missing where the sides are met, so that the step is none.
        let (by_a, by_b, independent) = step::<S, M>(task, &response, &unless(met, missing), 0.5);
        doubtful = doubtful | !(independent | met);
        shape.advance::<M>(task.geometry, by_a, by_b);
        iterations = iterations + met.select(zero, one);
        missing = shape.missing(balls);
        met = met | within(&missing, &bounds);
    }
    end(task, &shape, missing, iterations, met & !doubtful)
}

/// The least displacement near nominal, see [`Solver::LeastNorm`](crate::virtualization::Solver::LeastNorm).
///
/// Only where full steps do not overshoot; displacements of millimetres do.
#[inline(always)]
pub(super) fn least_norm<S: Simd, M: Model>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    if M::AROUND_CENTER {
        return polar::least_norm(task, balls);
    }
    let zero = balls.mean.like(0.0);
    let one = balls.mean.like(1.0);
    let bounds = balls.bounds(task.threshold);
    let least_step = balls.longest_squared() * (0.25 * task.threshold);
    let at_start = balls.missing_at_start(task.geometry);
    let mut shape = Shape::start::<M>(task.geometry, zero);
    let (by_a, by_b, independent) = begin::<S, M>(task, &shape, &at_start);
    shape.advance::<M>(task.geometry, by_a, by_b);
    let (mut last_a, mut last_b) = (by_a, by_b);
    let mut last_squared = squared::<S, M>(task, &by_a, &by_b);
    let mut iterations = one;
    let mut missing = shape.missing(balls);
    let mut met = last_squared.at_most(least_step) & within(&missing, &bounds);
    // Where a step turned back on the last one, or the sides were nearly dependent.
    let mut doubtful = !independent;
    for _ in 1..task.max_iterations.min(LEAST_NORM_STEPS) {
        if (met | doubtful).all() {
            break;
        }
        let response = shape.response::<M>();
        let mut target = missing;
        let (mut from_a, from_b) = (shape.a, shape.b);
        for k in 0..3 {
            from_a[k] = from_a[k] - task.geometry.start::<M>()[k];
            target[k] = target[k] * 0.5;
        }
        for k in 0..3 {
            let before = (k + 2) % 3;
            let gained = |products: [Lanes<S>; 2]| {
                let along = products[0] * from_a[k];
                if M::ACROSS { products[1].times_plus(from_b[k], along) } else { along }
            };
            target[k] = target[k] - gained(response.leaving[k]);
            target[before] = target[before] + gained(response.arriving[k]);
        }
        let (mut by_a, mut by_b, independent) = step::<S, M>(task, &response, &target, 1.0);
        for k in 0..3 {
            by_a[k] = by_a[k] - from_a[k];
            by_b[k] = by_b[k] - from_b[k];
        }
        (by_a, by_b) = (unless(met, by_a), unless(met, by_b));
        let mut along = zero;
        for k in 0..3 {
            along = by_a[k].times_plus(last_a[k], along);
            if M::ACROSS {
                along = (by_b[k] * (1.0 / task.compliance)).times_plus(last_b[k], along);
            }
        }
        let overshot = along.below(last_squared * -0.5);
        doubtful = doubtful | ((overshot | !independent) & !met);
        shape.advance::<M>(task.geometry, by_a, by_b);
        iterations = iterations + met.select(zero, one);
        missing = shape.missing(balls);
        last_squared = squared::<S, M>(task, &by_a, &by_b);
        (last_a, last_b) = (by_a, by_b);
        let now = last_squared.at_most(least_step) & within(&missing, &bounds);
        met = met | (now & !doubtful);
    }
    end(task, &shape, missing, iterations, met)
}

/// One over the product of the first side and the length of the fit, by which [`planar`] scales the triangle of the balls (1/m³), and one over the square of the first side (1/m²).
#[inline(always)]
fn per_fit<S: Simd>(task: &Task<'_>, balls: &Balls<S>) -> [Lanes<S>; 2] {
    let ([l_12, l_23, l_31], area) = (balls.squares, balls.plane.area);
    // |Σ c_k f_k|² of complex numbers is linear in squared sides and area of the c_k.
    let ([k_12, k_23, k_31], by_area) = task.geometry.fit;
    let square = l_31.times_plus(l_31.like(k_31), l_12.times_plus(l_12.like(k_12), l_23 * k_23));
    let square = area.times_plus(area.like(by_area), square);
    // The root and the division side by side.
    let both = (square * l_12).inverse();
    [square.sqrt() * both, square * both]
}

/// The least displacement of all, see [`Planar`](crate::virtualization::Planar).
#[inline(always)]
fn planar<S: Simd>(task: &Task<'_>, balls: &Balls<S>, ahead: Ahead<S>) -> Found<S> {
    let Ahead { scale, factors, .. } = ahead;
    let nominal = &task.geometry.from_center;
    let [_, [x_2, y_2], [x_3, y_3]] = *nominal;
    let [l_12, l_23, l_31] = balls.squares;
    // The triangle of the balls laid out along its first side, everything times that side: corners (0, 0), (l_12, 0), (along, up).
    let along = (l_12 + l_31 - l_23) * 0.5;
    let area = balls.plane.area;
    let up = area * task.geometry.sense;
    // The turn about its centroid that brings it nearest to the nominal sockets, not to scale.
    let cosine = up.times_plus(up.like(y_3), along.times_plus(along.like(x_3), l_12 * x_2));
    let sine = up.times_from(up.like(x_3), along.times_plus(along.like(y_3), l_12 * y_2));
    let second = [cosine * l_12, sine * l_12];
    let third = [sine.times_from(up, cosine * along), sine.times_plus(along, cosine * up)];
    let mut joints = [[scale; 3]; 2];
    for axis in 0..2 {
        let to_first = (second[axis] + third[axis]) * (-1.0 / 3.0);
        let corners = [to_first, second[axis] + to_first, third[axis] + to_first];
        for k in 0..3 {
            joints[axis][k] = corners[k].times_plus(scale, scale.like(-nominal[k][axis]));
        }
    }
    let second = [second[0] * scale, second[1] * scale];
    let third = [third[0] * scale, third[1] * scale];
    let edges = [second, [third[0] - second[0], third[1] - second[1]], third];
    let laid = Laid {
        side: [cosine * scale, sine * scale],
        center: task.geometry.socket_center.map(|center| scale.like(center)),
        factors,
    };
    closed(task, joints, missing(&edges, balls), laid)
}

/// One over the sum of the three slides (1/m), and one over the square of the first side (1/m²).
#[inline(always)]
fn per_sum<S: Simd>(balls: &Balls<S>) -> [Lanes<S>; 2] {
    let ([l_12, l_23, l_31], area) = (balls.squares, balls.plane.area);
    let half = (l_12 + l_31 + l_23) * 0.5;
    let square = area.times_plus(area.like(3.0_f64.sqrt()), half);
    // The root and the division side by side; one over l_12 alone would be moved to its use by the compiler, and not be computed ahead.
    let both = (square * l_12).inverse();
    [square.sqrt() * square.inverse(), square * both]
}

/// The only displacement, for sockets 120° apart, see [`Radial`](crate::virtualization::Radial).
#[inline(always)]
fn radial<S: Simd>(task: &Task<'_>, balls: &Balls<S>, ahead: Ahead<S>) -> Found<S> {
    let Ahead { scale: per_sum, per_square, factors } = ahead;
    let area = balls.plane.area;
    let [l_12, l_23, l_31] = balls.squares;
    let half = (l_12 + l_31 + l_23) * 0.5;
    let third = area.times_plus(area.like(1.0 / 3.0_f64.sqrt()), half);
    let slides = [(third - l_23) * per_sum, (third - l_31) * per_sum, (third - l_12) * per_sum];
    let mut missing = balls.squares;
    for (k, missing) in missing.iter_mut().enumerate() {
        // By the law of cosines.
        let (own, next) = (slides[k], slides[(k + 1) % 3]);
        let [cosine, _] = task.geometry.between[k];
        let along = next.times_plus(next.like(-2.0 * cosine), own);
        *missing = next.times_from(next, own.times_from(along, *missing));
    }
    let zero = area.like(0.0);
    let shape = Shape::at::<model::Radial>(task.geometry, slides, [zero; 3]);
    let [first, _, _] = shape.edges;
    let side = [first[0] * per_square, first[1] * per_square];
    let laid = Laid { side, center: shape.center(), factors };
    let found = closed(task, [slides, [zero; 3]], missing, laid);
    let outward = zero.below(slides[0].min(slides[1]).min(slides[2]));
    Found { met: found.met & outward, ..found }
}

/// Virtual joints found without steps, and where the sides are met.
///
/// The triangle has the sense of the base by construction, and with sides that are met an area: bases have a least height.
#[inline(always)]
fn closed<S: Simd>(
    task: &Task<'_>,
    [a, b]: [Three<S>; 2],
    missing: Three<S>,
    laid: Laid<S>,
) -> Found<S> {
    let [m_1, m_2, m_3] = missing;
    let all = m_1.times_plus(m_1, m_2.times_plus(m_2, m_3 * m_3));
    let met = all.below(all.like(task.all_missing));
    Found { a, b, gaps: Gaps::Squares(missing), laid: Some(laid), iterations: all.like(0.0), met }
}

/// The triangle at which steps end.
#[inline(always)]
fn end<S: Simd>(
    task: &Task<'_>,
    shape: &Shape<S>,
    missing: Three<S>,
    iterations: Lanes<S>,
    met: Mask<S>,
) -> Found<S> {
    let met = met & upright(task.geometry, shape.area());
    Found { a: shape.a, b: shape.b, gaps: Gaps::Squares(missing), laid: None, iterations, met }
}

/// The first step from nominal, and where the sides are independent there.
#[inline(always)]
fn begin<S: Simd, M: Model>(
    task: &Task<'_>,
    start: &Shape<S>,
    missing: &Three<S>,
) -> (Three<S>, Three<S>, Mask<S>) {
    if let Some(matrix) = task.first_step {
        let zero = missing[0].like(0.0);
        let (by_a, by_b) = first_step::<S, M>(matrix, missing);
        return (by_a, by_b, zero.at_most(zero));
    }
    step::<S, M>(task, &start.response::<M>(), missing, 0.5)
}

/// The least step that gives each edge what it lacks: C Eᵀ (E C Eᵀ)⁻¹ · target · share.
///
/// With it, where the three sides are independent beyond doubt.
#[inline(always)]
fn step<S: Simd, M: Model>(
    task: &Task<'_>,
    response: &Response<S>,
    target: &Three<S>,
    share: f64,
) -> (Three<S>, Three<S>, Mask<S>) {
    let entries = normal_matrix::<S, M>(task, response);
    let n_22 = entries[2];
    let Solution { y, product, minor, determinant } = solve_symmetric(entries, target, share);
    let (mut by_a, mut by_b) = (y, [determinant.like(0.0); 3]);
    for k in 0..3 {
        let (leaving, arriving) = (response.leaving[k], response.arriving[k]);
        let before = y[(k + 2) % 3];
        by_a[k] = leaving[0].times_from(y[k], arriving[0] * before);
        if M::ACROSS {
            by_b[k] = leaving[1].times_from(y[k], arriving[1] * before);
            if M::TURNS {
                by_b[k] = by_b[k] * task.compliance;
            }
        }
    }
    let independent =
        (product * LEAST_PIVOT).below(minor) & (n_22 * minor * LEAST_PIVOT).below(determinant);
    (by_a, by_b, independent)
}

/// E C Eᵀ, symmetric: its diagonal, then the entries (0,1), (1,2), (2,0).
#[inline(always)]
fn normal_matrix<S: Simd, M: Model>(task: &Task<'_>, response: &Response<S>) -> [Lanes<S>; 6] {
    let zero = response.leaving[0][0].like(0.0);
    let (mut diagonal, mut off_diagonal) = ([zero; 3], [zero; 3]);
    for k in 0..3 {
        let before = (k + 2) % 3;
        let ([l_a, l_b], [r_a, r_b]) = (response.leaving[k], response.arriving[k]);
        diagonal[k] = l_a.times_plus(l_a, diagonal[k]);
        diagonal[before] = r_a.times_plus(r_a, diagonal[before]);
        // Entry (k − 1, k).
        off_diagonal[before] = -(l_a * r_a);
        if M::ACROSS {
            let (l_c, r_c) =
                if M::TURNS { (l_b * task.compliance, r_b * task.compliance) } else { (l_b, r_b) };
            diagonal[k] = l_c.times_plus(l_b, diagonal[k]);
            diagonal[before] = r_c.times_plus(r_b, diagonal[before]);
            off_diagonal[before] = l_c.times_from(r_b, off_diagonal[before]);
        }
    }
    [diagonal[0], diagonal[1], diagonal[2], off_diagonal[0], off_diagonal[1], off_diagonal[2]]
}
