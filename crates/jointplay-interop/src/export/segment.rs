//! One step of a motion as channels: all axes, the platform, and the deflection of the arms.

use jointplay_core::spatial::Pose;
use nalgebra::UnitQuaternion;

use super::channel::{Channel, State, channels};
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
        let axes = cell.robot.axes.len();
        let carried = loaded(motion_export, step);
        let start = motion.times[step];
        let numbers = |since: f64, positions: &[f64]| {
            let pose = placed(motion_export, start + since, positions, carried)?;
            let failed = |source| Error::Placing { time: start + since, source: Box::new(source) };
            let rigid = cell.robot.forward(positions).map_err(failed)?;
            let mut numbers = Vec::new();
            numbers.extend(numbers_of(&pose.platform.base_from_platform));
            for (links, deflected) in rigid.base_from_link.iter().zip(&pose.base_from_link) {
                let both = links.last().zip(deflected.last());
                let pose = both.map_or(Pose::identity(), |(rigid, found)| rigid.inverse() * found);
                numbers.extend(numbers_of(&pose));
            }
            let arms = cell.robot.arms.iter().zip(&rigid.base_from_link);
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
            numbers.push(cell.robot.model.displacement(&cell.robot.gpr, &pose.platform));
            Ok::<_, Error>(numbers)
        };
        let at = |since: f64| {
            let sample = motion.sample_in_step(step, since);
            let mut values = sample.positions.clone();
            let now = numbers(since, &sample.positions)?;
            let mut rates = sample.velocities.clone();
            if sample.velocities.iter().all(|&speed| speed == 0.0) {
                rates.resize(axes + now.len(), 0.0);
            } else {
                let moved = |moment: f64| {
                    let both = sample.positions.iter().zip(&sample.velocities);
                    let positions: Vec<f64> = both.map(|(at, speed)| at + moment * speed).collect();
                    numbers(since, &positions)
                };
                let (before, after) = (moved(-MOMENT)?, moved(MOMENT)?);
                let pairs = before.iter().zip(&after);
                rates.extend(pairs.map(|(before, after)| (after - before) / (2.0 * MOMENT)));
            }
            values.extend(now);
            Ok::<_, Error>(State { time: since, values, rates })
        };
        let poses = 1 + cell.robot.arms.len() + cell.robot.effectors().count();
        let mut tolerances = vec![AXIS; axes];
        tolerances.resize(axes + poses * POSE_NUMBERS, POSE);
        tolerances.push(DISPLACEMENT);
        let breaks = motion.jerk_discontinuities(step);
        let channels = channels(&breaks, &tolerances, &at)?;
        Ok(Self { duration: motion.intrinsic_step_duration(step), channels })
    }
}

/// Origin (m) and vector part of the unit quaternion of a pose, without the noise of round-off.
pub(super) fn numbers_of(pose: &Pose) -> [f64; POSE_NUMBERS] {
    let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation).into_inner();
    let turn = if turn.w < 0.0 { -turn.imag() } else { turn.imag() };
    let place = pose.translation.vector;
    [place.x, place.y, place.z, turn.x, turn.y, turn.z].map(|number| rounded(number, 1e13))
}
