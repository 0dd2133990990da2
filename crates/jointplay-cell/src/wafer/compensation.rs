//! Inverse kinematics of drooping arms: the platform compensates the deflection.

use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use nalgebra::{Rotation3, Vector3};

use super::deflection::deflection_rotation;
use super::droop::Deflection;
use super::unreachable::{RejectedBranch, Unreachable};
use crate::robot::{ArmChain, Branch, Configuration, EffectorId, Inverse, Redundancy, WaferTarget};
use crate::workcell::Cell;

/// Largest distance from the target at which a wafer counts as there (m).
const TOLERANCE: f64 = 1e-12;

/// Distance from the target below which no further iteration is done (m).
const EXACT: f64 = 1e-14;

/// Largest number of iterations; each reduces the error by about the slope of the droop, so that a handful is enough.
const MAX_ITERATIONS: usize = 20;

/// Relative margin of a clamped tilt below the largest tilt, so that round-off does not violate the limit.
const CLAMP_MARGIN: f64 = 1e-12;

/// Positions at which a drooping arm holds a wafer at its target.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensatedPose {
    /// Positions of all axes, rods first (m or rad).
    pub positions: Vec<f64>,
    /// Elbow and reach direction of the arm.
    pub configuration: Configuration,
    /// Deflection of the arm there.
    pub deflection: Deflection,
    /// Distance of the wafer's centre from the target (m).
    pub residual: f64,
    /// Angle between the wafer's plane and that of the target; more than round-off only where the platform cannot tilt far enough (rad).
    pub residual_tilt: f64,
    /// Difference of the heading from the one asked for, where the arm cannot choose it (rad).
    pub heading_difference: f64,
    /// Number of iterations in which the deflection was computed.
    pub iterations: usize,
}

impl Cell {
    /// Positions at which the wafer lies in the target's plane, centre on centre, though the arm droops.
    ///
    /// ```text
    ///    rigid target  =  droop(reach)⁻¹ · target        reach from the rigid frame, until neither changes
    /// ```
    /// Where the platform cannot tilt far enough, it tilts as far as it can; the centre is met all the same, and the angle that is left is returned.
    ///
    /// # Arguments
    /// * `loaded` – whether the effector carries a wafer
    /// * `seed` – present positions of all axes
    ///
    /// # Errors
    /// [`Unreachable`]; also where more than the plane budget, [`Cell::plane_threshold`], is left of the tilt.
    ///
    /// # Numerics
    /// A fixed-point iteration that contracts by about the slope of the droop, 10⁻³, at each step; the wafer is within 10⁻¹² m of the target.
    pub fn compensated_inverse(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        seed: &[f64],
    ) -> Result<CompensatedPose, Unreachable> {
        self.compensated_inverse_by(effector, target, loaded, seed, Redundancy::AwayFromLimits)
    }

    /// As [`Self::compensated_inverse`], with the positions chosen where the arm is redundant.
    ///
    /// # Errors
    /// As [`Self::compensated_inverse`].
    pub fn compensated_inverse_by(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        seed: &[f64],
        redundancy: Redundancy,
    ) -> Result<CompensatedPose, Unreachable> {
        let choose = |found: &Inverse| found.chosen().cloned();
        self.compensated_inverse_with(effector, target, loaded, seed, redundancy, choose)
    }

    /// As [`Self::compensated_inverse`], in any branch, within limits or not: for what does not depend on the motors.
    ///
    /// # Errors
    /// As [`Self::compensated_inverse`], without limits.
    pub(crate) fn compensated_inverse_beyond_limits(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        seed: &[f64],
    ) -> Result<CompensatedPose, Unreachable> {
        let choose = |found: &Inverse| found.chosen().or(found.branches.first()).cloned();
        let redundancy = Redundancy::AwayFromLimits;
        self.compensated_inverse_with(effector, target, loaded, seed, redundancy, choose)
    }

    fn compensated_inverse_with(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        seed: &[f64],
        redundancy: Redundancy,
        choose: impl Fn(&Inverse) -> Option<Branch>,
    ) -> Result<CompensatedPose, Unreachable> {
        self.robot.check_effector(effector)?;
        let chain = ArmChain::new(&self.robot, effector);
        let target_normal = target.normal.normalize();
        let max_tilt = self.robot.gpr.limits().tilt_max;
        let mut aim = WaferTarget { normal: target_normal, ..*target };
        let mut needed = Tilt::from_normal(&target_normal).angle;
        let mut iterations = 0;
        let mut last_residual = f64::INFINITY;
        loop {
            aim.normal = clamped_tilt(&aim.normal, max_tilt);
            let branch = self.branch_to(effector, &aim, seed, redundancy, &choose)?;
            let rigid = self.rigid_wafer(&chain, &branch.positions)?;
            let deflection = self.deflection(&rigid, loaded)?;
            iterations += 1;
            let found = rigid.deflected(deflection);
            let residual = (found.translation.vector - target.center).norm();
            let residual_tilt = angle_to(&found, &target_normal);
            // A residual that no longer falls is round-off.
            let is_done = residual <= EXACT || (residual <= TOLERANCE && residual >= last_residual);
            if is_done || iterations == MAX_ITERATIONS {
                if residual > TOLERANCE {
                    return Err(Unreachable::NotConverged { residual, iterations });
                }
                if residual_tilt > self.plane_threshold {
                    let (allowed, threshold) = (max_tilt, self.plane_threshold);
                    let residual = residual_tilt;
                    return Err(Unreachable::Tilt { needed, allowed, residual, threshold });
                }
                return Ok(CompensatedPose {
                    positions: branch.positions.to_vec(),
                    configuration: branch.configuration,
                    deflection,
                    residual,
                    residual_tilt,
                    heading_difference: branch.heading_difference,
                    iterations,
                });
            }
            last_residual = residual;
            let back = deflection_rotation(&rigid.base_from_wafer, &rigid.joint, deflection.slope)
                .inverse();
            aim.center = target.center + Vector3::z() * deflection.drop;
            aim.normal = back * target_normal;
            needed = Tilt::from_normal(&aim.normal).angle;
            // A heading is an angle about the normal: the new normal needs another angle for the same direction.
            aim.heading = target.heading.map(|heading| {
                let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
                let along = back * (tilt_rotation(&target_normal) * turned * Vector3::x());
                let level = tilt_rotation(&aim.normal).inverse() * along;
                level.y.atan2(level.x)
            });
        }
    }

    /// The branch of the rigid arm that reaches a target.
    fn branch_to(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        seed: &[f64],
        redundancy: Redundancy,
        choose: &impl Fn(&Inverse) -> Option<Branch>,
    ) -> Result<Branch, Unreachable> {
        let found = self.robot.inverse_by(effector, target, seed, redundancy)?;
        if let Some(branch) = choose(&found) {
            return Ok(branch);
        }
        let rejected = found.branches.into_iter().map(|branch| RejectedBranch {
            configuration: branch.configuration,
            violations: branch.violations,
        });
        let rejected: Vec<RejectedBranch> = rejected.collect();
        Err(match found.out_of_reach {
            Some(out) if rejected.is_empty() => Unreachable::OutOfReach(out),
            _ if rejected.is_empty() => Unreachable::NoBranch,
            _ => Unreachable::Limits(rejected),
        })
    }
}

/// Angle between the normal of a wafer and a unit normal (rad).
fn angle_to(base_from_wafer: &Pose, normal: &Vector3<f64>) -> f64 {
    let found = base_from_wafer.rotation * Vector3::z();
    found.cross(normal).norm().atan2(found.dot(normal))
}

/// A normal tilted by at most a limit, toward the same side.
fn clamped_tilt(normal: &Vector3<f64>, limit: f64) -> Vector3<f64> {
    let tilt = Tilt::from_normal(normal);
    if tilt.angle <= limit {
        return *normal;
    }
    Tilt { azimuth: tilt.azimuth, angle: limit * (1.0 - CLAMP_MARGIN) }.normal()
}
