//! How fast a path is run through: one parameter in time, so that every axis stays within its limits.

use super::profile::JerkLimitedProfile;
use super::spline::{self, Jet, Spline};
use super::synchronized::{NoProfile, together};
use crate::robot::KinematicLimits;

/// Stages at which the fastest way under speed and acceleration limits is decided.
const STAGES: usize = 80;
/// Times at which a candidate is held against the limits while the best is looked for.
const GLANCES: usize = 100;
/// Times at which the best one is, besides those where its jerk or that of the path changes.
const PROBES: usize = 1200;
/// Slack left below each limit for what lies between the probes, as a share.
const SLACK: f64 = 2e-3;
/// By how much a path may exceed its limits and count as keeping them, as a share: round-off.
const EXACT: f64 = 3e-10;
/// Shares of the acceleration limits that the fastest way is looked for with: what is left is for the jerk.
const SHARES: [f64; 5] = [1.0, 0.8, 0.6, 0.42, 0.28];
/// Difference of the axes' speeds along the path up to which it counts as evenly geared, as a share.
const EVEN: f64 = 0.02;

/// A path, what the axes may do on it, and the largest rate of its parameter [1/s].
pub(crate) struct TimeParameterization<'a> {
    /// Positions over the parameter.
    spline: &'a Spline,
    /// Of each axis that moves.
    limits: Vec<(usize, KinematicLimits)>,
    /// One by each of them: speed, acceleration and jerk.
    by: Vec<[f64; 3]>,
    /// For each interval of the spline the jets of these axes at its start.
    jets: Vec<Jet>,
    /// Largest rate of the parameter [1/s].
    rate: f64,
}

impl<'a> TimeParameterization<'a> {
    /// # Arguments
    /// * `limits` – of each axis
    /// * `rate` – the largest of the parameter [1/s]
    pub(crate) fn new(spline: &'a Spline, limits: &[KinematicLimits], rate: f64) -> Self {
        let limits = limits.iter().copied().enumerate();
        let limits: Vec<(usize, KinematicLimits)> =
            limits.filter(|(axis, _)| spline.moves(*axis)).collect();
        let by = limits.iter().map(|(_, limits)| {
            [limits.velocity, limits.acceleration, limits.jerk].map(|limit| 1.0 / limit)
        });
        let jets = spline.jets().flat_map(|jets| limits.iter().map(|&(axis, _)| jets[axis]));
        Self { spline, by: by.collect(), jets: jets.collect(), limits, rate }
    }

    /// The parameter from 0 to 1 in time.
    ///
    /// A path that gears all axes evenly is run through like a single axis.
    /// On any other the fastest way under speed and acceleration limits is found stage by stage, so that it slows down where an axis has to hurry;
    /// averaging it over a window bounds its jerk, and what still exceeds a limit is slowed down as a whole.
    /// Several windows are tried, and the shortest result is taken.
    ///
    /// # Errors
    /// [`NoProfile`]
    ///
    /// # Source
    /// [TOPPRA] for the stages; the window is own derivation: it keeps ends and rest, and its jerk is a difference of accelerations over its width
    pub(crate) fn plan(&self) -> Result<JerkLimitedProfile, NoProfile> {
        let single = self.like_one_axis()?;
        if single.duration() == 0.0 || self.evenly_geared() {
            return Ok(self.slower_where_it_bends(single));
        }
        let mut best = (f64::INFINITY, None);
        let mut about = None;
        let stages: Vec<Stage> = self.stages().map(|s| self.stage(s)).collect();
        for share in SHARES {
            let way = self.fastest(&stages, share);
            let starts = starts(&way);
            let total = starts[way.len()];
            // From the second share on only near the width that was best.
            // Those first that are most likely the best: what they come to spares looks at the others.
            let widths: Vec<f64> = match about {
                None => [3, 4, 2, 5, 1, 6, 7].map(|k| total * 0.5_f64.powi(k)).into(),
                Some(width) => [1.0, 0.7, 1.4, 0.5, 2.0].map(|by| by * width).into(),
            };
            let mut shortest = f64::INFINITY;
            for width in widths {
                let candidate = averaged(&way, &starts, width);
                let Some(duration) = self.glance(&candidate, shortest.max(best.0)) else {
                    continue;
                };
                if duration < shortest {
                    (shortest, about) = (duration, Some(width));
                }
                if duration < best.0 {
                    best = (duration, Some(candidate));
                }
            }
        }
        let found = best.1.map(|candidate| self.within(candidate));
        // At least so long, and longer where a limit is passed between two glances.
        let least = self.glance(&single, f64::INFINITY).unwrap_or(0.0).max(single.duration());
        Ok(match found {
            Some(found) if found.duration() < least => found,
            found => {
                let single = self.slower_where_it_bends(single);
                found.filter(|found| found.duration() < single.duration()).unwrap_or(single)
            }
        })
    }

    /// What is planned like a single axis: where the path bends, the parameter's speed adds to what the axes do.
    fn slower_where_it_bends(&self, single: JerkLimitedProfile) -> JerkLimitedProfile {
        let excess = self.excess(&single);
        if excess > 1.0 + EXACT { single.slowed(excess * (1.0 + SLACK)) } else { single }
    }

    /// Constant limits of the parameter from the steepest axis, as if the path were straight.
    fn like_one_axis(&self) -> Result<JerkLimitedProfile, NoProfile> {
        let steepest: Vec<f64> =
            self.limits.iter().map(|&(axis, _)| self.spline.steepest(axis)).collect();
        let least = |of: &dyn Fn(&KinematicLimits) -> f64| {
            steepest
                .iter()
                .zip(&self.limits)
                .filter(|(slope, _)| **slope > 0.0)
                .map(|(slope, (_, limits))| of(limits) / slope)
                .fold(f64::INFINITY, f64::min)
        };
        let limits = KinematicLimits {
            velocity: least(&|limits| limits.velocity).min(self.rate),
            acceleration: least(&|limits| limits.acceleration),
            jerk: least(&|limits| limits.jerk),
        };
        if !limits.acceleration.is_finite() {
            return Ok(JerkLimitedProfile::still(1.0, 0.0));
        }
        let found = together(&[0.0], &[1.0], |_| limits)?;
        Ok(found.curves.into_iter().next().expect("one axis was asked for"))
    }

    fn evenly_geared(&self) -> bool {
        self.limits.iter().all(|&(axis, _)| {
            let slopes =
                self.stages().map(|s| self.spline.jet(self.spline.interval(s), axis, s)[1]);
            let (least, most) =
                slopes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            most - least <= EVEN * most.abs().max(least.abs())
        })
    }

    fn stages(&self) -> impl Iterator<Item = f64> {
        (0..=STAGES).map(|stage| stage as f64 / STAGES as f64)
    }

    /// Stretches of (duration, acceleration) of the parameter, the fastest with a share of the acceleration limits.
    fn fastest(&self, stages: &[Stage], share: f64) -> Vec<(f64, f64)> {
        let ds = 1.0 / STAGES as f64;
        // Squares of the rate from which the rest of the way can still be kept.
        let mut reach = vec![0.0; STAGES + 1];
        for k in (0..STAGES).rev() {
            reach[k] = stages[k].fastest(share, ds, reach[k + 1]);
        }
        let mut way = Vec::with_capacity(STAGES);
        let mut x = 0.0_f64;
        for k in 0..STAGES {
            let most = stages[k].most(share, x);
            // Never quite to rest on the way.
            let floor = if k + 1 < STAGES { 1e-9 * stages[k + 1].cap(share) } else { 0.0 };
            let next = (x + 2.0 * ds * most).min(reach[k + 1]).max(floor);
            let duration = 2.0 * ds / (x.sqrt() + next.sqrt());
            way.push((duration, (next - x) / (2.0 * ds)));
            x = next;
        }
        way
    }

    fn stage(&self, s: f64) -> Stage {
        let interval = self.spline.interval(s);
        let (mut cap, mut bends) = (self.rate * self.rate, f64::INFINITY);
        let mut rows = Vec::with_capacity(self.limits.len());
        for &(axis, limits) in &self.limits {
            let [_, slope, curvature, third] = self.spline.jet(interval, axis, s);
            if slope != 0.0 {
                cap = cap.min((limits.velocity / slope).powi(2));
            }
            if curvature != 0.0 {
                bends = bends.min(limits.acceleration / curvature.abs());
            }
            if third != 0.0 {
                cap = cap.min((limits.jerk / third.abs()).powf(2.0 / 3.0));
            }
            if slope.abs() > 1e-12 {
                rows.push((curvature / slope, limits.acceleration / slope.abs()));
            }
        }
        let between = |(place, &(curvature, limit)): (usize, &(f64, f64))| {
            let others = rows[..place].iter().filter(move |(other, _)| *other != curvature);
            others.map(move |(other, allowed)| (limit + allowed) / (curvature - other).abs())
        };
        let between = rows.iter().enumerate().flat_map(between).fold(f64::INFINITY, f64::min);
        Stage { cap, by_share: bends.min(between), rows }
    }

    /// The same, as fast as every limit is kept.
    fn within(&self, curve: JerkLimitedProfile) -> JerkLimitedProfile {
        let factor = self.excess(&curve) * (1.0 + SLACK);
        curve.slowed(factor)
    }

    /// How long it would have to take so that it just keeps every limit, at a glance; `None` if no less than is asked for.
    fn glance(&self, curve: &JerkLimitedProfile, less_than: f64) -> Option<f64> {
        let mut worst = 1e-9;
        for k in 1..GLANCES {
            // All over the way first: what is too long is so somewhere near a dozen of them.
            let k = k * 37 % GLANCES;
            let state = curve.at(curve.duration() * k as f64 / GLANCES as f64);
            self.exceed(&mut worst, state, self.spline.interval(state[0]));
            if curve.duration() * worst >= less_than {
                return None;
            }
        }
        Some(curve.duration() * worst)
    }

    /// The same, closely.
    fn excess(&self, curve: &JerkLimitedProfile) -> f64 {
        let duration = curve.duration();
        let mut worst = 1e-9;
        let (mut at, mut interval) = (curve.walk(), self.spline.walk());
        for k in 1..PROBES {
            let state = at(duration * k as f64 / PROBES as f64);
            self.exceed(&mut worst, state, interval(state[0]));
        }
        // The jerk jumps where the pieces meet: both sides are looked at.
        for t in curve.breaks() {
            for t in [t - 1e-9 * duration, t + 1e-9 * duration] {
                if t > 0.0 && t < duration {
                    let state = curve.at(t);
                    self.exceed(&mut worst, state, self.spline.interval(state[0]));
                }
            }
        }
        // So does the third derivative of the path at its knots.
        let knots = self.spline.knots();
        for (interval, &knot) in knots.iter().enumerate().take(knots.len() - 1).skip(1) {
            let state = curve.at(curve.when(knot));
            self.exceed(&mut worst, state, interval - 1);
            self.exceed(&mut worst, state, interval);
        }
        worst
    }

    /// Raises `worst` to the factor of time by which a state of the parameter exceeds the limits.
    fn exceed(&self, worst: &mut f64, [s, rate, acceleration, jerk]: [f64; 4], interval: usize) {
        let mut most = rate / self.rate;
        let (mut squared, mut cubed) = (0.0_f64, 0.0_f64);
        let count = self.by.len();
        let t = s - self.spline.knots()[interval];
        for (jet, by) in self.jets[interval * count..][..count].iter().zip(&self.by) {
            let [_, slope, curvature, third] = spline::after(jet, t);
            let v = slope * rate;
            let a = curvature * rate * rate + slope * acceleration;
            let j = third * rate.powi(3) + 3.0 * curvature * rate * acceleration + slope * jerk;
            most = most.max(v.abs() * by[0]);
            squared = squared.max(a.abs() * by[1]);
            cubed = cubed.max(j.abs() * by[2]);
        }
        *worst = worst.max(most);
        // Roots only of what is worse: there are far more states than worst ones.
        if squared > *worst * *worst {
            *worst = squared.sqrt();
        }
        if cubed > *worst * *worst * *worst {
            *worst = cubed.cbrt();
        }
    }
}

/// What the axes allow at one point of the path.
struct Stage {
    /// Of each axis: its curvature and its acceleration limit, by its slope.
    rows: Vec<(f64, f64)>,
    /// Largest square of the rate, by speed and jerk.
    cap: f64,
    /// The same by acceleration: where an axis does nothing but bend, and where two of them ask for different ones.
    by_share: f64,
}

impl Stage {
    /// Largest square of the rate with a share of the acceleration limits.
    fn cap(&self, share: f64) -> f64 {
        self.cap.min(share * self.by_share)
    }

    /// Largest acceleration of the parameter for a square of its rate.
    fn most(&self, share: f64, x: f64) -> f64 {
        self.rows
            .iter()
            .fold(1e12, |most, &(curvature, limit)| most.min(share * limit - curvature * x))
    }

    /// Largest square of the rate from which one of the next stage can be kept.
    ///
    /// ```text
    ///    −c_i x − l_i  ≤  ẍ  ≤  −c_i x + l_i        for all axes i, so that  0  ≤  x + 2 ds ẍ  ≤  next  for one ẍ
    /// ```
    /// Each of these keeps x below a bound or always holds, and all hold for x = 0; what two axes ask for is in the cap.
    fn fastest(&self, share: f64, ds: f64, next: f64) -> f64 {
        self.rows.iter().fold(self.cap(share), |x, &(curvature, limit)| {
            let (grows, by) = (1.0 - 2.0 * ds * curvature, 2.0 * ds * share * limit);
            if grows > 0.0 {
                x.min((next + by) / grows)
            } else if grows < 0.0 {
                x.min(-by / grows)
            } else {
                x
            }
        })
    }
}

/// When each stretch of a way begins, and the last ends [s].
fn starts(way: &[(f64, f64)]) -> Vec<f64> {
    let mut time = 0.0;
    let ends = way.iter().map(|(duration, _)| {
        time += duration;
        time
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// The average of a way over a window [s]: stretches of constant jerk.
///
/// ```text
///    s̈(t)  =  (ṡ(t) − ṡ(t − w)) / w        s⃛(t)  =  (s̈(t) − s̈(t − w)) / w
/// ```
///
/// # Arguments
/// * `starts` – when each stretch begins, and the last ends [s]
fn averaged(way: &[(f64, f64)], starts: &[f64], width: f64) -> JerkLimitedProfile {
    // Where a stretch begins, now or a window ago, one after the other.
    let acceleration = |begun: usize| match begun {
        0 => 0.0,
        begun => way.get(begun - 1).map_or(0.0, |(_, acceleration)| *acceleration),
    };
    let mut stretches = Vec::with_capacity(2 * starts.len());
    let (mut now, mut before) = (0, 0);
    let mut last = 0.0;
    while before < starts.len() {
        let ago = starts[before] + width;
        let next = starts.get(now).copied().filter(|&start| start <= ago);
        let time = next.unwrap_or(ago);
        stretches.push((time - last, (acceleration(now) - acceleration(before)) / width));
        last = time;
        if next.is_some() { now += 1 } else { before += 1 }
    }
    JerkLimitedProfile::through(0.0, 1.0, &stretches)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(count: usize) -> Vec<KinematicLimits> {
        vec![KinematicLimits { velocity: 2.0, acceleration: 10.0, jerk: 200.0 }; count]
    }

    fn spline(of: impl Fn(f64) -> Vec<f64>) -> Spline {
        let knots: Vec<f64> = (0..=60).map(|k| f64::from(k) / 60.0).collect();
        let values: Vec<Vec<f64>> = knots.iter().map(|&s| of(s)).collect();
        Spline::through(&knots, &values)
    }

    fn worst(spline: &Spline, curve: &JerkLimitedProfile, limits: &[KinematicLimits]) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        for k in 1..20_000 {
            let [s, r, a, j] = curve.at(curve.duration() * f64::from(k) / 20_000.0);
            for (axis, limits) in limits.iter().enumerate() {
                let [_, d1, d2, d3] = spline.jet(spline.interval(s), axis, s);
                worst[0] = worst[0].max((d1 * r).abs() / limits.velocity);
                worst[1] = worst[1].max((d2 * r * r + d1 * a).abs() / limits.acceleration);
                let third = d3 * r.powi(3) + 3.0 * d2 * r * a + d1 * j;
                worst[2] = worst[2].max(third.abs() / limits.jerk);
            }
        }
        worst
    }

    #[test]
    fn an_even_path_is_as_fast_as_one_axis() {
        let (spline, limits) = (spline(|s| vec![3.0 * s, -s]), limits(2));
        let curve = TimeParameterization::new(&spline, &limits, 1e9).plan().unwrap();
        assert!((curve.duration() - (1.5 + 0.2 + 0.05)).abs() < 1e-9, "{}", curve.duration());
        let slow = TimeParameterization::new(&spline, &limits, 0.25).plan().unwrap();
        assert!(slow.duration() > 4.0);
    }

    #[test]
    fn limits_hold_all_along_and_only_a_stretch_is_slow() {
        // A turn past an axis at a distance of a tenth: fast in the middle, as near a singular position.
        let turn = |s: f64| vec![((s - 0.5) / 0.1).atan(), 2.0 * s];
        let (spline, limits) = (spline(turn), limits(2));
        let pace = TimeParameterization::new(&spline, &limits, 1e9);
        let curve = pace.plan().unwrap();
        let worst = worst(&spline, &curve, &limits);
        assert!(worst.iter().all(|&share| share < 1.0), "{worst:?}");
        // With the middle's limits everywhere it takes much longer.
        let even = pace.slower_where_it_bends(pace.like_one_axis().unwrap());
        assert!(
            curve.duration() < 0.8 * even.duration(),
            "{} {}",
            curve.duration(),
            even.duration()
        );
        let rate = |s: f64| curve.at(curve.when(s))[1];
        assert!(rate(0.25) > 1.2 * rate(0.5), "{} {}", rate(0.25), rate(0.5));
        assert_eq!(curve.at(curve.duration()), [1.0, 0.0, 0.0, 0.0]);
    }
}
