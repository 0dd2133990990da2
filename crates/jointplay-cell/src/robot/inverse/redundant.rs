//! Which of infinitely many positions are taken, where an arm has more motors than the target asks for.

use nalgebra::{Matrix2, Vector2};

use super::super::planar::{Planar, Slopes, ahead, dot, turned};
use super::Configuration;
use super::plan::{Pair, Plan};
use super::turns::{Ranges, Turns};

/// Beyond this share of a range the cost goes on as its parabola there, so that it is finite beyond the limit too.
const EDGE: f64 = 0.9999;

/// Steps of the descent at most; it takes five to ten, and more only out of a nearly stretched arm.
const MOST_STEPS: usize = 100;

/// Steps below this end the descent [rad]: near a limit the cost is so curved that longer ones would still count.
const SMALL: f64 = 1e-9;

/// A start whose bend costs more is none: the pair moves too fast there for any free angle to lead out, within 3° of the stretched arm.
const STRETCHED: f64 = 400.0;

/// Where a start is looked for, if there is none where the arm is: so many for each free angle, and more where those do not reach.
const STARTS: [usize; 3] = [8, 16, 48];
/// The most of them.
const MOST_STARTS: usize = 48;

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
    bend: Bend,
    /// The arrows of the wafer and of the platform as they then are [m].
    arrows: [Vector2<f64>; 2],
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
    /// What the curvature has in it that may be negative.
    of_reach: f64,
    by_pair: Vector2<f64>,
}

/// Derivatives of the cost by the free angles.
struct Derivatives {
    slope: Vector2<f64>,
    curvature: Matrix2<f64>,
    /// The curvature without that of the constraint: never negative.
    bowl: Matrix2<f64>,
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
            Some(here) if here.bend.cost < STRETCHED => (here, None),
            here => match STARTS.iter().find_map(|&count| self.start(count, configuration, near)) {
                Some((start, now)) => {
                    free = start;
                    (now, here)
                }
                None => return here.map(|here| here.own),
            },
        };
        for _ in 0..MOST_STEPS {
            let Some(step) = self.step(&now) else { break };
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

    /// The best of a raster of so many values of each free angle.
    fn start(
        &self,
        count: usize,
        configuration: Configuration,
        near: &Slopes,
    ) -> Option<([f64; 2], Costed)> {
        let turn = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        // How far the pair would have to reach, less what the free arrows reach.
        let raster = |arrow: Option<usize>| {
            let mut reached = [Vector2::zeros(); MOST_STARTS];
            if let Some(k) = arrow {
                let vector = &self.planar.arrows()[k].vector;
                (0..count).for_each(|i| reached[i] = turned(vector, turn(i)));
            }
            (if arrow.is_some() { count } else { 1 }, reached)
        };
        let [last, first] = self.free();
        let (lasts, by_last) = raster(last);
        let (firsts, by_first) = raster(first);
        let held = match (self.plan.last, self.last) {
            (Some(k), Some(turn)) => turned(&self.planar.arrows()[k].vector, turn),
            _ => Vector2::zeros(),
        };
        let mut best: Option<([f64; 2], Costed)> = None;
        for (i, by_last) in by_last[..lasts].iter().enumerate() {
            let rest = self.point - held - by_last;
            for (j, by_first) in by_first[..firsts].iter().enumerate() {
                let most = best.as_ref().map_or(f64::INFINITY, |(_, best)| best.cost);
                if self.costs_at_least(&(rest - by_first)) > most {
                    continue;
                }
                let free = [turn(i), turn(j)];
                if let Some(found) = self.at(free, configuration, near)
                    && found.cost < most
                {
                    best = Some((free, found));
                }
            }
        }
        best
    }

    /// What it costs at least to span a point: 1 for each axis, and the bend of two links, by the law of cosines.
    fn costs_at_least(&self, point: &Vector2<f64>) -> f64 {
        let limits = self.ranges.count as f64;
        let Pair::Links([i, j]) = &self.plan.pair else { return limits };
        let twice = 2.0 * i.length * j.length;
        let cosine = (point.norm_squared() - i.length * i.length - j.length * j.length) / twice;
        let squared_sine = 1.0 - cosine * cosine;
        // Out of reach, but for round-off.
        if squared_sine < -1e-9 { f64::INFINITY } else { limits + 1.0 / squared_sine.max(0.0) }
    }

    fn at(&self, free: [f64; 2], configuration: Configuration, near: &Slopes) -> Option<Costed> {
        let mut unknown = [0.0; 4];
        unknown[2] = self.last.unwrap_or(free[0]);
        unknown[3] = free[1];
        let arrow = |arrow: Option<usize>, turn| {
            let vector = arrow.map(|k| turned(&self.planar.arrows()[k].vector, turn));
            vector.unwrap_or_else(Vector2::zeros)
        };
        let arrows = [arrow(self.plan.last, unknown[2]), arrow(self.plan.first, unknown[3])];
        let point = self.point - arrows[0] - arrows[1];
        let ways = self.plan.span(self.planar, &point, configuration, [0.0; 2]).ok()?;
        let pair = ways.into_iter().flatten().next()?.pair;
        (unknown[0], unknown[1]) = (pair[0], pair[1]);
        let own = self.turns.nearest(&self.plan.positions(&unknown), near);
        let limits = (0..self.ranges.count).map(|a| of_share(self.share(&own, a))[0]);
        let bend = self.bend(pair);
        let cost = limits.sum::<f64>() + bend.cost;
        Some(Costed { own, pair, cost, bend, arrows })
    }

    /// What it costs to be near the end of a bend.
    fn bend(&self, pair: [f64; 2]) -> Bend {
        let arrows = self.planar.arrows();
        // Of an angle that is no whole number of half turns.
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
        match &self.plan.pair {
            Pair::Links([i, j]) => {
                let [cost, slope, curvature] = of_angle(pair[1] + j.angle - pair[0] - i.angle);
                Bend { cost, slope, curvature, of_reach: 0.0, by_pair: Vector2::new(-1.0, 1.0) }
            }
            Pair::Belt([i, j], carried) => {
                let half = 0.5 * (pair[0] + i.angle - pair[1] - j.angle);
                let [cost, slope, curvature] = of_angle(half);
                let (sin, cos) = half.sin_cos();
                let reach = of_reach(2.0 * i.length * cos + carried.vector.x);
                let by_angle = -2.0 * i.length * sin;
                Bend {
                    cost: cost + reach[0],
                    slope: slope + reach[1] * by_angle,
                    curvature: curvature + reach[2] * by_angle * by_angle,
                    of_reach: reach[1] * -2.0 * i.length * cos,
                    by_pair: Vector2::new(0.5, -0.5),
                }
            }
            Pair::Slide(g) => {
                let along = self.planar.slides()[0].along.vector;
                let [cost, slope, curvature] = of_reach(pair[1] + along.dot(&arrows[*g].vector));
                Bend { cost, slope, curvature, of_reach: 0.0, by_pair: Vector2::new(0.0, 1.0) }
            }
        }
    }

    fn share(&self, own: &Slopes, axis: usize) -> f64 {
        (own[axis] - self.ranges.middle(axis)) / self.ranges.half(axis)
    }

    /// Newton's step on the free angles; where it leads uphill, that without the curvature of the constraint.
    fn step(&self, now: &Costed) -> Option<Vector2<f64>> {
        let Derivatives { slope, mut curvature, mut bowl } = self.derivatives(now)?;
        for (k, arrow) in self.free().into_iter().enumerate() {
            if arrow.is_none() {
                (curvature[(k, k)], bowl[(k, k)]) = (1.0, 1.0);
            }
        }
        let is_bowl = curvature[(0, 0)] > 0.0 && curvature.determinant() > 0.0;
        Some(if is_bowl { curvature } else { bowl }.try_inverse()? * slope * -1.0)
    }

    /// Arrows whose turns are free.
    fn free(&self) -> [Option<usize>; 2] {
        [self.plan.last.filter(|_| self.last.is_none()), self.plan.first]
    }

    /// Derivatives of the cost by the free angles; `None` where the arm is stretched or folded.
    ///
    /// ```text
    ///    S p_f  =  −w_f        S p_fg  =  −(w_fg + Σ_ij S_ij p_i,f p_j,g)
    /// ```
    /// with the pair p, the velocities S of its span and their derivatives S_ij, and the free arrows' velocities w_f and w_fg.
    fn derivatives(&self, now: &Costed) -> Option<Derivatives> {
        let span = self.plan.span_change(self.planar, now.pair);
        let inverse = Matrix2::from_columns(&span.velocities).try_inverse()?;
        let (bend, arrows) = (&now.bend, &now.arrows);
        let mut follow = [Vector2::zeros(); 2];
        let mut directions = [Slopes::default(); 2];
        for (f, arrow) in self.free().into_iter().enumerate() {
            if arrow.is_none() {
                continue;
            }
            follow[f] = inverse * ahead(&arrows[f]) * -1.0;
            let mut unknown = [follow[f][0], follow[f][1], 0.0, 0.0];
            unknown[2 + f] = 1.0;
            directions[f] = self.plan.positions(&unknown);
        }
        let bending = Vector2::from(follow.map(|follow| bend.by_pair.dot(&follow)));
        let mut slope = bending * bend.slope;
        let outer = bending * bending.transpose();
        let mut bowl = outer * bend.curvature;
        // What the cost gains by the pair alone.
        let mut by_pair = bend.by_pair * bend.slope;
        for a in 0..self.ranges.count {
            let [_, rising, curving] = of_share(self.share(&now.own, a));
            let half = self.ranges.half(a);
            let along = Vector2::from(directions.map(|direction| direction[a] / half));
            slope += along * rising;
            bowl += along * along.transpose() * curving;
            let of_pair = Vector2::new(self.plan.inverse[(a, 0)], self.plan.inverse[(a, 1)]);
            by_pair += of_pair * (rising / half);
        }
        let mut curvature = bowl + outer * bend.of_reach;
        let by_span = inverse.transpose() * by_pair;
        for (f, g) in [(0, 0), (0, 1), (1, 1)] {
            let (p, q) = (follow[f], follow[g]);
            let [first, both, second] = &span.second;
            let mut change =
                first * p[0] * q[0] + both * (p[0] * q[1] + p[1] * q[0]) + second * p[1] * q[1];
            if f == g {
                change -= arrows[f];
            }
            let more = -by_span.dot(&change);
            curvature[(f, g)] += more;
            if f != g {
                curvature[(g, f)] += more;
            }
        }
        Some(Derivatives { slope, curvature, bowl })
    }
}
