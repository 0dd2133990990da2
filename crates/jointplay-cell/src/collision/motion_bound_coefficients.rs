//! How far points of what moves go by each axis, at most.

use nalgebra::Vector3;

use super::object::{Holder, Item};
use crate::robot::{Arm, ArmJoint, AxisKind, EffectorId, HybridRobot, MAX_AXES};
use crate::wafer::{Droop, DroopBounds, SHORTEST};
use crate::workcell::Cell;

/// Tilt up to which deflected arms are bounded, where the robot may not tilt farther: a motion beyond breaks the tilt limit anyway [rad].
const STEEPEST: f64 = std::f64::consts::FRAC_PI_3;

/// How far points of one item go by the axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Levers {
    /// By each motor of the arms [m/m or m/rad].
    pub(crate) arms: [f64; MAX_AXES],
    /// By the square of its speed, how hard they bend from straight [1/m or m/rad²].
    pub(crate) turns: [f64; MAX_AXES],
    /// Change of the deflection by each motor of the arms [m/m or m/rad].
    pub(crate) droops: [f64; MAX_AXES],
    /// Of that, in other directions than up and down.
    pub(crate) asides: [f64; MAX_AXES],
    /// Change of the deflection as seen from the platform by the rotation of the platform [m/rad].
    pub(crate) hang: f64,
    /// Largest distance of a point of the rigid robot from the platform's origin [m].
    pub(crate) far: f64,
    /// Largest deflection of a point [m].
    deflection: f64,
}

/// How far an item's points are from the places that it turns about.
#[derive(Clone, Copy)]
struct Extent {
    holder: Holder,
    /// From the origin of what holds it, at most [m].
    origin: f64,
    /// From the centre of the wafer on its effector, at most [m].
    center: f64,
}

impl Extent {
    /// # Arguments
    /// * `reach` – distance from the origin of what holds the item, up to which its points count [m]
    fn new(cell: &Cell, item: &Item, reach: f64) -> Self {
        let origin = reach.min(item.solid.reach());
        let center = match item.holder {
            Holder::Tip(EffectorId { arm, effector }) => {
                let center = Vector3::from(cell.robot.arms[arm].effectors[effector].wafer_center);
                item.solid.reach_from(&center).min(origin + center.norm())
            }
            _ => origin,
        };
        Self { holder: item.holder, origin, center }
    }
}

impl Levers {
    /// Of an item that moves.
    ///
    /// # Arguments
    /// * `reach` – distance from the origin of what holds it, up to which its points count: that of its farthest point, or less where no other item is farther out [m]
    pub(crate) fn new(cell: &Cell, item: &Item, reach: f64) -> Self {
        Self::beyond(cell, Extent::new(cell, item, reach), 0)
    }

    /// Largest distance of a point from the platform's origin, the arm deflected [m].
    pub(crate) fn farthest(&self) -> f64 {
        self.far + self.deflection
    }

    /// Of the centre of an effector's wafer.
    pub(crate) fn of_center(cell: &Cell, effector: EffectorId) -> Self {
        let holder = Holder::Effector(effector);
        Self::beyond(cell, Extent { holder, origin: 0.0, center: 0.0 }, 0)
    }

    /// Of two items that move, against each other: what carries both alike counts for neither.
    ///
    /// # Arguments
    /// * `both` – with their reaches, as in [`Self::new`]
    pub(crate) fn between(cell: &Cell, both: [(&Item, f64); 2], common: Holder) -> Self {
        let common = if let Holder::Link { link, .. } = common { link + 1 } else { 0 };
        let [one, other] =
            both.map(|(item, reach)| Self::beyond(cell, Extent::new(cell, item, reach), common));
        let both = |one: [f64; MAX_AXES], other: [f64; MAX_AXES]| {
            std::array::from_fn(|axis| one[axis] + other[axis])
        };
        Self {
            arms: both(one.arms, other.arms),
            turns: both(one.turns, other.turns),
            droops: both(one.droops, other.droops),
            asides: both(one.asides, other.asides),
            hang: one.hang + other.hang,
            far: one.far + other.far,
            deflection: one.deflection + other.deflection,
        }
    }

    /// By joints from a place on, and by the deflection of the arm, which all of its joints change.
    ///
    /// ```text
    ///    |δ̇|  ≤  d' |ṙ|  +  R (s' |ṙ| + s |u̇| + s |φ̇|)  +  |ψ̇| (d + R s)
    /// ```
    /// δ: deflection; d, s: drop and slope by the reach r; R: distance from the wafer's centre; u: direction across the reach; φ, ψ: turns of the last link and of what carries both.
    /// See "Trajectory bounds" in `docs/explanation/collision-guarantee.md`.
    fn beyond(cell: &Cell, extent: Extent, common: usize) -> Self {
        let robot = &cell.robot;
        let Extent { holder, origin, center: radius } = extent;
        let mut levers = Self::by_joints(robot, (holder, origin), common);
        let (Holder::Effector(id) | Holder::Tip(id)) = holder else { return levers };
        let arm = &robot.arms[id.arm];
        if arm.droop == Droop::Rigid {
            return levers;
        }
        // Turned about its first joint, an arm keeps its reach.
        let first = usize::from(arm.joints[0].kind == AxisKind::Rotary);
        let center = Self::by_joints(robot, (Holder::Effector(id), 0.0), first).arms;
        let [at_first, at_last, at_common] =
            [first, arm.joints.len(), common].map(|joints| turning(arm, joints));
        let (most, height) = (droop_bounds(cell, id), height_of(arm, id));
        let steepest = robot.gpr.limits().tilt_max.max(STEEPEST);
        let spread = (1.0 + height * steepest.sin() / SHORTEST) / steepest.cos();
        let swing = most.turn * spread;
        let size = most.at.drop + radius * most.at.slope;
        for axis in 0..MAX_AXES {
            let turned = most.at.slope * (spread * at_first[axis] + at_last[axis]);
            let aside = radius * ((most.rate.slope + swing) * center[axis] + turned)
                + at_common[axis] * size;
            levers.asides[axis] = aside;
            levers.droops[axis] = most.rate.drop * center[axis] + aside;
        }
        let out = longest_reach(robot, id) + height;
        levers.hang = size + radius * (most.at.slope + swing * out);
        levers.deflection = size;
        levers
    }

    /// By joints from a place on.
    ///
    /// ```text
    ///    |v|  ≤  Σ_a |ȧ| Σ_g |m_ga| |v_g|        m_ga: turning of link g by axis a, |v_g|: its length
    /// ```
    /// so that a wafer that a belt keeps from turning has none of the levers that it would have about each joint.
    ///
    /// # Arguments
    /// * `reach` – of the farthest point from the origin of what holds it [m]
    fn by_joints(robot: &HybridRobot, (holder, reach): (Holder, f64), common: usize) -> Self {
        let (mut arms, mut turns) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        let Some((arm, joints)) = joints_of(robot, holder) else {
            return Self::rigid(arms, turns, reach);
        };
        let described = &robot.arms[arm];
        // Of a link, its origin is the joint.
        let own = match holder {
            Holder::Effector(id) => {
                let [x, y, z] = described.effectors[id.effector].wafer_center;
                x.hypot(y).hypot(z) + reach
            }
            _ => reach,
        };
        let [x, y, z] = described.mount;
        let mut far = x.hypot(y).hypot(z);
        let mut turning = [0.0_f64; MAX_AXES];
        for (place, joint) in described.joints[..joints].iter().enumerate() {
            let length = if place + 1 < joints { joint.length.hypot(joint.offset) } else { own };
            let length = length + slide(robot, joint);
            far += length + joint.rise.abs();
            let whole: f64 = turning.iter().map(|turning| turning.abs()).sum();
            for &(axis, ratio) in joint.drives.iter().filter(|_| place >= common) {
                match joint.kind {
                    AxisKind::Rotary => turning[axis] += ratio,
                    AxisKind::Linear => {
                        // 2 ḋ φ̇ e_⊥, and 2 |ȧ| |ḃ| ≤ ȧ² + ḃ².
                        arms[axis] += ratio.abs();
                        turns[axis] += ratio.abs() * whole;
                        for (lever, turning) in turns.iter_mut().zip(&turning) {
                            *lever += ratio.abs() * turning.abs();
                        }
                    }
                }
            }
            // φ̇²  ≤  Σ_a |m_a| ȧ² Σ_a |m_a|
            let whole: f64 = turning.iter().map(|turning| turning.abs()).sum();
            for axis in 0..MAX_AXES {
                let turning = turning[axis].abs();
                arms[axis] += turning * length;
                turns[axis] += turning * whole * length;
            }
        }
        Self::rigid(arms, turns, far)
    }

    fn rigid(arms: [f64; MAX_AXES], turns: [f64; MAX_AXES], far: f64) -> Self {
        let (droops, asides) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        Self { arms, turns, droops, asides, hang: 0.0, far, deflection: 0.0 }
    }
}

/// How an arm droops at most, with an effector's wafer or without.
pub(crate) fn droop_bounds(cell: &Cell, id: EffectorId) -> DroopBounds {
    let reach = longest_reach(&cell.robot, id);
    cell.robot.arms[id.arm].droop.at_most(reach, cell.wafer.mass(), cell.gravity)
}

/// Distance of an effector's wafer from the first joint within the arm's plane, at most [m].
fn longest_reach(robot: &HybridRobot, id: EffectorId) -> f64 {
    let arm = &robot.arms[id.arm];
    let [x, y, _] = arm.effectors[id.effector].wafer_center;
    let last = arm.joints.len() - 1;
    let links = arm.joints[..last].iter().map(|joint| joint.length.hypot(joint.offset));
    let slides = arm.joints.iter().map(|joint| slide(robot, joint));
    links.chain(slides).sum::<f64>() + x.hypot(y)
}

/// Distance of an effector's wafer from the plane of the first joint [m].
fn height_of(arm: &Arm, id: EffectorId) -> f64 {
    let rises: f64 = arm.joints.iter().map(|joint| joint.rise).sum();
    (rises + arm.effectors[id.effector].wafer_center[2]).abs()
}

/// Turn of what comes after so many joints of an arm, by each axis, without signs.
fn turning(arm: &Arm, joints: usize) -> [f64; MAX_AXES] {
    let mut turning = [0.0_f64; MAX_AXES];
    for joint in arm.joints[..joints].iter().filter(|joint| joint.kind == AxisKind::Rotary) {
        joint.drives.iter().for_each(|&(axis, ratio)| turning[axis] += ratio);
    }
    turning.map(f64::abs)
}

/// What carries two items that move alike, the last of it.
pub(crate) fn common(robot: &HybridRobot, one: &Item, other: &Item) -> Holder {
    match (joints_of(robot, one.holder), joints_of(robot, other.holder)) {
        (Some((a, m)), Some((b, n))) if a == b => Holder::Link { arm: a, link: m.min(n) - 1 },
        (Some((a, _)), Some((b, _))) if begin_alike(&robot.arms[a], &robot.arms[b]) => {
            Holder::Link { arm: a, link: 0 }
        }
        _ => Holder::Platform,
    }
}

/// The arm that a holder belongs to, and how many of its joints come before it.
fn joints_of(robot: &HybridRobot, holder: Holder) -> Option<(usize, usize)> {
    match holder {
        Holder::Link { arm, link } => Some((arm, link + 1)),
        Holder::Effector(id) | Holder::Tip(id) => Some((id.arm, robot.arms[id.arm].joints.len())),
        Holder::Platform | Holder::World | Holder::Slot(_) => None,
    }
}

/// Whether the first joints of two arms turn about one axis, and alike.
fn begin_alike(one: &Arm, other: &Arm) -> bool {
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

/// The farthest that a joint slides out [m].
fn slide(robot: &HybridRobot, joint: &ArmJoint) -> f64 {
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
