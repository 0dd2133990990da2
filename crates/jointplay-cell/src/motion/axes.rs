//! All axes from rest to rest in the same time, each on its own way.

use rsruckig::prelude::{
    InputParameter, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};
use rsruckig::ruckig::Ruckig;

use super::cubic::Curve;
use crate::robot::Dynamics;

/// Axes that go from rest to rest together, and the one that takes the whole time.
#[derive(Debug, Clone)]
pub(crate) struct Together {
    /// In the order of the axes.
    pub(crate) curves: Vec<Curve>,
    /// How long all take [s].
    pub(crate) duration: f64,
    /// The axis that would be last if each went as fast as it may; `None` where none moves.
    pub(crate) slowest: Option<usize>,
}

/// The fastest time-synchronised motion within jerk, acceleration and velocity limits.
///
/// # Errors
/// What the planner says.
///
/// # Source
/// [Ruckig]
pub(crate) fn together(
    from: &[f64],
    to: &[f64],
    limits: impl Fn(usize) -> Dynamics,
) -> Result<Together, String> {
    let moving: Vec<usize> = (0..from.len()).filter(|&axis| from[axis] != to[axis]).collect();
    let mut curves: Vec<Option<Curve>> = vec![None; from.len()];
    let (mut duration, mut slowest) = (0.0, None);
    if !moving.is_empty() {
        let count = moving.len();
        let mut input = InputParameter::<0>::new(Some(count));
        input.synchronization = Synchronization::Time;
        for (place, &axis) in moving.iter().enumerate() {
            let allowed = limits(axis);
            input.current_position[place] = from[axis];
            input.target_position[place] = to[axis];
            input.max_velocity[place] = allowed.velocity;
            input.max_acceleration[place] = allowed.acceleration;
            input.max_jerk[place] = allowed.jerk;
        }
        let mut planner = Ruckig::<0, ThrowErrorHandler>::new(Some(count), 1e-3);
        let mut planned = Trajectory::<0>::new(Some(count));
        match planner.calculate(&input, &mut planned) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => {}
            Ok(other) => return Err(format!("the planner answers {other:?}")),
            Err(error) => return Err(error.to_string()),
        }
        duration = planned.duration;
        let alone = &planned.independent_min_durations;
        slowest =
            (0..count).max_by(|&a, &b| alone[a].total_cmp(&alone[b])).map(|place| moving[place]);
        for (place, &axis) in moving.iter().enumerate() {
            let profile = &planned.profiles[0][place];
            let stretches: Vec<(f64, f64)> = profile.t.into_iter().zip(profile.j).collect();
            curves[axis] = Some(Curve::through(from[axis], to[axis], &stretches));
        }
    }
    let curves = curves
        .into_iter()
        .zip(from)
        .map(|(curve, &position)| curve.unwrap_or_else(|| Curve::still(position, duration)))
        .collect();
    Ok(Together { curves, duration, slowest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_axis_takes_the_time_of_the_closed_form() {
        // Long enough to reach all limits: t = d/v + v/a + a/j.
        let limits = Dynamics { velocity: 1.0, acceleration: 4.0, jerk: 40.0 };
        let found = together(&[0.5, 2.0], &[-1.5, 2.0], |_| limits).unwrap();
        assert!((found.duration - (2.0 + 0.25 + 0.1)).abs() < 1e-12, "{}", found.duration);
        assert_eq!(found.slowest, Some(0));
        assert_eq!(found.curves[1].at(1.0), [2.0, 0.0, 0.0, 0.0]);
        assert_eq!(found.curves[0].at(found.duration)[0], -1.5);
    }

    #[test]
    fn nothing_to_do_takes_no_time() {
        let limits = Dynamics { velocity: 1.0, acceleration: 1.0, jerk: 1.0 };
        let found = together(&[0.5], &[0.5], |_| limits).unwrap();
        assert_eq!((found.duration, found.slowest), (0.0, None));
    }
}
