//! How the platform makes up for an arm that droops.

use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use nalgebra::{Point3, Rotation3, Translation3, Unit, Vector3};

use super::{Deflection, Droop, DroopError, SHORTEST};
use crate::CellError;
use crate::robot::{ArmChain, Configuration, EffectorId, LimitViolation, OutOfReach, WaferTarget};
use crate::workcell::Cell;

/// Farther than this from its target, a wafer is not there [m].
const RESIDUAL: f64 = 1e-12;

/// Nearer than this to its target, no further step is taken [m].
const GOOD_ENOUGH: f64 = 1e-14;

/// Most steps; each makes the error smaller by about the slope of the droop, so that a handful is enough.
const MOST_STEPS: usize = 20;

/// By how much of itself the largest tilt is kept away from where it has to be given up, so that round-off does not break it.
const INSIDE: f64 = 1e-12;

/// Positions at which a wafer lies where it should, its arm drooping.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensatedPose {
    /// Of all axes, rods first ([m], [rad]).
    pub positions: Vec<f64>,
    /// How the arm is bent.
    pub configuration: Configuration,
    /// How the arm droops there.
    pub deflection: Deflection,
    /// Distance of the drooping wafer's centre from the target [m].
    pub residual_height: f64,
    /// Angle between the drooping wafer's plane and that of the target; more than round-off only where the robot cannot tilt far enough [rad].
    pub residual_tilt: f64,
    /// How far the heading is from the one asked for, where the arm is not free to choose it [rad].
    pub heading_off: f64,
    /// How often the droop was found anew.
    pub steps: usize,
}

/// Why no positions bring a wafer to a place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unreachable {
    /// The robot cannot be computed there.
    #[error(transparent)]
    Robot(#[from] CellError),
    /// Nothing is known of how the arm droops there.
    #[error(transparent)]
    Droop(#[from] DroopError),
    /// The platform would have to lean too far.
    #[error(
        "the platform would have to lean {:.4}°, but leans by at most {:.4}°: {:.1} µrad would be left, and {:.1} µrad are allowed",
        needed.to_degrees(), allowed.to_degrees(), left * 1e6, threshold * 1e6
    )]
    Tilt {
        /// How far it would have to lean, droop included [rad].
        needed: f64,
        /// How far it may [rad].
        allowed: f64,
        /// Angle to the target's plane that would be left [rad].
        left: f64,
        /// Angle that may be left [rad].
        threshold: f64,
    },
    /// The links are too short, or cannot fold that far.
    #[error(
        "the arm would have to span {:.3} mm, but spans {:.3} to {:.3} mm: {:.3} mm are missing",
        .0.distance * 1e3, .0.min * 1e3, .0.max * 1e3, .0.missing() * 1e3
    )]
    OutOfReach(OutOfReach),
    /// Every way to get there breaks a limit.
    #[error("every way to get there breaks a limit: {}", told(.0))]
    Limits(Vec<RejectedBranch>),
    /// There is no way, for reasons that the solver does not know.
    #[error("no positions were found that bring the wafer there")]
    NoWay,
    /// The droop changes faster with the reach than can be made up for.
    #[error(
        "the droop cannot be made up for: {:.3e} mm were left after {steps} steps",
        residual * 1e3
    )]
    NotConverged {
        /// Distance from the target that was left [m].
        residual: f64,
        /// How many steps were taken.
        steps: usize,
    },
}

/// One way to a target, and what stops it.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedBranch {
    /// How the arm is bent.
    pub configuration: Configuration,
    /// Limits that it breaks, each with the name of its axis.
    pub broken: Vec<(String, LimitViolation)>,
}

fn told(ways: &[RejectedBranch]) -> String {
    let limit = |(name, limit): &(String, LimitViolation)| match limit {
        LimitViolation::Axis { position, min, max, .. } => {
            format!("axis {name} at {position:.4}, limits {min:.4} to {max:.4}")
        }
        LimitViolation::Tilt { pitch, max } => {
            format!("tilt of {:.4}°, limit {:.4}°", pitch.to_degrees(), max.to_degrees())
        }
    };
    let way = |way: &RejectedBranch| {
        let limits: Vec<String> = way.broken.iter().map(limit).collect();
        format!("{} ({})", way.configuration, limits.join("; "))
    };
    ways.iter().map(way).collect::<Vec<_>>().join(", ")
}

/// The wafer frame of a drooping arm from the rigid one's.
///
/// The centre goes down by the drop, and the wafer turns about the horizontal perpendicular to the reach, its outer end down.
///
/// # Arguments
/// * `joint` – first joint of the arm, in the base frame [m]
#[must_use]
pub fn apply_deflection(
    base_from_wafer: &Pose,
    joint: &Vector3<f64>,
    deflection: Deflection,
) -> Pose {
    let turn = turn(base_from_wafer, joint, deflection.slope);
    let center = base_from_wafer.translation.vector - Vector3::z() * deflection.drop;
    Pose::from_parts(Translation3::from(center), turn * base_from_wafer.rotation)
}

/// The rotation of a deflected wafer: about the horizontal across the reach, by an angle that falls to zero in proportion to the horizontal reach within [`SHORTEST`] of the joint.
///
/// So the direction of an arm that passes over its own joint does not matter, and the rotation is Lipschitz in the reach.
pub(super) fn turn(base_from_wafer: &Pose, joint: &Vector3<f64>, slope: f64) -> Rotation3<f64> {
    let out = base_from_wafer.translation.vector - joint;
    let slope = slope * (out.xy().norm() / SHORTEST).min(1.0);
    match Unit::try_new(Vector3::new(-out.y, out.x, 0.0), f64::MIN_POSITIVE) {
        Some(axis) => Rotation3::from_axis_angle(&axis, slope),
        None => Rotation3::identity(),
    }
}

impl Cell {
    /// Where the wafer of an effector is, its arm drooping; the rest frame of its supports, the wafer's own sag left aside.
    ///
    /// # Errors
    /// [`Unreachable::Robot`] and [`Unreachable::Droop`].
    pub fn wafer_pose(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, Unreachable> {
        self.drooping_wafer(effector, positions, loaded).map(|(pose, _)| pose)
    }

    /// The same, the arm to it known.
    pub(crate) fn wafer_pose_by(
        &self,
        (effector, planar): (EffectorId, &ArmChain),
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, Unreachable> {
        let (rigid, joint, deflection) = self.deflected((effector, planar), positions, loaded)?;
        Ok(apply_deflection(&rigid, &joint, deflection))
    }

    /// The same, and how the arm droops.
    pub(crate) fn drooping_wafer(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<(Pose, Deflection), Unreachable> {
        self.robot.check_effector(effector)?;
        self.robot.check_positions(positions)?;
        let planar = ArmChain::new(&self.robot, effector);
        let (rigid, joint, deflection) = self.deflected((effector, &planar), positions, loaded)?;
        Ok((apply_deflection(&rigid, &joint, deflection), deflection))
    }

    /// The same where nothing may be known of the droop: there the arm is told as if it were rigid, and why.
    ///
    /// # Errors
    /// As [`crate::robot::HybridRobot::forward`].
    pub fn wafer_pose_as_known(
        &self,
        effector: EffectorId,
        positions: &[f64],
        loaded: bool,
    ) -> Result<(Pose, Option<DroopError>), CellError> {
        let (base_from_platform, rigid) = self.robot.platform_and_effector(positions, effector)?;
        let joint = (base_from_platform * Point3::from(self.robot.arms[effector.arm].mount)).coords;
        Ok(match self.deflection(effector.arm, &rigid, &joint, loaded) {
            Ok(deflection) => (apply_deflection(&rigid, &joint, deflection), None),
            Err(unknown) => (rigid, Some(unknown)),
        })
    }

    /// The wafer frame of an effector over a platform that is known.
    ///
    /// # Errors
    /// [`DroopError`]
    pub(crate) fn wafer_over(
        &self,
        base_from_platform: &Pose,
        (effector, planar): (EffectorId, &ArmChain),
        positions: &[f64],
        loaded: bool,
    ) -> Result<Pose, DroopError> {
        let rigid = base_from_platform * planar.wafer(positions);
        let arm = &self.robot.arms[effector.arm];
        if arm.droop == Droop::Rigid {
            return Ok(rigid);
        }
        let joint = (base_from_platform * Point3::from(arm.mount)).coords;
        let deflection = self.deflection(effector.arm, &rigid, &joint, loaded)?;
        Ok(apply_deflection(&rigid, &joint, deflection))
    }

    /// Rigid wafer frame, first joint, and how the arm droops.
    fn deflected(
        &self,
        (effector, planar): (EffectorId, &ArmChain),
        positions: &[f64],
        loaded: bool,
    ) -> Result<(Pose, Vector3<f64>, Deflection), Unreachable> {
        let base_from_platform = self.robot.platform(positions)?.base_from_platform;
        let rigid = base_from_platform * planar.wafer(positions);
        let joint = (base_from_platform * Point3::from(self.robot.arms[effector.arm].mount)).coords;
        let deflection = self.deflection(effector.arm, &rigid, &joint, loaded)?;
        Ok((rigid, joint, deflection))
    }

    /// Deflection of an arm whose rigid wafer frame is this.
    pub(crate) fn deflection(
        &self,
        arm: usize,
        rigid: &Pose,
        joint: &Vector3<f64>,
        loaded: bool,
    ) -> Result<Deflection, DroopError> {
        let out = rigid.translation.vector - joint;
        let normal = rigid.rotation * Vector3::z();
        let reach = (out - normal * out.dot(&normal)).norm();
        let load = if loaded { self.wafer.mass() } else { 0.0 };
        self.robot.arms[arm].droop.at(reach, load, self.gravity)
    }

    /// Positions at which the wafer lies in the target's plane, centre on centre, though the arm droops.
    ///
    /// ```text
    ///    rigid target  =  droop(reach)⁻¹ · target        reach from the rigid frame, until neither changes
    /// ```
    /// Where the platform cannot lean far enough, it leans as far as it can; the centre is met all the same, and what is left of the tilt is reported.
    ///
    /// # Arguments
    /// * `loaded` – whether the effector carries a wafer
    /// * `near` – positions of all axes that the robot is at
    ///
    /// # Errors
    /// [`Unreachable`], with what is possible; also where more than the cell's threshold is left of the tilt.
    ///
    /// # Numerics
    /// An iteration that contracts by about the slope of the droop, 10⁻³, at each step; the wafer is within 10⁻¹² m of the target.
    pub fn reach(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        near: &[f64],
    ) -> Result<CompensatedPose, Unreachable> {
        self.robot.check_effector(effector)?;
        let planar = ArmChain::new(&self.robot, effector);
        let wanted_normal = target.normal.normalize();
        let limit = self.robot.gpr.limits().tilt_max;
        let mut aim = WaferTarget { normal: wanted_normal, ..*target };
        let mut needed = Tilt::from_normal(&wanted_normal).pitch;
        let mut steps = 0;
        let mut residual_before = f64::INFINITY;
        loop {
            aim.normal = within(&aim.normal, limit);
            let branch = self.way(effector, &aim, near)?;
            let (rigid, joint, deflection) =
                self.deflected((effector, &planar), &branch.positions, loaded)?;
            steps += 1;
            let found = apply_deflection(&rigid, &joint, deflection);
            let residual_height = (found.translation.vector - target.center).norm();
            let normal = found.rotation * Vector3::z();
            let residual_tilt =
                normal.cross(&wanted_normal).norm().atan2(normal.dot(&wanted_normal));
            // No better than before is as good as it gets in round-off.
            let done = residual_height <= GOOD_ENOUGH
                || (residual_height <= RESIDUAL && residual_height >= residual_before);
            if done || steps == MOST_STEPS {
                if residual_height > RESIDUAL {
                    return Err(Unreachable::NotConverged { residual: residual_height, steps });
                }
                if residual_tilt > self.plane_threshold {
                    let (allowed, left) = (limit, residual_tilt);
                    let threshold = self.plane_threshold;
                    return Err(Unreachable::Tilt { needed, allowed, left, threshold });
                }
                return Ok(CompensatedPose {
                    positions: branch.positions.to_vec(),
                    configuration: branch.configuration,
                    deflection,
                    residual_height,
                    residual_tilt,
                    heading_off: branch.heading_off,
                    steps,
                });
            }
            residual_before = residual_height;
            let back = turn(&rigid, &joint, deflection.slope).inverse();
            aim.center = target.center + Vector3::z() * deflection.drop;
            aim.normal = back * wanted_normal;
            needed = Tilt::from_normal(&aim.normal).pitch;
            // The heading is about the normal, which is another one now.
            aim.heading = target.heading.map(|heading| {
                let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
                let along = back * (tilt_rotation(&wanted_normal) * turned * Vector3::x());
                let level = tilt_rotation(&aim.normal).inverse() * along;
                level.y.atan2(level.x)
            });
        }
    }

    /// The branch to take to a rigid target, or why there is none.
    fn way(
        &self,
        effector: EffectorId,
        target: &WaferTarget,
        near: &[f64],
    ) -> Result<crate::robot::Branch, Unreachable> {
        let found = self.robot.inverse(effector, target, near)?;
        if let Some(branch) = found.chosen() {
            return Ok(branch.clone());
        }
        let name = |limit: &LimitViolation| {
            let name = match limit {
                LimitViolation::Axis { axis, .. } => self.robot.axes[*axis].name.clone(),
                LimitViolation::Tilt { .. } => String::new(),
            };
            (name, *limit)
        };
        let ways = found.branches.iter().map(|branch| RejectedBranch {
            configuration: branch.configuration,
            broken: branch.broken.iter().map(name).collect(),
        });
        let ways: Vec<RejectedBranch> = ways.collect();
        Err(match found.out_of_reach {
            Some(out) if ways.is_empty() => Unreachable::OutOfReach(out),
            _ if ways.is_empty() => Unreachable::NoWay,
            _ => Unreachable::Limits(ways),
        })
    }
}

/// The normal that leans no farther than allowed, toward the same side.
fn within(normal: &Vector3<f64>, limit: f64) -> Vector3<f64> {
    let tilt = Tilt::from_normal(normal);
    if tilt.pitch <= limit {
        return *normal;
    }
    Tilt { yaw: tilt.yaw, pitch: limit * (1.0 - INSIDE) }.normal()
}
