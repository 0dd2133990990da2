//! The resolution of positions from inverse kinematics: rods that differ by a common height differ from each other by the same numbers, to the bit.

use super::hybrid_robot::{HybridRobot, RODS};

/// Multiples of the resolution in a metre or radian: it is 10⁻¹² m or rad, to which inverse kinematics is accurate.
const PER_UNIT: f64 = 1e12;
/// Positions up to this one are rounded: multiples of the resolution are exact numbers (m or rad).
const LARGEST: f64 = 1e3;

fn nearest_multiple(position: f64) -> f64 {
    // Plus zero: -0 becomes 0.
    (position * PER_UNIT).round() + 0.0
}

/// Rods as multiples of the resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RodMultiples([f64; RODS]);

impl RodMultiples {
    /// Multiples nearest to the rods, which are the first of the positions of all axes. Distances from the first rod are rounded by themselves, so that round-off in a common height does not change them.
    fn nearest(positions: &[f64]) -> Self {
        let (first, lowest) = (positions[0], nearest_multiple(positions[0]));
        Self(std::array::from_fn(|rod| lowest + nearest_multiple(positions[rod] - first)))
    }

    /// Rods of the positions of all axes; `None` unless they are multiples of the resolution.
    pub(crate) fn exact(positions: &[f64]) -> Option<Self> {
        let multiples = Self::nearest(positions);
        (multiples.lengths() == positions[..RODS]).then_some(multiples)
    }

    fn lengths(self) -> [f64; RODS] {
        self.0.map(|multiple| multiple / PER_UNIT)
    }

    /// Lengths over the first rod of others (m).
    pub(crate) fn over(self, lowest: Self) -> [f64; RODS] {
        self.0.map(|multiple| (multiple - lowest.0[0]) / PER_UNIT)
    }
}

/// Rounds the rods of the positions of all axes to the resolution.
fn round_rods(positions: &mut [f64]) {
    if positions[..RODS].iter().all(|length| length.abs() < LARGEST) {
        let rounded = RodMultiples::nearest(positions).lengths();
        positions[..RODS].copy_from_slice(&rounded);
    }
}

/// Rounds the positions of all axes to the resolution; motors that are at their present positions to the resolution stay there to the bit.
///
/// # Arguments
/// * `present` – positions of all axes before (m or rad)
fn round_positions(positions: &mut [f64], present: &[f64]) {
    round_rods(positions);
    for (motor, &present) in positions.iter_mut().zip(present).skip(RODS) {
        *motor = if (*motor - present).abs() <= 1.0 / PER_UNIT {
            present
        } else if motor.abs() < LARGEST {
            nearest_multiple(*motor) / PER_UNIT
        } else {
            *motor
        };
    }
}

impl HybridRobot {
    /// Positions of all axes, rounded to the resolution; as they are where the rounded ones would be beyond a limit.
    ///
    /// # Arguments
    /// * `present` – positions of all axes before (m or rad)
    pub(crate) fn rounded(&self, positions: Vec<f64>, present: &[f64]) -> Vec<f64> {
        let mut rounded = positions.clone();
        round_positions(&mut rounded, present);
        let is_within = self.limit_violations(&rounded).is_ok_and(|found| found.is_empty());
        if is_within { rounded } else { positions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn raised_rods_have_the_same_distances(
            rods in [-2.0..2.0, -2.0..2.0, -2.0..2.0],
            height in -1_000_000_000_i64..1_000_000_000,
            noise in [-1e-16..1e-16, -1e-16..1e-16, -1e-16..1e-16],
            motor in -7.0..7.0,
        ) {
            let mut low = vec![rods[0], rods[1], rods[2], motor];
            round_positions(&mut low, &[0.0, 0.0, 0.0, motor + 1e-9]);
            for (rounded, position) in low.iter().zip(rods.iter().chain([&motor])) {
                prop_assert!((rounded - position).abs() <= 1.1e-12);
            }
            // Nanometres, as text in millimetres with six decimals has them.
            let height = height as f64 / 1e9;
            let mut high: Vec<f64> = (0..RODS).map(|rod| low[rod] + height + noise[rod]).collect();
            high.push(motor);
            round_positions(&mut high, &[0.0; RODS + 1]);
            let [low, high] = [&low, &high].map(|one| RodMultiples::exact(one).unwrap());
            prop_assert_eq!(low.over(low), high.over(high));
            prop_assert!((high.over(low)[0] - height).abs() <= 1e-15);
        }

        #[test]
        fn decimal_numbers_stay_as_they_are(nanometres in -2_000_000_000_i64..2_000_000_000) {
            let position = nanometres as f64 / 1e9;
            let mut positions = vec![position, 0.25, position, position];
            round_positions(&mut positions, &[0.0; RODS + 1]);
            prop_assert_eq!(positions, [position, 0.25, position, position]);
        }
    }

    #[test]
    fn a_motor_at_its_present_position_stays_there() {
        let present = [0.1, 0.2, 0.3, 1.0 / 3.0, 2.0 / 3.0];
        let mut positions = [0.1, 0.2, 0.3, 1.0 / 3.0 + 9e-13, 2.0 / 3.0 + 2e-12];
        round_positions(&mut positions, &present);
        assert_eq!(positions[..4], present[..4]);
        assert_eq!(positions[4], 0.666_666_666_669);
        let mut zeros = [-0.0, -1e-13, 1e-13, -1e-13];
        round_positions(&mut zeros, &[0.0, 0.0, 0.0, 1.0]);
        assert!(zeros.iter().all(|zero| zero.to_bits() == 0), "{zeros:?}");
    }

    #[test]
    fn huge_positions_are_not_rounded_and_have_no_multiples() {
        let huge = [1e9 + 1e-6, 1e300, f64::MAX, 0.1];
        let mut positions = huge.to_vec();
        round_positions(&mut positions, &[0.0; RODS + 1]);
        assert_eq!(positions, huge);
        assert_eq!(RodMultiples::exact(&[f64::MAX, -f64::MAX, 1.0]), None);
        assert_eq!(RodMultiples::exact(&[0.1, 0.2, 1.0 / 3.0]), None);
    }
}
