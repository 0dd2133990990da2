//! Point-to-point moves: all axes from rest to rest, ending at the same time.

use rsruckig::prelude::{
    InputParameter, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};
use rsruckig::ruckig::Ruckig;

use super::profile::JerkLimitedProfile;
use crate::robot::KinematicLimits;

/// Profiles of all axes from rest to rest, synchronized in time.
#[derive(Debug, Clone)]
pub(crate) struct SynchronizedProfile {
    /// Profile of each axis, in the order of the axes.
    pub(crate) axes: Vec<JerkLimitedProfile>,
    /// Duration that all profiles have (s).
    pub(crate) duration: f64,
    /// Axis with the longest minimum duration, which determines that of all; `None` where no axis moves.
    pub(crate) limiting_axis: Option<usize>,
}

impl SynchronizedProfile {
    /// All profiles stretched in time by a factor.
    pub(super) fn slowed(&self, factor: f64) -> Self {
        Self {
            axes: self.axes.iter().map(|profile| profile.slowed(factor)).collect(),
            duration: self.duration * factor,
            limiting_axis: self.limiting_axis,
        }
    }
}

/// Shares by which the jerk limits are lowered, one after the other, until the planner finds a profile.
///
/// Where the displacement is the least one at which an axis reaches its acceleration limit, 2 a³ / j², two kinds of profile coincide.
/// Within round-off of that displacement the planner may find neither, and jerk limits lowered by far less than any tolerance separate the two.
const LOWERED_JERK_SHARES: [f64; 4] = [0.0, 1e-12, 1e-10, 1e-8];

/// Relative amount by which round-off may exceed a limit.
///
/// Displacements of micrometres differ from those that the planner reaches by more: its tolerance is absolute.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// The fastest time-synchronized move within velocity, acceleration and jerk limits.
///
/// # Errors
/// [`NoProfile`]
///
/// # Source
/// \[Ruckig\]
pub(crate) fn synchronized_profile(
    from: &[f64],
    to: &[f64],
    limits: impl Fn(usize) -> KinematicLimits,
) -> Result<SynchronizedProfile, NoProfile> {
    let moving: Vec<usize> = (0..from.len()).filter(|&axis| from[axis] != to[axis]).collect();
    if moving.is_empty() {
        let axes = from.iter().map(|&position| JerkLimitedProfile::at_rest(position, 0.0));
        return Ok(SynchronizedProfile {
            axes: axes.collect(),
            duration: 0.0,
            limiting_axis: None,
        });
    }
    let limits = moving.iter().map(|&axis| limits(axis)).collect();
    let request = SynchronizedMove { moving, from, to, limits };
    let mut attempts = LOWERED_JERK_SHARES.iter();
    let found =
        attempts.find_map(|&fraction| Some((Units::SI, request.plan(Units::SI, fraction)?)));
    let found = found.or_else(|| {
        // The planner's tolerances are absolute: numbers far from 1 are planned in units in which they are near 1.
        let units = request.natural_units()?;
        Some((units, request.plan(units, 0.0)?))
    });
    let (units, planned) = found.ok_or_else(|| NoProfile::new(&request))?;
    let profile = request.profiles(units, &planned);
    let excess = request.time_scale(&profile);
    Ok(if excess > 1.0 + LIMIT_TOLERANCE { profile.slowed(excess) } else { profile })
}

/// A move to plan.
struct SynchronizedMove<'a> {
    /// Indices of the axes that move.
    moving: Vec<usize>,
    /// Start positions of all axes (m or rad).
    from: &'a [f64],
    /// End positions of all axes (m or rad).
    to: &'a [f64],
    /// Limits of each moving axis.
    limits: Vec<KinematicLimits>,
}

/// Units of length (or angle) and time.
#[derive(Debug, Clone, Copy)]
struct Units {
    /// (m or rad)
    length: f64,
    /// (s)
    time: f64,
}

impl Units {
    const SI: Self = Self { length: 1.0, time: 1.0 };

    fn are_si(self) -> bool {
        self.length == 1.0 && self.time == 1.0
    }
}

impl SynchronizedMove<'_> {
    /// Absolute displacement of each moving axis (m or rad).
    fn displacements(&self) -> impl Iterator<Item = f64> + '_ {
        self.moving.iter().map(|&axis| (self.to[axis] - self.from[axis]).abs())
    }

    /// Units in which the longest displacement is 1, and so is the longest time that a displacement takes at the jerk limit alone.
    fn natural_units(&self) -> Option<Units> {
        let length = self.displacements().fold(0.0, f64::max);
        let times = self.displacements().zip(&self.limits);
        let times = times.map(|(displacement, limits)| displacement / limits.jerk);
        let time = times.fold(0.0, f64::max).cbrt();
        (length.is_normal() && time.is_normal()).then_some(Units { length, time })
    }

    /// Profiles in the units given, the jerk limits lowered by a fraction; `None` where the planner finds none.
    fn plan(&self, units: Units, lowered_share: f64) -> Option<Trajectory<0>> {
        let count = self.moving.len();
        let mut input = InputParameter::<0>::new(Some(count));
        input.synchronization = Synchronization::Time;
        let Units { length, time } = units;
        for (index, (&axis, limits)) in self.moving.iter().zip(&self.limits).enumerate() {
            // In units other than SI, a short displacement far from zero would be lost in round-off.
            let zero = if units.are_si() { 0.0 } else { self.from[axis] };
            input.current_position[index] = (self.from[axis] - zero) / length;
            input.target_position[index] = (self.to[axis] - zero) / length;
            input.max_velocity[index] = limits.velocity * time / length;
            input.max_acceleration[index] = limits.acceleration * time * time / length;
            input.max_jerk[index] = (1.0 - lowered_share) * limits.jerk * time.powi(3) / length;
        }
        let mut planner = Ruckig::<0, ThrowErrorHandler>::new(Some(count), 1e-3);
        let mut planned = Trajectory::<0>::new(Some(count));
        match planner.calculate(&input, &mut planned) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => {
                // The planner takes a very short displacement for none, and returns a move without duration.
                (planned.duration.is_finite() && planned.duration > 0.0).then_some(planned)
            }
            // Other results and errors print the planner's state, and contain nothing else that is of use.
            Ok(_) | Err(_) => None,
        }
    }

    /// Time scale at which profiles are within all limits; below 1 where they do not reach them.
    fn time_scale(&self, profile: &SynchronizedProfile) -> f64 {
        let mut scale = 0.0_f64;
        for (&axis, limits) in self.moving.iter().zip(&self.limits) {
            for piece in profile.axes[axis].pieces() {
                let [_, velocity, acceleration, jerk] = piece.state(0.0).map(f64::abs);
                scale = scale
                    .max(velocity / limits.velocity)
                    .max((acceleration / limits.acceleration).sqrt())
                    .max((jerk / limits.jerk).cbrt());
            }
        }
        scale
    }

    /// The profiles of all axes that the planner found.
    fn profiles(&self, units: Units, planned: &Trajectory<0>) -> SynchronizedProfile {
        let duration = planned.duration * units.time;
        let minimum = &planned.independent_min_durations;
        let limiting = (0..self.moving.len()).max_by(|&a, &b| minimum[a].total_cmp(&minimum[b]));
        let mut axes: Vec<JerkLimitedProfile> = self
            .from
            .iter()
            .map(|&position| JerkLimitedProfile::at_rest(position, duration))
            .collect();
        let jerk = units.length / units.time.powi(3);
        for (index, &axis) in self.moving.iter().enumerate() {
            let profile = &planned.profiles[0][index];
            let pieces = profile.t.into_iter().zip(profile.j);
            let pieces: Vec<(f64, f64)> =
                pieces.map(|(time, value)| (time * units.time, value * jerk)).collect();
            axes[axis] = JerkLimitedProfile::from_pieces(self.from[axis], self.to[axis], &pieces);
        }
        SynchronizedProfile { axes, duration, limiting_axis: limiting.map(|k| self.moving[k]) }
    }
}

/// No profile was found for a point-to-point move.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no jerk-limited profile was found for axes that move by {min_displacement:.3e} to {max_displacement:.3e} (m or rad), with velocities up to {velocity:.3e}, accelerations up to {acceleration:.3e} and jerks up to {jerk:.3e} in the same unit and s; bring distance and limits closer to each other"
)]
pub struct NoProfile {
    /// Least displacement of a moving axis (m or rad).
    pub min_displacement: f64,
    /// Largest displacement of a moving axis (m or rad).
    pub max_displacement: f64,
    /// Largest velocity limit of a moving axis (m/s or rad/s).
    pub velocity: f64,
    /// Largest acceleration limit of a moving axis (m/s² or rad/s²).
    pub acceleration: f64,
    /// Largest jerk limit of a moving axis (m/s³ or rad/s³).
    pub jerk: f64,
}

impl NoProfile {
    fn new(request: &SynchronizedMove<'_>) -> Self {
        let largest =
            |of: fn(&KinematicLimits) -> f64| request.limits.iter().map(of).fold(0.0, f64::max);
        Self {
            min_displacement: request.displacements().fold(f64::INFINITY, f64::min),
            max_displacement: request.displacements().fold(0.0, f64::max),
            velocity: largest(|limits| limits.velocity),
            acceleration: largest(|limits| limits.acceleration),
            jerk: largest(|limits| limits.jerk),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::RngExt;
    use proptest::test_runner::{RngAlgorithm, TestRng};

    use super::*;

    #[test]
    fn displacement_that_just_reaches_the_acceleration_limit_is_planned() {
        // 30 mm at 1.5 m/s² and 15 m/s³ are 2 a³ / j²; rod positions of a lift.
        let from = [0.5409999998136328, 0.5410000002384691, 0.5409999999274673];
        let to = [0.5709999998136328, 0.5710000002384691, 0.5709999999274673];
        let limits = KinematicLimits { velocity: 0.3, acceleration: 1.5, jerk: 15.0 };
        let found = synchronized_profile(&from, &to, |_| limits).unwrap();
        assert!((found.duration - 0.4).abs() < 1e-9, "{}", found.duration);
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[1; 32]);
        let mut random = || generator.random::<f64>();
        for k in 0..4000 {
            let limits = KinematicLimits {
                velocity: 100.0,
                acceleration: 0.5 + 5.0 * random(),
                jerk: 10.0 + 100.0 * random(),
            };
            let displacement = 2.0 * limits.acceleration.powi(3) / limits.jerk.powi(2);
            let from = random();
            let found = synchronized_profile(&[from], &[from + displacement], |_| limits).unwrap();
            let expected = 4.0 * limits.acceleration / limits.jerk;
            assert!((found.duration / expected - 1.0).abs() < 1e-9, "{k}: {}", found.duration);
        }
    }

    #[test]
    fn duration_of_one_axis_is_that_of_the_closed_form() {
        // Long enough to reach all limits: t = d/v + v/a + a/j.
        let limits = KinematicLimits { velocity: 1.0, acceleration: 4.0, jerk: 40.0 };
        let found = synchronized_profile(&[0.5, 2.0], &[-1.5, 2.0], |_| limits).unwrap();
        assert!((found.duration - (2.0 + 0.25 + 0.1)).abs() < 1e-12, "{}", found.duration);
        assert_eq!(found.limiting_axis, Some(0));
        assert_eq!(found.axes[1].state(1.0), [2.0, 0.0, 0.0, 0.0]);
        assert_eq!(found.axes[0].state(found.duration)[0], -1.5);
    }

    #[test]
    fn displacements_and_limits_of_any_size_have_a_profile_or_a_typed_error() {
        // Jerk alone limits: t = 4 (d / 2 j)^(1/3); by an independent closed form.
        for far in [1e-12, 1e-9, 1e-3, 1.0] {
            for jerk in [1e-9, 1e-3, 1.0, 1e6, 1e15] {
                let limits = KinematicLimits { velocity: 1e30, acceleration: 1e30, jerk };
                let expected = 4.0 * (far / (2.0 * jerk)).cbrt();
                match synchronized_profile(&[0.5], &[0.5 + far], |_| limits) {
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
    fn very_short_moves_keep_their_limits() {
        // Rods that level the platform by a tenth of a micrometre, and others of any length.
        let limits = KinematicLimits { velocity: 0.2, acceleration: 0.8, jerk: 8.0 };
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[2; 32]);
        let mut random = || generator.random::<f64>();
        for _ in 0..2000 {
            let length = 10_f64.powf(-9.0 + 8.0 * random());
            let from = [0.5, 0.5, 0.5];
            let to = [0.5 + length, 0.5 - length * random(), 0.5 + length * random()];
            let found = synchronized_profile(&from, &to, |_| limits).unwrap();
            for profile in &found.axes {
                for piece in profile.pieces() {
                    let [_, velocity, acceleration, jerk] = piece.state(0.0).map(f64::abs);
                    let fractions = [velocity / 0.2, acceleration / 0.8, jerk / 8.0];
                    assert!(fractions.iter().all(|one| *one <= 1.0 + 4e-9), "{to:?} {fractions:?}");
                }
            }
            // Jerk alone limits short moves: t = 4 (d / 2 j)^(1/3).
            if length < 1e-4 {
                let expected = 4.0 * (length / 16.0).cbrt();
                assert!(found.duration < 1.05 * expected, "{length}: {}", found.duration);
            }
        }
    }

    #[test]
    fn move_without_displacement_has_no_duration() {
        let limits = KinematicLimits { velocity: 1.0, acceleration: 1.0, jerk: 1.0 };
        let found = synchronized_profile(&[0.5], &[0.5], |_| limits).unwrap();
        assert_eq!((found.duration, found.limiting_axis), (0.0, None));
    }
}
