//! Time parameterization of a path: its parameter over time, within the limits of all axes.
//!
//! For a path q(s), the axes move with
//!
//! ```text
//!    q̇ = q' ṡ        q̈ = q'' ṡ² + q' s̈        q⃛ = q''' ṡ³ + 3 q'' ṡ s̈ + q' s⃛
//! ```
//! The fastest parameterization under these limits is found at collocation points; it is verified on a fine grid, its constraints are tightened where limits are exceeded in between,
//! and the remaining exceedance is removed by a slowdown of the whole.

use pulp::Arch;

use super::axis_state::AxisState;
use super::collocation::{CollocationPath, FrictionConstraints};
use super::profile::JerkLimitedProfile;
use super::rate_constraints::{Exceedance, RateConstraints};
use super::rate_lanes::INTERVALS;
use super::rate_search::RateSearch;
use super::spline::{self, Jet, Spline};
use super::squared_rate::RateGrid;
use super::synchronized::{NoProfile, synchronized_profile};
use crate::extrema::raise;
use crate::robot::{AxesMotion, KinematicLimits};

/// Number of intervals between the path parameters at which slopes are compared.
const SLOPE_INTERVALS: usize = 80;
/// Least number of times at which a profile is verified, besides those in each of its pieces.
const VERIFICATION_SAMPLES: f64 = 600.0;
/// Least number of intervals between the verified times of each piece of a profile.
const VERIFICATION_INTERVALS: f64 = 4.0;
/// Number of states that are verified side by side.
const LANES: usize = 8;
/// Margin below each limit for the times between verified ones, relative to the limit.
const MARGIN: f64 = 1e-3;
/// Relative amount by which round-off may exceed a limit.
const ROUND_OFF_TOLERANCE: f64 = 3e-10;
/// Largest difference of an axis' slopes along a path that counts as constant, relative to the slope.
const PROPORTIONALITY_TOLERANCE: f64 = 5e-3;
/// Largest ramp fraction of a search with friction: smaller accelerations are reached sooner.
const MAX_RAMP_FRACTION_BY_FRICTION: f64 = 0.04;
/// Number of searches with tightened constraints.
const REFINEMENTS: usize = 3;
/// Relative excess of the duration over the least one at which each search ends.
const GAPS: [f64; REFINEMENTS + 1] = [1e-2, 3e-3, 2e-3, 2e-3];
/// Fraction of the duration that a search with tightened constraints has to save at least; below it the search is not repeated.
const REFINEMENT_GAIN: f64 = 2e-3;

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

    /// The path parameter over time as by [`Self::plan`], in addition within constraints of friction at collocation points; between them they may be exceeded slightly.
    pub(crate) fn plan_with_friction(
        &self,
        friction: &FrictionConstraints<'_>,
    ) -> Option<JerkLimitedProfile> {
        let single = self.single_axis_profile(self.first_acceleration(friction)?).ok()?;
        let ramp_fraction = single.ramp_duration() / single.duration();
        self.fastest_profile(ramp_fraction.min(MAX_RAMP_FRACTION_BY_FRICTION), Some(friction))
    }

    /// Largest acceleration of the path parameter at the start of the path, within constraints of friction (1/s²); `None` where there is none.
    fn first_acceleration(&self, friction: &FrictionConstraints<'_>) -> Option<f64> {
        let jets: Vec<Jet> =
            (0..self.spline.axes()).map(|axis| self.spline.jet(0, axis, 0.0)).collect();
        let [positions, velocities] =
            [0, 1].map(|order| jets.iter().map(|jet| jet[order]).collect::<Vec<f64>>());
        let accelerations = vec![0.0; jets.len()];
        let rows = friction(&AxesMotion {
            positions: &positions,
            velocities: &velocities,
            accelerations: &accelerations,
        })?;
        // x' = 2 s̈
        Some(rows.iter().map(|row| 0.5 / row[1].max(0.0)).fold(f64::INFINITY, f64::min))
    }

    /// The path parameter over time, from 0 to 1.
    ///
    /// A path on which all axes move in proportion is parameterized like a single axis, any other path by [`RateSearch`].
    ///
    /// # Errors
    /// [`NoProfile`]
    pub(crate) fn plan(&self) -> Result<JerkLimitedProfile, NoProfile> {
        let single = self.single_axis_profile(f64::INFINITY)?;
        if single.duration() == 0.0 || self.is_proportional() {
            return Ok(self.slowed_for_curvature(single));
        }
        let ramp_fraction = single.ramp_duration() / single.duration();
        let Some(fastest) = self.fastest_profile(ramp_fraction, None) else {
            return Ok(self.slowed_for_curvature(single));
        };
        // The slowdown for curvature never shortens a profile.
        if fastest.duration() <= single.duration() {
            return Ok(fastest);
        }
        let single = self.slowed_for_curvature(single);
        Ok(if fastest.duration() <= single.duration() { fastest } else { single })
    }

    /// The fastest profile found, slowed until it satisfies all limits; `None` where numbers overflow.
    ///
    /// # Arguments
    /// * `ramp_fraction` – fraction of its duration in which the acceleration grows from rest, by constant limits
    fn fastest_profile(
        &self,
        ramp_fraction: f64,
        friction: Option<&FrictionConstraints<'_>>,
    ) -> Option<JerkLimitedProfile> {
        let grid = RateGrid::new(ramp_fraction);
        let path = CollocationPath::new(&grid, self.spline, &self.limits, self.max_rate, friction)?;
        let mut tightened = Exceedance::none(self.limits.len());
        let mut search = RateSearch::new(RateConstraints::new(&path, &tightened))?;
        let mut best: Option<JerkLimitedProfile> = None;
        for (refinement, gap) in GAPS.into_iter().enumerate() {
            search = search.solved(gap);
            let solution = search.solution();
            let profile = solution.profile();
            let mut found = Exceedance::none(self.limits.len());
            let mut scale = self.time_scale(&profile, Some(&mut found));
            if friction.is_some() {
                // Friction keeps the axes below their limits: the profile is not accelerated up to these.
                scale = scale.max(1.0);
            }
            let profile = profile.slowed(scale * (1.0 + MARGIN));
            let is_shorter = |best: &JerkLimitedProfile| profile.duration() < best.duration();
            if profile.duration().is_finite() && best.as_ref().is_none_or(is_shorter) {
                best = Some(profile);
            }
            let possible_gain = scale - 1.0 + if refinement == 0 { gap } else { 0.0 };
            if refinement == REFINEMENTS || possible_gain < REFINEMENT_GAIN {
                break;
            }
            tightened.accumulate(&found);
            let tighter = RateConstraints::new(&path, &tightened);
            let Some(next) = RateSearch::continued(tighter, &solution, gap) else {
                break;
            };
            search = next;
        }
        best
    }

    /// A profile planned as for a single axis, slowed where the curvature of the path exceeds the limits.
    fn slowed_for_curvature(&self, single: JerkLimitedProfile) -> JerkLimitedProfile {
        let scale = self.time_scale(&single, None);
        if scale > 1.0 + ROUND_OFF_TOLERANCE {
            single.slowed(scale * (1.0 + MARGIN))
        } else {
            single
        }
    }

    /// The profile of a single axis, with constant limits of the parameter by the largest slope of each axis.
    ///
    /// # Arguments
    /// * `max_acceleration` – largest acceleration of the path parameter, besides that of the axes (1/s²)
    fn single_axis_profile(&self, max_acceleration: f64) -> Result<JerkLimitedProfile, NoProfile> {
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
            acceleration: least(&|limits| limits.acceleration).min(max_acceleration),
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

    /// Smallest time scale at which a profile satisfies all limits, by fine samples.
    ///
    /// # Arguments
    /// * `exceedance` – raised to the ratios found; for a profile with the same number of pieces in each interval of a squared rate
    fn time_scale(&self, profile: &JerkLimitedProfile, exceedance: Option<&mut Exceedance>) -> f64 {
        // By the instructions that the processor has, of which none is fused: all processors find the same.
        Arch::new().dispatch(
            #[inline(always)]
            move || self.time_scale_of(profile, exceedance),
        )
    }

    #[inline(always)]
    fn time_scale_of(
        &self,
        profile: &JerkLimitedProfile,
        mut exceedance: Option<&mut Exceedance>,
    ) -> f64 {
        let mut scale = 1e-9;
        let pieces = profile.pieces().len();
        let mut intervals = self.spline.intervals_in_order();
        let mut states = States::new();
        for (index, piece) in profile.pieces().enumerate() {
            let fraction = piece.duration / profile.duration();
            let count = VERIFICATION_INTERVALS.max((VERIFICATION_SAMPLES * fraction).ceil());
            let rate_interval = index * INTERVALS / pieces;
            for k in 0..=count as usize {
                let state = piece.state(piece.duration * (k as f64 / count));
                let interval = intervals(state[0]);
                if states.is_full() || states.interval != interval {
                    let exceeded =
                        exceedance.as_deref_mut().map(|it| it.in_interval(rate_interval));
                    self.raise_time_scale(&mut scale, &mut states, exceeded);
                }
                states.push(interval, state);
            }
            let exceeded = exceedance.as_deref_mut().map(|it| it.in_interval(rate_interval));
            self.raise_time_scale(&mut scale, &mut states, exceeded);
        }
        // The third derivative of the path is discontinuous at its knots: both sides are verified.
        let knots = self.spline.knots();
        let mut at = profile.states_in_order();
        for (interval, time) in profile.times_at(&knots[1..knots.len() - 1]).enumerate() {
            let state = at(time);
            for side in [interval, interval + 1] {
                states.push(side, state);
                self.raise_time_scale(&mut scale, &mut states, None);
            }
        }
        scale
    }

    /// Raises a time scale to the one at which states of the path parameter satisfy all limits, and removes the states.
    ///
    /// Time stretched by a factor divides velocities by it, accelerations by its square and jerks by its cube.
    #[inline(always)]
    fn raise_time_scale(
        &self,
        scale: &mut f64,
        states: &mut States,
        exceeded: Option<&mut [[f64; 2]]>,
    ) {
        let Some(&[s, rate, acceleration, jerk]) = states.filled() else { return };
        let count = self.inverse_limits.len();
        let start = self.spline.knots()[states.interval];
        let jets = &self.jets[states.interval * count..][..count];
        let (mut velocities, mut accelerations, mut jerks) =
            ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            velocities[k] = rate[k] / self.max_rate;
        }
        let mut exceeded = exceeded.into_iter().flatten();
        for (jet, inverse) in jets.iter().zip(&self.inverse_limits) {
            let (mut own_accelerations, mut own_jerks) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let (r, r_2) = (rate[k], rate[k] * rate[k]);
                let [_, slope, curvature, third] = spline::advanced(jet, s[k] - start);
                let v = slope * r;
                let a = curvature * r_2 + slope * acceleration[k];
                let j = third * (rate[k] * rate[k] * rate[k])
                    + 3.0 * curvature * r * acceleration[k]
                    + slope * jerk[k];
                raise(&mut velocities[k], v.abs() * inverse[0]);
                own_accelerations[k] = a.abs() * inverse[1];
                own_jerks[k] = j.abs() * inverse[2];
                raise(&mut accelerations[k], own_accelerations[k]);
                raise(&mut jerks[k], own_jerks[k]);
            }
            if let Some(known) = exceeded.next() {
                raise(&mut known[0], largest(&own_accelerations));
                raise(&mut known[1], largest(&own_jerks));
            }
        }
        raise(scale, largest(&velocities));
        // Powers are compared before roots are taken: few states raise the scale.
        let (acceleration, jerk) = (largest(&accelerations), largest(&jerks));
        if acceleration > *scale * *scale {
            *scale = acceleration.sqrt();
        }
        if jerk > *scale * *scale * *scale {
            *scale = jerk.cbrt();
        }
        states.count = 0;
    }
}

/// States of the path parameter in one interval of the spline: of each order one number of each state.
struct States {
    interval: usize,
    count: usize,
    numbers: [[f64; LANES]; 4],
}

impl States {
    fn new() -> Self {
        Self { interval: 0, count: 0, numbers: [[0.0; LANES]; 4] }
    }

    fn is_full(&self) -> bool {
        self.count == LANES
    }

    /// Adds a state, in the interval of the others.
    #[inline(always)]
    fn push(&mut self, interval: usize, state: AxisState) {
        self.interval = interval;
        for (numbers, number) in self.numbers.iter_mut().zip(state) {
            numbers[self.count] = number;
        }
        self.count += 1;
    }

    /// All states, the last one again in places that are free; `None` without states.
    #[inline(always)]
    fn filled(&mut self) -> Option<&[[f64; LANES]; 4]> {
        let last = self.count.checked_sub(1)?;
        for numbers in &mut self.numbers {
            let number = numbers[last];
            numbers[self.count..].fill(number);
        }
        Some(&self.numbers)
    }
}

/// The largest of several numbers that are not negative; NaN is passed over.
#[inline(always)]
fn largest(numbers: &[f64; LANES]) -> f64 {
    let mut largest = [0.0; LANES];
    for k in 0..LANES {
        raise(&mut largest[k], numbers[k]);
    }
    for half in [LANES / 2, LANES / 4, LANES / 8] {
        for k in 0..half {
            let other = largest[k + half];
            raise(&mut largest[k], other);
        }
    }
    largest[0]
}

/// Path parameters at which slopes are compared.
fn grid() -> impl Iterator<Item = f64> {
    (0..=SLOPE_INTERVALS).map(|k| k as f64 / SLOPE_INTERVALS as f64)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    fn limits(count: usize) -> Vec<KinematicLimits> {
        vec![KinematicLimits { velocity: 2.0, acceleration: 10.0, jerk: 200.0 }; count]
    }

    fn spline(of: impl Fn(f64) -> Vec<f64>) -> Spline {
        let knots: Vec<f64> = (0..=60).map(|k| f64::from(k) / 60.0).collect();
        let values: Vec<f64> = knots.iter().flat_map(|&s| of(s)).collect();
        Spline::through(&knots, &DMatrix::from_vec(of(0.0).len(), knots.len(), values))
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
    fn friction_along_a_straight_path_acts_like_a_limit_of_acceleration() {
        for friction in [8.0, 4.0, 1.0, 0.2] {
            let (spline, mut limits) = (spline(|s| vec![3.0 * s, -s]), limits(2));
            let constraints = |at: &AxesMotion<'_>| {
                let row = |most: f64| [at.accelerations[0] / most, 0.5 * at.velocities[0] / most];
                Some(vec![row(friction), row(-friction)])
            };
            let found = TimeParameterization::new(&spline, &limits, 1e9)
                .plan_with_friction(&constraints)
                .unwrap();
            limits[0].acceleration = friction;
            let expected = TimeParameterization::new(&spline, &limits, 1e9).plan().unwrap();
            let excess = found.duration() / expected.duration() - 1.0;
            assert!((0.0..0.03).contains(&excess), "{friction}: {excess}");
        }
        let never = |_: &AxesMotion<'_>| None;
        let (spline, limits) = (spline(|s| vec![s]), limits(1));
        let parameterization = TimeParameterization::new(&spline, &limits, 1e9);
        assert!(parameterization.plan_with_friction(&never).is_none());
    }

    #[test]
    fn limits_hold_along_the_path_and_only_its_profiled_part_is_slow() {
        // The direction to a point that is passed at a distance of a tenth: it turns fast in the middle, as near a singular position.
        let turn = |s: f64| vec![((s - 0.5) / 0.1).atan(), 2.0 * s];
        let (spline, limits) = (spline(turn), limits(2));
        let parameterization = TimeParameterization::new(&spline, &limits, 1e9);
        let profile = parameterization.plan().unwrap();
        let worst = worst(&spline, &profile, &limits);
        assert!(worst.iter().all(|&fraction| fraction < 1.0), "{worst:?}");
        // With the limits of the middle everywhere the path takes much longer.
        let constant_limits = parameterization
            .slowed_for_curvature(parameterization.single_axis_profile(f64::INFINITY).unwrap());
        assert!(
            profile.duration() < 0.8 * constant_limits.duration(),
            "{} {}",
            profile.duration(),
            constant_limits.duration()
        );
        let rate = |s: f64| profile.state(profile.times_at(&[s]).next().unwrap())[1];
        assert!(rate(0.25) > 1.2 * rate(0.5), "{} {}", rate(0.25), rate(0.5));
        assert_eq!(profile.state(profile.duration()), [1.0, 0.0, 0.0, 0.0]);
    }
}
