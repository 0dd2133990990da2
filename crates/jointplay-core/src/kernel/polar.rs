//! Polar virtual joints of many poses, by the law of cosines.
//!
//! ```text
//!    L_ij² = l_i² + l_j² − 2 l_i l_j cos ψ_ij        ψ_ij = β_j − β_i + φ_j − φ_i
//! ```
//! Only differences of the φ_k enter, so that every step leaves their sum unchanged.
//! The steps are those of the other virtualizations in `solve.rs`, with half as many operations.

use pulp::Simd;

use super::found::{
    Found, Gaps, LEAST_NORM_STEPS, LEAST_PIVOT, NEWTON_STEPS, squared, unless, unless_branchless,
    upright,
};
use super::geometry::{FirstStep, Geometry, Task};
use super::lanes::{Lanes, Mask};
use super::shape::{Balls, Three, within};
use super::symmetric::{Solution, solve_symmetric};
use super::trigonometry::Series;

/// The sockets of many poses, in polar coordinates.
#[derive(Clone, Copy)]
struct Sockets<S: Simd> {
    /// Distances from O_p (m).
    l: Three<S>,
    /// Displacements of the angles from nominal (rad).
    phi: Three<S>,
    /// Cosines of the angles between neighbours.
    cosine: Three<S>,
    /// Sines of the angles between neighbours.
    sine: Three<S>,
}

/// Half the derivatives of the squared sides: by l_i, by l_j, and by φ_j, which is minus that by φ_i.
#[derive(Clone, Copy)]
struct Response<S: Simd> {
    by_i: Three<S>,
    by_j: Three<S>,
    by_turn: Three<S>,
}

/// A step: of the l_k, and the share of each side in those of the φ_k.
struct Step<S: Simd> {
    l: Three<S>,
    turns: Three<S>,
    /// Where the three sides are independent beyond doubt.
    independent: Mask<S>,
}

impl<S: Simd> Step<S> {
    /// Steps of the φ_k: each side turns its two sockets in opposite senses.
    #[inline(always)]
    fn phi(&self) -> Three<S> {
        let [t_01, t_12, t_20] = self.turns;
        [t_20 - t_01, t_01 - t_12, t_12 - t_20]
    }
}

/// Differences between neighbours.
#[inline(always)]
fn between<S: Simd>([a, b, c]: Three<S>) -> Three<S> {
    [b - a, c - b, a - c]
}

impl<S: Simd> Sockets<S> {
    #[inline(always)]
    fn nominal(geometry: &Geometry, any: Lanes<S>) -> Self {
        let mut nominal =
            Self { l: [any; 3], phi: [any.like(0.0); 3], cosine: [any; 3], sine: [any; 3] };
        for k in 0..3 {
            nominal.l[k] = any.like(geometry.start::<super::Polar>()[k]);
            nominal.cosine[k] = any.like(geometry.between[k][0]);
            nominal.sine[k] = any.like(geometry.between[k][1]);
        }
        nominal
    }

    /// Moves the nominal sockets by the matrix of the first step, and leaves their directions.
    #[inline(always)]
    fn begin(&mut self, first_step: &FirstStep, missing: &Three<S>) {
        let zero = missing[0].like(0.0);
        for k in 0..3 {
            self.l[k] = product(&first_step.0[k], missing, self.l[k]);
        }
        let first = product(&first_step.0[3], missing, zero);
        let last = product(&first_step.0[5], missing, zero);
        // A difference from zero, since the negative of zero plus a step of zero is another zero.
        self.phi = [first, zero - (first + last), last];
    }

    /// Adds a step to the coordinates, and returns the differences by which it turns the directions.
    #[inline(always)]
    fn advance(&mut self, step: &Step<S>) -> Three<S> {
        self.l = sum(self.l, step.l);
        let by_phi = step.phi();
        self.phi = sum(self.phi, by_phi);
        between(by_phi)
    }

    /// Turns the directions by differences of steps whose sines and versines are given.
    #[inline(always)]
    fn turn(&mut self, sines: &Three<S>, versines: &Three<S>) {
        for k in 0..3 {
            let (c, s) = (self.cosine[k], self.sine[k]);
            self.cosine[k] = versines[k].times_from(c, sines[k].times_from(s, c));
            self.sine[k] = versines[k].times_from(s, sines[k].times_plus(c, s));
        }
    }

    #[inline(always)]
    fn response(&self) -> Response<S> {
        let mut response = Response { by_i: self.l, by_j: self.l, by_turn: self.l };
        for k in 0..3 {
            let (i, j) = (self.l[k], self.l[(k + 1) % 3]);
            response.by_i[k] = j.times_from(self.cosine[k], i);
            response.by_j[k] = i.times_from(self.cosine[k], j);
            response.by_turn[k] = i * j * self.sine[k];
        }
        response
    }

    /// Difference of each squared side from that of this triangle (m²).
    #[inline(always)]
    fn missing(&self, response: &Response<S>, balls: &Balls<S>) -> Three<S> {
        let mut missing = balls.squares;
        for (k, missing) in missing.iter_mut().enumerate() {
            let (i, j) = (self.l[k], self.l[(k + 1) % 3]);
            *missing = j.times_from(response.by_j[k], i.times_from(response.by_i[k], *missing));
        }
        missing
    }

    #[inline(always)]
    fn found(
        &self,
        geometry: &Geometry,
        response: &Response<S>,
        missing: Three<S>,
        iterations: Lanes<S>,
        met: Mask<S>,
    ) -> Found<S> {
        let [t_0, t_1, t_2] = response.by_turn;
        let met = met & upright(geometry, t_0 + t_1 + t_2);
        Found { a: self.l, b: self.phi, gaps: Gaps::Squares(missing), laid: None, iterations, met }
    }
}

/// Difference of each squared side from that of sockets at given coordinates (m²), and where it is exact to round-off: nowhere for large angles.
#[inline(always)]
pub(super) fn missing<S: Simd>(
    geometry: &Geometry,
    balls: &Balls<S>,
    l: Three<S>,
    phi: Three<S>,
) -> (Three<S>, Mask<S>) {
    let series = Series::of_small(&between(phi));
    let mut sockets = Sockets { l, phi, ..Sockets::nominal(geometry, l[0]) };
    sockets.turn(&series.sines, &series.versines);
    (sockets.missing(&sockets.response(), balls), series.exact)
}

/// The step from nominal, by the matrix that all poses share or by itself.
#[inline(always)]
fn begin<S: Simd>(
    task: &Task<'_>,
    nominal: &Sockets<S>,
    missing: &Three<S>,
) -> (Sockets<S>, Mask<S>) {
    let zero = missing[0].like(0.0);
    let mut sockets = *nominal;
    let independent = if let Some(first_step) = task.first_step {
        sockets.begin(first_step, missing);
        zero.at_most(zero)
    } else {
        let step = step(task, &nominal.response(), missing, 0.5);
        sockets.l = sum(sockets.l, step.l);
        sockets.phi = step.phi();
        step.independent
    };
    let turned = between(sockets.phi);
    let (sines, versines) = Series::of_small(&turned).or_any(turned);
    sockets.turn(&sines, &versines);
    (sockets, independent)
}

/// A row times a vector, and an addend.
#[inline(always)]
fn product<S: Simd>(row: &[f64; 3], vector: &Three<S>, addend: Lanes<S>) -> Lanes<S> {
    let [a, b, c] = *vector;
    a.times_plus(a.like(row[0]), b.times_plus(b.like(row[1]), c.times_plus(c.like(row[2]), addend)))
}

#[inline(always)]
fn sum<S: Simd>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Newton's method from nominal, see [`Solver::Newton`](crate::virtualization::Solver::Newton).
#[inline(always)]
pub(super) fn newton<S: Simd>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    if let (Some(first_step), 2..) = (task.first_step, task.max_iterations) {
        let (found, enough) = two_steps(task, first_step, balls);
        if enough.all() {
            return found;
        }
    }
    many_steps(task, balls)
}

/// Two steps of Newton's method, and where they are enough, which is nearly always.
///
/// Without a branch: a processor that need not wait for an answer begins the next block meanwhile, and no number is kept for a branch that is not taken.
#[inline(always)]
fn two_steps<S: Simd>(
    task: &Task<'_>,
    first_step: &FirstStep,
    balls: &Balls<S>,
) -> (Found<S>, Mask<S>) {
    let (zero, one) = (balls.mean.like(0.0), balls.mean.like(1.0));
    let at_start = balls.missing_at_start(task.geometry);
    let bounds = balls.bounds(task.threshold);
    let met_at_start = within(&at_start, &bounds);
    let mut sockets = Sockets::nominal(task.geometry, zero);
    sockets.begin(first_step, &at_start);
    let first = Series::of_small(&between(sockets.phi));
    sockets.turn(&first.sines, &first.versines);
    let response = sockets.response();
    let missing = sockets.missing(&response, balls);
    let met_once = within(&missing, &bounds);
    let step = step(task, &response, &unless_branchless(met_once, missing), 0.5);
    let second = Series::of_tiny(&sockets.advance(&step));
    sockets.turn(&second.sines, &second.versines);
    let response = sockets.response();
    let missing = sockets.missing(&response, balls);
    let met = met_once | within(&missing, &bounds);
    let certain = first.exact & second.exact & (step.independent | met_once);
    // Where no step is needed, a step would move round-off.
    let enough = met & certain & !met_at_start;
    let iterations = met_once.select(one, one + one);
    (sockets.found(task.geometry, &response, missing, iterations, met), enough)
}

/// As many steps as are needed, by any angles.
#[inline(always)]
fn many_steps<S: Simd>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    let zero = balls.mean.like(0.0);
    let one = balls.mean.like(1.0);
    let nominal = Sockets::nominal(task.geometry, zero);
    let at_start = balls.missing_at_start(task.geometry);
    let bounds = balls.bounds(task.threshold);
    let met = within(&at_start, &bounds);
    let (sockets, independent) = begin(task, &nominal, &unless(met, at_start));
    let response = sockets.response();
    let missing = sockets.missing(&response, balls);
    let mut at = Iterate {
        sockets,
        response,
        missing,
        met: met | within(&missing, &bounds),
        doubtful: !(independent | met),
        iterations: met.select(zero, one),
    };
    let steps = task.max_iterations.min(NEWTON_STEPS);
    for _ in 1..steps {
        if at.met.all() {
            break;
        }
        at.advance(task, balls, &bounds);
    }
    let met = at.met & !at.doubtful;
    at.sockets.found(task.geometry, &at.response, at.missing, at.iterations, met)
}

/// Where Newton's method is.
struct Iterate<S: Simd> {
    sockets: Sockets<S>,
    response: Response<S>,
    missing: Three<S>,
    met: Mask<S>,
    /// Where the sides were nearly dependent.
    doubtful: Mask<S>,
    iterations: Lanes<S>,
}

impl<S: Simd> Iterate<S> {
    #[inline(always)]
    fn advance(&mut self, task: &Task<'_>, balls: &Balls<S>, bounds: &Three<S>) {
        let (zero, one) = (bounds[0].like(0.0), bounds[0].like(1.0));
        // Nothing is missing where the sides are met, so that the step is none.
        let step = step(task, &self.response, &unless(self.met, self.missing), 0.5);
        self.doubtful = self.doubtful | !(step.independent | self.met);
        let turned = self.sockets.advance(&step);
        let (sines, versines) = Series::of_tiny(&turned).or_any(turned);
        self.sockets.turn(&sines, &versines);
        self.iterations = self.iterations + self.met.select(zero, one);
        self.response = self.sockets.response();
        self.missing = self.sockets.missing(&self.response, balls);
        self.met = self.met | within(&self.missing, bounds);
    }
}

/// The least displacement near nominal, see [`Solver::LeastNorm`](crate::virtualization::Solver::LeastNorm).
///
/// Only where steps become smaller by half or more; others may overshoot.
#[inline(always)]
pub(super) fn least_norm<S: Simd>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
    let zero = balls.mean.like(0.0);
    let one = balls.mean.like(1.0);
    let nominal = Sockets::nominal(task.geometry, zero);
    let bounds = balls.bounds(task.threshold);
    let least_step = balls.longest_squared() * (0.25 * task.threshold);
    let at_start = balls.missing_at_start(task.geometry);
    let (mut sockets, independent) = begin(task, &nominal, &at_start);
    let mut moved = sockets.l;
    for (moved, start) in moved.iter_mut().zip(nominal.l) {
        *moved = *moved - start;
    }
    let mut last_squared = squared::<S, super::Polar>(task, &moved, &sockets.phi);
    let mut doubtful = !independent;
    let mut iterations = one;
    let mut response = sockets.response();
    let mut missing = sockets.missing(&response, balls);
    let mut met = last_squared.at_most(least_step) & within(&missing, &bounds);
    for _ in 1..task.max_iterations.min(LEAST_NORM_STEPS) {
        if (met | doubtful).all() {
            break;
        }
        // What the sides would lack at nominal, were they linear.
        let turned = between(sockets.phi);
        let mut target = missing;
        for k in 0..3 {
            let (i, j) = (moved[k], moved[(k + 1) % 3]);
            let linear = response.by_turn[k].times_plus(turned[k], response.by_j[k] * j);
            let linear = response.by_i[k].times_plus(i, linear);
            target[k] = target[k].times_plus(one * 0.5, linear);
        }
        let step = step(task, &response, &target, 1.0);
        let phi = step.phi();
        let (mut by_l, mut by_phi) = (step.l, phi);
        for k in 0..3 {
            by_l[k] = by_l[k] - moved[k];
            by_phi[k] = by_phi[k] - sockets.phi[k];
        }
        (by_l, by_phi) = (unless(met, by_l), unless(met, by_phi));
        let by_squared = squared::<S, super::Polar>(task, &by_l, &by_phi);
        // A step of at most half the last one cannot reverse more than half of it.
        let shrinks = by_squared.at_most(last_squared * 0.25);
        doubtful = doubtful | !((shrinks & step.independent) | met);
        for k in 0..3 {
            moved[k] = moved[k] + by_l[k];
            sockets.l[k] = nominal.l[k] + moved[k];
        }
        sockets.phi = sum(sockets.phi, by_phi);
        let turned = between(by_phi);
        let (sines, versines) = Series::of_tiny(&turned).or_any(turned);
        sockets.turn(&sines, &versines);
        iterations = iterations + met.select(zero, one);
        response = sockets.response();
        missing = sockets.missing(&response, balls);
        last_squared = by_squared;
        let now = last_squared.at_most(least_step) & within(&missing, &bounds);
        met = met | (now & !doubtful);
    }
    sockets.found(task.geometry, &response, missing, iterations, met)
}

/// The least step that gives each squared side what it lacks: W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ · target · share, with halves of J.
#[inline(always)]
fn step<S: Simd>(
    task: &Task<'_>,
    response: &Response<S>,
    target: &Three<S>,
    share: f64,
) -> Step<S> {
    let Response { by_i, by_j, by_turn } = response;
    let mut turns = *by_turn;
    let mut diagonal = *by_turn;
    for k in 0..3 {
        turns[k] = by_turn[k] * task.compliance;
        let along = by_i[k].times_plus(by_i[k], by_j[k].squared());
        diagonal[k] = (turns[k] + turns[k]).times_plus(by_turn[k], along);
    }
    let [n_00, n_11, n_22] = diagonal;
    let n_01 = turns[0].times_from(by_turn[1], by_j[0] * by_i[1]);
    let n_12 = turns[1].times_from(by_turn[2], by_j[1] * by_i[2]);
    let n_20 = turns[2].times_from(by_turn[0], by_j[2] * by_i[0]);
    let entries = [n_00, n_11, n_22, n_01, n_12, n_20];
    let Solution { y, product, determinant, .. } = solve_symmetric(entries, target, share);
    let mut l = y;
    for k in 0..3 {
        let before = (k + 2) % 3;
        l[k] = by_i[k].times_plus(y[k], by_j[before] * y[before]);
        turns[k] = turns[k] * y[k];
    }
    // The pivots of a positive matrix are at most its diagonal, and their product is its determinant.
    let independent = (product * (n_22 * LEAST_PIVOT)).below(determinant);
    Step { l, turns, independent }
}
