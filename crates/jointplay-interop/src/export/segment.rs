//! One step of a motion as channels: all axes, the platform, and the deflection of the arms.

use jointplay_cell::robot::EffectorId;
use jointplay_core::spatial::Pose;
use nalgebra::UnitQuaternion;

use super::channel::{Channel, Functions, channels};
use super::error::Error;
use super::motion_export::MotionExport;
use super::samples::{loaded, placed};
use super::scene::rounded;

/// Tolerance of the cubics of axis positions (m or rad).
const AXIS: f64 = 1e-8;
/// Tolerance of the cubics of poses (m), and of the vector part of a unit quaternion.
const POSE: f64 = 2e-8;
/// Tolerance of the cubics of the displacement of the virtual joints (m).
const DISPLACEMENT: f64 = 1e-8;
/// Interval before and after a time over which rates are differences (s).
const MOMENT: f64 = 1e-5;
/// Numbers of a pose: origin x, y, z, then the vector part x, y, z of a unit quaternion whose scalar part is positive.
pub(super) const POSE_NUMBERS: usize = 6;

/// The channels of one step, by time since its start.
///
/// In order: positions of all axes; [`POSE_NUMBERS`] of the platform in the base frame; for each arm, the frame of its deflected last link in the rigid one; for each effector, arm by arm, the frame of its last link by which its wafer is deflected, in the rigid one; the displacement of the virtual joints from nominal (m).
pub(super) struct Segment {
    pub(super) duration: f64,
    pub(super) channels: Vec<Channel>,
}

impl Segment {
    pub(super) fn new(motion_export: &MotionExport<'_>, step: usize) -> Result<Self, Error> {
        let MotionExport { cell, motion, .. } = *motion_export;
        let described = Step::new(motion_export, step);
        let mut tolerances = vec![AXIS; cell.robot.axes.len()];
        tolerances.resize(tolerances.len() + described.numbers_of_poses(), POSE);
        tolerances.push(DISPLACEMENT);
        let channels = channels(&motion.jerk_discontinuities(step), &tolerances, &described)?;
        Ok(Self { duration: motion.intrinsic_step_duration(step), channels })
    }
}

/// The numbers of all channels, by time since the start of the step.
struct Step<'a> {
    motion_export: &'a MotionExport<'a>,
    index: usize,
    carried: &'a [EffectorId],
    /// Start of the step (s).
    start: f64,
}

impl<'a> Step<'a> {
    fn new(motion_export: &'a MotionExport<'a>, index: usize) -> Self {
        let start = motion_export.motion.times[index];
        Self { motion_export, index, carried: loaded(motion_export, index), start }
    }

    /// Number of the channels of poses.
    fn numbers_of_poses(&self) -> usize {
        let robot = &self.motion_export.cell.robot;
        (1 + robot.arms.len() + robot.effectors().count()) * POSE_NUMBERS
    }

    /// The numbers of all channels after those of the axes: poses and displacement.
    fn poses(&self, since: f64, positions: &[f64]) -> Result<Vec<f64>, Error> {
        let time = self.start + since;
        let robot = &self.motion_export.cell.robot;
        let pose = placed(self.motion_export, time, positions, self.carried)?;
        let failed = |source| Error::Placing { time, source: Box::new(source) };
        let rigid = robot.forward(positions).map_err(failed)?;
        let mut numbers = Vec::new();
        numbers.extend(numbers_of(&pose.platform.base_from_platform));
        for (links, deflected) in rigid.base_from_link.iter().zip(&pose.base_from_link) {
            let both = links.last().zip(deflected.last());
            let pose = both.map_or(Pose::identity(), |(rigid, found)| rigid.inverse() * found);
            numbers.extend(numbers_of(&pose));
        }
        let arms = robot.arms.iter().zip(&rigid.base_from_link);
        for ((arm, links), (rigid, found)) in
            arms.zip(rigid.base_from_wafer.iter().zip(&pose.base_from_wafer))
        {
            for ((_, rigid), found) in arm.effectors.iter().zip(rigid).zip(found) {
                let last = links.last().copied().unwrap_or(Pose::identity());
                let link_from_wafer = last.inverse() * rigid;
                let pose = last.inverse() * found * link_from_wafer.inverse();
                numbers.extend(numbers_of(&pose));
            }
        }
        numbers.push(robot.model.displacement(&robot.gpr, &pose.platform));
        Ok(numbers)
    }
}

impl Functions for Step<'_> {
    type Error = Error;

    fn values(&self, since: f64) -> Result<Vec<f64>, Error> {
        let mut values = self.motion_export.motion.sample_in_step(self.index, since).positions;
        values.extend(self.poses(since, &values)?);
        Ok(values)
    }

    fn rates(&self, since: f64) -> Result<Vec<f64>, Error> {
        let sample = self.motion_export.motion.sample_in_step(self.index, since);
        let moved = |moment: f64| {
            let both = sample.positions.iter().zip(&sample.velocities);
            let positions: Vec<f64> = both.map(|(at, speed)| at + moment * speed).collect();
            self.poses(since, &positions)
        };
        let mut rates = sample.velocities.clone();
        if sample.velocities.iter().all(|&speed| speed == 0.0) {
            rates.resize(rates.len() + self.numbers_of_poses() + 1, 0.0);
        } else {
            let (before, after) = (moved(-MOMENT)?, moved(MOMENT)?);
            let pairs = before.iter().zip(&after);
            rates.extend(pairs.map(|(before, after)| (after - before) / (2.0 * MOMENT)));
        }
        Ok(rates)
    }
}

/// Origin (m) and vector part of the unit quaternion of a pose, without the noise of round-off.
pub(super) fn numbers_of(pose: &Pose) -> [f64; POSE_NUMBERS] {
    let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation).into_inner();
    let turn = if turn.w < 0.0 { -turn.imag() } else { turn.imag() };
    let place = pose.translation.vector;
    [place.x, place.y, place.z, turn.x, turn.y, turn.z].map(|number| rounded(number, 1e13))
}
