//! Velocities of a wafer by those of the axes.

use jointplay_core::gpr::PlatformPose;
use jointplay_core::virtualization::BuiltIn;
use nalgebra::{Rotation3, Vector3};

use super::acceleration::turn_between;
use super::arm_chain::ArmChain;
use super::hybrid_robot::{EffectorId, HybridRobot, MAX_AXES, RODS};
use crate::CellError;

/// Half the step of differences over rods, where the model has no derivative in closed form (m).
const STEP: f64 = 1e-5;

/// Velocity of a wafer by that of each axis, in the base frame.
///
/// ```text
///    v = Σ_a linear_a ȧ        ω = Σ_a angular_a ȧ
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectorJacobian {
    /// Velocity of the wafer's centre by axis (m/m or m/rad); zero for entries beyond the last axis.
    pub linear: [Vector3<f64>; MAX_AXES],
    /// Angular velocity of the wafer by axis (rad/m or rad/rad).
    pub angular: [Vector3<f64>; MAX_AXES],
}

/// Velocity of O_p, and angular velocity of the platform.
type Velocity = (Vector3<f64>, Vector3<f64>);

impl HybridRobot {
    /// Jacobian of an effector's wafer.
    ///
    /// # Errors
    /// As [`Self::effector_pose`].
    ///
    /// # Numerics
    /// Closed form; for virtualizations other than planar, the columns of the rods by central differences with a step of 10⁻⁵ m, with a relative error of about 10⁻⁸.
    /// Does not allocate.
    pub fn effector_jacobian(
        &self,
        positions: &[f64],
        id: EffectorId,
    ) -> Result<EffectorJacobian, CellError> {
        self.check_effector(id)?;
        self.check_positions(positions)?;
        self.jacobian_by(&ArmChain::new(self, id), positions)
    }

    /// As [`Self::effector_jacobian`], the arm to the effector known.
    pub(crate) fn jacobian_by(
        &self,
        chain: &ArmChain,
        positions: &[f64],
    ) -> Result<EffectorJacobian, CellError> {
        let platform = self.platform(positions)?;
        let turn = platform.base_from_platform.rotation;
        let arm_positions = chain.arm_positions(positions);
        let tip = chain.tip(&arm_positions).push(chain.height);
        let mut jacobian = EffectorJacobian {
            linear: [Vector3::zeros(); MAX_AXES],
            angular: [Vector3::zeros(); MAX_AXES],
        };
        let arm = turn * tip;
        for (rod, (origin, angular)) in self.platform_velocities(&platform)?.into_iter().enumerate()
        {
            jacobian.linear[rod] = origin + angular.cross(&arm);
            jacobian.angular[rod] = angular;
        }
        let velocities = chain.tip_velocities(&arm_positions);
        for (k, &axis) in chain.axes().iter().enumerate() {
            jacobian.linear[axis] = turn * velocities[k].push(0.0);
            jacobian.angular[axis] = turn * Vector3::z() * chain.heading.1[k];
        }
        Ok(jacobian)
    }

    /// Velocity of O_p and angular velocity of the platform, by each rod.
    ///
    /// The planar model keeps the centroid of the sockets on that of the balls, and Σ b_k × d_k = 0 about it, b_k and d_k from the centroid to socket and ball;
    /// differentiated, the rotation about the normal is n · Σ b_k × ḋ_k / Σ b_k · d_k.
    fn platform_velocities(&self, platform: &PlatformPose) -> Result<[Velocity; RODS], CellError> {
        let mut velocities = [(Vector3::zeros(), Vector3::zeros()); RODS];
        if self.model.virtualization != BuiltIn::Planar {
            for (k, velocity) in velocities.iter_mut().enumerate() {
                let at = |step: f64| {
                    let mut rods = platform.rods;
                    rods[k] += step;
                    self.model.forward(&self.gpr, rods).map(|found| found.base_from_platform)
                };
                let (before, after) = (at(-STEP)?, at(STEP)?);
                let shift = after.translation.vector - before.translation.vector;
                let turn = turn_between(&before.rotation, &after.rotation);
                *velocity = (shift / (2.0 * STEP), turn / (2.0 * STEP));
            }
            return Ok(velocities);
        }
        let balls = self.gpr.ball_centers(&platform.rods);
        let sockets = self.gpr.platform().sockets();
        let socket_center = (sockets[0] + sockets[1] + sockets[2]) / 3.0;
        let ball_center = (balls[0] + balls[1] + balls[2]) / 3.0;
        let turn: Rotation3<f64> = platform.base_from_platform.rotation;
        let normal = turn * Vector3::z();
        let from_center = sockets.map(|socket| turn * (socket - socket_center).push(0.0));
        let to_ball = balls.map(|ball| ball - ball_center);
        let spread: f64 = (0..3).map(|k| from_center[k].dot(&to_ball[k])).sum();
        let upward = (balls[1] - balls[0]).cross(&(balls[2] - balls[0]));
        let area = upward.dot(&normal);
        for (k, velocity) in velocities.iter_mut().enumerate() {
            // The plane rotates about the line through the two other balls.
            let side = balls[(k + 2) % 3] - balls[(k + 1) % 3];
            let changed = Vector3::z().cross(&side) * -1.0 / area;
            let tilting = normal.cross(&(changed - normal * normal.dot(&changed)));
            let about_normal: f64 = (0..3)
                .map(|j| {
                    let ball = Vector3::z() * (f64::from(u8::from(j == k)) - 1.0 / 3.0);
                    normal.dot(&from_center[j].cross(&ball))
                })
                .sum();
            let angular = tilting + normal * (about_normal / spread);
            let origin = Vector3::z() / 3.0 - angular.cross(&(turn * socket_center.push(0.0)));
            *velocity = (origin, angular);
        }
        Ok(velocities)
    }
}
