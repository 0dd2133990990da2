//! All axes from rest to rest in the same time, each on its own way.

use rsruckig::prelude::{
    InputParameter, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};
use rsruckig::ruckig::Ruckig;

use super::profile::JerkLimitedProfile;
use crate::robot::KinematicLimits;

/// Axes that go from rest to rest together, and the one that takes the whole time.
#[derive(Debug, Clone)]
pub(crate) struct SynchronizedProfile {
    /// In the order of the axes.
    pub(crate) curves: Vec<JerkLimitedProfile>,
    /// How long all take [s].
    pub(crate) duration: f64,
    /// The axis that would be last if each went as fast as it may; `None` where none moves.
    pub(crate) slowest: Option<usize>,
}

/// Shares by which jerks are lowered, one after the other, where the planner finds nothing.
///
/// An axis whose way is the least that takes it to its acceleration limit, 2 a³ / j², has a profile of two kinds at once, and within round-off of that the planner may find neither.
const LOWERED: [f64; 4] = [0.0, 1e-12, 1e-10, 1e-8];

/// The fastest time-synchronised motion within jerk, acceleration and velocity limits.
///
/// # Errors
/// [`NoProfile`]
///
/// # Source
/// [Ruckig]
pub(crate) fn together(
    from: &[f64],
    to: &[f64],
    limits: impl Fn(usize) -> KinematicLimits,
) -> Result<SynchronizedProfile, NoProfile> {
    let moving: Vec<usize> = (0..from.len()).filter(|&axis| from[axis] != to[axis]).collect();
    let mut curves: Vec<Option<JerkLimitedProfile>> = vec![None; from.len()];
    let (mut duration, mut slowest) = (0.0, None);
    if !moving.is_empty() {
        let count = moving.len();
        let allowed: Vec<KinematicLimits> = moving.iter().map(|&axis| limits(axis)).collect();
        let mut attempts = LOWERED.iter().map(|&lowered| (Units::SI, lowered));
        let found = attempts.find_map(|(units, lowered)| {
            planned((&moving, from, to), &allowed, (units, lowered)).map(|found| (units, found))
        });
        let found = found.or_else(|| {
            // Far from the order of 1 the planner's own tolerances decide.
            let units = Units::of((&moving, from, to), &allowed)?;
            planned((&moving, from, to), &allowed, (units, 0.0)).map(|found| (units, found))
        });
        let (units, planned) = found.ok_or_else(|| NoProfile::of((&moving, from, to), &allowed))?;
        duration = planned.duration * units.time;
        let alone = &planned.independent_min_durations;
        slowest =
            (0..count).max_by(|&a, &b| alone[a].total_cmp(&alone[b])).map(|place| moving[place]);
        for (place, &axis) in moving.iter().enumerate() {
            let profile = &planned.profiles[0][place];
            let jerk = units.length / units.time.powi(3);
            let stretches = profile.t.into_iter().zip(profile.j);
            let stretches: Vec<(f64, f64)> =
                stretches.map(|(time, value)| (time * units.time, value * jerk)).collect();
            curves[axis] = Some(JerkLimitedProfile::through(from[axis], to[axis], &stretches));
        }
    }
    let curves = curves
        .into_iter()
        .zip(from)
        .map(|(curve, &position)| {
            curve.unwrap_or_else(|| JerkLimitedProfile::still(position, duration))
        })
        .collect();
    Ok(SynchronizedProfile { curves, duration, slowest })
}

/// Axes that move, by index, and where all of them start and end.
type Move<'a> = (&'a [usize], &'a [f64], &'a [f64]);

/// What lengths and times are counted in.
#[derive(Debug, Clone, Copy)]
struct Units {
    /// [m or rad]
    length: f64,
    /// [s]
    time: f64,
}

impl Units {
    const SI: Self = Self { length: 1.0, time: 1.0 };

    fn are_si(self) -> bool {
        self.length == 1.0 && self.time == 1.0
    }

    /// Units in which the longest displacement and the time that its jerk alone asks for are 1.
    fn of((moving, from, to): Move<'_>, limits: &[KinematicLimits]) -> Option<Self> {
        let far = |&axis: &usize| (to[axis] - from[axis]).abs();
        let length = moving.iter().map(far).fold(0.0, f64::max);
        let times = moving.iter().zip(limits).map(|(axis, allowed)| far(axis) / allowed.jerk);
        let time = times.fold(0.0, f64::max).cbrt();
        (length.is_normal() && time.is_normal()).then_some(Self { length, time })
    }
}

/// No profile was found for a motion of axes from rest to rest.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "no jerk-limited profile was found for axes that move by {least:.3e} to {most:.3e} (m or rad), with speeds up to {velocity:.3e}, accelerations up to {acceleration:.3e} and jerks up to {jerk:.3e} in the same unit and s; bring distance and limits closer to each other"
)]
pub(crate) struct NoProfile {
    /// Least and largest displacement of an axis that moves [m or rad].
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Largest limits among them [m/s or rad/s, and so on].
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

impl NoProfile {
    fn of((moving, from, to): Move<'_>, limits: &[KinematicLimits]) -> Self {
        let far = || moving.iter().map(|&axis| (to[axis] - from[axis]).abs());
        let most = |of: fn(&KinematicLimits) -> f64| limits.iter().map(of).fold(0.0, f64::max);
        Self {
            least: far().fold(f64::INFINITY, f64::min),
            most: far().fold(0.0, f64::max),
            velocity: most(|of| of.velocity),
            acceleration: most(|of| of.acceleration),
            jerk: most(|of| of.jerk),
        }
    }
}

/// A profile of each axis in the units given; `None` where the planner finds none.
fn planned(
    (moving, from, to): Move<'_>,
    limits: &[KinematicLimits],
    (units, lowered): (Units, f64),
) -> Option<Trajectory<0>> {
    let count = moving.len();
    let mut input = InputParameter::<0>::new(Some(count));
    input.synchronization = Synchronization::Time;
    let Units { length, time } = units;
    for (place, (&axis, allowed)) in moving.iter().zip(limits).enumerate() {
        // In other units, a short displacement far from zero would be round-off.
        let zero = if units.are_si() { 0.0 } else { from[axis] };
        input.current_position[place] = (from[axis] - zero) / length;
        input.target_position[place] = (to[axis] - zero) / length;
        input.max_velocity[place] = allowed.velocity * time / length;
        input.max_acceleration[place] = allowed.acceleration * time * time / length;
        input.max_jerk[place] = (1.0 - lowered) * allowed.jerk * time.powi(3) / length;
    }
    let mut planner = Ruckig::<0, ThrowErrorHandler>::new(Some(count), 1e-3);
    let mut planned = Trajectory::<0>::new(Some(count));
    match planner.calculate(&input, &mut planned) {
        Ok(RuckigResult::Working | RuckigResult::Finished) => {
            // What moves takes time; to the planner, a very short way is none.
            (planned.duration.is_finite() && planned.duration > 0.0).then_some(planned)
        }
        // Its other answers and its errors print its own state, and say no more than this.
        Ok(_) | Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_that_just_takes_an_axis_to_its_acceleration_is_planned() {
        // 30 mm at 1.5 m/s² and 15 m/s³ are 2 a³ / j²; rods as a lift had them.
        let from = [0.5409999998136328, 0.5410000002384691, 0.5409999999274673];
        let to = [0.5709999998136328, 0.5710000002384691, 0.5709999999274673];
        let limits = KinematicLimits { velocity: 0.3, acceleration: 1.5, jerk: 15.0 };
        let found = together(&from, &to, |_| limits).unwrap();
        assert!((found.duration - 0.4).abs() < 1e-9, "{}", found.duration);
        for k in 0..4000_u32 {
            let random = |by: u32| f64::from(k.wrapping_mul(by) % 997) / 997.0;
            let limits = KinematicLimits {
                velocity: 100.0,
                acceleration: 0.5 + 5.0 * random(31),
                jerk: 10.0 + 100.0 * random(57),
            };
            let way = 2.0 * limits.acceleration.powi(3) / limits.jerk.powi(2);
            let from = random(71);
            let found = together(&[from], &[from + way], |_| limits).unwrap();
            let expected = 4.0 * limits.acceleration / limits.jerk;
            assert!((found.duration / expected - 1.0).abs() < 1e-9, "{k}: {}", found.duration);
        }
    }

    #[test]
    fn a_single_axis_takes_the_time_of_the_closed_form() {
        // Long enough to reach all limits: t = d/v + v/a + a/j.
        let limits = KinematicLimits { velocity: 1.0, acceleration: 4.0, jerk: 40.0 };
        let found = together(&[0.5, 2.0], &[-1.5, 2.0], |_| limits).unwrap();
        assert!((found.duration - (2.0 + 0.25 + 0.1)).abs() < 1e-12, "{}", found.duration);
        assert_eq!(found.slowest, Some(0));
        assert_eq!(found.curves[1].at(1.0), [2.0, 0.0, 0.0, 0.0]);
        assert_eq!(found.curves[0].at(found.duration)[0], -1.5);
    }

    #[test]
    fn displacements_and_limits_of_any_size_have_a_profile_or_an_error_in_own_words() {
        // Jerk alone limits: t = 4 (d / 2 j)^(1/3); by an independent closed form.
        for far in [1e-12, 1e-9, 1e-3, 1.0] {
            for jerk in [1e-9, 1e-3, 1.0, 1e6, 1e15] {
                let limits = KinematicLimits { velocity: 1e30, acceleration: 1e30, jerk };
                let expected = 4.0 * (far / (2.0 * jerk)).cbrt();
                match together(&[0.5], &[0.5 + far], |_| limits) {
                    Ok(found) => {
                        let off = (found.duration / expected - 1.0).abs();
                        // The displacement itself is round-off of 0.5.
                        assert!(off < 1e-6 + 1e-16 / far, "{far} {jerk}: {}", found.duration);
                    }
                    Err(error) => {
                        let text = error.to_string();
                        assert!(!text.contains("inp.") && !text.contains("dof"), "{text}");
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_to_do_takes_no_time() {
        let limits = KinematicLimits { velocity: 1.0, acceleration: 1.0, jerk: 1.0 };
        let found = together(&[0.5], &[0.5], |_| limits).unwrap();
        assert_eq!((found.duration, found.slowest), (0.0, None));
    }
}
