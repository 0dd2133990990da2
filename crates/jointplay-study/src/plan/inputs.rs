//! Inputs of each sample: its place in the grid, its draw, its pose.

use jointplay_core::spatial::Tilt;

use super::definition::{Plan, TiltForm};
use super::random::{FIRST_STREAM, HEIGHT_STREAM, SECOND_STREAM, Stream};
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
        let grid = plan.grid()?;
        let (firsts, seconds) = (plan.tilt.first.values(), plan.tilt.second.values());
        let [mut of_height, mut of_first, mut of_second] =
            [HEIGHT_STREAM, FIRST_STREAM, SECOND_STREAM]
                .map(|stream| Stream::new(plan.seed, stream));
        let column = || Vec::with_capacity(samples.len());
        let mut inputs = Self {
            draw: Vec::with_capacity(samples.len()),
            height: column(),
            angles: [column(), column()],
            azimuth: column(),
            tilt_angle: column(),
        };
        for &sample in samples {
            let (draw, place) = (sample / grid, sample % grid);
            let height = plan.height.at(&mut of_height, place / seconds / firsts, draw);
            let first = plan.tilt.first.at(&mut of_first, place / seconds % firsts, draw);
            let second = plan.tilt.second.at(&mut of_second, place % seconds, draw);
            let tilt = match plan.tilt.form {
                TiltForm::AzimuthAngle => Tilt { azimuth: first, angle: second },
                TiltForm::AboutXAndY => Tilt::from_about_x_and_y(first, second),
            };
            inputs.draw.push(draw);
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
