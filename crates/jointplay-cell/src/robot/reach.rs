//! Range of distances that an effector reaches.

use super::hybrid_robot::{EffectorId, HybridRobot, RODS};
use crate::CellError;

/// Number of positions of each axis on the grid of starts.
const STARTS: usize = 7;
/// Number of starts that are followed, the best of all.
const FOLLOWED: usize = 24;
/// Step below which a search ends, as a fraction of an axis' range.
const FINEST: f64 = 1e-9;

/// A start of a search.
struct Start {
    gain: f64,
    positions: Vec<f64>,
}

impl HybridRobot {
    /// Least and greatest distance of an effector's wafer centre from the base axis through O_b, the rods at home, over the ranges of all motors that move it (m).
    ///
    /// # Errors
    /// As [`Self::effector_pose`].
    ///
    /// # Numerics
    /// Hill climbing by steps of all motors from the best of a grid of starts, down to a billionth of their ranges.
    pub fn reach_range(&self, id: EffectorId) -> Result<[f64; 2], CellError> {
        let home: Vec<f64> = self.axes.iter().map(|axis| axis.home).collect();
        let motors: Vec<usize> =
            self.axes_of(id)?.into_iter().filter(|&axis| axis >= RODS).collect();
        // The squared distance is smooth at the axis too.
        let distance = |positions: &[f64]| {
            let center = self.effector_pose(positions, id)?.translation.vector;
            Ok::<f64, CellError>(center.x * center.x + center.y * center.y)
        };
        let mut ends = [0.0; 2];
        for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
            let gain = |positions: &[f64]| Ok::<f64, CellError>(sign * distance(positions)?);
            let mut starts = vec![Start { gain: gain(&home)?, positions: home.clone() }];
            for start in 0..STARTS.pow(u32::try_from(motors.len()).unwrap_or(0)) {
                let mut positions = home.clone();
                let mut rest = start;
                for &motor in &motors {
                    let fraction = (rest % STARTS) as f64 / (STARTS - 1) as f64;
                    rest /= STARTS;
                    let axis = &self.axes[motor];
                    positions[motor] = axis.min + fraction * (axis.max - axis.min);
                }
                starts.push(Start { gain: gain(&positions)?, positions });
            }
            starts.sort_by(|one, other| other.gain.total_cmp(&one.gain));
            starts.truncate(FOLLOWED);
            let mut best = f64::NEG_INFINITY;
            for start in starts {
                best = self.hill_climb(&motors, start, gain)?.max(best);
            }
            *end = (sign * best).max(0.0).sqrt();
        }
        Ok(ends)
    }

    /// The largest gain that steps of the motors lead to from a start.
    fn hill_climb(
        &self,
        motors: &[usize],
        start: Start,
        gain: impl Fn(&[f64]) -> Result<f64, CellError>,
    ) -> Result<f64, CellError> {
        let Start { gain: mut best, positions: mut at } = start;
        let mut fraction = 1.0 / (STARTS - 1) as f64;
        while fraction > FINEST {
            let mut better = false;
            // Steps along every axis, and along all axes together: ridges do not run along axes.
            for direction in 0..3_usize.pow(u32::try_from(motors.len()).unwrap_or(0)) {
                let mut positions = at.clone();
                let mut rest = direction;
                for &motor in motors {
                    let sign = (rest % 3) as f64 - 1.0;
                    rest /= 3;
                    let axis = &self.axes[motor];
                    let moved = positions[motor] + sign * fraction * (axis.max - axis.min);
                    positions[motor] = moved.clamp(axis.min, axis.max);
                }
                let found = gain(&positions)?;
                if found > best {
                    (best, at, better) = (found, positions, true);
                }
            }
            if !better {
                fraction *= 0.5;
            }
        }
        Ok(best)
    }
}
