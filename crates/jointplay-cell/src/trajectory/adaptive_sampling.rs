//! Adaptive sample times for plots: velocities and accelerations between them are nearly linear.

use super::sample::{Sample, UniformSampling};
use super::trajectory::Trajectory;
use crate::robot::KinematicLimits;

/// Largest deviation of straight lines between samples from velocities and accelerations, as a fraction of the limits: less than a pixel of a plot.
const PEAK_TOLERANCE: f64 = 2.5e-3;
/// Least distance between two samples (s).
const MIN_INTERVAL: f64 = 1e-3;
/// Times closer to each other than this are one (s).
const SAME_TIME: f64 = 1e-9;

/// Largest deviations of straight lines from the velocity and the acceleration of an axis.
struct Tolerance {
    /// (m/s or rad/s)
    velocity: f64,
    /// (m/s² or rad/s²)
    acceleration: f64,
}

impl Trajectory {
    /// Times in an interval at which to sample velocities and accelerations so that straight lines between the samples show their peaks, in growing order (s).
    ///
    /// They are sample times at a uniform rate, the ends of all steps, and between them times at which the jerk changes or a velocity has a peak.
    ///
    /// ```text
    ///    d  =  a₁ − a₀ − j₀ h  =  (j₁ − j₀) r        w  =  v₁ − v₀ − a₀ h − j₀ h² / 2  =  (j₁ − j₀) r² / 2        r  =  2 w / d
    /// ```
    /// v, a, j: velocity, acceleration and jerk at two samples h apart, between which the jerk changes once; r: time from that change to the second sample.
    /// Where the jerk is piecewise constant, as in all segments but Cartesian lines, accelerations between the samples are exact;
    /// elsewhere intervals are halved until the deviation is within a fraction of the limits.
    ///
    /// # Arguments
    /// * `rate` – uniform rate (Hz)
    /// * `interval` – start and end time (s)
    /// * `limits` – limits of each axis, which deviations are compared with
    pub fn plot_times<'l>(
        &self,
        rate: f64,
        interval: [f64; 2],
        limits: impl Iterator<Item = &'l KinematicLimits>,
    ) -> Vec<f64> {
        let [start, end] = interval;
        let uniform = UniformSampling::new(self.duration(), rate).iter();
        let mut base: Vec<f64> = uniform.chain(self.times.iter().copied()).collect();
        base.retain(|time| (start..=end).contains(time));
        base.sort_by(f64::total_cmp);
        base.dedup_by(|later, earlier| *later - *earlier < SAME_TIME);
        let tolerances: Vec<Tolerance> = limits
            .map(|limits| Tolerance {
                velocity: PEAK_TOLERANCE * limits.velocity,
                acceleration: PEAK_TOLERANCE * limits.acceleration,
            })
            .collect();
        let mut times = Vec::with_capacity(2 * base.len());
        let mut last = Sample::default();
        for &time in &base {
            let to = self.sample_at(time);
            if !times.is_empty() {
                self.add_times_between(&last, &to, &tolerances, &mut times);
            }
            times.push(time);
            last = to;
        }
        times
    }

    /// Adds the times between two samples at which samples are needed.
    fn add_times_between(
        &self,
        from: &Sample,
        to: &Sample,
        tolerances: &[Tolerance],
        times: &mut Vec<f64>,
    ) {
        if to.time - from.time < 2.0 * MIN_INTERVAL {
            return;
        }
        let Some(time) = division(from, to, tolerances) else { return };
        let middle = self.sample_at(time);
        self.add_times_between(from, &middle, tolerances, times);
        times.push(time);
        self.add_times_between(&middle, to, tolerances, times);
    }
}

/// Time at which an interval between two samples is divided; `None` where straight lines are accurate enough.
fn division(from: &Sample, to: &Sample, tolerances: &[Tolerance]) -> Option<f64> {
    let width = to.time - from.time;
    for (axis, tolerance) in tolerances.iter().enumerate() {
        let [v0, v1] = [from.velocities[axis], to.velocities[axis]];
        let [a0, a1] = [from.accelerations[axis], to.accelerations[axis]];
        let jerk = from.jerks[axis];
        let acceleration_excess = a1 - a0 - jerk * width;
        let velocity_excess = v1 - v0 - width * (a0 + 0.5 * jerk * width);
        if acceleration_excess.abs() > tolerance.acceleration
            || velocity_excess.abs() > 0.5 * tolerance.acceleration * width
        {
            let time = to.time - 2.0 * velocity_excess / acceleration_excess;
            let inside = from.time + MIN_INTERVAL..to.time - MIN_INTERVAL;
            return Some(if inside.contains(&time) { time } else { from.time + 0.5 * width });
        }
        // A velocity with its peak between the samples.
        let over = (a1 - a0).abs() * width / 8.0;
        if a0 * a1 < 0.0 && over > tolerance.velocity {
            let time = from.time + width * a0 / (a0 - a1);
            if time > from.time + MIN_INTERVAL && time < to.time - MIN_INTERVAL {
                return Some(time);
            }
        }
    }
    None
}
