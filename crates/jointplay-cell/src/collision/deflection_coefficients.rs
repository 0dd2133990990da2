//! Motion bound coefficients of the deflection of arms, for any bounds of the droop.

use crate::robot::{Arm, ArmJoint, AxisKind, EffectorId, HybridRobot, MAX_AXES};
use crate::wafer::{Droop, DroopBounds, MIN_REACH};
use crate::workcell::Cell;

/// Tilt up to which the motion of deflected arms is bounded at least (rad).
///
/// Bounds hold up to the larger of this tilt and the robot's limit; the check reports a tilt beyond that limit as a violation.
const MIN_BOUNDED_TILT: f64 = std::f64::consts::FRAC_PI_3;

/// Upper bounds of the change of a deflection.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DeflectionBound {
    /// In any direction (m, or per unit of an axis).
    pub(crate) total: f64,
    /// Horizontal part (m, or per unit of an axis).
    pub(crate) lateral: f64,
}

/// Quantities that bound the change of an object's deflection, without the droop itself.
///
/// ```text
///    |δ̇|  ≤  f' |ϱ̇|  +  a (φ' |ϱ̇| + φ |v̇| / max(|v|, r₀) + φ |ψ̇|)  +  |ω| (f + a φ)
/// ```
/// Symbols as in the chapter "Deflection" of `docs/explanation/collision-guarantee.md`:
/// δ: displacement of a point by the deflection; a: its distance from the wafer's centre (`from_center`); ϱ: reach, the extension of the arm from its first joint to that centre;
/// f, φ: drop and slope at the reach (`droop.value`), f', φ': their derivatives with respect to it (`droop.by_reach`); v: horizontal part of the reach, r₀: [`MIN_REACH`], with φ / max(|v|, r₀) ≤ `slope_per_reach`;
/// ψ: rotation of the last link; ω: rotation of the common ancestor (`at_common`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct DeflectionCoefficients {
    effector: EffectorId,
    /// Largest distance of a point from the centre of the wafer (m).
    from_center: f64,
    /// Travel of the wafer's centre relative to the first joint per unit of each axis (m/m or m/rad).
    center: [f64; MAX_AXES],
    /// Rotations by the first joint, inflated by `spread`, and of the last link per unit of each axis.
    rotation: [f64; MAX_AXES],
    /// Rotation of the common ancestor per unit of each axis.
    at_common: [f64; MAX_AXES],
    /// Factor by which v̇ may exceed its value on a level platform.
    spread: f64,
    /// Largest extension of the arm (m).
    max_extension: f64,
    /// Largest distance of the wafer's centre from the first joint (m).
    from_first_joint: f64,
}

impl DeflectionCoefficients {
    /// Coefficients of an object on the last link of an arm, or of the wafer there; `None` where the arm is rigid.
    ///
    /// # Arguments
    /// * `from_center` – largest distance of a point from the centre of the wafer (m)
    /// * `common_joints` – number of joints up to the common ancestor
    /// * `center` – travel of the wafer's centre relative to the first joint per unit of each axis (m/m or m/rad)
    pub(super) fn new(
        robot: &HybridRobot,
        id: EffectorId,
        from_center: f64,
        common_joints: usize,
        center: [f64; MAX_AXES],
    ) -> Option<Self> {
        let arm = &robot.arms[id.arm];
        if arm.droop == Droop::Rigid {
            return None;
        }
        let first = joints_of_constant_reach(arm);
        let [at_first, at_last, at_common] =
            [first, arm.joints.len(), common_joints].map(|joints| rotation_ratios(arm, joints));
        let height = height_of(arm, id);
        let max_tilt = robot.gpr.limits().tilt_max.max(MIN_BOUNDED_TILT);
        let spread = (1.0 + height * max_tilt.sin() / MIN_REACH) / max_tilt.cos();
        let max_extension = max_extension(robot, id);
        Some(Self {
            effector: id,
            from_center,
            center,
            rotation: std::array::from_fn(|axis| spread * at_first[axis] + at_last[axis]),
            at_common,
            spread,
            max_extension,
            from_first_joint: max_extension + height,
        })
    }

    /// The effector at which the arm deflects.
    pub(super) fn effector(&self) -> EffectorId {
        self.effector
    }

    /// Largest deflection of a point (m).
    pub(super) fn largest(&self, droop: &DroopBounds) -> f64 {
        droop.value.drop + self.from_center * droop.value.slope
    }

    /// Change of the deflection in the platform frame per rotation of the platform (m/rad).
    pub(super) fn by_platform(&self, droop: &DroopBounds) -> f64 {
        let turn = droop.slope_per_reach * self.spread;
        let rotated = droop.value.slope + turn * self.from_first_joint;
        self.largest(droop) + self.from_center * rotated
    }

    /// Change of the deflection per unit of an axis (m/m or m/rad).
    pub(super) fn by_axis(&self, droop: &DroopBounds, axis: usize) -> DeflectionBound {
        let turn = droop.slope_per_reach * self.spread;
        let rotated = droop.value.slope * self.rotation[axis];
        let lateral = self.from_center
            * ((droop.by_reach.slope + turn) * self.center[axis] + rotated)
            + self.at_common[axis] * self.largest(droop);
        DeflectionBound { total: droop.by_reach.drop * self.center[axis] + lateral, lateral }
    }

    /// Upper bounds of the droop at all reaches of the arm, loaded or not.
    pub(super) fn droop(&self, cell: &Cell) -> DroopBounds {
        self.droop_up_to(cell, self.max_extension)
    }

    fn droop_up_to(&self, cell: &Cell, reach: f64) -> DroopBounds {
        cell.robot.arms[self.effector.arm].droop.at_most(reach, cell.wafer.mass(), cell.gravity)
    }

    /// Change of the deflection in an interval, by the droop at its largest reach.
    ///
    /// # Arguments
    /// * `reach` – larger reach of the arm at both ends of the interval (m)
    /// * `paths` – each axis that moves, with its travel (m or rad)
    pub(super) fn in_interval(
        &self,
        cell: &Cell,
        reach: f64,
        paths: impl Iterator<Item = (usize, f64)> + Clone,
    ) -> DeflectionBound {
        let travelled: f64 = paths.clone().map(|(axis, path)| self.center[axis] * path).sum();
        // Between the ends the centre is no farther out than by half of its travel.
        let droop = self.droop_up_to(cell, (reach + 0.5 * travelled).min(self.max_extension));
        let mut bound = DeflectionBound::default();
        for (axis, path) in paths {
            let by_axis = self.by_axis(&droop, axis);
            bound.total += by_axis.total * path;
            bound.lateral += by_axis.lateral * path;
        }
        bound
    }
}

/// Number of joints at the start of an arm that do not change its reach: a rotation about the first joint does not.
pub(super) fn joints_of_constant_reach(arm: &Arm) -> usize {
    usize::from(arm.joints[0].kind == AxisKind::Rotary)
}

/// Upper bounds of the droop of an arm, loaded or not.
pub(crate) fn droop_bounds(cell: &Cell, id: EffectorId) -> DroopBounds {
    let extension = max_extension(&cell.robot, id);
    cell.robot.arms[id.arm].droop.at_most(extension, cell.wafer.mass(), cell.gravity)
}

/// Largest extension of an arm: distance of the wafer's centre from the first joint in the arm's plane (m).
fn max_extension(robot: &HybridRobot, id: EffectorId) -> f64 {
    let arm = &robot.arms[id.arm];
    let [x, y, _] = arm.effectors[id.effector].wafer_center;
    let last = arm.joints.len() - 1;
    let links = arm.joints[..last].iter().map(|joint| joint.length.hypot(joint.offset));
    let slides = arm.joints.iter().map(|joint| max_slide(robot, joint));
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

/// Largest displacement of a prismatic joint (m).
pub(super) fn max_slide(robot: &HybridRobot, joint: &ArmJoint) -> f64 {
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
