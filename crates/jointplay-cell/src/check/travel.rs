//! How far what moves can have gone between two samples, at most.

use std::ops::Range;

use super::scene::{Holder, Item};
use crate::cell::Cell;
use crate::motion::{State, Track};
use crate::robot::{Arm, ArmJoint, EffectorId, HybridRobot, MAX_AXES, MotionKind, RODS};
use crate::wafer::DroopBounds;

/// Slack for what the bounds leave out: the platform's shift and twist by its tilt, of the size of the tilt.
const SLACK: f64 = 1.1;

/// How far points of one item go by the axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levers {
    /// By each motor of the arms [m/m or m/rad].
    arms: [f64; MAX_AXES],
    /// By the square of its speed, how hard they bend from straight [1/m or m/rad²].
    turns: [f64; MAX_AXES],
    /// What each motor of the arms does to how a wafer droops, all but turn it about the first joint [m/m or m/rad].
    droops: [f64; MAX_AXES],
    /// Of that, in other directions than up and down.
    asides: [f64; MAX_AXES],
    /// What drooping does as seen from the platform when that leans [m/rad].
    hang: f64,
    /// Largest distance of a point from the platform's origin [m].
    far: f64,
}

/// How far points of an item went, at most.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Travel {
    /// By the rods [m].
    pub(super) plane: f64,
    /// By the arms, parallel to the platform [m].
    pub(super) arm: f64,
    /// By drooping otherwise than before, as the reach changed [m].
    pub(super) droop: f64,
    /// Of that, in other directions than up and down [m].
    pub(super) aside: f64,
    /// By drooping as seen from the platform, which leaned [m].
    pub(super) hang: f64,
}

impl Travel {
    pub(super) fn total(self) -> f64 {
        self.plane + self.arm + self.droop
    }
}

/// What all axes did between two samples, at most.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moved {
    /// Path of each axis [m or rad].
    axes: [f64; MAX_AXES],
    /// ∫|q̈| dt of each [m/s or rad/s].
    hurries: [f64; MAX_AXES],
    /// ∫q̇² dt of each [m²/s or rad²/s].
    squares: [f64; MAX_AXES],
    /// Path of the platform's height over its origin [m].
    height: f64,
    /// Angle that its normal turned by [rad].
    pub(super) lean: f64,
}

/// How far everything has come by each sample of a step, at most.
#[derive(Default)]
pub(super) struct Odometer {
    /// Of each axis that moves, in the order of the track: path, ∫|q̈| dt and ∫q̇² dt; there may be more than there are.
    axes: Vec<Vec<[f64; 3]>>,
    /// Of the platform, while rods move: path of its height, and angle that its normal turned by.
    platform: Vec<[f64; 2]>,
}

impl Odometer {
    /// Takes up a step.
    pub(super) fn take(&mut self, gearing: &Gearing, times: &[f64], track: &Track) {
        let (moving, states) = (track.moving(), track.states());
        if self.axes.len() < moving.len() {
            self.axes.resize_with(moving.len(), Vec::new);
        }
        self.platform.clear();
        if moving.first().is_some_and(|&axis| axis < RODS) {
            self.platform.resize(times.len(), [0.0; 2]);
        }
        for (place, (&axis, states)) in moving.iter().zip(states).enumerate() {
            let by = &mut self.axes[place];
            by.clear();
            let mut all = [0.0; 3];
            by.push(all);
            for (k, pair) in states.windows(2).enumerate() {
                let dt = times[k + 1] - times[k];
                let [speed, hurry] = gearing.most(dt, axis, [&pair[0], &pair[1]]);
                let path = dt * speed;
                for (sum, more) in all.iter_mut().zip([path, dt * hurry, path * speed]) {
                    *sum += more;
                }
                by.push(all);
                if axis < RODS {
                    let [height, _] = &mut self.platform[k + 1];
                    *height = height.max(path);
                }
            }
        }
        if !self.platform.is_empty() {
            self.lean(gearing, times, track);
        }
    }

    /// Sums up what the rods do to the platform: its height is theirs, weighted, and its normal turns as they go unevenly.
    fn lean(&mut self, gearing: &Gearing, times: &[f64], track: &Track) {
        let rods: [Option<&Vec<State>>; RODS] = std::array::from_fn(|rod| {
            let place = track.moving().iter().position(|&axis| axis == rod)?;
            Some(&track.states()[place])
        });
        let of =
            |sample: usize| rods.map(|states| states.map_or([0.0; 4], |states| states[sample]));
        let mut first = of(0);
        let mut all = [0.0; 2];
        for k in 1..times.len() {
            let last = of(k);
            all[0] += gearing.weights * self.platform[k][0];
            all[1] += gearing.lean(times[k] - times[k - 1], [&first, &last]);
            self.platform[k] = all;
            first = last;
        }
    }

    /// What all axes did between two samples, at most.
    pub(super) fn moved(&self, track: &Track, between: &Range<usize>) -> Moved {
        let mut moved = Moved::default();
        let (from, to) = (between.start, between.end);
        for (&axis, by) in track.moving().iter().zip(&self.axes) {
            let [path, hurry, square] = std::array::from_fn(|k| by[to][k] - by[from][k]);
            (moved.axes[axis], moved.hurries[axis], moved.squares[axis]) = (path, hurry, square);
        }
        if let (Some(last), Some(first)) = (self.platform.get(to), self.platform.get(from)) {
            (moved.height, moved.lean) = (last[0] - first[0], last[1] - first[1]);
        }
        moved
    }
}

/// The base triangle, as far as it gears rods to the platform.
pub(super) struct Gearing {
    /// Sum of the absolute weights by which the rods lift the platform's origin.
    weights: f64,
    /// Heights of the base triangle over each side [m], at the corner of each rod.
    heights: [f64; RODS],
    radius: f64,
    /// Largest jerk that the limits of each axis allow: samples do not show what it is between them [m/s³ or rad/s³].
    jerks: [f64; MAX_AXES],
}

impl Gearing {
    pub(super) fn new(robot: &HybridRobot) -> Self {
        let b = robot.gpr.base_points();
        let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let corner = |k: usize| [b[k].x, b[k].y];
        let whole = area(corner(0), corner(1), corner(2));
        let origin = [0.0, 0.0];
        let weight = |k: usize| area(corner((k + 1) % 3), corner((k + 2) % 3), origin) / whole;
        let side = |k: usize| (b[(k + 1) % 3] - b[(k + 2) % 3]).norm();
        let mut jerks = [0.0; MAX_AXES];
        for (jerk, axis) in jerks.iter_mut().zip(&robot.axes) {
            *jerk = axis.empty.jerk.max(axis.loaded.jerk);
        }
        Self {
            jerks,
            weights: (0..RODS).map(|k| weight(k).abs()).sum(),
            heights: [0, 1, 2].map(|k| whole.abs() / side(k)),
            radius: b.iter().map(|point| point.norm()).fold(0.0, f64::max),
        }
    }

    /// Distance of the platform's origin from that of the base, at most [m].
    pub(super) fn highest(&self, robot: &HybridRobot) -> f64 {
        let rods = robot.axes[..RODS].iter().map(|rod| rod.min.abs().max(rod.max.abs()));
        self.weights * rods.fold(0.0, f64::max) + self.radius
    }

    /// Speed [m/s or rad/s] and acceleration [m/s² or rad/s²] of an axis between two samples, at most.
    fn most(&self, dt: f64, axis: usize, [from, to]: [&State; 2]) -> [f64; 2] {
        let jerk = self.jerks[axis].max(from[3].abs()).max(to[3].abs());
        let hurry = most(dt, [from[2], to[2]], jerk);
        let speed = most(dt, [from[1], to[1]], hurry);
        [speed, hurry]
    }

    /// The angle that the platform's normal turned by between two samples, at most [rad].
    fn lean(&self, dt: f64, [from, to]: [&[State; RODS]; 2]) -> f64 {
        let off = |states: &[State; RODS], order: usize| -> [f64; RODS] {
            let mean = (states[0][order] + states[1][order] + states[2][order]) / 3.0;
            std::array::from_fn(|rod| states[rod][order] - mean)
        };
        let velocities = [from, to].map(|states| off(states, 1));
        let accelerations = [from, to].map(|states| off(states, 2));
        let jerk_of = |rod: usize| self.jerks[rod].max(from[rod][3].abs()).max(to[rod][3].abs());
        let jerk = 2.0 * (0..RODS).map(jerk_of).fold(0.0, f64::max);
        let turned = |rod: usize| {
            let hurry = most(dt, accelerations.map(|of| of[rod]), jerk);
            let speed = most(dt, velocities.map(|of| of[rod]), hurry);
            SLACK * dt * speed / self.heights[rod]
        };
        (0..RODS).map(turned).sum()
    }

    /// How much the platform's normal turns as the rods go so unevenly, or how fast where these are rates, at most [rad, or that by time].
    pub(super) fn leaning(&self, rods: &[f64; RODS]) -> f64 {
        let mean = (rods[0] + rods[1] + rods[2]) / 3.0;
        SLACK * (0..RODS).map(|rod| (rods[rod] - mean).abs() / self.heights[rod]).sum::<f64>()
    }

    /// How much the platform's origin goes up or down as the rods go so, at most [m, or that by time].
    pub(super) fn lift(&self, rods: &[f64; RODS]) -> f64 {
        self.weights * rods.iter().fold(0.0, |most: f64, rod| most.max(rod.abs()))
    }

    /// How far points of an item went, at most.
    pub(super) fn travel(&self, levers: &Levers, moved: &Moved) -> Travel {
        let plane = moved.height + moved.lean * (levers.far + 0.5 * self.radius);
        let by = |levers: &[f64; MAX_AXES]| -> f64 {
            levers.iter().zip(&moved.axes).map(|(lever, path)| lever * path).sum()
        };
        let hang = moved.lean * levers.hang;
        let [arm, droop, aside] = [&levers.arms, &levers.droops, &levers.asides].map(by);
        let [plane, arm, droop, aside, hang] =
            [plane, arm, droop, aside, hang].map(|way| SLACK * way);
        Travel { plane, arm, droop, aside, hang }
    }

    /// How fast the arms' part of the way of a point changed, in all [m/s].
    ///
    /// ```text
    ///    p̈  =  Σ_g |v_g| (φ̈_g e_⊥ - φ̇_g² e)         g: links from the first that moves on, φ_g: angle of each
    /// ```
    pub(super) fn bend(&self, levers: &Levers, moved: &Moved) -> f64 {
        let each = |levers: &[f64; MAX_AXES], moved: &[f64; MAX_AXES]| -> f64 {
            levers.iter().zip(moved).map(|(lever, moved)| lever * moved).sum()
        };
        SLACK * (each(&levers.arms, &moved.hurries) + each(&levers.turns, &moved.squares))
    }
}

/// What lies between two values, at most, of something that changes no faster than so.
///
/// Speeds bounded so bound the way in any part of the interval by that part of it: in half of the time no more than half.
fn most(dt: f64, [first, last]: [f64; 2], rate: f64) -> f64 {
    0.5 * (first.abs() + last.abs() + dt * rate)
}

impl Levers {
    /// Of an item that moves.
    ///
    /// # Arguments
    /// * `reach` – distance from the origin of what holds it, up to which its points count: that of its farthest point, or less where no other item is farther out [m]
    pub(super) fn new(cell: &Cell, item: &Item, reach: f64) -> Self {
        Self::beyond(cell, (item.holder, reach), 0)
    }

    /// Largest distance of a point from the platform's origin [m].
    pub(super) fn far(&self) -> f64 {
        self.far
    }

    /// Of the centre of an effector's wafer.
    pub(super) fn of_center(cell: &Cell, effector: EffectorId) -> Self {
        Self::beyond(cell, (Holder::Effector(effector), 0.0), 0)
    }

    /// Of two items that move, against each other: what carries both alike counts for neither.
    ///
    /// # Arguments
    /// * `both` – with their reaches, as in [`Self::new`]
    pub(super) fn between(cell: &Cell, both: [(&Item, f64); 2], common: Holder) -> Self {
        let common = if let Holder::Link { link, .. } = common { link + 1 } else { 0 };
        let [one, other] = both.map(|(it, reach)| Self::beyond(cell, (it.holder, reach), common));
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
        }
    }

    /// By joints from a place on, and by how a wafer droops by all.
    ///
    /// ```text
    ///    |v|  ≤  d' |ṙ|  +  R (s' |ṙ| + s |φ̇|)  +  s |v_arm|,   |φ̇|  ≤  |ṙ| / r        d, s: drop and slope, r: reach, R: radius of the item
    /// ```
    fn beyond(cell: &Cell, (holder, radius): (Holder, f64), common: usize) -> Self {
        let robot = &cell.robot;
        let mut levers = Self::by_joints(robot, (holder, radius), common);
        if let Holder::Effector(id) = holder {
            // Turned about its first joint, an arm droops as before.
            let turns = usize::from(robot.arms[id.arm].joints[0].kind == MotionKind::Turn);
            let [center, point] =
                [0.0, radius].map(|radius| Self::by_joints(robot, (holder, radius), turns).arms);
            let most = droop_bounds(cell, id);
            for axis in 0..MAX_AXES {
                let tipped = radius * (most.rate.slope + most.turn) * center[axis];
                levers.asides[axis] = tipped;
                levers.droops[axis] =
                    most.rate.drop * center[axis] + tipped + most.at.slope * point[axis];
            }
            levers.hang = most.at.drop + radius * most.at.slope;
        }
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
                    MotionKind::Turn => turning[axis] += ratio,
                    MotionKind::Slide => {
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
        Self { arms, turns, droops, asides, hang: 0.0, far }
    }
}

/// How an arm droops at most, with an effector's wafer or without.
pub(super) fn droop_bounds(cell: &Cell, id: EffectorId) -> DroopBounds {
    let (robot, arm) = (&cell.robot, &cell.robot.arms[id.arm]);
    let [x, y, _] = arm.effectors[id.effector].wafer_center;
    let last = arm.joints.len() - 1;
    let links = arm.joints[..last].iter().map(|joint| joint.length.hypot(joint.offset));
    let slides = arm.joints.iter().map(|joint| slide(robot, joint));
    let reach = links.chain(slides).sum::<f64>() + x.hypot(y);
    arm.droop.at_most(reach, cell.wafer.mass(), cell.gravity)
}

/// What carries two items that move alike, the last of it.
pub(super) fn common(robot: &HybridRobot, one: &Item, other: &Item) -> Holder {
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
        Holder::Effector(id) => Some((id.arm, robot.arms[id.arm].joints.len())),
        Holder::Platform | Holder::World | Holder::Slot(_) => None,
    }
}

/// Whether the first joints of two arms turn about one axis, and alike.
fn begin_alike(one: &Arm, other: &Arm) -> bool {
    match (one.joints.first(), other.joints.first()) {
        (Some(first), Some(second)) => {
            one.mount[..2] == other.mount[..2]
                && first.kind == MotionKind::Turn
                && second.kind == MotionKind::Turn
                && first.drives == second.drives
        }
        _ => false,
    }
}

/// The farthest that a joint slides out [m].
fn slide(robot: &HybridRobot, joint: &ArmJoint) -> f64 {
    if joint.kind == MotionKind::Turn {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_way_is_enough_for_either_half_of_the_time() {
        // By pieces of one jerk from whatever speed and acceleration, turning back or not.
        let mut state = 3_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for round in 0..2000 {
            let (dt, jerk) = (0.01, 100.0 * random());
            // Speeding up from rest, the second half is three times the first.
            let (v, a) = if round == 0 { (0.0, 5.0) } else { (0.2 * random(), 10.0 * random()) };
            let speed = |t: f64| v + a * t + 0.5 * jerk * t * t;
            let hurry = most(dt, [a, a + jerk * dt], jerk.abs());
            let bound = dt * most(dt, [v, speed(dt)], hurry);
            let way = |from: f64| {
                let steps = 200;
                let step = 0.5 * dt / f64::from(steps);
                (0..steps)
                    .map(|k| speed(from + (f64::from(k) + 0.5) * step).abs() * step)
                    .sum::<f64>()
            };
            for from in [0.0, 0.5 * dt] {
                assert!(way(from) <= 0.5 * bound * (1.0 + 1e-4), "{round}: {} {bound}", way(from));
            }
        }
    }
}
