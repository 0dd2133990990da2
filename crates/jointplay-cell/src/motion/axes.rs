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

/// Shares by which jerks are lowered, one after the other, where the planner finds nothing.
///
/// An axis whose way is the least that takes it to its acceleration limit, 2 a³ / j², has a profile of two kinds at once, and within round-off of that the planner may find neither.
const LOWERED: [f64; 4] = [0.0, 1e-12, 1e-10, 1e-8];

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
        }
        let mut attempt = |lowered: f64| {
            for (place, &axis) in moving.iter().enumerate() {
                input.max_jerk[place] = (1.0 - lowered) * limits(axis).jerk;
            }
            planned(&input, count)
        };
        let mut found = attempt(LOWERED[0]);
        for lowered in &LOWERED[1..] {
            found = found.or_else(|why| attempt(*lowered).map_err(|_| why));
        }
        let planned = found?;
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

fn planned(input: &InputParameter<0>, count: usize) -> Result<Trajectory<0>, String> {
    let mut planner = Ruckig::<0, ThrowErrorHandler>::new(Some(count), 1e-3);
    let mut planned = Trajectory::<0>::new(Some(count));
    match planner.calculate(input, &mut planned) {
        Ok(RuckigResult::Working | RuckigResult::Finished) => Ok(planned),
        Ok(other) => Err(format!("the planner answers {other:?}")),
        Err(error) => Err(error.to_string()),
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
        let limits = Dynamics { velocity: 0.3, acceleration: 1.5, jerk: 15.0 };
        let found = together(&from, &to, |_| limits).unwrap();
        assert!((found.duration - 0.4).abs() < 1e-9, "{}", found.duration);
        for k in 0..4000_u32 {
            let random = |by: u32| f64::from(k.wrapping_mul(by) % 997) / 997.0;
            let limits = Dynamics {
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
