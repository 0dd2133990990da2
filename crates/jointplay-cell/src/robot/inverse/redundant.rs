//! Redundancy resolution: the positions chosen where an arm has more motors than the target needs.

mod extension;
mod nearest;

use std::array::from_fn;

use nalgebra::{Matrix2, Vector2};

use super::barrier::{
    AXES, DescentStep, EndBarrier, MAX_BARRIERS, Model, PerAxis, QuadraticModel,
    RELATIVE_TOLERANCE, of_limits,
};
use super::closed_form::PairSolution;
use super::decomposition::{Decomposition, Pair};
use super::revolutions::{Ranges, Revolutions};
use super::solution::Configuration;
use crate::robot::arm_chain::{ArmChain, ArmVector, perpendicular, turned};

/// Largest number of descent steps; three to five are usual, more only out of a nearly stretched arm.
const MAX_ITERATIONS: usize = 100;

/// Longest step of a free angle: beyond it the second-order model is too inaccurate (rad).
const MAX_STEP: f64 = 1.0;

/// Step below which the descent has converged (rad).
const MIN_STEP: f64 = 1e-9;

/// Elbow cost above which a start is useless: within 3° of the stretched arm the pair moves too fast for any free angle to lead out.
const MAX_ELBOW_COST: f64 = 400.0;

/// Numbers of grid values of each free angle that are tried for a start where the present positions give none, one after the other.
const STARTS: [usize; 3] = [8, 16, 48];
/// Largest of [`STARTS`].
const MAX_STARTS: usize = 48;

/// Reach of a radial arm, as a fraction of the length of its last link, at which the barrier at the change of its reach direction costs 1.
const MIN_REACH: f64 = 0.1;

/// The free unknowns of an arm: angles of its first and of its last link vector, or an extension.
pub(super) struct Redundant<'a> {
    chain: &'a ArmChain,
    decomposition: &'a Decomposition,
    revolutions: &'a Revolutions,
    ranges: &'a Ranges,
    /// Vector that free links and pair have to span (m).
    point: Vector2<f64>,
    /// Angle of the last link, where a heading prescribes it (rad).
    last: Option<f64>,
    /// Indices of the links whose angles are free.
    free: [Option<usize>; 2],
    /// Whether the last and the first unknown are free.
    is_free: [bool; 2],
    /// Unknowns at the present positions.
    seed: ArmVector,
    /// Position of each axis, from −1 at one limit to 1 at the other, for each unit of each unknown.
    by_unknown: [PerAxis; 4],
    /// Position of each axis, from −1 at one limit to 1 at the other, where all unknowns are zero.
    at_zero: PerAxis,
    poles: [EndBarrier; MAX_BARRIERS],
}

/// Unknowns that reach the target, with their cost.
#[derive(Clone, Copy)]
struct Candidate {
    unknown: ArmVector,
    found: PairSolution,
    /// Vector that the pair spans (m).
    point: Vector2<f64>,
    /// Free link vectors (m).
    link_vectors: [Vector2<f64>; 2],
    /// Position of each axis, from −1 at one limit to 1 at the other.
    normalized_positions: PerAxis,
    cost: f64,
    /// Part of the cost for elbow and reach direction.
    singularity_cost: f64,
}

impl<'a> Redundant<'a> {
    /// # Arguments
    /// * `seed` – present positions
    pub(super) fn new(
        chain: &'a ArmChain,
        decomposition: &'a Decomposition,
        revolutions: &'a Revolutions,
        ranges: &'a Ranges,
        point: Vector2<f64>,
        last: Option<f64>,
        seed: &ArmVector,
    ) -> Self {
        let (mut by_unknown, mut at_zero) = ([PerAxis::default(); 4], PerAxis::default());
        for a in 0..ranges.count {
            let half = ranges.half(a);
            at_zero[a] = -ranges.middle(a) / half;
            for (r, by_unknown) in by_unknown.iter_mut().enumerate() {
                by_unknown[a] = decomposition.inverse[(a, r)] / half;
            }
        }
        let vector = |k: usize| &chain.link_vectors()[k].vector;
        let near_end =
            EndBarrier::Reach(MIN_REACH * decomposition.last.map_or(0.0, |k| vector(k).norm()));
        let poles = match decomposition.pair {
            Pair::Links(_) => [EndBarrier::Elbow, EndBarrier::None],
            Pair::Belt(..) => [EndBarrier::Elbow, near_end],
            Pair::Prismatic(_) => [EndBarrier::None, near_end],
        };
        let held = decomposition.last.zip(last).map(|(k, turn)| turned(vector(k), turn));
        let point = point - held.unwrap_or_else(Vector2::zeros);
        let free = [decomposition.last.filter(|_| last.is_none()), decomposition.first];
        let is_free = decomposition.free_unknowns(last.is_some());
        let seed = decomposition.unknown(seed);
        Self {
            chain,
            decomposition,
            revolutions,
            ranges,
            point,
            last,
            free,
            is_free,
            seed,
            by_unknown,
            at_zero,
            poles,
        }
    }

    /// The positions of a given configuration that are farthest from limits, and from the stretched and the folded arm:
    /// a local minimum of Σ 1/(1 − u²) + 1/sin² β near the present positions, u from −1 at one limit of an axis to 1 at the other, β the elbow angle of two links, or half of it for a belt-driven pair, which is stretched at 0 and at π.
    ///
    /// The free angles descend while the pair follows in closed form, so that it never leaves its configuration:
    /// each step minimizes a second-order model of u and cos β.
    /// The start is the present position, or the same pose by other revolutions where that violates a limit; an arm with a free extension also starts from a grid where this leads out of limits.
    pub(super) fn away_from_limits(&self, configuration: Configuration) -> Option<ArmVector> {
        let here = self.candidate([self.seed[2], self.seed[3]], configuration, &self.seed);
        let here = here.map(|here| self.wrapped_to_limits(here));
        let (mut now, stretched) = match here {
            Some(here) if here.singularity_cost < MAX_ELBOW_COST => (here, None),
            here => match STARTS.iter().find_map(|&count| self.start(count, configuration)) {
                Some(now) => (now, here),
                None => return here.map(|here| self.decomposition.positions(&here.unknown)),
            },
        };
        now = self.descended(now, configuration);
        if self.decomposition.slide.is_some() && !self.is_within(&now) {
            let starts = STARTS.iter().filter_map(|&count| self.start(count, configuration));
            let mut found = starts.map(|start| self.descended(start, configuration));
            now = found.find(|found| self.is_within(found)).unwrap_or(now);
        }
        let taken = match stretched {
            Some(stretched) if self.is_within(&stretched) && !self.is_within(&now) => stretched,
            _ => now,
        };
        Some(self.decomposition.positions(&taken.unknown))
    }

    /// The local minimum of the cost near a place.
    fn descended(&self, mut now: Candidate, configuration: Configuration) -> Candidate {
        let mut radius = MAX_STEP;
        for _ in 0..MAX_ITERATIONS {
            let found = self.model(&now).and_then(|model| model.least(radius));
            let Some(DescentStep { step, gain }) = found else { break };
            let size = step.amax();
            if size.is_nan() || size < MIN_STEP {
                break;
            }
            let is_last = gain <= RELATIVE_TOLERANCE * now.cost;
            let there = [now.unknown[2] + step[0], now.unknown[3] + step[1]];
            match self.candidate(there, configuration, &now.unknown) {
                Some(next) if is_last => {
                    now = next;
                    break;
                }
                Some(next) if next.cost < now.cost => {
                    now = next;
                    radius = (2.0 * size).clamp(radius, MAX_STEP);
                }
                _ if is_last => break,
                _ => radius = 0.3 * size,
            }
        }
        now
    }

    /// The positions of a given configuration whose free links have the directions of the present positions.
    pub(super) fn keeping_redundant_angles(
        &self,
        configuration: Configuration,
    ) -> Option<ArmVector> {
        let here = self.candidate([self.seed[2], self.seed[3]], configuration, &self.seed)?;
        Some(self.decomposition.positions(&here.unknown))
    }

    fn is_within(&self, place: &Candidate) -> bool {
        place.normalized_positions.iter().all(|u| u.abs() <= 1.0)
    }

    /// The same pose by the revolutions of least cost, where a limit is violated otherwise.
    fn wrapped_to_limits(&self, place: Candidate) -> Candidate {
        if self.is_within(&place) {
            return place;
        }
        let mut best = place;
        self.revolutions.within(
            &self.decomposition.positions(&place.unknown),
            self.ranges,
            |arm_positions| {
                let mut wrapped = place;
                wrapped.unknown = self.decomposition.unknown(arm_positions);
                let wrapped = self.costed(wrapped);
                if wrapped.cost < best.cost {
                    best = wrapped;
                }
            },
        );
        best
    }

    /// The best of a grid of values of each free angle.
    fn start(&self, count: usize, configuration: Configuration) -> Option<Candidate> {
        let turn = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        // The vectors that a free link takes on the grid.
        let raster = |link_vector: Option<usize>| {
            let mut reached = [Vector2::zeros(); MAX_STARTS];
            if let Some(k) = link_vector {
                let vector = &self.chain.link_vectors()[k].vector;
                (0..count).for_each(|i| reached[i] = turned(vector, turn(i)));
            }
            (if link_vector.is_some() { count } else { 1 }, reached)
        };
        let [last, first] = self.free;
        if self.decomposition.slide.is_some() {
            return self.start_with_extension(count, configuration);
        }
        let (lasts, by_last) = raster(last);
        let (firsts, by_first) = raster(first);
        let mut best: Option<Candidate> = None;
        for (i, by_last) in by_last[..lasts].iter().enumerate() {
            let rest = self.point - by_last;
            for (j, by_first) in by_first[..firsts].iter().enumerate() {
                let most = best.as_ref().map_or(f64::INFINITY, |best| best.cost);
                if self.costs_at_least(&(rest - by_first)) > most {
                    continue;
                }
                let free = [turn(i), turn(j)];
                if let Some(found) = self.candidate(free, configuration, &self.seed)
                    && found.cost < most
                {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// Lower bound on the cost of spanning a vector: 1 for each axis, and that of the elbow by the law of cosines.
    fn costs_at_least(&self, point: &Vector2<f64>) -> f64 {
        let limits = AXES as f64;
        let Pair::Links([i, j]) = &self.decomposition.pair else { return limits };
        let twice = 2.0 * i.length * j.length;
        let cosine = (point.norm_squared() - i.length * i.length - j.length * j.length) / twice;
        let squared_sine = 1.0 - cosine * cosine;
        // Out of reach by more than round-off.
        if squared_sine < -1e-9 { f64::INFINITY } else { limits + 1.0 / squared_sine.max(0.0) }
    }

    /// Unknowns for given free angles, in the revolutions nearest to other unknowns.
    fn candidate(
        &self,
        free: [f64; 2],
        configuration: Configuration,
        seed: &ArmVector,
    ) -> Option<Candidate> {
        let link_vectors = from_fn(|f| match self.free[f] {
            Some(k) => turned(&self.chain.link_vectors()[k].vector, free[f]),
            None => Vector2::zeros(),
        });
        let mut point = self.point - link_vectors[0] - link_vectors[1];
        let extension = self.decomposition.free_extension(free);
        if let Some(slide) = self.decomposition.slide
            && Some(slide.link_vector) == self.decomposition.last
        {
            let along = self.chain.prismatic_joints()[0].along.vector * extension;
            point -= turned(&along, self.last.unwrap_or(free[0]));
        }
        let pair =
            self.decomposition.solve_links(self.chain, &point, configuration, [0.0; 2], extension);
        let solutions = pair.ok()?;
        let found = solutions.into_iter().flatten().next()?;
        let unknown = [found.pair[0], found.pair[1], self.last.unwrap_or(free[0]), free[1]];
        let unknown = self.decomposition.wrapped(&unknown, seed);
        let (normalized_positions, cost, singularity_cost) = (PerAxis::default(), 0.0, 0.0);
        Some(self.costed(Candidate {
            unknown,
            found,
            point,
            link_vectors,
            normalized_positions,
            cost,
            singularity_cost,
        }))
    }

    /// The same unknowns with their cost.
    #[inline]
    fn costed(&self, mut place: Candidate) -> Candidate {
        let (by, y) = (&self.by_unknown, &place.unknown);
        place.normalized_positions = from_fn(|a| {
            self.at_zero[a]
                + (by[0][a] * y[0] + by[1][a] * y[1])
                + (by[2][a] * y[2] + by[3][a] * y[3])
        });
        let ends = self.ends(&place.found);
        place.singularity_cost =
            (0..MAX_BARRIERS).map(|t| self.poles[t].cost_and_derivatives(ends[t][0])[0]).sum();
        place.cost =
            of_limits(&place.normalized_positions)[0].iter().sum::<f64>() + place.singularity_cost;
        place
    }

    /// Argument of each barrier, with its first two derivatives with respect to the squared length of the spanned vector.
    #[inline]
    fn ends(&self, found: &PairSolution) -> [[f64; 3]; MAX_BARRIERS] {
        let perpendicular = found.singular_coordinate.abs();
        let of_ahead = [
            perpendicular,
            0.5 / perpendicular,
            -0.25 / (perpendicular * perpendicular * perpendicular),
        ];
        match &self.decomposition.pair {
            Pair::Links([i, j]) => {
                [[found.singular_coordinate, 0.5 / (i.length * j.length), 0.0], [0.0; 3]]
            }
            Pair::Belt([i, _], belt_driven_link) => {
                let by_ahead = found.singular_coordinate.signum() / (2.0 * i.length);
                let [_, slope, curvature] = of_ahead.map(|number| number * by_ahead);
                [
                    [
                        (found.singular_coordinate - belt_driven_link.vector.x) / (2.0 * i.length),
                        slope,
                        curvature,
                    ],
                    of_ahead,
                ]
            }
            Pair::Prismatic(_) => [[0.0; 3], of_ahead],
        }
    }

    /// Second-order model of the cost; `None` where the arm is stretched or folded.
    ///
    /// ```text
    ///    S p_f  =  −w_f        S p_fg  =  −(w_fg + Σ_ij S_ij p_i,f p_j,g)
    /// ```
    /// for the pair p, the derivatives S and S_ij of its span, and the derivatives w_f and w_fg of the free link vectors.
    fn model(&self, now: &Candidate) -> Option<Model> {
        if self.decomposition.slide.is_some() {
            return self.difference_model(now);
        }
        let span = self.decomposition.span_change(&now.found, &now.point);
        let inverse = Matrix2::from_columns(&span.velocities).try_inverse()?;
        let [a, b] = &now.link_vectors;
        let [p, q] = [a, b].map(|link_vector| -(inverse * perpendicular(link_vector)));
        let bent = |p: &Vector2<f64>, q: &Vector2<f64>, inward: &Vector2<f64>| {
            let [first, both, second] = &span.second;
            let change =
                first * (p[0] * q[0]) + both * (p[0] * q[1] + p[1] * q[0]) + second * (p[1] * q[1]);
            inverse * (inward - change)
        };
        let bends = [bent(&p, &p, a), bent(&p, &q, &Vector2::zeros()), bent(&q, &q, b)];
        let free = self.is_free;
        let by = &self.by_unknown;
        let by_pair = |pair: &Vector2<f64>| from_fn(|t| by[0][t] * pair[0] + by[1][t] * pair[1]);
        let mut slopes: [PerAxis; 2] = [by_pair(&p), by_pair(&q)];
        for (f, slopes) in slopes.iter_mut().enumerate().filter(|&(f, _)| free[f]) {
            *slopes = from_fn(|t| slopes[t] + by[2 + f][t]);
        }
        let curvatures = from_fn(|k| by_pair(&bends[k]));
        let limits = QuadraticModel { values: now.normalized_positions, slopes, curvatures };
        // Derivatives of the squared length that the pair spans.
        let slope = [2.0 * now.point.perp(a), 2.0 * now.point.perp(b)];
        let curvature = [a.dot(&(a + now.point)), a.dot(b), b.dot(&(b + now.point))];
        let square = [slope[0] * slope[0], slope[0] * slope[1], slope[1] * slope[1]];
        let by = self.ends(&now.found);
        let ends = QuadraticModel {
            values: by.map(|by| by[0]),
            slopes: from_fn(|f| by.map(|by| slope[f] * by[1])),
            curvatures: from_fn(|k| by.map(|by| 2.0 * curvature[k] * by[1] + square[k] * by[2])),
        };
        Some(Model { limits, ends, poles: self.poles, free })
    }
}
