//! Poses of wafers on drooping arms.

use jointplay_core::spatial::Pose;
use nalgebra::{Point3, Rotation3, Translation3, Unit, Vector3};

use super::droop::{Deflection, DroopError, MIN_REACH};
use super::model::Droop;
use super::unreachable::Unreachable;
use crate::CellError;
use crate::robot::{ArmChain, EffectorId};
use crate::workcell::Cell;

/// A wafer on an arm that does not droop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidWafer {
    /// Index of the arm.
    pub(crate) arm: usize,
    /// Pose of the wafer.
    pub(crate) base_from_wafer: Pose,
    /// First joint of the arm, in the base frame (m).
    pub(crate) joint: Vector3<f64>,
}

impl RigidWafer {
    /// Pose of the wafer on the arm as it deflects.
    pub(crate) fn deflected(&self, deflection: Deflection) -> Pose {
        apply_deflection(&self.base_from_wafer, &self.joint, deflection)
    }
}

/// The wafer frame of a drooping arm from that of the rigid arm.
///
/// The centre moves down by the drop, and the wafer rotates about the horizontal axis perpendicular to the reach, its outer end down.
///
/// # Arguments
/// * `joint` – first joint of the arm, in the base frame (m)
#[must_use]
pub fn apply_deflection(
    base_from_wafer: &Pose,
    joint: &Vector3<f64>,
    deflection: Deflection,
) -> Pose {
    let rotation = deflection_rotation(base_from_wafer, joint, deflection.slope);
    let center = base_from_wafer.translation.vector - Vector3::z() * deflection.drop;
    Pose::from_parts(Translation3::from(center), rotation * base_from_wafer.rotation)
}

/// The rotation of a deflected wafer: about the horizontal perpendicular to the reach, by an angle that falls to zero in proportion to the horizontal reach within [`MIN_REACH`] of the joint.
///
/// So the direction of an arm that passes over its own joint does not matter, and the rotation is Lipschitz in the reach.
pub(super) fn deflection_rotation(
    base_from_wafer: &Pose,
    joint: &Vector3<f64>,
    slope: f64,
) -> Rotation3<f64> {
    let reach = base_from_wafer.translation.vector - joint;
    let angle = slope * (reach.xy().norm() / MIN_REACH).min(1.0);
    match Unit::try_new(Vector3::new(-reach.y, reach.x, 0.0), f64::MIN_POSITIVE) {
        Some(axis) => Rotation3::from_axis_angle(&axis, angle),
        None => Rotation3::identity(),
    }
}

impl Cell {
    /// Pose of an effector's wafer, its arm drooping: the frame of the supports' plane; the wafer's own sag is neglected.
    ///
    /// # Errors
    /// [`Unreachable::Robot`] and [`Unreachable::Droop`].
    pub fn wafer_pose(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, Unreachable> {
        self.wafer_pose_and_deflection(effector, positions, loaded).map(|(pose, _)| pose)
    }

    /// As [`Self::wafer_pose`], with the deflection of the arm.
    pub(crate) fn wafer_pose_and_deflection(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<(Pose, Deflection), Unreachable> {
        self.robot.check_effector(effector)?;
        self.robot.check_positions(positions)?;
        let rigid = self.rigid_wafer(&ArmChain::new(&self.robot, effector), positions)?;
        let deflection = self.deflection(&rigid, loaded)?;
        Ok((rigid.deflected(deflection), deflection))
    }

    /// As [`Self::wafer_pose`], for an arm that is prepared, and positions that are valid.
    pub(crate) fn wafer_pose_by(
        &self,
        chain: &ArmChain,
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, Unreachable> {
        let rigid = self.rigid_wafer(chain, positions)?;
        Ok(rigid.deflected(self.deflection(&rigid, loaded)?))
    }

    /// As [`Self::wafer_pose`], with a rigid arm where its droop is not known; the error has the reason.
    ///
    /// # Errors
    /// As [`crate::robot::HybridRobot::forward`].
    pub fn wafer_pose_or_rigid(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<(Pose, Option<DroopError>), CellError> {
        let (base_from_platform, base_from_wafer) =
            self.robot.platform_and_effector(positions, effector)?;
        let rigid = self.rigid_wafer_at(effector.arm, &base_from_platform, base_from_wafer);
        Ok(match self.deflection(&rigid, loaded) {
            Ok(deflection) => (rigid.deflected(deflection), None),
            Err(unknown) => (base_from_wafer, Some(unknown)),
        })
    }

    /// Pose of an effector's wafer over a platform whose pose is known.
    ///
    /// # Errors
    /// [`DroopError`]
    pub(crate) fn wafer_over(
        &self,
        base_from_platform: &Pose,
        chain: &ArmChain,
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, DroopError> {
        let base_from_wafer = base_from_platform * chain.wafer(positions);
        let arm = chain.effector.arm;
        if self.robot.arms[arm].droop == Droop::Rigid {
            return Ok(base_from_wafer);
        }
        let rigid = self.rigid_wafer_at(arm, base_from_platform, base_from_wafer);
        Ok(rigid.deflected(self.deflection(&rigid, loaded)?))
    }

    /// The wafer of an arm that does not droop.
    pub(super) fn rigid_wafer(
        &self,
        chain: &ArmChain,
        positions: &[f64],
    ) -> Result<RigidWafer, CellError> {
        let base_from_platform = self.robot.platform(positions)?.base_from_platform;
        let base_from_wafer = base_from_platform * chain.wafer(positions);
        Ok(self.rigid_wafer_at(chain.effector.arm, &base_from_platform, base_from_wafer))
    }

    /// The wafer of an arm that does not droop, its pose known.
    pub(crate) fn rigid_wafer_at(
        &self,
        arm: usize,
        base_from_platform: &Pose,
        base_from_wafer: Pose,
    ) -> RigidWafer {
        let joint = (base_from_platform * Point3::from(self.robot.arms[arm].mount)).coords;
        RigidWafer { arm, base_from_wafer, joint }
    }

    /// Deflection of an arm at the reach of its wafer, empty or loaded.
    pub(crate) fn deflection(
        &self,
        rigid: &RigidWafer,
        loaded: bool,
    ) -> Result<Deflection, DroopError> {
        let out = rigid.base_from_wafer.translation.vector - rigid.joint;
        let normal = rigid.base_from_wafer.rotation * Vector3::z();
        let reach = (out - normal * out.dot(&normal)).norm();
        let load = if loaded { self.wafer.mass() } else { 0.0 };
        self.robot.arms[rigid.arm].droop.deflection(reach, load, self.gravity)
    }
}
