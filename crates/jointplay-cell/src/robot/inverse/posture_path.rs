//! Postures of an arm along a whole path of its wafer: redundancy and branch are resolved for the path, not for each of its points.

use std::array::from_fn;
use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Vector2};

use super::barrier::of_limits;
use super::closed_form::PairSolution;
use super::decomposition::{Decomposition, Pair};
use super::revolutions::{Ranges, Revolutions};
use super::solution::Configuration;
use crate::robot::arm_chain::{ArmChain, AxisCoefficients, turned};
use crate::robot::hybrid_robot::{EffectorId, HybridRobot};

/// Distance of neighbouring samples of the search (m).
const SAMPLE_DISTANCE: f64 = 0.03;
/// Least and largest number of intervals between samples of the search.
const INTERVALS: [usize; 2] = [8, 64];
/// Number of grid values of one free angle; for two, the values of each.
const GRID: [usize; 2] = [120, 36];
/// Largest change of a free angle between neighbouring samples, in steps of the grid, for one and for two free angles.
const REACH: [usize; 2] = [6, 2];
/// Largest change of a link's angle between neighbouring samples: beyond it the pair is too near its stretched or folded position to be followed (rad).
const LARGEST_TURN: f64 = 0.8;
/// Largest change of a prismatic joint between neighbouring samples, in distances of samples.
const LARGEST_SLIDE: f64 = 4.0;
/// Weight of the limits of axes, and of the stretched arm, against the squared duration of the path (s²).
const LIMIT_WEIGHT: f64 = 0.02;
/// Weight of curvature against the squared duration.
const CURVATURE_WEIGHT: f64 = 0.02;
/// Weight of the distance of the first posture from the home position.
const HOME_WEIGHT: f64 = 0.05;
/// Number of intervals that one interval of the search is divided into for smoothing.
const REFINEMENT: usize = 2;
/// Step of the free angles for derivatives (rad).
const DIFFERENCE: f64 = 1e-5;
/// Damping of the first descent step, and its limits, as a share of the diagonal.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-9;
const LARGEST_DAMPING: f64 = 1e9;
/// Largest number of descent steps.
const MAX_ITERATIONS: usize = 60;
/// Share of the cost below which a gain ends the descent.
const LEAST_GAIN: f64 = 1e-5;

/// A path of the wafer's centre in the arm's plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlanarPath {
    /// Corners of the path, in the platform frame (m).
    pub(crate) corners: Vec<Vector2<f64>>,
    /// Heading of the wafer from the platform's x axis, where it is prescribed (rad).
    pub(crate) heading: Option<f64>,
}

/// Positions of an arm's motors along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PosturePath {
    /// Shares of the path's length, growing from 0 to 1.
    pub shares: Vec<f64>,
    /// Positions of the arm's axes at each share, rods aside, in the order of the joints that they drive first (m or rad).
    pub positions: Vec<Vec<f64>>,
}

impl PosturePath {
    /// Positions of the arm's axes at a share of the path's length, between the samples on a straight path (m or rad).
    pub(crate) fn at(&self, share: f64) -> Vec<f64> {
        let next = self.shares.partition_point(|&s| s <= share).clamp(1, self.shares.len() - 1);
        let [from, to] = [self.shares[next - 1], self.shares[next]];
        let t = (share - from) / (to - from);
        let pairs = self.positions[next - 1].iter().zip(&self.positions[next]);
        pairs.map(|(a, b)| a + t * (b - a)).collect()
    }
}

/// No motion of an arm's motors follows a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoPosturePath {
    /// Largest share of the path's length that can be followed from its start.
    pub(crate) share: f64,
}

impl PlanarPath {
    /// Shares of the path's length at the corners.
    pub(crate) fn shares(&self) -> Vec<f64> {
        let mut lengths = vec![0.0];
        for pair in self.corners.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let whole = lengths[lengths.len() - 1];
        lengths.iter().map(|length| if whole > 0.0 { length / whole } else { 1.0 }).collect()
    }

    fn length(&self) -> f64 {
        self.corners.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    /// The point at a share of the path's length (m).
    pub(crate) fn at(&self, share: f64) -> Vector2<f64> {
        let shares = self.shares();
        let leg = shares.partition_point(|&s| s <= share).clamp(1, shares.len() - 1);
        let [from, to] = [shares[leg - 1], shares[leg]];
        let t = if to > from { (share - from) / (to - from) } else { 0.0 };
        self.corners[leg - 1] + (self.corners[leg] - self.corners[leg - 1]) * t
    }
}

impl HybridRobot {
    /// Whether an arm can hold its wafer at a point in several postures that a path connects: it has motors to spare, or a pair of links with two elbows and a heading to keep.
    pub(crate) fn has_posture_paths(&self, id: EffectorId) -> bool {
        let chain = ArmChain::new(self, id);
        chain.axes().len() > 2 && Decomposition::new(&chain).is_some()
    }

    /// Positions of an arm's motors that carry the wafer's centre along a path in the arm's plane, without a jump and within limits.
    ///
    /// ```text
    ///    min ∫ Σ_a (q_a′/v_a)² + c (q_a″/v_a)² + w Σ_a 1/(1 − u_a²) + w/sin² β ds
    /// ```
    /// v: velocity limit of an axis, u: its position, from −1 at one limit to 1 at the other, β: the elbow angle. The first posture is free, at a small cost for its distance from home.
    /// A shortest path through a grid of free angles, elbows and revolutions is the global minimum on that grid; it is then smoothed.
    ///
    /// # Errors
    /// [`NoPosturePath`] where no grid path exists.
    ///
    /// # Panics
    /// The effector does not exist, or the arm has no closed form; see [`Self::has_posture_paths`].
    pub(crate) fn posture_path(
        &self,
        id: EffectorId,
        path: &PlanarPath,
    ) -> Result<PosturePath, NoPosturePath> {
        let chain = ArmChain::new(self, id);
        let decomposition = Decomposition::new(&chain).expect("the arm has a closed form");
        let search = PostureSearch::new(self, &chain, &decomposition, path);
        let found = search.shortest()?;
        Ok(search.smoothed(found))
    }
}

/// A posture at a sample.
#[derive(Debug, Clone, Copy)]
struct Posture {
    /// Angle of the last link vector and of the first, where they are free (rad).
    free: [f64; 2],
    unknown: AxisCoefficients,
    own: AxisCoefficients,
    configuration: Configuration,
    /// Cost of limits and elbow.
    cost: f64,
}

/// Postures of one sample, by the cell of the grid that they are in.
struct Layer {
    postures: Vec<Posture>,
    /// Index of the first posture of each cell, and the number of all.
    cells: Vec<usize>,
}

struct PostureSearch<'a> {
    chain: &'a ArmChain,
    decomposition: &'a Decomposition,
    revolutions: Revolutions,
    ranges: Ranges,
    path: &'a PlanarPath,
    /// Whether the last and the first link vector are free.
    is_free: [bool; 2],
    /// Number of intervals between samples.
    intervals: usize,
    /// Numbers of grid values of the free angles.
    grid: [usize; 2],
    /// Largest changes of the free angles between samples, in steps of the grid.
    reach: usize,
    /// One over the velocity limit of each axis (s/m or s/rad).
    slowness: AxisCoefficients,
    home: AxisCoefficients,
    /// Largest change of the pair between samples (rad, or m).
    largest: [f64; 2],
}

impl<'a> PostureSearch<'a> {
    fn new(
        robot: &HybridRobot,
        chain: &'a ArmChain,
        decomposition: &'a Decomposition,
        path: &'a PlanarPath,
    ) -> Self {
        let is_free =
            [decomposition.last.is_some() && path.heading.is_none(), decomposition.first.is_some()];
        let count = is_free.iter().filter(|free| **free).count();
        let [grid, reach] = [GRID, REACH].map(|both| both[count.saturating_sub(1)]);
        let intervals = (path.length() / SAMPLE_DISTANCE).ceil() as usize;
        let intervals = intervals.clamp(INTERVALS[0], INTERVALS[1]);
        let (mut slowness, mut home) = ([0.0; 4], [0.0; 4]);
        for (a, &axis) in chain.axes().iter().enumerate() {
            slowness[a] = 1.0 / robot.axes[axis].loaded.velocity;
            home[a] = robot.axes[axis].home;
        }
        let slide = LARGEST_SLIDE * path.length() / intervals as f64;
        let largest = match decomposition.pair {
            Pair::Prismatic(_) => [LARGEST_TURN, slide],
            Pair::Links(_) | Pair::Belt(..) => [LARGEST_TURN; 2],
        };
        Self {
            chain,
            decomposition,
            revolutions: Revolutions::of(decomposition),
            ranges: robot.ranges(chain),
            path,
            is_free,
            intervals,
            grid: is_free.map(|free| if free { grid } else { 1 }),
            reach,
            slowness,
            home,
            largest,
        }
    }

    /// The vector that the pair has to span at a point, for given angles of the other links (m).
    fn spanned(&self, point: &Vector2<f64>, free: [f64; 2]) -> Vector2<f64> {
        let mut spanned = point - self.chain.origin;
        let angles = [self.last_angle(free), free[1]];
        let links = [self.decomposition.last, self.decomposition.first];
        for (link, angle) in links.into_iter().zip(angles) {
            if let Some(k) = link {
                spanned -= turned(&self.chain.link_vectors()[k].vector, angle);
            }
        }
        spanned
    }

    /// Angle of the last link vector (rad).
    fn last_angle(&self, free: [f64; 2]) -> f64 {
        match self.path.heading {
            Some(heading) if self.decomposition.last.is_some() => heading - self.chain.heading.0,
            _ => free[0],
        }
    }

    fn unknown(&self, found: &PairSolution, free: [f64; 2]) -> AxisCoefficients {
        [found.pair[0], found.pair[1], self.last_angle(free), free[1]]
    }

    /// A posture with its cost; `own` may differ from `unknown` by whole revolutions.
    fn posture(&self, found: &PairSolution, free: [f64; 2], own: &AxisCoefficients) -> Posture {
        let unknown = self.decomposition.unknown(own);
        let shares = from_fn(|a| {
            let used = a < self.ranges.count;
            if used { (own[a] - self.ranges.middle(a)) / self.ranges.half(a) } else { 0.0 }
        });
        let limits: f64 = of_limits(&shares)[0].iter().sum();
        let configuration = found.configuration;
        Posture { free, unknown, own: *own, configuration, cost: limits + self.elbow_cost(found) }
    }

    /// Cost of the stretched and of the folded arm.
    fn elbow_cost(&self, found: &PairSolution) -> f64 {
        match self.decomposition.pair {
            Pair::Links(_) => {
                1.0 / (1.0 - found.end_distance * found.end_distance).max(f64::MIN_POSITIVE)
            }
            Pair::Belt(..) | Pair::Prismatic(_) => 0.0,
        }
    }

    fn is_within_limits(&self, own: &AxisCoefficients) -> bool {
        (0..self.ranges.count).all(|a| (self.ranges.min[a]..=self.ranges.max[a]).contains(&own[a]))
    }

    /// All postures at a share of the path, on the grid of free angles.
    fn layer(&self, share: f64) -> Layer {
        let point = self.path.at(share);
        let mut layer = Layer { postures: Vec::new(), cells: vec![0] };
        for i in 0..self.grid[0] {
            for j in 0..self.grid[1] {
                let free =
                    [TAU * i as f64 / self.grid[0] as f64, TAU * j as f64 / self.grid[1] as f64];
                let spanned = self.spanned(&point, free);
                let any = Configuration::default();
                if let Ok(found) = self.decomposition.span(self.chain, &spanned, any, [0.0; 2]) {
                    for found in found.iter().flatten() {
                        let own = self.decomposition.positions(&self.unknown(found, free));
                        self.revolutions.within(&own, &self.ranges, |own| {
                            if self.is_within_limits(own) {
                                layer.postures.push(self.posture(found, free, own));
                            }
                        });
                    }
                }
                layer.cells.push(layer.postures.len());
            }
        }
        layer
    }

    /// Squared duration of a change at the velocity limits (s²).
    fn squared_duration(&self, change: &AxisCoefficients) -> f64 {
        let each = change.iter().zip(&self.slowness);
        each.map(|(change, slowness)| (change * slowness) * (change * slowness)).sum()
    }

    /// Whether two neighbouring postures are on one branch.
    fn is_continuous(&self, from: &Posture, to: &Posture) -> bool {
        (0..2).all(|r| (to.unknown[r] - from.unknown[r]).abs() <= self.largest[r])
            && (2..4).all(|r| (to.unknown[r] - from.unknown[r]).abs() < std::f64::consts::PI)
            && from.configuration.agrees_with(to.configuration)
    }

    /// The shortest path through the grid.
    fn shortest(&self) -> Result<Vec<Posture>, NoPosturePath> {
        let layers: Vec<Layer> =
            (0..=self.intervals).map(|k| self.layer(k as f64 / self.intervals as f64)).collect();
        let step = 1.0 / self.intervals as f64;
        let first = layers[0].postures.iter().map(|posture| {
            let away: AxisCoefficients = from_fn(|a| posture.own[a] - self.home[a]);
            HOME_WEIGHT * self.squared_duration(&away) + LIMIT_WEIGHT * step * posture.cost
        });
        let mut costs: Vec<f64> = first.collect();
        let mut before: Vec<Vec<usize>> = vec![Vec::new()];
        if costs.is_empty() {
            return Err(NoPosturePath { share: 0.0 });
        }
        for k in 1..layers.len() {
            let (from, to) = (&layers[k - 1], &layers[k]);
            let mut next = vec![f64::INFINITY; to.postures.len()];
            let mut by = vec![usize::MAX; to.postures.len()];
            self.for_neighbours(from, to, |f, t| {
                if !costs[f].is_finite() {
                    return;
                }
                let (a, b) = (&from.postures[f], &to.postures[t]);
                if !self.is_continuous(a, b) {
                    return;
                }
                let change: AxisCoefficients = from_fn(|a_| b.own[a_] - a.own[a_]);
                let cost =
                    costs[f] + self.squared_duration(&change) / step + LIMIT_WEIGHT * step * b.cost;
                if cost < next[t] {
                    (next[t], by[t]) = (cost, f);
                }
            });
            if !next.iter().any(|cost| cost.is_finite()) {
                return Err(NoPosturePath { share: (k - 1) as f64 * step });
            }
            costs = next;
            before.push(by);
        }
        let least = |best: usize, k: usize| if costs[k] < costs[best] { k } else { best };
        let mut at = (0..costs.len()).fold(0, least);
        let mut found = Vec::with_capacity(layers.len());
        for k in (0..layers.len()).rev() {
            found.push(layers[k].postures[at]);
            if k > 0 {
                at = before[k][at];
            }
        }
        found.reverse();
        Ok(found)
    }

    /// Calls a function with all pairs of postures in neighbouring cells of two layers.
    fn for_neighbours(&self, from: &Layer, to: &Layer, mut each: impl FnMut(usize, usize)) {
        let near = |k: usize, count: usize| {
            let reach = self.reach.min(count / 2);
            let all = if count == 1 { 1 } else { (2 * reach + 1).min(count) };
            (0..all).map(move |d| (k + count + d - if count == 1 { 0 } else { reach }) % count)
        };
        let [rows, columns] = self.grid;
        for i in 0..rows {
            for j in 0..columns {
                let cell = i * columns + j;
                let ends = from.cells[cell]..from.cells[cell + 1];
                if ends.is_empty() {
                    continue;
                }
                for row in near(i, rows) {
                    for column in near(j, columns) {
                        let other = row * columns + column;
                        for t in to.cells[other]..to.cells[other + 1] {
                            ends.clone().for_each(|f| each(f, t));
                        }
                    }
                }
            }
        }
    }

    /// The path with smooth free angles, on a finer grid of samples where all of them can be reached.
    fn smoothed(&self, found: Vec<Posture>) -> PosturePath {
        let postures = self.refined(&found).unwrap_or(found);
        let last = (postures.len() - 1) as f64;
        let shares: Vec<f64> = (0..postures.len()).map(|k| k as f64 / last).collect();
        let mut smoothing = Smoothing { search: self, shares: &shares, postures };
        smoothing.run();
        let postures = smoothing.postures.iter();
        let positions = postures.map(|it| it.own[..self.ranges.count].to_vec()).collect();
        PosturePath { shares, positions }
    }

    /// Postures with others between them, their free angles interpolated.
    fn refined(&self, found: &[Posture]) -> Option<Vec<Posture>> {
        let count = self.intervals * REFINEMENT;
        let mut refined = vec![found[0]];
        for k in 1..=count {
            let (at, t) = (k / REFINEMENT, (k % REFINEMENT) as f64 / REFINEMENT as f64);
            let from = &found[at];
            let next = found.get(at + 1).unwrap_or(from);
            let free = from_fn(|f| from.free[f] + t * (next.unknown[2 + f] - from.unknown[2 + f]));
            let near = refined[k - 1];
            let posture = self.posture_near(k as f64 / count as f64, free, &near)?;
            self.is_continuous(&near, &posture).then(|| refined.push(posture))?;
        }
        Some(refined)
    }

    /// The posture of given free angles in the configuration and revolutions of another.
    fn posture_near(&self, share: f64, free: [f64; 2], near: &Posture) -> Option<Posture> {
        let spanned = self.spanned(&self.path.at(share), free);
        let pair = [near.unknown[0], near.unknown[1]];
        let found = self.decomposition.span(self.chain, &spanned, near.configuration, pair).ok()?;
        let found = found.into_iter().flatten().next()?;
        let unknown = self.decomposition.wrapped(&self.unknown(&found, free), &near.unknown);
        let own = self.decomposition.positions(&unknown);
        self.is_within_limits(&own).then(|| self.posture(&found, free, &own))
    }
}

/// Levenberg–Marquardt descent of the cost of a path over its free angles.
struct Smoothing<'a> {
    search: &'a PostureSearch<'a>,
    shares: &'a [f64],
    postures: Vec<Posture>,
}

/// Derivatives of the positions, and of the root of the cost of limits, by the free angles of one posture.
#[derive(Clone, Copy, Default)]
struct PostureSlopes {
    own: [AxisCoefficients; 2],
    root_cost: [f64; 2],
}

impl Smoothing<'_> {
    fn run(&mut self) {
        let free: Vec<usize> = (0..2).filter(|&f| self.search.is_free[f]).collect();
        if free.is_empty() {
            return;
        }
        let mut damping = FIRST_DAMPING;
        let mut cost = self.residuals().norm_squared();
        for _ in 0..MAX_ITERATIONS {
            let residuals = self.residuals();
            let jacobian = self.jacobian(&free, residuals.len());
            let gradient = jacobian.tr_mul(&residuals);
            let normal = jacobian.tr_mul(&jacobian);
            let mut improved = None;
            while damping < LARGEST_DAMPING {
                let mut damped = normal.clone();
                for k in 0..damped.nrows() {
                    damped[(k, k)] *= 1.0 + damping;
                    damped[(k, k)] += f64::MIN_POSITIVE;
                }
                let step = damped.cholesky().map(|factors| factors.solve(&-&gradient));
                if let Some(found) = step.and_then(|step| self.moved(&free, &step)) {
                    let before = std::mem::replace(&mut self.postures, found);
                    let now = self.residuals().norm_squared();
                    if now < cost {
                        improved = Some((cost - now) / cost);
                        cost = now;
                        damping = (damping * 0.1).max(LEAST_DAMPING);
                        break;
                    }
                    self.postures = before;
                }
                damping *= 10.0;
            }
            if improved.is_none_or(|gain| gain < LEAST_GAIN) {
                break;
            }
        }
    }

    /// The postures after a step of all free angles; `None` where one cannot be reached, or jumps.
    fn moved(&self, free: &[usize], step: &DVector<f64>) -> Option<Vec<Posture>> {
        let moved = self.postures.iter().enumerate().map(|(k, posture)| {
            let mut angles = posture.free;
            for (row, &f) in free.iter().enumerate() {
                angles[f] += step[k * free.len() + row];
            }
            self.search.posture_near(self.shares[k], angles, posture)
        });
        let moved = moved.collect::<Option<Vec<Posture>>>()?;
        let continuous = moved.windows(2).all(|pair| self.search.is_continuous(&pair[0], &pair[1]));
        continuous.then_some(moved)
    }

    /// Weighted differences of the positions, so that the sum of their squares is the cost of the path.
    #[expect(
        clippy::needless_range_loop,
        reason = "the axes of several arrays, of which only the first ones are used"
    )]
    fn residuals(&self) -> DVector<f64> {
        let step = self.step();
        let [first, second] = difference_weights(step);
        let slowness = &self.search.slowness;
        let own = |k: usize, a: usize| self.postures[k].own[a] * slowness[a];
        let mut residuals = Vec::new();
        for a in 0..self.search.ranges.count {
            residuals.push(HOME_WEIGHT.sqrt() * (own(0, a) - self.search.home[a] * slowness[a]));
        }
        for (k, posture) in self.postures.iter().enumerate() {
            residuals.push((LIMIT_WEIGHT * step * posture.cost).sqrt());
            for a in 0..self.search.ranges.count {
                if k > 0 {
                    residuals.push(first * (own(k, a) - own(k - 1, a)));
                }
                if k > 1 {
                    let bend = own(k, a) - 2.0 * own(k - 1, a) + own(k - 2, a);
                    residuals.push(second * bend);
                }
            }
        }
        DVector::from_vec(residuals)
    }

    /// Derivatives of the residuals by the free angles, in the order of both.
    #[expect(
        clippy::needless_range_loop,
        reason = "the axes of several arrays, of which only the first ones are used"
    )]
    fn jacobian(&self, free: &[usize], rows: usize) -> DMatrix<f64> {
        let step = self.step();
        let [first, second] = difference_weights(step);
        let slowness = &self.search.slowness;
        let slopes: Vec<PostureSlopes> = (0..self.postures.len()).map(|k| self.slopes(k)).collect();
        let mut jacobian = DMatrix::zeros(rows, self.postures.len() * free.len());
        let mut row = 0;
        let mut add =
            |row: usize, k: usize, factor: f64, of: &dyn Fn(&PostureSlopes, usize) -> f64| {
                for (column, &f) in free.iter().enumerate() {
                    jacobian[(row, k * free.len() + column)] += factor * of(&slopes[k], f);
                }
            };
        for a in 0..self.search.ranges.count {
            add(row, 0, HOME_WEIGHT.sqrt() * slowness[a], &|slopes, f| slopes.own[f][a]);
            row += 1;
        }
        for k in 0..self.postures.len() {
            add(row, k, (LIMIT_WEIGHT * step).sqrt(), &|slopes, f| slopes.root_cost[f]);
            row += 1;
            for a in 0..self.search.ranges.count {
                let of = |slopes: &PostureSlopes, f: usize| slopes.own[f][a] * slowness[a];
                if k > 0 {
                    add(row, k, first, &of);
                    add(row, k - 1, -first, &of);
                    row += 1;
                }
                if k > 1 {
                    add(row, k, second, &of);
                    add(row, k - 1, -2.0 * second, &of);
                    add(row, k - 2, second, &of);
                    row += 1;
                }
            }
        }
        jacobian
    }

    /// Derivatives at one posture by central differences; one-sided at the end of what can be reached.
    fn slopes(&self, k: usize) -> PostureSlopes {
        let here = &self.postures[k];
        let mut slopes = PostureSlopes::default();
        for f in (0..2).filter(|&f| self.search.is_free[f]) {
            let at = |offset: f64| {
                let mut angles = here.free;
                angles[f] += offset;
                self.search.posture_near(self.shares[k], angles, here)
            };
            let [(low, before), (high, after)] = [-DIFFERENCE, DIFFERENCE]
                .map(|offset| at(offset).map_or((0.0, *here), |found| (offset, found)));
            if high > low {
                let by = 1.0 / (high - low);
                slopes.own[f] = from_fn(|a| (after.own[a] - before.own[a]) * by);
                slopes.root_cost[f] = (after.cost.sqrt() - before.cost.sqrt()) * by;
            }
        }
        slopes
    }

    fn step(&self) -> f64 {
        1.0 / (self.shares.len() - 1) as f64
    }
}

/// Weights of first and second differences of neighbouring samples.
fn difference_weights(step: f64) -> [f64; 2] {
    [step.powf(-0.5), (CURVATURE_WEIGHT / (step * step * step)).sqrt()]
}
