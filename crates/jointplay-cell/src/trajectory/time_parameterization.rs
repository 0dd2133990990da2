//! Time parameterization of a path: its parameter over time, within the limits of all axes.
//!
//! For a path q(s), the axes move with
//!
//! ```text
//!    q̇ = q' ṡ        q̈ = q'' ṡ² + q' s̈        q⃛ = q''' ṡ³ + 3 q'' ṡ s̈ + q' s⃛
//! ```
//! Limits of velocity and acceleration bound ṡ² and s̈ at each s: the fastest parameterization under them is found by reachability analysis (\[TOPPRA\]).
//! It switches the acceleration at once; a moving average over time bounds the jerk.
//! Because the average passes each s at another time, the result is verified on a fine grid and slowed as a whole until all limits hold.

use super::profile::{AxisState, JerkLimitedProfile};
use super::spline::{self, Jet, Spline};
use super::synchronized::{NoProfile, synchronized_profile};
use crate::robot::KinematicLimits;

/// Number of intervals between grid points of the path parameter.
const GRID_INTERVALS: usize = 80;
/// Number of times at which a candidate is compared with the limits while the best is searched for.
const COARSE_SAMPLES: usize = 100;
/// Number of times at which the result is verified, besides those where its jerk or that of the path is discontinuous.
const VERIFICATION_SAMPLES: usize = 1200;
/// Margin below each limit for the times between verified ones, relative to the limit.
const MARGIN: f64 = 2e-3;
/// Relative amount by which round-off may exceed a limit.
const ROUND_OFF_TOLERANCE: f64 = 3e-10;
/// Shares of the acceleration limits that the fastest parameterization may use; the rest is left to the jerk.
const ACCELERATION_SHARES: [f64; 5] = [1.0, 0.8, 0.6, 0.42, 0.28];
/// Windows of the moving average as shares of the duration, halved k times; those first that are most often the best, because a good candidate shortens the comparison of all others.
const WINDOW_HALVINGS: [i32; 7] = [3, 4, 2, 5, 1, 6, 7];
/// Windows relative to the best window of the acceleration fraction before.
const WINDOW_FACTORS: [f64; 5] = [1.0, 0.7, 1.4, 0.5, 2.0];
/// Largest difference of an axis' slopes along a path that counts as constant, relative to the slope.
const PROPORTIONALITY_TOLERANCE: f64 = 0.02;

/// A path to parameterize, and its limits.
pub(crate) struct TimeParameterization<'a> {
    /// Positions of all axes over the path parameter.
    spline: &'a Spline,
    /// Index and limits of each axis that moves.
    limits: Vec<(usize, KinematicLimits)>,
    /// Inverse limits of velocity, acceleration and jerk of each axis that moves.
    inverse_limits: Vec<[f64; 3]>,
    /// Jets of the moving axes at the start of each interval of the spline.
    jets: Vec<Jet>,
    /// Largest rate of the path parameter (1/s).
    max_rate: f64,
}

/// A piece of a parameterization with constant acceleration of the path parameter.
#[derive(Clone, Copy)]
struct Piece {
    /// (s)
    duration: f64,
    /// (1/s²)
    acceleration: f64,
}

impl<'a> TimeParameterization<'a> {
    /// # Arguments
    /// * `limits` – limits of each axis
    /// * `max_rate` – largest rate of the path parameter (1/s)
    pub(crate) fn new(spline: &'a Spline, limits: &[KinematicLimits], max_rate: f64) -> Self {
        let limits = limits.iter().copied().enumerate();
        let limits: Vec<(usize, KinematicLimits)> =
            limits.filter(|(axis, _)| spline.moves(*axis)).collect();
        let inverse_limits = limits.iter().map(|(_, limits)| {
            [limits.velocity, limits.acceleration, limits.jerk].map(|limit| 1.0 / limit)
        });
        let jets = spline.jets().flat_map(|jets| limits.iter().map(|&(axis, _)| jets[axis]));
        let (inverse_limits, jets) = (inverse_limits.collect(), jets.collect());
        Self { spline, inverse_limits, jets, limits, max_rate }
    }

    /// The path parameter over time, from 0 to 1.
    ///
    /// A path on which all axes move in proportion is parameterized like a single axis.
    /// On any other path, candidates are the fastest parameterizations under several shares of the acceleration limits, each averaged over several windows;
    /// the shortest candidate is returned, slowed until it satisfies all limits.
    ///
    /// # Errors
    /// [`NoProfile`]
    ///
    /// # Source
    /// \[TOPPRA\] for the parameterization; own derivation for the moving average: it preserves both ends and zero velocity there, and its jerk is a difference of accelerations over the window
    pub(crate) fn plan(&self) -> Result<JerkLimitedProfile, NoProfile> {
        let single = self.single_axis_profile()?;
        if single.duration() == 0.0 || self.is_proportional() {
            return Ok(self.slowed_for_curvature(single));
        }
        let best = self.best_candidate().map(|candidate| self.slowed_to_limits(candidate));
        // The coarse duration of the single-axis profile is a lower bound: if it is longer, no verification is needed.
        let single_bound =
            self.coarse_duration(&single, f64::INFINITY).unwrap_or(0.0).max(single.duration());
        Ok(match best {
            Some(best) if best.duration() < single_bound => best,
            best => {
                let single = self.slowed_for_curvature(single);
                best.filter(|best| best.duration() < single.duration()).unwrap_or(single)
            }
        })
    }

    /// The candidate that is shortest once it is slowed to the limits, by coarse samples; its timing is not yet slowed.
    fn best_candidate(&self) -> Option<JerkLimitedProfile> {
        let mut best = (f64::INFINITY, None);
        let mut best_window = None;
        let grid: Vec<GridPoint> = grid().map(|s| self.grid_point(s)).collect();
        for fraction in ACCELERATION_SHARES {
            let pieces = self.fastest_pieces(&grid, fraction);
            let starts = start_times(&pieces);
            let duration = starts[pieces.len()];
            let windows: Vec<f64> = match best_window {
                None => WINDOW_HALVINGS.map(|k| duration * 0.5_f64.powi(k)).into(),
                Some(window) => WINDOW_FACTORS.map(|factor| factor * window).into(),
            };
            let mut shortest_of_share = f64::INFINITY;
            for window in windows {
                let candidate = moving_average(&pieces, &starts, window);
                let longest = shortest_of_share.max(best.0);
                let Some(duration) = self.coarse_duration(&candidate, longest) else {
                    continue;
                };
                if duration < shortest_of_share {
                    (shortest_of_share, best_window) = (duration, Some(window));
                }
                if duration < best.0 {
                    best = (duration, Some(candidate));
                }
            }
        }
        best.1
    }

    /// A profile planned as for a single axis, slowed where the curvature of the path exceeds the limits.
    fn slowed_for_curvature(&self, single: JerkLimitedProfile) -> JerkLimitedProfile {
        let scale = self.time_scale(&single);
        if scale > 1.0 + ROUND_OFF_TOLERANCE {
            single.slowed(scale * (1.0 + MARGIN))
        } else {
            single
        }
    }

    /// A profile slowed until it satisfies all limits, or accelerated until it reaches one.
    fn slowed_to_limits(&self, profile: JerkLimitedProfile) -> JerkLimitedProfile {
        let factor = self.time_scale(&profile) * (1.0 + MARGIN);
        profile.slowed(factor)
    }

    /// The profile of a single axis, with constant limits of the parameter by the largest slope of each axis.
    fn single_axis_profile(&self) -> Result<JerkLimitedProfile, NoProfile> {
        let slopes: Vec<f64> =
            self.limits.iter().map(|&(axis, _)| self.spline.max_slope(axis)).collect();
        let least = |limit: &dyn Fn(&KinematicLimits) -> f64| {
            slopes
                .iter()
                .zip(&self.limits)
                .filter(|(slope, _)| **slope > 0.0)
                .map(|(slope, (_, limits))| limit(limits) / slope)
                .fold(f64::INFINITY, f64::min)
        };
        let limits = KinematicLimits {
            velocity: least(&|limits| limits.velocity).min(self.max_rate),
            acceleration: least(&|limits| limits.acceleration),
            jerk: least(&|limits| limits.jerk),
        };
        if !limits.acceleration.is_finite() {
            return Ok(JerkLimitedProfile::at_rest(1.0, 0.0));
        }
        let found = synchronized_profile(&[0.0], &[1.0], |_| limits)?;
        Ok(found.axes.into_iter().next().expect("one axis was planned"))
    }

    /// Whether all axes move nearly in proportion along the path.
    fn is_proportional(&self) -> bool {
        self.limits.iter().all(|&(axis, _)| {
            let slopes = grid().map(|s| self.spline.jet(self.spline.interval(s), axis, s)[1]);
            let (min, max) =
                slopes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            max - min <= PROPORTIONALITY_TOLERANCE * max.abs().max(min.abs())
        })
    }

    /// The fastest parameterization under the velocity limits and a fraction of the acceleration limits.
    ///
    /// The backward pass computes, for each grid point, the largest x = ṡ² from which the rest of the path can be followed (the upper end of the controllable set);
    /// the forward pass accelerates as much as the axes allow without leaving these sets.
    fn fastest_pieces(&self, grid: &[GridPoint], fraction: f64) -> Vec<Piece> {
        let ds = 1.0 / GRID_INTERVALS as f64;
        let mut controllable = vec![0.0; GRID_INTERVALS + 1];
        for k in (0..GRID_INTERVALS).rev() {
            controllable[k] = grid[k].controllable(fraction, ds, controllable[k + 1]);
        }
        let mut pieces = Vec::with_capacity(GRID_INTERVALS);
        let mut x = 0.0_f64;
        for k in 0..GRID_INTERVALS {
            let acceleration = grid[k].max_acceleration(fraction, x);
            // The rate stays above zero between the ends: otherwise the piece would take for ever.
            let floor = if k + 1 < GRID_INTERVALS {
                1e-9 * grid[k + 1].max_squared_rate(fraction)
            } else {
                0.0
            };
            let next = (x + 2.0 * ds * acceleration).min(controllable[k + 1]).max(floor);
            let duration = 2.0 * ds / (x.sqrt() + next.sqrt());
            pieces.push(Piece { duration, acceleration: (next - x) / (2.0 * ds) });
            x = next;
        }
        pieces
    }

    /// Constraints of all axes at one value of the path parameter.
    fn grid_point(&self, s: f64) -> GridPoint {
        let interval = self.spline.interval(s);
        let (mut by_velocity, mut by_curvature) = (self.max_rate * self.max_rate, f64::INFINITY);
        let mut rows = Vec::with_capacity(self.limits.len());
        for &(axis, limits) in &self.limits {
            let [_, slope, curvature, third] = self.spline.jet(interval, axis, s);
            if slope != 0.0 {
                by_velocity = by_velocity.min((limits.velocity / slope).powi(2));
            }
            if curvature != 0.0 {
                by_curvature = by_curvature.min(limits.acceleration / curvature.abs());
            }
            if third != 0.0 {
                by_velocity = by_velocity.min((limits.jerk / third.abs()).powf(2.0 / 3.0));
            }
            if slope.abs() > 1e-12 {
                rows.push(ConstraintRow {
                    curvature: curvature / slope,
                    limit: limits.acceleration / slope.abs(),
                });
            }
        }
        // Two axes admit a common s̈ only up to the ṡ² at which their intervals of s̈ separate.
        let separation = |(index, row): (usize, &ConstraintRow)| {
            let row = *row;
            let others = rows[..index].iter();
            let others = others.filter(move |other| other.curvature != row.curvature);
            others.map(move |other| {
                (row.limit + other.limit) / (row.curvature - other.curvature).abs()
            })
        };
        let by_pairs = rows.iter().enumerate().flat_map(separation).fold(f64::INFINITY, f64::min);
        GridPoint { by_velocity, by_acceleration: by_curvature.min(by_pairs), rows }
    }

    /// Duration at which a profile would just satisfy all limits, by coarse samples (s); `None` if it is at least `less_than`.
    fn coarse_duration(&self, profile: &JerkLimitedProfile, less_than: f64) -> Option<f64> {
        let mut scale = 1e-9;
        for k in 1..COARSE_SAMPLES {
            // 37 has no common factor with the number of samples: the first dozen is spread over the whole path, which finds violations early.
            let k = k * 37 % COARSE_SAMPLES;
            let state = profile.state(profile.duration() * k as f64 / COARSE_SAMPLES as f64);
            self.raise_time_scale(&mut scale, state, self.spline.interval(state[0]));
            if profile.duration() * scale >= less_than {
                return None;
            }
        }
        Some(profile.duration() * scale)
    }

    /// Smallest time scale at which a profile satisfies all limits, by fine samples.
    fn time_scale(&self, profile: &JerkLimitedProfile) -> f64 {
        let duration = profile.duration();
        let mut scale = 1e-9;
        let mut state = profile.states_in_order();
        let mut interval = self.spline.intervals_in_order();
        for k in 1..VERIFICATION_SAMPLES {
            let state = state(duration * k as f64 / VERIFICATION_SAMPLES as f64);
            self.raise_time_scale(&mut scale, state, interval(state[0]));
        }
        // The jerk of the parameter is discontinuous between pieces: both sides are verified.
        for t in profile.jerk_discontinuities() {
            for t in [t - 1e-9 * duration, t + 1e-9 * duration] {
                if t > 0.0 && t < duration {
                    let state = profile.state(t);
                    self.raise_time_scale(&mut scale, state, self.spline.interval(state[0]));
                }
            }
        }
        // So is the third derivative of the path at its knots.
        let knots = self.spline.knots();
        for (interval, &knot) in knots.iter().enumerate().take(knots.len() - 1).skip(1) {
            let state = profile.state(profile.time_at(knot));
            self.raise_time_scale(&mut scale, state, interval - 1);
            self.raise_time_scale(&mut scale, state, interval);
        }
        scale
    }

    /// Raises a time scale to the one at which a state of the path parameter satisfies all limits.
    ///
    /// Time stretched by a factor divides velocities by it, accelerations by its square and jerks by its cube.
    fn raise_time_scale(
        &self,
        scale: &mut f64,
        [s, rate, acceleration, jerk]: AxisState,
        interval: usize,
    ) {
        let mut velocity_ratio = rate / self.max_rate;
        let (mut acceleration_ratio, mut jerk_ratio) = (0.0_f64, 0.0_f64);
        let count = self.inverse_limits.len();
        let t = s - self.spline.knots()[interval];
        for (jet, inverse) in
            self.jets[interval * count..][..count].iter().zip(&self.inverse_limits)
        {
            let [_, slope, curvature, third] = spline::advanced(jet, t);
            let v = slope * rate;
            let a = curvature * rate * rate + slope * acceleration;
            let j = third * rate.powi(3) + 3.0 * curvature * rate * acceleration + slope * jerk;
            velocity_ratio = velocity_ratio.max(v.abs() * inverse[0]);
            acceleration_ratio = acceleration_ratio.max(a.abs() * inverse[1]);
            jerk_ratio = jerk_ratio.max(j.abs() * inverse[2]);
        }
        *scale = scale.max(velocity_ratio);
        // Powers are compared before roots are taken: few states raise the scale.
        if acceleration_ratio > *scale * *scale {
            *scale = acceleration_ratio.sqrt();
        }
        if jerk_ratio > *scale * *scale * *scale {
            *scale = jerk_ratio.cbrt();
        }
    }
}

/// Grid points of the path parameter, both ends included.
fn grid() -> impl Iterator<Item = f64> {
    (0..=GRID_INTERVALS).map(|k| k as f64 / GRID_INTERVALS as f64)
}

/// The acceleration constraint of one axis on the path parameter: |s̈ + curvature ṡ²| ≤ limit.
#[derive(Clone, Copy)]
struct ConstraintRow {
    /// q'' / q'
    curvature: f64,
    /// Acceleration limit / |q'| (1/s²).
    limit: f64,
}

/// Constraints of all axes at one grid point.
struct GridPoint {
    rows: Vec<ConstraintRow>,
    /// Largest squared rate by the limits of velocity and jerk (1/s²).
    by_velocity: f64,
    /// Largest squared rate by the acceleration limits: where axes have no slope but curvature, and where two axes admit no common acceleration (1/s²).
    by_acceleration: f64,
}

impl GridPoint {
    /// Largest squared rate with a fraction of the acceleration limits (1/s²).
    fn max_squared_rate(&self, fraction: f64) -> f64 {
        self.by_velocity.min(fraction * self.by_acceleration)
    }

    /// Largest acceleration of the path parameter at a squared rate x (1/s²).
    fn max_acceleration(&self, fraction: f64, x: f64) -> f64 {
        self.rows.iter().fold(1e12, |most, row| most.min(fraction * row.limit - row.curvature * x))
    }

    /// Largest squared rate x from which a squared rate of at most `next` is reached at the next grid point.
    ///
    /// ```text
    ///    −c_i x − l_i  ≤  s̈  ≤  −c_i x + l_i   for all axes i,   and   0  ≤  x + 2 ds s̈  ≤  next   for one s̈
    /// ```
    /// Each constraint bounds x from above or always holds, because all hold for x = 0; constraints of two axes on each other are part of [`Self::max_squared_rate`].
    fn controllable(&self, fraction: f64, ds: f64, next: f64) -> f64 {
        self.rows.iter().fold(self.max_squared_rate(fraction), |x, row| {
            let (slope, constant) =
                (1.0 - 2.0 * ds * row.curvature, 2.0 * ds * fraction * row.limit);
            if slope > 0.0 {
                x.min((next + constant) / slope)
            } else if slope < 0.0 {
                x.min(-constant / slope)
            } else {
                x
            }
        })
    }
}

/// Start time of each piece, and the end time of the last (s).
fn start_times(pieces: &[Piece]) -> Vec<f64> {
    let mut time = 0.0;
    let ends = pieces.iter().map(|piece| {
        time += piece.duration;
        time
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// The moving average of a parameterization over a window of time (s): pieces of constant jerk.
///
/// ```text
///    s̈(t)  =  (ṡ(t) − ṡ(t − w)) / w        s⃛(t)  =  (s̈(t) − s̈(t − w)) / w
/// ```
///
/// # Arguments
/// * `starts` – by [`start_times`] (s)
fn moving_average(pieces: &[Piece], starts: &[f64], window: f64) -> JerkLimitedProfile {
    // Acceleration after a number of pieces have begun; zero before the first and after the last.
    let acceleration = |begun: usize| match begun {
        0 => 0.0,
        begun => pieces.get(begun - 1).map_or(0.0, |piece| piece.acceleration),
    };
    let mut averaged = Vec::with_capacity(2 * starts.len());
    // The jerk changes where a piece begins, or began a window ago: both sequences are merged in order of time.
    let (mut leading, mut trailing) = (0, 0);
    let mut last = 0.0;
    while trailing < starts.len() {
        let trailing_start = starts[trailing] + window;
        let leading_start = starts.get(leading).copied().filter(|&start| start <= trailing_start);
        let time = leading_start.unwrap_or(trailing_start);
        averaged.push((time - last, (acceleration(leading) - acceleration(trailing)) / window));
        last = time;
        if leading_start.is_some() { leading += 1 } else { trailing += 1 }
    }
    JerkLimitedProfile::from_pieces(0.0, 1.0, &averaged)
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

    fn worst(
        spline: &Spline,
        profile: &JerkLimitedProfile,
        limits: &[KinematicLimits],
    ) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        for k in 1..20_000 {
            let [s, r, a, j] = profile.state(profile.duration() * f64::from(k) / 20_000.0);
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
    fn straight_path_is_as_fast_as_one_axis() {
        let (spline, limits) = (spline(|s| vec![3.0 * s, -s]), limits(2));
        let profile = TimeParameterization::new(&spline, &limits, 1e9).plan().unwrap();
        assert!((profile.duration() - (1.5 + 0.2 + 0.05)).abs() < 1e-9, "{}", profile.duration());
        let slow = TimeParameterization::new(&spline, &limits, 0.25).plan().unwrap();
        assert!(slow.duration() > 4.0);
    }

    #[test]
    fn limits_hold_along_the_path_and_only_its_profiled_part_is_slow() {
        // The direction to a point that is passed at a distance of a tenth: it turns fast in the middle, as near a singular position.
        let turn = |s: f64| vec![((s - 0.5) / 0.1).atan(), 2.0 * s];
        let (spline, limits) = (spline(turn), limits(2));
        let parameterization = TimeParameterization::new(&spline, &limits, 1e9);
        let profile = parameterization.plan().unwrap();
        let worst = worst(&spline, &profile, &limits);
        assert!(worst.iter().all(|&share| share < 1.0), "{worst:?}");
        // With the limits of the middle everywhere the path takes much longer.
        let constant_limits =
            parameterization.slowed_for_curvature(parameterization.single_axis_profile().unwrap());
        assert!(
            profile.duration() < 0.8 * constant_limits.duration(),
            "{} {}",
            profile.duration(),
            constant_limits.duration()
        );
        let rate = |s: f64| profile.state(profile.time_at(s))[1];
        assert!(rate(0.25) > 1.2 * rate(0.5), "{} {}", rate(0.25), rate(0.5));
        assert_eq!(profile.state(profile.duration()), [1.0, 0.0, 0.0, 0.0]);
    }
}
