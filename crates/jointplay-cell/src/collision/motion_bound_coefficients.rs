//! Motion bound coefficients: upper bounds of the travel of any point of an object per unit of each axis.

use nalgebra::Vector3;

use super::deflection_coefficients::{DeflectionCoefficients, joints_of_constant_reach, max_slide};
use super::object::{CollisionObject, Parent};
use crate::robot::{Arm, AxisKind, EffectorId, HybridRobot, MAX_AXES};
use crate::workcell::Cell;

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
    /// What the coefficients of the deflection are computed from, for one or both objects on arms that deflect.
    pub(super) deflections: [Option<DeflectionCoefficients>; 2],
}

/// Largest distances of an object's points from the points that it rotates about.
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
    /// * `relevant_radius` – distance from the origin of the parent up to which points are relevant (m)
    fn new(cell: &Cell, object: &CollisionObject, relevant_radius: f64) -> Self {
        let from_origin = relevant_radius.min(object.collider.bounding_radius());
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
    /// * `relevant_radius` – distance from the origin of the parent up to which points are relevant: that of the farthest point, or less where no other object is farther out (m)
    pub(crate) fn new(cell: &Cell, object: &CollisionObject, relevant_radius: f64) -> Self {
        Self::with_deflection(cell, ObjectExtent::new(cell, object, relevant_radius), 0)
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

    /// Coefficients of the relative motion of two moving objects; joints up to the common ancestor move both alike and do not count.
    ///
    /// # Arguments
    /// * `objects` – with their relevant radii, as in [`Self::new`]
    pub(crate) fn relative(
        cell: &Cell,
        objects: [(&CollisionObject, f64); 2],
        ancestor: Parent,
    ) -> Self {
        let common_joints = if let Parent::Link { link, .. } = ancestor { link + 1 } else { 0 };
        let [one, other] = objects.map(|(object, relevant_radius)| {
            let extent = ObjectExtent::new(cell, object, relevant_radius);
            Self::with_deflection(cell, extent, common_joints)
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
            deflections: [one.deflections[0], other.deflections[0]],
        }
    }

    /// Coefficients by the joints after the first `common_joints`, and by the deflection of the arm, which all of its joints change.
    fn with_deflection(cell: &Cell, extent: ObjectExtent, common_joints: usize) -> Self {
        let robot = &cell.robot;
        let ObjectExtent { parent, from_origin, from_center } = extent;
        let mut coefficients = Self::without_deflection(robot, parent, from_origin, common_joints);
        let (Parent::Effector(id) | Parent::DeflectedLastLink(id)) = parent else {
            return coefficients;
        };
        let first = joints_of_constant_reach(&robot.arms[id.arm]);
        let center = Self::without_deflection(robot, Parent::Effector(id), 0.0, first).arms;
        let deflection = DeflectionCoefficients::new(robot, id, from_center, common_joints, center);
        let Some(deflection) = deflection else {
            return coefficients;
        };
        let droop = deflection.droop(cell);
        for axis in 0..MAX_AXES {
            let by_axis = deflection.by_axis(&droop, axis);
            coefficients.deflection[axis] = by_axis.total;
            coefficients.lateral_deflection[axis] = by_axis.lateral;
        }
        coefficients.platform_deflection = deflection.by_platform(&droop);
        coefficients.max_deflection = deflection.largest(&droop);
        coefficients.deflections = [Some(deflection), None];
        coefficients
    }

    /// Coefficients by the joints after the first `common_joints`, of a rigid arm.
    ///
    /// ```text
    ///    |v|  ≤  Σ_a |q̇_a| Σ_g |m_ga| |v_g|
    /// ```
    /// v: velocity of a point in the platform frame; q̇_a: velocity of axis a; m_ga: rotation of link g per unit of axis a (`ratios`); |v_g|: length of the link (`length`).
    /// The ratios are added with their signs along the chain: a wafer that a belt keeps from rotating has no coefficients about the joints that the belt compensates.
    ///
    /// # Arguments
    /// * `from_origin` – distance of the farthest point from the origin of the parent (m)
    fn without_deflection(
        robot: &HybridRobot,
        parent: Parent,
        from_origin: f64,
        common_joints: usize,
    ) -> Self {
        let (mut arms, mut centripetal) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        let Some((arm, joints)) = joints_of(robot, parent) else {
            return Self::rigid(arms, centripetal, from_origin);
        };
        let described = &robot.arms[arm];
        // The origin of a link is at its joint.
        let last_length = match parent {
            Parent::Effector(id) => {
                let [x, y, z] = described.effectors[id.effector].wafer_center;
                x.hypot(y).hypot(z) + from_origin
            }
            _ => from_origin,
        };
        let [x, y, z] = described.mount;
        let mut radius = x.hypot(y).hypot(z);
        let mut ratios = [0.0_f64; MAX_AXES];
        for (index, joint) in described.joints[..joints].iter().enumerate() {
            let is_last = index + 1 == joints;
            let length = if is_last { last_length } else { joint.length.hypot(joint.offset) };
            let length = length + max_slide(robot, joint);
            radius += length + joint.rise.abs();
            let sum: f64 = ratios.iter().map(|ratio| ratio.abs()).sum();
            for &(axis, ratio) in joint.drives.iter().filter(|_| index >= common_joints) {
                match joint.kind {
                    AxisKind::Rotary => ratios[axis] += ratio,
                    AxisKind::Linear => {
                        // Coriolis acceleration 2 l̇ φ̇ e_⊥ of a slide l on a link at the angle φ, with 2 |q̇_a| |q̇_b| ≤ q̇_a² + q̇_b².
                        arms[axis] += ratio.abs();
                        centripetal[axis] += ratio.abs() * sum;
                        for (coefficient, turning) in centripetal.iter_mut().zip(&ratios) {
                            *coefficient += ratio.abs() * turning.abs();
                        }
                    }
                }
            }
            // φ̇²  ≤  Σ_a |m_a| q̇_a² Σ_a |m_a|, φ: angle of this link.
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
            deflections: [None; 2],
        }
    }
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
