//! Inputs of each sample: its place in the grid, its draw, its pose.

use jointplay_core::spatial::Tilt;

use super::definition::{Plan, TiltForm};
use super::grid::Grid;
use super::random::{FIRST_STREAM, HEIGHT_STREAM, SECOND_STREAM};
use crate::Error;

/// Commanded poses of some samples.
pub(super) struct Inputs {
    /// Draw of each.
    pub(super) draw: Vec<u64>,
    /// (m).
    pub(super) height: Vec<f64>,
    /// As the plan has them (rad).
    pub(super) angles: [Vec<f64>; 2],
    /// (rad).
    pub(super) azimuth: Vec<f64>,
    /// (rad).
    pub(super) tilt_angle: Vec<f64>,
}

impl Inputs {
    pub(super) fn of(plan: &Plan, samples: &[u64]) -> Result<Self, Error> {
        let streams = [HEIGHT_STREAM, FIRST_STREAM, SECOND_STREAM];
        let mut grid = Grid::new(plan.pose().into_iter().zip(streams), plan.draws, plan.seed)?;
        let column = || Vec::with_capacity(samples.len());
        let mut inputs = Self {
            draw: Vec::with_capacity(samples.len()),
            height: column(),
            angles: [column(), column()],
            azimuth: column(),
            tilt_angle: column(),
        };
        for &sample in samples {
            let mut values = [0.0; 3];
            grid.values(sample, &mut values);
            let [height, first, second] = values;
            let tilt = match plan.tilt.form {
                TiltForm::AzimuthAngle => Tilt { azimuth: first, angle: second },
                TiltForm::AboutXAndY => Tilt::from_about_x_and_y(first, second),
            };
            inputs.draw.push(grid.draw(sample));
            inputs.height.push(height);
            inputs.angles[0].push(first);
            inputs.angles[1].push(second);
            inputs.azimuth.push(tilt.azimuth);
            inputs.tilt_angle.push(tilt.angle);
        }
        Ok(inputs)
    }

    /// The tilt of a sample, counted from 0 in these inputs.
    pub(super) fn tilt(&self, i: usize) -> Tilt {
        Tilt { azimuth: self.azimuth[i], angle: self.tilt_angle[i] }
    }
}
