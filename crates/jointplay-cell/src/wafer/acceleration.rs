//! How a wafer moves that a drooping arm carries.

use nalgebra::{Vector2, Vector3};

use super::compensation::{Unreachable, apply_deflection, turn};
use super::droop::DroopError;
use super::{Droop, FrictionMargin, SHORTEST};
use crate::robot::{ArmChain, AxesMotion, EffectorId, FrameMotion};
use crate::workcell::Cell;

/// Nearer to its joint an arm points nowhere [m].
const MIN_HEADING_RADIUS: f64 = 1e-9;

impl Cell {
    /// How the wafer of an effector moves, its arm drooping as if it stood; the wafer's own sag left aside.
    ///
    /// # Errors
    /// [`Unreachable::Robot`] and [`Unreachable::Droop`].
    ///
    /// # Numerics
    /// As [`HybridRobot::effector_motion`](crate::robot::HybridRobot::effector_motion); what an arm's end turns by the droop is off by the square of that angle.
    /// Where the slope of a droop table jumps, at its rows, that of one side counts; what the jump itself would do to the wafer is left out.
    pub fn wafer_motion(
        &self,
        effector: EffectorId,
        motion: &AxesMotion<'_>,
        loaded: bool,
    ) -> Result<FrameMotion, Unreachable> {
        let robot = &self.robot;
        robot.check_effector(effector)?;
        robot.check_motion(motion)?;
        let now = robot.platform(motion.positions)?;
        let platform = robot.platform_motion(&now, motion)?;
        let planar = ArmChain::new(robot, effector);
        let on_platform = planar.moving(&planar.own_rates(motion));
        Ok(self.lowered_motion(&platform, &on_platform, effector, loaded)?)
    }

    /// What holds the wafer of an effector on its way, and what friction can; see [`Slip`].
    ///
    /// # Errors
    /// As [`Self::wafer_motion`].
    pub fn slip(
        &self,
        effector: EffectorId,
        motion: &AxesMotion<'_>,
    ) -> Result<FrictionMargin, Unreachable> {
        Ok(self.slip_of(effector, &self.wafer_motion(effector, motion, true)?))
    }

    /// The same of a carried wafer that moves so.
    pub(crate) fn slip_of(&self, effector: EffectorId, wafer: &FrameMotion) -> FrictionMargin {
        let described = &self.robot.arms[effector.arm].effectors[effector.effector];
        FrictionMargin::of(wafer, &self.wafer, &described.support, described.friction, self.gravity)
    }

    /// [`Self::wafer_motion`], the platform's known, and that of the rigid arm on it.
    pub(crate) fn lowered_motion(
        &self,
        platform: &FrameMotion,
        on_platform: &FrameMotion,
        effector: EffectorId,
        loaded: bool,
    ) -> Result<FrameMotion, DroopError> {
        let arm = &self.robot.arms[effector.arm];
        let rigid = platform.carrying(on_platform);
        if arm.droop == Droop::Rigid {
            return Ok(rigid);
        }
        // Reach, seen on the platform.
        let [x, y, _] = arm.mount;
        let out = on_platform.base_from_frame.translation.vector.xy() - Vector2::new(x, y);
        let [reach, growth, urge] =
            length([out, on_platform.velocity.xy(), on_platform.acceleration.xy()]);
        let load = if loaded { self.wafer.mass() } else { 0.0 };
        let [by, first, second] = arm.droop.by_reach(reach, load, self.gravity)?;
        let drop = second.drop * growth * growth + first.drop * urge;
        let slopes =
            [by.slope, first.slope * growth, second.slope * growth * growth + first.slope * urge];
        // The turn δ, along the horizontal across the reach.
        let joint = platform.point(&Vector3::from(arm.mount));
        let of = [rigid.base_from_frame.translation.vector, rigid.velocity, rigid.acceleration];
        let across: [Vector2<f64>; 3] = std::array::from_fn(|order| {
            let out = of[order] - joint[order];
            Vector2::new(-out.y, out.x)
        });
        let [delta, velocity, acceleration] = along(slopes, across);
        let turned = turn(&rigid.base_from_frame, &joint[0], by.slope);
        let omega = velocity + delta.cross(&velocity) * 0.5;
        let alpha = acceleration + delta.cross(&acceleration) * 0.5;
        let turning = turned * rigid.angular_velocity;
        Ok(FrameMotion {
            base_from_frame: apply_deflection(&rigid.base_from_frame, &joint[0], by),
            velocity: rigid.velocity - Vector3::z() * (first.drop * growth),
            acceleration: rigid.acceleration - Vector3::z() * drop,
            angular_velocity: omega + turning,
            angular_acceleration: alpha
                + turned * rigid.angular_acceleration
                + omega.cross(&turning),
        })
    }
}

/// Length of a vector, with its first and second derivative; they are zero where it has no direction.
fn length([vector, velocity, acceleration]: [Vector2<f64>; 3]) -> [f64; 3] {
    let length = vector.norm();
    if length <= MIN_HEADING_RADIUS {
        return [length, 0.0, 0.0];
    }
    let growth = vector.dot(&velocity) / length;
    let squares = velocity.norm_squared() + vector.dot(&acceleration) - growth * growth;
    [length, growth, squares / length]
}

/// A vector of a given length along the direction of another that lies level, with its derivatives.
fn along(lengths: [f64; 3], of: [Vector2<f64>; 3]) -> [Vector3<f64>; 3] {
    let [h, growth, urge] = length(of);
    if h < SHORTEST {
        // As `turn`: there the angle grows in proportion to the horizontal reach.
        let [l, speed, hurry] = lengths.map(|length| length / SHORTEST);
        return [
            (of[0] * l).push(0.0),
            (of[0] * speed + of[1] * l).push(0.0),
            (of[0] * hurry + of[1] * (2.0 * speed) + of[2] * l).push(0.0),
        ];
    }
    let unit = of[0] / h;
    let turning = (of[1] - unit * growth) / h;
    let swerving = (of[2] - turning * (2.0 * growth) - unit * urge) / h;
    let [l, speed, hurry] = lengths;
    [
        (unit * l).push(0.0),
        (unit * speed + turning * l).push(0.0),
        (unit * hurry + turning * (2.0 * speed) + swerving * l).push(0.0),
    ]
}
