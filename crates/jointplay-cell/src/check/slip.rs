//! Whether carried wafers slip in a step, looked at only where that may be the worst of it, or too much.

use std::ops::Range;

use super::course::{Axes, Course};
use super::scene::Scene;
use super::travel::Gearing;
use crate::robot::{AxesMotion, EffectorId, MAX_JOINTS, RODS};
use crate::wafer::Slip;

/// Slack for what the bound leaves out: where the pressure of the pads has its centre, and the platform's shift and twist by its tilt.
const SLACK: f64 = 1.1;
/// How much of what an arm does may go across its plane as the droop changes with reach.
const DROOPING: f64 = 0.02;
/// By how much the largest share may be passed over.
const PASSED: f64 = 1e-4;

/// A carried wafer at the samples of a step.
pub(super) struct Carried<'a> {
    scene: &'a Scene<'a>,
    rods: Axes<'a, RODS>,
    arm: Axes<'a, MAX_JOINTS>,
    effector: EffectorId,
    /// How much what has to be borne by mass has changed since the start, at most, by sample [m/s²].
    changed: Vec<f64>,
    /// The largest share so far.
    most: f64,
    /// What was looked at, by sample.
    pub(super) seen: Vec<(usize, Slip)>,
}

impl<'a> Carried<'a> {
    /// # Arguments
    /// * `tilt` – largest of the platform in the step [rad]
    pub(super) fn new(
        scene: &'a Scene<'a>,
        course: &'a Course,
        gearing: &Gearing,
        effector: EffectorId,
        tilt: f64,
    ) -> Self {
        let rods = course.axes(&[0, 1, 2]);
        let arm = course.axes(scene.planar(effector).axes());
        let changed = changed((scene, effector), course, (&rods, &arm), (gearing, tilt));
        Self { scene, rods, arm, effector, changed, most: 0.0, seen: Vec::new() }
    }

    /// Looks at a run of samples.
    pub(super) fn run(&mut self, run: &Range<usize>) {
        let (first, last) = (run.start, run.end - 1);
        let left = self.look(first);
        if last > first {
            let right = self.look(last);
            self.search(first..last, left, right);
        }
    }

    /// Between two samples.
    ///
    /// ```text
    ///    max φ  ≤  (φ_0 + φ_1 + (1 + s µ) change) / 2          φ  =  needed - s held,   held = µ f_n
    /// ```
    /// for the share s that is the largest so far, or what friction holds: where φ is not above zero, no share is above s.
    fn search(&mut self, between: Range<usize>, left: Slip, right: Slip) {
        if between.len() < 2 {
            return;
        }
        // Never what is too much.
        let share = self.most.min(1.0 - PASSED);
        let effector = &self.scene.cell.robot.arms[self.effector.arm].effectors;
        let friction = effector[self.effector.effector].friction;
        let changed = self.changed[between.end] - self.changed[between.start];
        let over = |slip: Slip| slip.needed - (share + PASSED) * slip.held;
        if over(left) + over(right) + (1.0 + share * friction) * changed <= 0.0 {
            return;
        }
        let middle = between.start.midpoint(between.end);
        let center = self.look(middle);
        // The worse half first: what it comes to spares looks at the other.
        if left.share() >= right.share() {
            self.search(between.start..middle, left, center);
            self.search(middle..between.end, center, right);
        } else {
            self.search(middle..between.end, center, right);
            self.search(between.start..middle, left, center);
        }
    }

    /// At a sample; where the platform just beside is nowhere, that is told of the next, and nothing is passed over.
    fn look(&mut self, sample: usize) -> Slip {
        let Some(found) = self.slip(sample) else {
            return Slip { needed: f64::INFINITY, held: 0.0 };
        };
        self.most = self.most.max(found.share());
        self.seen.push((sample, found));
        found
    }

    fn slip(&self, sample: usize) -> Option<Slip> {
        let cell = self.scene.cell;
        let rods = self.rods.rates(sample);
        let [positions, velocities, accelerations] = rods.each_ref().map(|rates| &rates[..]);
        let motion = AxesMotion { positions, velocities, accelerations };
        let now = cell.robot.platform(positions).ok()?;
        let platform = cell.robot.platform_motion(&now, &motion).ok()?;
        let on_platform = self.scene.planar(self.effector).moving(&self.arm.rates(sample));
        let wafer = cell.lowered_motion(&platform, &on_platform, self.effector, true).ok()?;
        Some(cell.slip_of(self.effector, &wafer))
    }
}

/// How much what a wafer has to be borne with by mass, seen from it, has changed since the start, at most, by sample [m/s²].
///
/// ```text
///    arm        Σ_g |v_g| (|Δφ̈| + |Δφ̇²| + |Δχ| (|φ̈| + φ̇²))          φ: angles of links, χ: from the wafer's heading ϑ
///    platform   |Δö| + |Δα| r + |α| (|Δr| + r |Δϑ|) + 2 |Δω| v + 2 |ω| (|Δv| + v |Δϑ|)
///    gravity    g |Δn| + g sin(tilt) |Δϑ|
///    turning    R²/2 |Δϑ̈| / b
/// ```
fn changed(
    (scene, effector): (&Scene<'_>, EffectorId),
    course: &Course,
    (rods, arm): (&Axes<'_, RODS>, &Axes<'_, MAX_JOINTS>),
    (gearing, tilt): (&Gearing, f64),
) -> Vec<f64> {
    let cell = scene.cell;
    let planar = scene.planar(effector);
    let described = &cell.robot.arms[effector.arm].effectors[effector.effector];
    let radius = 0.5 * cell.wafer.diameter;
    let twisting = 0.5 * radius * radius / described.support.lever(&cell.wafer);
    let (moving, count) = (course.track().moving(), course.times().len());
    let rods_move = moving.first().is_some_and(|&axis| axis < RODS);
    let arm_moves = moving.iter().any(|axis| planar.axes().contains(axis));
    let mut before = rods.rates(0);
    let mut doing = planar.doing(&arm.rates(0));
    let mut by_arm = planar.change(&doing, &doing);
    let mut all = 0.0;
    let mut changed = Vec::with_capacity(count);
    changed.push(all);
    for sample in 1..count {
        let mut change = 0.0;
        if arm_moves {
            let now = planar.doing(&arm.rates(sample));
            by_arm = planar.change(&doing, &now);
            doing = now;
            change += by_arm.acceleration * (1.0 + DROOPING)
                + DROOPING * by_arm.speed * by_arm.velocity
                + cell.gravity * tilt * by_arm.turn
                + twisting * by_arm.spin;
        }
        if rods_move {
            let after = rods.rates(sample);
            let unlike = |order: usize| -> [f64; RODS] {
                std::array::from_fn(|rod| after[order][rod] - before[order][rod])
            };
            let of = |order: usize| gearing.leaning(&after[order]);
            let [lean, turning, spinning] = [0, 1, 2].map(|order| gearing.leaning(&unlike(order)));
            change += gearing.lift(&unlike(2))
                + spinning * by_arm.reach
                + of(2) * (by_arm.way + by_arm.turn * by_arm.reach)
                + 2.0
                    * (turning * by_arm.speed
                        + of(1) * (by_arm.velocity + by_arm.turn * by_arm.speed))
                + 2.0 * cell.gravity * lean;
            before = after;
        }
        all += SLACK * change;
        changed.push(all);
    }
    changed
}
