//! Which of infinitely many positions are taken, where an arm has more motors than the target asks for.

use nalgebra::{Matrix2, Vector2};

use super::super::planar::{Planar, Slopes, ahead, dot, turned};
use super::Configuration;
use super::closed::Found;
use super::plan::Plan;
use super::turns::{Ranges, Turns};

/// How steeply the cost grows toward limits.
const STEEPNESS: f64 = 4.0;

/// Steps of the descent at most; it takes five to ten.
const MOST_STEPS: usize = 40;

/// Steps below this end the descent [rad].
const SMALL: f64 = 1e-9;

/// Where a start is looked for, if there is none where the arm is: so many for each free angle.
const STARTS: usize = 24;

/// What is left to choose: turns of the first and of the last arrow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Redundant<'a> {
    pub(super) planar: &'a Planar,
    pub(super) plan: &'a Plan,
    pub(super) turns: &'a Turns,
    pub(super) ranges: &'a Ranges,
    /// From the origin of the arm to the point [m].
    pub(super) point: Vector2<f64>,
    /// Turn of the last arrow, where a heading asks for it [rad].
    pub(super) last: Option<f64>,
}

/// A way with its cost.
struct Costed {
    own: Slopes,
    pair: [f64; 2],
    cost: f64,
}

impl Redundant<'_> {
    /// The positions bent as asked for that are farthest from limits: least Σ cosh(4 u) near where the arm is,
    /// u from −1 at one limit of an axis to 1 at the other.
    ///
    /// Descent by Newton's method on the free angles, the pair following in closed form so that it never leaves its bend.
    pub(super) fn away_from_limits(
        &self,
        configuration: Configuration,
        near: &Slopes,
    ) -> Option<Slopes> {
        let turn_of =
            |arrow: Option<usize>| arrow.map_or(0.0, |k| dot(&self.planar.arrows()[k].turn, near));
        let mut free = [turn_of(self.plan.last), turn_of(self.plan.first)];
        let mut now = match self.at(free, configuration, near) {
            Some(now) => now,
            None => {
                let (start, now) = self.start(configuration, near)?;
                free = start;
                now
            }
        };
        for _ in 0..MOST_STEPS {
            let step = self.step(&now, free);
            if step.amax() < SMALL {
                break;
            }
            let mut share = (1.0 / step.amax()).min(1.0);
            let better = loop {
                let there = [free[0] + share * step[0], free[1] + share * step[1]];
                match self.at(there, configuration, &now.own) {
                    Some(next) if next.cost < now.cost => break Some((there, next)),
                    _ if share * step.amax() < SMALL => break None,
                    _ => share *= 0.4,
                }
            };
            let Some((there, next)) = better else { break };
            let gained = now.cost - next.cost;
            (free, now) = (there, next);
            if gained <= 1e-15 * now.cost {
                break;
            }
        }
        Some(now.own)
    }

    /// The best of a raster of free angles.
    fn start(&self, configuration: Configuration, near: &Slopes) -> Option<([f64; 2], Costed)> {
        let raster = |is_free: bool| if is_free { STARTS } else { 1 };
        let mut best: Option<([f64; 2], Costed)> = None;
        for i in 0..raster(self.last.is_none() && self.plan.last.is_some()) {
            for j in 0..raster(self.plan.first.is_some()) {
                let free = [i, j].map(|k| std::f64::consts::TAU * k as f64 / STARTS as f64);
                if let Some(found) = self.at(free, configuration, near)
                    && best.as_ref().is_none_or(|(_, best)| found.cost < best.cost)
                {
                    best = Some((free, found));
                }
            }
        }
        best
    }

    fn at(&self, free: [f64; 2], configuration: Configuration, near: &Slopes) -> Option<Costed> {
        let mut unknown = [0.0; 4];
        unknown[2] = self.last.unwrap_or(free[0]);
        unknown[3] = free[1];
        let mut point = self.point;
        for (arrow, turn) in [(self.plan.last, unknown[2]), (self.plan.first, unknown[3])] {
            if let Some(k) = arrow {
                point -= turned(&self.planar.arrows()[k].vector, turn);
            }
        }
        let ways = self.plan.span(self.planar, &point, [0.0; 2]).ok()?;
        let way = |found: &Found| found.configuration.agrees_with(configuration);
        let pair = ways.into_iter().flatten().find(way)?.pair;
        (unknown[0], unknown[1]) = (pair[0], pair[1]);
        let own = self.turns.nearest(&self.plan.positions(&unknown), near);
        let cost = (0..self.ranges.count).map(|a| (STEEPNESS * self.share(&own, a)).cosh()).sum();
        Some(Costed { own, pair, cost })
    }

    fn share(&self, own: &Slopes, axis: usize) -> f64 {
        (own[axis] - self.ranges.middle(axis)) / self.ranges.half(axis)
    }

    /// Newton's step on the free angles, the curvature of the constraint left out.
    fn step(&self, now: &Costed, free: [f64; 2]) -> Vector2<f64> {
        let velocities = self.plan.span_velocities(self.planar, now.pair);
        let span = Matrix2::from_columns(&velocities);
        let Some(inverse) = span.try_inverse() else { return Vector2::zeros() };
        let mut directions = [Slopes::default(); 2];
        let frees = [
            (2, self.plan.last.filter(|_| self.last.is_none()), free[0]),
            (3, self.plan.first, free[1]),
        ];
        for (direction, (row, arrow, turn)) in directions.iter_mut().zip(frees) {
            let Some(k) = arrow else { continue };
            let follow = inverse * ahead(&turned(&self.planar.arrows()[k].vector, turn)) * -1.0;
            let mut unknown = [follow[0], follow[1], 0.0, 0.0];
            unknown[row] = 1.0;
            *direction = self.plan.positions(&unknown);
        }
        let mut gradient = Vector2::zeros();
        let mut curvature = Matrix2::zeros();
        for a in 0..self.ranges.count {
            let (u, half) = (STEEPNESS * self.share(&now.own, a), self.ranges.half(a));
            let along = directions.map(|direction| direction[a] * STEEPNESS / half);
            let along = Vector2::from(along);
            gradient += along * u.sinh();
            curvature += along * along.transpose() * u.cosh();
        }
        for k in 0..2 {
            if curvature[(k, k)] == 0.0 {
                curvature[(k, k)] = 1.0;
            }
        }
        curvature.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * gradient * -1.0)
    }
}
