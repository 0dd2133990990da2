//! Which of infinitely many positions are taken, where an arm has more motors than the target asks for.

use nalgebra::{Matrix2, Vector2};

use super::super::planar::{Planar, Slopes, ahead, dot, turned};
use super::Configuration;
use super::closed::Found;
use super::plan::{Pair, Plan};
use super::turns::{Ranges, Turns};

/// Beyond this share of a range the cost goes on as its parabola there, so that it is finite beyond the limit too.
const EDGE: f64 = 0.9999;

/// Steps of the descent at most; it takes five to ten, and more only out of a nearly stretched arm.
const MOST_STEPS: usize = 100;

/// Steps below this end the descent [rad]: near a limit the cost is so curved that longer ones would still count.
const SMALL: f64 = 1e-9;

/// Step of differences of slopes [rad].
const DIFFERENCE: f64 = 1e-6;

/// A start whose bend costs more is none: the pair moves too fast there for any free angle to lead out, within 3° of the stretched arm.
const STRETCHED: f64 = 400.0;

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

/// A radial arm counts as near the end of its bend where its last joint is this share of the last link ahead of the first.
const NEAR: f64 = 0.1;

/// A way with its cost.
struct Costed {
    own: Slopes,
    pair: [f64; 2],
    cost: f64,
}

/// 1/(1 − u²) with its derivatives.
fn of_share(u: f64) -> [f64; 3] {
    let within = u.clamp(-EDGE, EDGE);
    let cost = 1.0 / (1.0 - within * within);
    let slope = 2.0 * within * cost * cost;
    let curvature = (2.0 + 6.0 * within * within) * cost * cost * cost;
    let beyond = u - within;
    [cost + (slope + 0.5 * curvature * beyond) * beyond, slope + curvature * beyond, curvature]
}

/// The cost of the bend, with its derivatives by the coordinate of the bend, and that by the pair.
struct Bend {
    cost: f64,
    slope: f64,
    curvature: f64,
    by_pair: [f64; 2],
}

impl Redundant<'_> {
    /// The positions bent as asked for that are farthest from limits and from being stretched or folded:
    /// least Σ 1/(1 − u²) + 1/sin² β near where the arm is, u from −1 at one limit of an axis to 1 at the other, β the bend.
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
        let here = self.at(free, configuration, near);
        let (mut now, stretched) = match here {
            Some(here) if self.bend(here.pair).cost < STRETCHED => (here, None),
            here => match self.start(configuration, near) {
                Some((start, now)) => {
                    free = start;
                    (now, here)
                }
                None => return here.map(|here| here.own),
            },
        };
        for _ in 0..MOST_STEPS {
            let Some(step) = self.step(&now, free, configuration) else { break };
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
        let is_within =
            |own: &Slopes| (0..self.ranges.count).all(|a| self.share(own, a).abs() <= 1.0);
        match stretched {
            Some(stretched) if is_within(&stretched.own) && !is_within(&now.own) => {
                Some(stretched.own)
            }
            _ => Some(now.own),
        }
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
        let limits = (0..self.ranges.count).map(|a| of_share(self.share(&own, a))[0]);
        let cost = limits.sum::<f64>() + self.bend(pair).cost;
        Some(Costed { own, pair, cost })
    }

    /// What it costs to be near the end of a bend.
    fn bend(&self, pair: [f64; 2]) -> Bend {
        let arrows = self.planar.arrows();
        let at = |k: usize, turn: f64| turned(&arrows[k].vector, turn);
        // Of an angle between 0 and π.
        let of_angle = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let cost = 1.0 / (sin * sin);
            [cost, -2.0 * cos * cost / sin, cost * cost * (2.0 + 4.0 * cos * cos)]
        };
        // Of how far the wafer's arm is ahead of the first joint.
        let last = self.plan.last.map_or(0.0, |k| arrows[k].vector.norm());
        let of_reach = |ahead: f64| {
            let cost = (NEAR * last / ahead).powi(2);
            [cost, -2.0 * cost / ahead, 6.0 * cost / (ahead * ahead)]
        };
        let ([cost, slope, curvature], by_pair) = match self.plan.pair {
            Pair::Links([i, j]) => {
                let (one, other) = (at(i, pair[0]), at(j, pair[1]));
                (of_angle(one.perp(&other).atan2(one.dot(&other))), [-1.0, 1.0])
            }
            Pair::Belt([i, j], w) => {
                let middle = self.plan.middle(self.planar, pair);
                let (one, other) = (at(i, pair[0]), at(j, pair[1]));
                let carried = at(w, 0.5 * (pair[0] + pair[1]));
                let aside = middle.perp(&one);
                let [cost, slope, curvature] = of_angle(aside.atan2(middle.dot(&one)));
                let reach = of_reach(middle.dot(&(one + other + carried)));
                let by_angle = -2.0 * aside;
                let total = [
                    cost + reach[0],
                    slope + reach[1] * by_angle,
                    curvature + reach[2] * by_angle * by_angle,
                ];
                (total, [0.5, -0.5])
            }
            Pair::Slide(g) => {
                let along = self.planar.slides()[0].along.vector;
                (of_reach(pair[1] + along.dot(&arrows[g].vector)), [0.0, 1.0])
            }
        };
        Bend { cost, slope, curvature, by_pair }
    }

    fn share(&self, own: &Slopes, axis: usize) -> f64 {
        (own[axis] - self.ranges.middle(axis)) / self.ranges.half(axis)
    }

    /// Newton's step on the free angles, curvatures by differences of slopes; where they lead uphill, those without the curvature of the constraint.
    fn step(
        &self,
        now: &Costed,
        free: [f64; 2],
        configuration: Configuration,
    ) -> Option<Vector2<f64>> {
        let (slope, mut bowl) = self.slope(now, free)?;
        let is_free = self.free().map(|arrow| arrow.is_some());
        let mut curvature = Matrix2::identity();
        let mut is_whole = true;
        for k in (0..2).filter(|&k| is_free[k]) {
            let mut there = free;
            there[k] += DIFFERENCE;
            let beside = self.at(there, configuration, &now.own);
            match beside.and_then(|beside| self.slope(&beside, there)) {
                Some((changed, _)) => {
                    let column = (changed - slope) / DIFFERENCE;
                    for j in (0..2).filter(|&j| is_free[j]) {
                        curvature[(j, k)] = column[j];
                    }
                }
                None => is_whole = false,
            }
        }
        curvature = (curvature + curvature.transpose()) * 0.5;
        let is_bowl = curvature[(0, 0)] > 0.0 && curvature.determinant() > 0.0;
        if !(is_whole && is_bowl) {
            for k in (0..2).filter(|&k| !is_free[k]) {
                bowl[(k, k)] = 1.0;
            }
            curvature = bowl;
        }
        Some(curvature.try_inverse()? * slope * -1.0)
    }

    /// Arrows whose turns are free.
    fn free(&self) -> [Option<usize>; 2] {
        [self.plan.last.filter(|_| self.last.is_none()), self.plan.first]
    }

    /// Slope of the cost by the free angles, and its curvature without that of the constraint; `None` where the arm is stretched or folded.
    fn slope(&self, now: &Costed, free: [f64; 2]) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let velocities = self.plan.span_velocities(self.planar, now.pair);
        let inverse = Matrix2::from_columns(&velocities).try_inverse()?;
        let bend = self.bend(now.pair);
        let mut bending = Vector2::zeros();
        let mut directions = [Slopes::default(); 2];
        for (f, arrow) in self.free().into_iter().enumerate() {
            let Some(k) = arrow else { continue };
            let along = ahead(&turned(&self.planar.arrows()[k].vector, free[f]));
            let follow = inverse * along * -1.0;
            let mut unknown = [follow[0], follow[1], 0.0, 0.0];
            unknown[2 + f] = 1.0;
            directions[f] = self.plan.positions(&unknown);
            bending[f] = bend.by_pair[0] * follow[0] + bend.by_pair[1] * follow[1];
        }
        let mut slope = bending * bend.slope;
        let mut curvature = bending * bending.transpose() * bend.curvature;
        for a in 0..self.ranges.count {
            let [_, rising, curving] = of_share(self.share(&now.own, a));
            let half = self.ranges.half(a);
            let along = Vector2::from(directions.map(|direction| direction[a] / half));
            slope += along * rising;
            curvature += along * along.transpose() * curving;
        }
        Some((slope, curvature))
    }
}
