//! Shortest path through a grid of an arm's postures along a path of its wafer.

use std::array::from_fn;
use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use super::barrier::of_limits;
use super::closed_form::{PairSolution, PairSolutions};
use super::decomposition::{Decomposition, Pair};
use super::posture_path::{NoPosturePath, PlanarPath};
use super::revolutions::{Ranges, Revolutions};
use super::solution::Configuration;
use crate::robot::arm_chain::{ArmChain, ArmVector, turned};
use crate::robot::hybrid_robot::HybridRobot;

/// Distance of neighbouring samples of the search (m).
const SAMPLE_DISTANCE: f64 = 0.03;
/// Least and largest number of intervals between samples of the search.
const INTERVALS: [usize; 2] = [8, 64];
/// Number of grid values of one free angle; for two, the values of each.
const GRID: [usize; 2] = [120, 36];
/// Largest change of a free angle between neighbouring samples, in steps of the grid, for one and for two free angles.
const NEIGHBOURHOOD: [usize; 2] = [6, 2];
/// Factor by which the grid of a fine search has more values of each free angle, and its neighbourhood more steps, so that the neighbourhood covers the same angles.
const FINE_FACTOR: usize = 2;
/// Largest change of a link's angle between neighbouring samples: beyond it the pair is too near its stretched or folded position to be followed (rad).
const MAX_ROTATION: f64 = 0.8;
/// Largest change of a prismatic joint between neighbouring samples, in distances of samples.
const MAX_TRANSLATION: f64 = 4.0;
/// Largest distance of neighbouring grid values of a free extension (m).
const EXTENSION_STEP: f64 = 0.015;
/// Weight of the limits of axes, and of the stretched arm, against the squared duration of the path (s²).
pub(super) const LIMIT_WEIGHT: f64 = 0.02;
/// Weight of curvature against the squared duration.
pub(super) const CURVATURE_WEIGHT: f64 = 0.02;
/// Weight of the distance of the first posture from the home position, without the axes that turn the whole arm.
const HOME_WEIGHT: f64 = 0.05;

/// A posture at a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Posture {
    /// Angle of the last link vector and of the first, or an extension in the place of one, where they are free (rad or m).
    pub(super) free: [f64; 2],
    pub(super) unknown: ArmVector,
    pub(super) arm_positions: ArmVector,
    configuration: Configuration,
    /// Cost of limits and elbow.
    pub(super) cost: f64,
}

/// Postures of an arm along a path, one of several candidates: the shortest path through the grid from a first posture that is better than its neighbours.
#[derive(Debug, Clone)]
pub(crate) struct PostureCandidate {
    pub(super) postures: Vec<Posture>,
    /// Cost of the path without its curvature: its squared duration at the velocity limits, with weighted penalties of limits, stretched elbow and distance from home (s²).
    pub(crate) cost: f64,
}

impl PostureCandidate {
    /// Positions of the arm's axes at the start of the path, followed by zeros up to four (m or rad).
    pub(crate) fn first_positions(&self) -> &ArmVector {
        &self.postures[0].arm_positions
    }
}

/// Postures of one sample, by the cell of the grid that they are in.
struct Layer {
    postures: Vec<Posture>,
    /// Index of the first posture of each cell, and the number of all.
    bins: Vec<usize>,
}

pub(super) struct PostureSearch<'a> {
    chain: &'a ArmChain,
    decomposition: &'a Decomposition,
    revolutions: Revolutions,
    pub(super) ranges: Ranges,
    path: &'a PlanarPath,
    /// Whether the last and the first unknown are free.
    pub(super) is_free: [bool; 2],
    /// Number of intervals between samples.
    pub(super) intervals: usize,
    /// Numbers of grid values of the free angles.
    pub(super) grid: [usize; 2],
    /// Largest changes of the free angles between samples, in steps of the grid.
    neighbourhood: usize,
    /// One over the velocity limit of each axis (s/m or s/rad).
    pub(super) inverse_speed: ArmVector,
    pub(super) home: ArmVector,
    /// Root of the weight of the distance of the first posture from home, over the velocity limit of each axis; zero for axes that turn the whole arm (s/m or s/rad).
    pub(super) home_weights: ArmVector,
    /// Largest change of each unknown between samples (rad, or m).
    largest: ArmVector,
    /// Least and largest extension of a free prismatic joint (m).
    extensions: [f64; 2],
}

impl<'a> PostureSearch<'a> {
    pub(super) fn new(
        robot: &HybridRobot,
        chain: &'a ArmChain,
        decomposition: &'a Decomposition,
        path: &'a PlanarPath,
    ) -> Self {
        let is_free = decomposition.free_unknowns(path.heading.is_some());
        let count = is_free.iter().filter(|free| **free).count();
        let [grid, neighbourhood] = [GRID, NEIGHBOURHOOD].map(|both| both[count.saturating_sub(1)]);
        let intervals = (path.length() / SAMPLE_DISTANCE).ceil() as usize;
        let intervals = intervals.clamp(INTERVALS[0], INTERVALS[1]);
        let (mut inverse_speed, mut home, mut home_weights) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for (a, &axis) in chain.axes().iter().enumerate() {
            inverse_speed[a] = 1.0 / robot.axes[axis].loaded.velocity;
            home[a] = robot.axes[axis].home;
            if !robot.turns_whole_arms(axis) {
                home_weights[a] = HOME_WEIGHT.sqrt() * inverse_speed[a];
            }
        }
        let slide = MAX_TRANSLATION * path.length() / intervals as f64;
        let largest = from_fn(|unknown| match unknown {
            _ if !decomposition.is_angle(unknown) => slide,
            0 | 1 => MAX_ROTATION,
            _ => PI,
        });
        let ranges = robot.ranges(chain);
        let extensions = decomposition.extension_range(&ranges);
        let steps = ((extensions[1] - extensions[0]) / EXTENSION_STEP).ceil() as usize;
        let values = |f: usize| match f {
            _ if !is_free[f] => 1,
            _ if !decomposition.is_angle(2 + f) => steps.clamp(1, grid) + 1,
            _ => grid,
        };
        Self {
            chain,
            decomposition,
            revolutions: Revolutions::of(decomposition),
            ranges,
            path,
            is_free,
            intervals,
            grid: from_fn(values),
            neighbourhood,
            inverse_speed,
            home,
            home_weights,
            largest,
            extensions,
        }
    }

    /// Value of a free unknown on the grid.
    fn grid_value(&self, f: usize, index: usize) -> f64 {
        let count = self.grid[f];
        if self.decomposition.is_angle(2 + f) {
            return TAU * index as f64 / count as f64;
        }
        let [least, most] = self.extensions;
        least + (most - least) * index as f64 / (count - 1) as f64
    }

    /// The pair for given free unknowns.
    fn solve_pair(
        &self,
        point: &Vector2<f64>,
        free: [f64; 2],
        wanted: Configuration,
        like: [f64; 2],
    ) -> Option<PairSolutions> {
        let spanned = self.spanned(point, free);
        let extension = self.decomposition.free_extension(free);
        self.decomposition.solve_links(self.chain, &spanned, wanted, like, extension).ok()
    }

    /// The search on a finer grid, which finds narrower passages and takes about sixteen times as long for each pair of free angles.
    pub(super) fn finer(mut self) -> Self {
        self.grid = self.grid.map(|count| if count > 1 { FINE_FACTOR * count } else { count });
        self.neighbourhood *= FINE_FACTOR;
        self
    }

    /// The vector that the pair has to span at a point, for given angles of the other links (m).
    fn spanned(&self, point: &Vector2<f64>, free: [f64; 2]) -> Vector2<f64> {
        let mut spanned = point - self.chain.origin;
        let angles = [self.last_angle(free), free[1]];
        let extension = self.decomposition.free_extension(free);
        let links = [self.decomposition.last, self.decomposition.first];
        for (link, angle) in links.into_iter().zip(angles) {
            if let Some(k) = link {
                spanned -= turned(&self.decomposition.extended(self.chain, k, extension), angle);
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

    fn unknown(&self, found: &PairSolution, free: [f64; 2]) -> ArmVector {
        [found.pair[0], found.pair[1], self.last_angle(free), free[1]]
    }

    /// A posture with its cost.
    ///
    /// # Arguments
    /// * `arm_positions` – positions of the arm's axes for `found` and `free`, up to whole revolutions
    fn posture(&self, found: &PairSolution, free: [f64; 2], arm_positions: &ArmVector) -> Posture {
        let unknown = self.decomposition.unknown(arm_positions);
        let fractions = from_fn(|a| {
            let used = a < self.ranges.count;
            if used {
                (arm_positions[a] - self.ranges.middle(a)) / self.ranges.half(a)
            } else {
                0.0
            }
        });
        let limits: f64 = of_limits(&fractions)[0].iter().sum();
        let configuration = found.configuration;
        Posture {
            free,
            unknown,
            arm_positions: *arm_positions,
            configuration,
            cost: limits + self.elbow_cost(found),
        }
    }

    /// Cost of the stretched and of the folded arm.
    fn elbow_cost(&self, found: &PairSolution) -> f64 {
        match self.decomposition.pair {
            Pair::Links(_) => {
                1.0 / (1.0 - found.singular_coordinate * found.singular_coordinate)
                    .max(f64::MIN_POSITIVE)
            }
            Pair::Belt(..) | Pair::Prismatic(_) => 0.0,
        }
    }

    fn is_within_limits(&self, arm_positions: &ArmVector) -> bool {
        (0..self.ranges.count)
            .all(|a| (self.ranges.min[a]..=self.ranges.max[a]).contains(&arm_positions[a]))
    }

    /// All postures at a fraction of the path, on the grid of free angles.
    fn layer(&self, fraction: f64) -> Layer {
        let point = self.path.at(fraction);
        let mut layer = Layer { postures: Vec::new(), bins: vec![0] };
        for i in 0..self.grid[0] {
            for j in 0..self.grid[1] {
                let free = [self.grid_value(0, i), self.grid_value(1, j)];
                let any = Configuration::default();
                if let Some(found) = self.solve_pair(&point, free, any, [0.0; 2]) {
                    for found in found.iter().flatten() {
                        let arm_positions =
                            self.decomposition.positions(&self.unknown(found, free));
                        self.revolutions.within(&arm_positions, &self.ranges, |arm_positions| {
                            if self.is_within_limits(arm_positions) {
                                layer.postures.push(self.posture(found, free, arm_positions));
                            }
                        });
                    }
                }
                layer.bins.push(layer.postures.len());
            }
        }
        layer
    }

    /// Squared duration of a change at the velocity limits (s²).
    pub(super) fn squared_duration(&self, change: &ArmVector) -> f64 {
        let each = change.iter().zip(&self.inverse_speed);
        each.map(|(change, inverse_speed)| (change * inverse_speed) * (change * inverse_speed))
            .sum()
    }

    /// Whether two neighbouring postures are on one branch.
    pub(super) fn is_continuous(&self, from: &Posture, to: &Posture) -> bool {
        (0..4).all(|r| (to.unknown[r] - from.unknown[r]).abs() <= self.largest[r])
            && from.configuration.agrees_with(to.configuration)
    }

    /// The shortest paths through the grid from all first postures that are better than their neighbours, the shortest first.
    pub(super) fn shortest_paths(&self) -> Result<Vec<PostureCandidate>, NoPosturePath> {
        let layers: Vec<Layer> =
            (0..=self.intervals).map(|k| self.layer(k as f64 / self.intervals as f64)).collect();
        let step = 1.0 / self.intervals as f64;
        let limit_cost = |posture: &Posture| LIMIT_WEIGHT * step * posture.cost;
        // Costs to the end of the path, and the next posture on it, from the last layer to the first.
        let mut costs: Vec<f64> = layers[self.intervals].postures.iter().map(limit_cost).collect();
        let mut successors: Vec<Vec<usize>> = vec![Vec::new(); self.intervals];
        for k in (0..self.intervals).rev() {
            let (from, to) = (&layers[k], &layers[k + 1]);
            let mut previous = vec![f64::INFINITY; from.postures.len()];
            let mut by = vec![usize::MAX; from.postures.len()];
            self.for_neighbours(from, to, |f, t| {
                if !costs[t].is_finite() {
                    return;
                }
                let (a, b) = (&from.postures[f], &to.postures[t]);
                if !self.is_continuous(a, b) {
                    return;
                }
                let change: ArmVector = from_fn(|a_| b.arm_positions[a_] - a.arm_positions[a_]);
                let cost = costs[t] + self.squared_duration(&change) / step;
                if cost < previous[f] {
                    (previous[f], by[f]) = (cost, t);
                }
            });
            for (cost, posture) in previous.iter_mut().zip(&from.postures) {
                *cost += limit_cost(posture);
            }
            (costs, successors[k]) = (previous, by);
        }
        for (cost, posture) in costs.iter_mut().zip(&layers[0].postures) {
            *cost += self.squared_distance_from_home(&posture.arm_positions);
        }
        let path = |first: usize| {
            let mut postures = vec![layers[0].postures[first]];
            let mut at = first;
            for (layer, next) in layers[1..].iter().zip(&successors) {
                at = next[at];
                postures.push(layer.postures[at]);
            }
            PostureCandidate { postures, cost: costs[first] }
        };
        let mut paths: Vec<PostureCandidate> =
            self.local_minima(&layers[0], &costs).into_iter().map(path).collect();
        paths.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        if paths.is_empty() {
            return Err(NoPosturePath { fraction: self.connected_fraction(&layers) });
        }
        Ok(paths)
    }

    /// Weighted square of the distance of the first posture from home.
    fn squared_distance_from_home(&self, arm_positions: &ArmVector) -> f64 {
        let weighted = |a: usize| self.home_weights[a] * (arm_positions[a] - self.home[a]);
        (0..4).map(|a| weighted(a) * weighted(a)).sum()
    }

    /// Postures of a layer with a path to the end, and no cheaper posture of their branch in their neighbourhood.
    fn local_minima(&self, layer: &Layer, costs: &[f64]) -> Vec<usize> {
        let mut is_least: Vec<bool> = costs.iter().map(|cost| cost.is_finite()).collect();
        self.for_neighbours(layer, layer, |a, b| {
            let is_cheaper = costs[b] < costs[a] || (costs[b] <= costs[a] && b < a);
            if is_cheaper && self.is_continuous(&layer.postures[a], &layer.postures[b]) {
                is_least[a] = false;
            }
        });
        (0..costs.len()).filter(|&k| is_least[k]).collect()
    }

    /// Largest fraction of the path that postures connected to the first layer reach.
    fn connected_fraction(&self, layers: &[Layer]) -> f64 {
        let mut is_connected = vec![true; layers[0].postures.len()];
        for k in 1..layers.len() {
            let (from, to) = (&layers[k - 1], &layers[k]);
            let mut next = vec![false; to.postures.len()];
            self.for_neighbours(from, to, |f, t| {
                next[t] |=
                    is_connected[f] && self.is_continuous(&from.postures[f], &to.postures[t]);
            });
            if !next.contains(&true) {
                return (k - 1) as f64 / self.intervals as f64;
            }
            is_connected = next;
        }
        1.0
    }

    /// Calls a function with all pairs of postures in neighbouring bins of two layers.
    fn for_neighbours(&self, from: &Layer, to: &Layer, mut each: impl FnMut(usize, usize)) {
        let seed = |k: usize, count: usize| {
            let neighbourhood = self.neighbourhood.min(count / 2);
            let all = if count == 1 { 1 } else { (2 * neighbourhood + 1).min(count) };
            (0..all)
                .map(move |d| (k + count + d - if count == 1 { 0 } else { neighbourhood }) % count)
        };
        let [rows, columns] = self.grid;
        for i in 0..rows {
            for j in 0..columns {
                let cell = i * columns + j;
                let ends = from.bins[cell]..from.bins[cell + 1];
                if ends.is_empty() {
                    continue;
                }
                for row in seed(i, rows) {
                    for column in seed(j, columns) {
                        let other = row * columns + column;
                        for t in to.bins[other]..to.bins[other + 1] {
                            ends.clone().for_each(|f| each(f, t));
                        }
                    }
                }
            }
        }
    }

    /// The posture of given free angles in the configuration and revolutions of another.
    pub(super) fn posture_near(
        &self,
        fraction: f64,
        free: [f64; 2],
        seed: &Posture,
    ) -> Option<Posture> {
        let pair = [seed.unknown[0], seed.unknown[1]];
        let found = self.solve_pair(&self.path.at(fraction), free, seed.configuration, pair)?;
        let found = found.into_iter().flatten().next()?;
        let unknown = self.decomposition.wrapped(&self.unknown(&found, free), &seed.unknown);
        let arm_positions = self.decomposition.positions(&unknown);
        self.is_within_limits(&arm_positions).then(|| self.posture(&found, free, &arm_positions))
    }
}
