//! Motions of an arm between postures, with its wafer close to the axis of the first joint.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

use nalgebra::Vector2;

use super::decomposition::Decomposition;
use super::solution::Configuration;
use crate::incremental::{CacheKey, CacheKeyPart};
use crate::robot::arm_chain::{ArmChain, ArmVector};
use crate::robot::hybrid_robot::{AxisKind, EffectorId, HybridRobot};

/// Largest radius of the wafer's centre beyond the larger one at both ends of a move, and beyond that which the change of posture requires (m).
const RADIUS_ALLOWANCE: f64 = 0.025;
/// Radius of the grid's nodes beyond that which the change of posture requires, so that moves between distant nodes stay within the allowance (m).
const NODE_ALLOWANCE: f64 = 0.005;
/// Factor of the duration of grid steps at the largest radius, less one: paths through nodes farther inside allow longer moves.
const OUTER_COST: f64 = 2.0;
/// Time that each move takes to accelerate and to stop (s).
const STOP_TIME: f64 = 0.5;
/// Grid step of rotary axes, for at most two and for three axes (rad).
const ROTARY_STEPS: [f64; 2] = [PI / 36.0, PI / 18.0];
/// Grid step of prismatic axes, for at most two and for three axes (m).
const PRISMATIC_STEPS: [f64; 2] = [0.01, 0.02];
/// Largest number of axes of the grid.
const MAX_GRID_AXES: usize = 3;
/// Distance of the grid's ends beyond both postures, within limits (rad).
const GRID_MARGIN: f64 = PI;
/// Both postures are rounded to multiples of this, so that visits whose droop differs share one change of posture (rad or m).
const ROUNDING: f64 = 1e-3;
/// Number of intervals at which a move is sampled.
const SAMPLES: usize = 24;

impl HybridRobot {
    /// Configuration of an arm; without meaning where it has no closed form.
    ///
    /// # Panics
    /// The effector does not exist.
    pub(crate) fn configuration(&self, id: EffectorId, positions: &[f64]) -> Configuration {
        let chain = ArmChain::new(self, id);
        let arm_positions = chain.arm_positions(positions);
        Decomposition::new(&chain)
            .map_or_else(Configuration::default, |it| it.configuration(&chain, &arm_positions))
    }

    /// Sum of the squared durations of all axes from one set of positions to another, at their velocity limits with a wafer (s²).
    pub(crate) fn squared_travel_time(&self, from: &[f64], to: &[f64]) -> f64 {
        let axes = self.axes.iter().zip(from.iter().zip(to));
        axes.map(|(axis, (from, to))| ((to - from) / axis.loaded.velocity).powi(2)).sum()
    }
}

/// A move of an arm between two postures, without those axes that turn the whole arm.
pub(crate) struct PostureChange {
    chain: ArmChain,
    axis: Vector2<f64>,
    /// Indices, within the arm, of the axes that do not turn the whole arm.
    folding: Vec<usize>,
    /// One over the velocity limit of each axis with a wafer (s/m or s/rad).
    inverse_speed: ArmVector,
    /// Positions of the arm's axes at both ends, at zero for axes that turn the whole arm.
    from: ArmVector,
    to: ArmVector,
}

impl PostureChange {
    /// The move between two sets of positions of all axes; `None` where the arm has no choice of postures, none of its axes turns the whole arm, or it has more axes than the grid.
    ///
    /// # Panics
    /// The effector does not exist.
    pub(crate) fn new(
        robot: &HybridRobot,
        id: EffectorId,
        from: &[f64],
        to: &[f64],
    ) -> Option<Self> {
        if !robot.has_posture_paths(id) {
            return None;
        }
        let chain = ArmChain::new(robot, id);
        let turns = |a: usize| robot.turns_whole_arms(chain.axes()[a]);
        let count = chain.axes().len();
        let folding: Vec<usize> = (0..count).filter(|&a| !turns(a)).collect();
        if folding.len() == count || folding.len() > MAX_GRID_AXES {
            return None;
        }
        let folded = |positions: &[f64]| {
            let mut folded = ArmVector::default();
            for &a in &folding {
                let axis = &robot.axes[chain.axes()[a]];
                let rounded = (positions[chain.axes()[a]] / ROUNDING).round() * ROUNDING;
                folded[a] = rounded.max(axis.min).min(axis.max);
            }
            folded
        };
        let mut inverse_speed = ArmVector::default();
        for (inverse_speed, &axis) in inverse_speed.iter_mut().zip(chain.axes()) {
            *inverse_speed = 1.0 / robot.axes[axis].loaded.velocity;
        }
        let [x, y, _] = robot.arms[id.arm].mount;
        let (axis, from, to) = (Vector2::new(x, y), folded(from), folded(to));
        Some(Self { axis, inverse_speed, from, to, chain, folding })
    }

    /// Indices of the axes that move.
    pub(crate) fn axes(&self) -> impl Iterator<Item = usize> + '_ {
        self.folding.iter().map(|&a| self.chain.axes()[a])
    }

    /// Whether a single point-to-point move takes the wafer's centre farther from the axis of the arm's first joint than both of its ends, by more than an allowance of 25 mm.
    pub(crate) fn swings_out(&self) -> bool {
        !self.is_within(&self.from, &self.to, self.end_radius() + RADIUS_ALLOWANCE)
    }

    /// Positions of the [axes](Self::axes) between moves that together change the posture without a swing.
    ///
    /// The largest distance of the wafer's centre from the axis of the first joint is the least one that a path through a grid of the axes' positions attains between limits, or that of an end of the move if that is larger, and the allowance.
    ///
    /// ```text
    ///    min over paths  max over the path  |tip|        then        min Σ |Δa|   with  |tip| ≤ that radius + allowance
    /// ```
    /// Δa: displacement of the axes between nodes of the grid, in units of time at the velocity limits, larger at the largest radius. Moves that stay within the radius then replace nodes so that all of them together take the least time.
    pub(crate) fn waypoints(&self, robot: &HybridRobot) -> Vec<Vec<f64>> {
        let grid = Grid::new(robot, self);
        let radius = grid.least_radius().max(self.end_radius());
        let nodes = grid.shortest(radius + NODE_ALLOWANCE);
        let points: Vec<ArmVector> = std::iter::once(self.from)
            .chain(nodes.iter().map(|&node| grid.point(node)))
            .chain([self.to])
            .collect();
        let waypoints = self.shortened(&points, radius + RADIUS_ALLOWANCE);
        let moved = |point: &ArmVector| self.folding.iter().map(|&a| point[a]).collect();
        waypoints.iter().map(moved).collect()
    }

    /// Distance of the wafer's centre from the axis of the first joint (m).
    fn radius(&self, arm_positions: &ArmVector) -> f64 {
        (self.chain.tip(arm_positions) - self.axis).norm()
    }

    /// The larger radius of both ends (m).
    fn end_radius(&self) -> f64 {
        self.radius(&self.from).max(self.radius(&self.to))
    }

    /// Whether the wafer's centre stays within a radius during a point-to-point move.
    ///
    /// The axes end together, but the shares of their displacements at one time differ: each lies between that of a constant velocity and that of a profile of constant jerk.
    /// All combinations of both are sampled.
    fn is_within(&self, from: &ArmVector, to: &ArmVector, radius: f64) -> bool {
        (1..SAMPLES).all(|k| {
            let time = k as f64 / SAMPLES as f64;
            let shares = [time, share_at_constant_jerk(time)];
            (0..1_usize << self.folding.len()).all(|combination| {
                let mut at = *from;
                for (bit, &a) in self.folding.iter().enumerate() {
                    at[a] += shares[combination >> bit & 1] * (to[a] - from[a]);
                }
                self.radius(&at) <= radius
            })
        })
    }

    /// Points between moves that start at the first point and end at the last one, stay within a radius and take the least time; moves between neighbouring points are within it.
    fn shortened(&self, points: &[ArmVector], radius: f64) -> Vec<ArmVector> {
        // Least time to each point, and the point before it.
        let mut fastest = vec![(0.0, 0)];
        for k in 1..points.len() {
            let mut best = (f64::INFINITY, k - 1);
            for from in (0..k).rev() {
                let time = fastest[from].0 + self.duration(&points[from], &points[k]);
                let is_possible =
                    from + 1 == k || self.is_within(&points[from], &points[k], radius);
                if time < best.0 && is_possible {
                    best = (time, from);
                }
            }
            fastest.push(best);
        }
        let (mut between, mut at) = (Vec::new(), fastest[points.len() - 1].1);
        while at > 0 {
            between.push(points[at]);
            at = fastest[at].1;
        }
        between.reverse();
        between
    }

    /// Approximate duration of a move (s).
    fn duration(&self, from: &ArmVector, to: &ArmVector) -> f64 {
        let each = self.folding.iter().map(|&a| (to[a] - from[a]).abs() * self.inverse_speed[a]);
        STOP_TIME + each.fold(0.0, f64::max)
    }
}

impl CacheKeyPart for PostureChange {
    /// Its waypoints follow from both postures, and from the robot, which all entries of a cache share.
    fn append_to(&self, key: &mut CacheKey) {
        let Self { chain, from, to, folding: _, axis: _, inverse_speed: _ } = self;
        key.add(&chain.effector).add(from).add(to);
    }
}

/// Share of the displacement of a move from rest to rest that only its jerk limits, at a fraction of its duration.
fn share_at_constant_jerk(time: f64) -> f64 {
    if time > 0.5 {
        return 1.0 - share_at_constant_jerk(1.0 - time);
    }
    if time < 0.25 {
        return 32.0 / 3.0 * time * time * time;
    }
    let before_middle = 0.5 - time;
    0.5 - 2.0 * before_middle + 16.0 / 3.0 * before_middle * before_middle * before_middle
}

/// Values of one axis of the grid.
struct GridAxis {
    /// Index of the axis within the arm.
    index: usize,
    min: f64,
    step: f64,
    count: usize,
    /// Duration of one step at the velocity limit (s).
    duration: f64,
}

/// Grid of positions of the axes that do not turn the whole arm.
struct Grid {
    axes: Vec<GridAxis>,
    /// Radius of the wafer's centre at each node (m).
    radii: Vec<f64>,
    /// Nodes nearest to both ends of the move.
    ends: [usize; 2],
}

impl Grid {
    fn new(robot: &HybridRobot, change: &PostureChange) -> Self {
        let coarse = usize::from(change.folding.len() > 2);
        let axis = |&index: &usize| {
            let axis = &robot.axes[change.chain.axes()[index]];
            let longest = match axis.kind {
                AxisKind::Rotary => ROTARY_STEPS[coarse],
                AxisKind::Linear => PRISMATIC_STEPS[coarse],
            };
            let (from, to) = (change.from[index], change.to[index]);
            let min = axis.min.max(from.min(to) - GRID_MARGIN);
            let max = axis.max.min(from.max(to) + GRID_MARGIN);
            let intervals = ((max - min) / longest).ceil().max(1.0);
            let step = (max - min) / intervals;
            let duration = step * change.inverse_speed[index];
            GridAxis { index, min, step, count: intervals as usize + 1, duration }
        };
        let axes: Vec<GridAxis> = change.folding.iter().map(axis).collect();
        let count = axes.iter().map(|axis| axis.count).product();
        let mut grid = Self { axes, radii: Vec::new(), ends: [0; 2] };
        grid.radii = (0..count).map(|node| change.radius(&grid.point(node))).collect();
        grid.ends = [change.from, change.to].map(|point| grid.nearest(&point));
        grid
    }

    /// Positions of the arm's axes at a node, at zero for axes that turn the whole arm.
    fn point(&self, mut node: usize) -> ArmVector {
        let mut point = ArmVector::default();
        for axis in &self.axes {
            point[axis.index] = axis.min + axis.step * (node % axis.count) as f64;
            node /= axis.count;
        }
        point
    }

    fn nearest(&self, point: &ArmVector) -> usize {
        self.axes.iter().rev().fold(0, |node, axis| {
            let steps = (point[axis.index] - axis.min) / axis.step;
            let nearest = if steps.is_finite() { steps.round() as usize } else { 0 };
            node * axis.count + nearest.min(axis.count - 1)
        })
    }

    /// Neighbours of a node, with the duration of a move to them at the velocity limits (s).
    fn for_neighbours(&self, node: usize, mut each: impl FnMut(usize, f64)) {
        for combination in 0..3_usize.pow(self.axes.len() as u32) {
            let (mut rest, mut choice, mut stride) = (node, combination, 1);
            let (mut neighbour, mut squared) = (0, 0.0);
            let mut exists = true;
            for axis in &self.axes {
                // The coordinate of the neighbour, plus one.
                let moved = rest % axis.count + choice % 3;
                exists &= (1..=axis.count).contains(&moved);
                if choice % 3 != 1 {
                    squared += axis.duration * axis.duration;
                }
                neighbour += stride * moved.saturating_sub(1);
                (rest, choice, stride) = (rest / axis.count, choice / 3, stride * axis.count);
            }
            if exists && neighbour != node {
                each(neighbour, squared.sqrt());
            }
        }
    }

    /// Least radius within which a path through the grid connects both ends (m).
    fn least_radius(&self) -> f64 {
        let larger = |cost: f64, node: usize, _: f64| cost.max(self.radii[node]);
        self.search(self.radii[self.ends[0]], larger).0
    }

    /// Nodes of the shortest path between both ends within a radius.
    fn shortest(&self, radius: f64) -> Vec<usize> {
        let longer = |cost: f64, node: usize, duration: f64| {
            let share = self.radii[node] / radius;
            if share <= 1.0 {
                cost + duration * (1.0 + OUTER_COST * share * share)
            } else {
                f64::INFINITY
            }
        };
        self.search(0.0, longer).1
    }

    /// Least cost of a path between both ends, and its nodes.
    ///
    /// # Arguments
    /// * `first` – cost of the start
    /// * `next` – cost of a node from that of the node before, its number, and the duration between both; not less than the cost before, and infinite where there is no path
    fn search(&self, first: f64, next: impl Fn(f64, usize, f64) -> f64) -> (f64, Vec<usize>) {
        let [start, end] = self.ends;
        let mut costs = vec![f64::INFINITY; self.radii.len()];
        let mut before = vec![usize::MAX; self.radii.len()];
        costs[start] = first;
        // The bits of costs, which are not negative, are in the order of the costs.
        let mut heap = BinaryHeap::from([Reverse((first.to_bits(), start))]);
        while let Some(Reverse((bits, node))) = heap.pop() {
            if node == end {
                break;
            }
            let cost = f64::from_bits(bits);
            if cost > costs[node] {
                continue;
            }
            self.for_neighbours(node, |neighbour, duration| {
                let cost = next(cost, neighbour, duration);
                if cost < costs[neighbour] {
                    (costs[neighbour], before[neighbour]) = (cost, node);
                    heap.push(Reverse((cost.to_bits(), neighbour)));
                }
            });
        }
        let mut nodes = vec![end];
        let mut at = end;
        while at != start && before[at] != usize::MAX {
            at = before[at];
            nodes.push(at);
        }
        nodes.reverse();
        (costs[end], nodes)
    }
}
