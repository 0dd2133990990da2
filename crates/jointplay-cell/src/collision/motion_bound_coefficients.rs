//! Motion bound coefficients: upper bounds of the travel of any point of an object per unit of each axis.

use nalgebra::Vector3;

use super::object::{CollisionObject, Parent};
use crate::robot::{Arm, ArmJoint, AxisKind, EffectorId, HybridRobot, MAX_AXES};
use crate::wafer::{Droop, DroopBounds, MIN_REACH};
use crate::workcell::Cell;

/// Least tilt up to which the motion of deflected arms is bounded (rad); the tilt limit of the robot counts where it is larger, and a motion beyond violates it.
const MIN_BOUNDED_TILT: f64 = std::f64::consts::FRAC_PI_3;

/// Upper bounds of the travel of any point of an object per unit of each axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionBoundCoefficients {
    /// Travel per unit of each motor of the arms (m/m or m/rad).
    pub(crate) arms: [f64; MAX_AXES],
    /// Centripetal acceleration per squared speed of each motor (1/m or m/rad²).
    pub(crate) centripetal: [f64; MAX_AXES],
    /// Change of the deflection per unit of each motor of the arms (m/m or m/rad).
    pub(crate) deflection: [f64; MAX_AXES],
    /// Horizontal part of `deflection` (m/m or m/rad).
    pub(crate) lateral_deflection: [f64; MAX_AXES],
    /// Change of the deflection in the platform frame per rotation of the platform (m/rad).
    pub(crate) platform_deflection: f64,
    /// Largest distance of a point from the platform's origin without deflection (m).
    pub(super) rigid_radius: f64,
    /// Largest deflection of a point (m).
    max_deflection: f64,
}

/// Distances of an object's points from the places that it rotates about.
#[derive(Clone, Copy)]
struct ObjectExtent {
    parent: Parent,
    /// Largest distance from the origin of its parent (m).
    from_origin: f64,
    /// Largest distance from the centre of the wafer on its effector (m).
    from_center: f64,
}

impl ObjectExtent {
    /// # Arguments
    /// * `reach` – distance from the origin of the parent up to which points are relevant (m)
    fn new(cell: &Cell, object: &CollisionObject, reach: f64) -> Self {
        let from_origin = reach.min(object.collider.reach());
        let from_center = match object.parent {
            Parent::DeflectedLastLink(EffectorId { arm, effector }) => {
                let center = Vector3::from(cell.robot.arms[arm].effectors[effector].wafer_center);
                object.collider.reach_from(&center).min(from_origin + center.norm())
            }
            _ => from_origin,
        };
        Self { parent: object.parent, from_origin, from_center }
    }
}

impl MotionBoundCoefficients {
    /// Coefficients of a moving object.
    ///
    /// # Arguments
    /// * `reach` – distance from the origin of the parent up to which points are relevant: that of the farthest point, or less where no other object is farther out (m)
    pub(crate) fn new(cell: &Cell, object: &CollisionObject, reach: f64) -> Self {
        Self::with_deflection(cell, ObjectExtent::new(cell, object, reach), 0)
    }

    /// Largest distance of a point from the platform's origin, with deflection (m).
    pub(crate) fn radius(&self) -> f64 {
        self.rigid_radius + self.max_deflection
    }

    /// Coefficients of the centre of an effector's wafer.
    pub(crate) fn of_wafer_center(cell: &Cell, effector: EffectorId) -> Self {
        let parent = Parent::Effector(effector);
        let extent = ObjectExtent { parent, from_origin: 0.0, from_center: 0.0 };
        Self::with_deflection(cell, extent, 0)
    }

    /// Coefficients of the relative motion of two moving objects; joints up to the common ancestor move both alike and are excluded.
    ///
    /// # Arguments
    /// * `objects` – with their reaches, as in [`Self::new`]
    pub(crate) fn relative(
        cell: &Cell,
        objects: [(&CollisionObject, f64); 2],
        ancestor: Parent,
    ) -> Self {
        let common_joints = if let Parent::Link { link, .. } = ancestor { link + 1 } else { 0 };
        let [one, other] = objects.map(|(object, reach)| {
            Self::with_deflection(cell, ObjectExtent::new(cell, object, reach), common_joints)
        });
        let sum = |one: [f64; MAX_AXES], other: [f64; MAX_AXES]| {
            std::array::from_fn(|axis| one[axis] + other[axis])
        };
        Self {
            arms: sum(one.arms, other.arms),
            centripetal: sum(one.centripetal, other.centripetal),
            deflection: sum(one.deflection, other.deflection),
            lateral_deflection: sum(one.lateral_deflection, other.lateral_deflection),
            platform_deflection: one.platform_deflection + other.platform_deflection,
            rigid_radius: one.rigid_radius + other.rigid_radius,
            max_deflection: one.max_deflection + other.max_deflection,
        }
    }

    /// Coefficients by the joints after the first `common_joints`, and by the deflection of the arm, which all of its joints change.
    ///
    /// ```text
    ///    |δ̇|  ≤  d' |ṙ|  +  R (s' |ṙ| + s |u̇| + s |φ̇|)  +  |ψ̇| (d + R s)
    /// ```
    /// δ: deflection; d, s: drop and slope at the reach r; R: distance from the wafer's centre; u: direction across the reach; φ, ψ: rotations of the last link and of the common ancestor.
    fn with_deflection(cell: &Cell, extent: ObjectExtent, common_joints: usize) -> Self {
        let robot = &cell.robot;
        let ObjectExtent { parent, from_origin, from_center } = extent;
        let mut coefficients = Self::without_deflection(robot, parent, from_origin, common_joints);
        let (Parent::Effector(id) | Parent::DeflectedLastLink(id)) = parent else {
            return coefficients;
        };
        let arm = &robot.arms[id.arm];
        if arm.droop == Droop::Rigid {
            return coefficients;
        }
        // A rotation about the first joint does not change the reach.
        let first = usize::from(arm.joints[0].kind == AxisKind::Rotary);
        let center = Self::without_deflection(robot, Parent::Effector(id), 0.0, first).arms;
        let [at_first, at_last, at_common] =
            [first, arm.joints.len(), common_joints].map(|joints| rotation_ratios(arm, joints));
        let (droop, height) = (droop_bounds(cell, id), height_of(arm, id));
        let max_tilt = robot.gpr.limits().tilt_max.max(MIN_BOUNDED_TILT);
        let spread = (1.0 + height * max_tilt.sin() / MIN_REACH) / max_tilt.cos();
        let turn = droop.turn * spread;
        let size = droop.at.drop + from_center * droop.at.slope;
        for axis in 0..MAX_AXES {
            let rotated = droop.at.slope * (spread * at_first[axis] + at_last[axis]);
            let lateral = from_center * ((droop.rate.slope + turn) * center[axis] + rotated)
                + at_common[axis] * size;
            coefficients.lateral_deflection[axis] = lateral;
            coefficients.deflection[axis] = droop.rate.drop * center[axis] + lateral;
        }
        let from_first_joint = longest_reach(robot, id) + height;
        coefficients.platform_deflection =
            size + from_center * (droop.at.slope + turn * from_first_joint);
        coefficients.max_deflection = size;
        coefficients
    }

    /// Coefficients by the joints after the first `common_joints`, of a rigid arm.
    ///
    /// ```text
    ///    |v|  ≤  Σ_a |ȧ| Σ_g |m_ga| |v_g|        m_ga: rotation of link g per unit of axis a, |v_g|: its length
    /// ```
    /// The ratios are added with their signs along the chain: a wafer that a belt keeps from rotating has no coefficients about the joints that the belt compensates.
    ///
    /// # Arguments
    /// * `reach` – distance of the farthest point from the origin of the parent (m)
    fn without_deflection(
        robot: &HybridRobot,
        parent: Parent,
        reach: f64,
        common_joints: usize,
    ) -> Self {
        let (mut arms, mut centripetal) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        let Some((arm, joints)) = joints_of(robot, parent) else {
            return Self::rigid(arms, centripetal, reach);
        };
        let described = &robot.arms[arm];
        // The origin of a link is at its joint.
        let last_length = match parent {
            Parent::Effector(id) => {
                let [x, y, z] = described.effectors[id.effector].wafer_center;
                x.hypot(y).hypot(z) + reach
            }
            _ => reach,
        };
        let [x, y, z] = described.mount;
        let mut radius = x.hypot(y).hypot(z);
        let mut ratios = [0.0_f64; MAX_AXES];
        for (index, joint) in described.joints[..joints].iter().enumerate() {
            let is_last = index + 1 == joints;
            let length = if is_last { last_length } else { joint.length.hypot(joint.offset) };
            let length = length + max_extension(robot, joint);
            radius += length + joint.rise.abs();
            let sum: f64 = ratios.iter().map(|ratio| ratio.abs()).sum();
            for &(axis, ratio) in joint.drives.iter().filter(|_| index >= common_joints) {
                match joint.kind {
                    AxisKind::Rotary => ratios[axis] += ratio,
                    AxisKind::Linear => {
                        // Coriolis acceleration 2 ḋ φ̇ e_⊥, with 2 |ȧ| |ḃ| ≤ ȧ² + ḃ².
                        arms[axis] += ratio.abs();
                        centripetal[axis] += ratio.abs() * sum;
                        for (coefficient, turning) in centripetal.iter_mut().zip(&ratios) {
                            *coefficient += ratio.abs() * turning.abs();
                        }
                    }
                }
            }
            // φ̇²  ≤  Σ_a |m_a| ȧ² Σ_a |m_a|
            let sum: f64 = ratios.iter().map(|ratio| ratio.abs()).sum();
            for axis in 0..MAX_AXES {
                let ratio = ratios[axis].abs();
                arms[axis] += ratio * length;
                centripetal[axis] += ratio * sum * length;
            }
        }
        Self::rigid(arms, centripetal, radius)
    }

    fn rigid(arms: [f64; MAX_AXES], centripetal: [f64; MAX_AXES], rigid_radius: f64) -> Self {
        let (deflection, lateral_deflection) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        Self {
            arms,
            centripetal,
            deflection,
            lateral_deflection,
            platform_deflection: 0.0,
            rigid_radius,
            max_deflection: 0.0,
        }
    }
}

/// Upper bounds of the droop of an arm, loaded or not.
pub(crate) fn droop_bounds(cell: &Cell, id: EffectorId) -> DroopBounds {
    let reach = longest_reach(&cell.robot, id);
    cell.robot.arms[id.arm].droop.at_most(reach, cell.wafer.mass(), cell.gravity)
}

/// Largest distance of an effector's wafer from the first joint in the arm's plane (m).
fn longest_reach(robot: &HybridRobot, id: EffectorId) -> f64 {
    let arm = &robot.arms[id.arm];
    let [x, y, _] = arm.effectors[id.effector].wafer_center;
    let last = arm.joints.len() - 1;
    let links = arm.joints[..last].iter().map(|joint| joint.length.hypot(joint.offset));
    let slides = arm.joints.iter().map(|joint| max_extension(robot, joint));
    links.chain(slides).sum::<f64>() + x.hypot(y)
}

/// Distance of an effector's wafer from the plane of the first joint (m).
fn height_of(arm: &Arm, id: EffectorId) -> f64 {
    let rises: f64 = arm.joints.iter().map(|joint| joint.rise).sum();
    (rises + arm.effectors[id.effector].wafer_center[2]).abs()
}

/// Magnitude of the rotation after the first `joints` of an arm per unit of each axis.
fn rotation_ratios(arm: &Arm, joints: usize) -> [f64; MAX_AXES] {
    let mut ratios = [0.0_f64; MAX_AXES];
    for joint in arm.joints[..joints].iter().filter(|joint| joint.kind == AxisKind::Rotary) {
        joint.drives.iter().for_each(|&(axis, ratio)| ratios[axis] += ratio);
    }
    ratios.map(f64::abs)
}

/// The last body that carries two moving objects.
pub(crate) fn common_ancestor(
    robot: &HybridRobot,
    one: &CollisionObject,
    other: &CollisionObject,
) -> Parent {
    match (joints_of(robot, one.parent), joints_of(robot, other.parent)) {
        (Some((a, m)), Some((b, n))) if a == b => Parent::Link { arm: a, link: m.min(n) - 1 },
        (Some((a, _)), Some((b, _))) if share_proximal_axes(&robot.arms[a], &robot.arms[b]) => {
            Parent::Link { arm: a, link: 0 }
        }
        _ => Parent::Platform,
    }
}

/// Arm of a parent, and the number of joints between it and the platform.
fn joints_of(robot: &HybridRobot, parent: Parent) -> Option<(usize, usize)> {
    match parent {
        Parent::Link { arm, link } => Some((arm, link + 1)),
        Parent::Effector(id) | Parent::DeflectedLastLink(id) => {
            Some((id.arm, robot.arms[id.arm].joints.len()))
        }
        Parent::Platform | Parent::World | Parent::Slot(_) => None,
    }
}

/// Whether the first joints of two arms rotate about one axis with the same drives.
fn share_proximal_axes(one: &Arm, other: &Arm) -> bool {
    match (one.joints.first(), other.joints.first()) {
        (Some(first), Some(second)) => {
            one.mount[..2] == other.mount[..2]
                && first.kind == AxisKind::Rotary
                && second.kind == AxisKind::Rotary
                && first.drives == second.drives
        }
        _ => false,
    }
}

/// Largest extension of a prismatic joint (m).
fn max_extension(robot: &HybridRobot, joint: &ArmJoint) -> f64 {
    if joint.kind == AxisKind::Rotary {
        return 0.0;
    }
    let most: f64 = joint
        .drives
        .iter()
        .map(|&(axis, ratio)| {
            let axis = &robot.axes[axis];
            ratio.abs() * axis.min.abs().max(axis.max.abs())
        })
        .sum();
    joint.zero.abs() + most
}
