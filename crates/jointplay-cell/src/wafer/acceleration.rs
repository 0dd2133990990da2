//! Velocities and accelerations of wafers on drooping arms.

use nalgebra::{Vector2, Vector3};

use super::deflection::{apply_deflection, deflection_rotation};
use super::droop::{DroopError, MIN_REACH};
use super::friction::{FrictionDemand, WrenchAlongPath};
use super::model::Droop;
use super::unreachable::Unreachable;
use crate::robot::{ArmChain, AxesMotion, EffectorId, FrameMotion};
use crate::workcell::Cell;

/// Horizontal distance from its joint below which an arm has no heading (m).
const MIN_HEADING_RADIUS: f64 = 1e-9;

impl Cell {
    /// Motion of an effector's wafer, the deflection of its arm quasi-static: that of the arm at rest in each position; the wafer's own sag is neglected.
    ///
    /// # Errors
    /// [`Unreachable::Robot`] and [`Unreachable::Droop`].
    ///
    /// # Numerics
    /// As [`HybridRobot::effector_motion`](crate::robot::HybridRobot::effector_motion); the rotation of the arm's end by the droop has an error of the square of its angle.
    /// Where the slope of a droop table is discontinuous, at its rows, the slope of one side is used; the jump itself is neglected.
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
        let chain = ArmChain::new(robot, effector);
        let on_platform = chain.wafer_motion(&chain.arm_states(motion));
        Ok(self.deflected_motion(&platform, &on_platform, effector, loaded)?)
    }

    /// Friction that a carried wafer needs, and friction that is available; see [`FrictionDemand`].
    ///
    /// # Errors
    /// As [`Self::wafer_motion`].
    pub fn friction_demand(
        &self,
        effector: EffectorId,
        motion: &AxesMotion<'_>,
    ) -> Result<FrictionDemand, Unreachable> {
        Ok(self.friction_demand_of(effector, &self.wafer_motion(effector, motion, true)?))
    }

    /// As [`Self::friction_demand`], the motion of the wafer known.
    pub(crate) fn friction_demand_of(
        &self,
        effector: EffectorId,
        wafer: &FrameMotion,
    ) -> FrictionDemand {
        let described = &self.robot.arms[effector.arm].effectors[effector.effector];
        FrictionDemand::new(
            wafer,
            &self.wafer,
            &described.support,
            described.friction,
            self.gravity,
        )
    }

    /// Constraints k₀ x + k₁ x' ≤ 1 on the squared rate x = u̇² of the parameter u of a path, by which a carried wafer uses at most a fraction of its friction; `None` where it needs more at rest.
    ///
    /// # Arguments
    /// * `path` – positions at a place of the path, with their first two derivatives with respect to u
    ///
    /// # Errors
    /// As [`Self::wafer_motion`].
    pub(crate) fn friction_constraints(
        &self,
        effector: EffectorId,
        path: &AxesMotion<'_>,
        fraction: f64,
    ) -> Result<Option<Vec<[f64; 2]>>, Unreachable> {
        let zero = vec![0.0; path.positions.len()];
        let still = AxesMotion { velocities: &zero, accelerations: &zero, ..*path };
        let starting = AxesMotion { velocities: &zero, accelerations: path.velocities, ..*path };
        let wafer = |motion| self.wafer_motion(effector, motion, true);
        let motions = [&wafer(&still)?, &wafer(path)?, &wafer(&starting)?];
        let described = &self.robot.arms[effector.arm].effectors[effector.effector];
        let along = WrenchAlongPath::new(motions, &self.wafer, self.gravity);
        let friction = fraction * described.friction;
        Ok(along.constraints(&self.wafer, &described.support, friction))
    }

    /// As [`Self::wafer_motion`], the motions of the platform, and of the rigid arm's wafer relative to it, known.
    pub(crate) fn deflected_motion(
        &self,
        platform: &FrameMotion,
        on_platform: &FrameMotion,
        effector: EffectorId,
        loaded: bool,
    ) -> Result<FrameMotion, DroopError> {
        let arm = &self.robot.arms[effector.arm];
        let rigid = platform.composed_with(on_platform);
        if arm.droop == Droop::Rigid {
            return Ok(rigid);
        }
        // The reach lies in the platform plane: its derivatives follow from the motion relative to the platform.
        let [x, y, _] = arm.mount;
        let out = on_platform.base_from_frame.translation.vector.xy() - Vector2::new(x, y);
        let [reach, reach_rate, reach_acceleration] =
            length_derivatives([out, on_platform.velocity.xy(), on_platform.acceleration.xy()]);
        let load = if loaded { self.wafer.mass() } else { 0.0 };
        let [deflection, first, second] =
            arm.droop.derivatives_by_reach(reach, load, self.gravity)?;
        let drop_acceleration =
            second.drop * reach_rate * reach_rate + first.drop * reach_acceleration;
        let slopes = [
            deflection.slope,
            first.slope * reach_rate,
            second.slope * reach_rate * reach_rate + first.slope * reach_acceleration,
        ];
        // The rotation vector δ of the deflection, along the horizontal perpendicular to the reach.
        let joint = platform.point(&Vector3::from(arm.mount));
        let center = [rigid.base_from_frame.translation.vector, rigid.velocity, rigid.acceleration];
        let perpendicular: [Vector2<f64>; 3] = std::array::from_fn(|order| {
            let out = center[order] - joint[order];
            Vector2::new(-out.y, out.x)
        });
        let [delta, velocity, acceleration] = vector_along(slopes, perpendicular);
        let rotation = deflection_rotation(&rigid.base_from_frame, &joint[0], deflection.slope);
        // Angular velocity of a rotation vector, to second order in its angle.
        let omega = velocity + delta.cross(&velocity) * 0.5;
        let alpha = acceleration + delta.cross(&acceleration) * 0.5;
        let rigid_omega = rotation * rigid.angular_velocity;
        Ok(FrameMotion {
            base_from_frame: apply_deflection(&rigid.base_from_frame, &joint[0], deflection),
            velocity: rigid.velocity - Vector3::z() * (first.drop * reach_rate),
            acceleration: rigid.acceleration - Vector3::z() * drop_acceleration,
            angular_velocity: omega + rigid_omega,
            angular_acceleration: alpha
                + rotation * rigid.angular_acceleration
                + omega.cross(&rigid_omega),
        })
    }
}

/// Length of a vector with its first and second derivative; they are zero where the vector has no direction.
fn length_derivatives([vector, velocity, acceleration]: [Vector2<f64>; 3]) -> [f64; 3] {
    let length = vector.norm();
    if length <= MIN_HEADING_RADIUS {
        return [length, 0.0, 0.0];
    }
    let rate = vector.dot(&velocity) / length;
    let squares = velocity.norm_squared() + vector.dot(&acceleration) - rate * rate;
    [length, rate, squares / length]
}

/// A horizontal vector of a given length along the direction of another vector, with its derivatives.
fn vector_along(lengths: [f64; 3], of: [Vector2<f64>; 3]) -> [Vector3<f64>; 3] {
    let [norm, norm_rate, norm_acceleration] = length_derivatives(of);
    if norm < MIN_REACH {
        // As in `deflection_rotation`: near the joint the angle grows in proportion to the horizontal reach.
        let [l, rate, acceleration] = lengths.map(|length| length / MIN_REACH);
        return [
            (of[0] * l).push(0.0),
            (of[0] * rate + of[1] * l).push(0.0),
            (of[0] * acceleration + of[1] * (2.0 * rate) + of[2] * l).push(0.0),
        ];
    }
    let unit = of[0] / norm;
    let unit_rate = (of[1] - unit * norm_rate) / norm;
    let unit_acceleration =
        (of[2] - unit_rate * (2.0 * norm_rate) - unit * norm_acceleration) / norm;
    let [l, rate, acceleration] = lengths;
    [
        (unit * l).push(0.0),
        (unit * rate + unit_rate * l).push(0.0),
        (unit * acceleration + unit_rate * (2.0 * rate) + unit_acceleration * l).push(0.0),
    ]
}
