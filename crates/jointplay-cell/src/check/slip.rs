//! Whether carried wafers slip in a step, looked at only where that may be the worst of it, or too much.

use std::ops::Range;

use crate::collision::{Axes, Course, Gearing, Scene, droop_bounds};
use crate::robot::{AxesMotion, EffectorId, MAX_JOINTS, RODS};
use crate::wafer::{DroopBounds, FrictionMargin, SHORTEST};

/// Slack for what the bound leaves out: where the pressure of the pads has its centre, and the platform's shift and twist by its tilt.
const SLACK: f64 = 1.1;
/// By how much the largest share may be passed over.
const PASSED: f64 = 1e-4;

/// A carried wafer at the samples of a step.
pub(super) struct Carried<'a> {
    scene: &'a Scene<'a>,
    rods: Axes<'a, RODS>,
    arm: Axes<'a, MAX_JOINTS>,
    effector: EffectorId,
    /// Sine of the largest tilt of a wafer in the step, or more.
    tilt: f64,
    /// How much what has to be borne by mass has changed since the start, at most, by sample.
    changed: Vec<Changed>,
    /// The largest share so far.
    most: f64,
    /// What was looked at, by sample.
    pub(super) seen: Vec<(usize, FrictionMargin)>,
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
        let droop = droop_bounds(scene.cell, effector);
        let changed = changed((scene, effector), course, (&rods, &arm), (gearing, tilt, &droop));
        let tilt = tilt.sin() + droop.at.slope;
        Self { scene, rods, arm, effector, tilt, changed, most: 0.0, seen: Vec::new() }
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
    ///    max φ  ≤  (φ_0 + φ_1 + (1 + s µ) change + (sin(tilt) + s µ) heave) / 2          φ  =  needed - s held,   held = µ f_n
    /// ```
    /// for the share s that is the largest so far, or what friction holds: where φ is not above zero, no share is above s.
    fn search(&mut self, between: Range<usize>, left: FrictionMargin, right: FrictionMargin) {
        if between.len() < 2 {
            return;
        }
        // Never what is too much.
        let share = self.most.min(1.0 - PASSED);
        let effector = &self.scene.cell.robot.arms[self.effector.arm].effectors;
        let friction = effector[self.effector.effector].friction;
        let [from, to] = [between.start, between.end].map(|sample| self.changed[sample]);
        let pressing = share * friction;
        let changed = (1.0 + pressing) * (to.aside - from.aside)
            + (self.tilt + pressing) * (to.upward - from.upward);
        let over = |slip: FrictionMargin| slip.required - (share + PASSED) * slip.available;
        if over(left) + over(right) + changed <= 0.0 {
            return;
        }
        let middle = between.start.midpoint(between.end);
        let center = self.look(middle);
        // The worse half first: what it comes to spares looks at the other.
        if left.utilization() >= right.utilization() {
            self.search(between.start..middle, left, center);
            self.search(middle..between.end, center, right);
        } else {
            self.search(middle..between.end, center, right);
            self.search(between.start..middle, left, center);
        }
    }

    /// At a sample; where the platform just beside is nowhere, that is told of the next, and nothing is passed over.
    fn look(&mut self, sample: usize) -> FrictionMargin {
        let Some(found) = self.slip(sample) else {
            return FrictionMargin { required: f64::INFINITY, available: 0.0 };
        };
        self.most = self.most.max(found.utilization());
        self.seen.push((sample, found));
        found
    }

    fn slip(&self, sample: usize) -> Option<FrictionMargin> {
        let cell = self.scene.cell;
        let rods = self.rods.rates(sample);
        let [positions, velocities, accelerations] = rods.each_ref().map(|rates| &rates[..]);
        let motion = AxesMotion { positions, velocities, accelerations };
        let now = cell.robot.platform(positions).ok()?;
        let platform = cell.robot.platform_motion(&now, &motion).ok()?;
        let on_platform = self.scene.planar(self.effector).wafer_motion(&self.arm.rates(sample));
        let wafer = cell.deflected_motion(&platform, &on_platform, self.effector, true).ok()?;
        Some(cell.friction_margin_of(self.effector, &wafer))
    }
}

/// How much what a wafer has to be borne with by mass has changed, at most [m/s²].
#[derive(Debug, Clone, Copy, Default)]
struct Changed {
    /// In any direction.
    aside: f64,
    /// Up and down in the base frame.
    upward: f64,
}

/// How much what a wafer has to be borne with by mass, seen from it, has changed since the start, at most, by sample [m/s²].
///
/// ```text
///    arm        |Δr̈|        r, ṙ, r̈: on the platform, along the wafer's axes; ϑ: its heading
///    heave      |Δö|
///    platform   |Δα| r + |α| (|Δr| + r |Δϑ|) + 2 |Δω| ṙ + 2 |ω| (|Δṙ| + ṙ |Δϑ|)
///    gravity    g |Δn| + g sin(tilt) |Δϑ|
///    turning    R²/2 |Δϑ̈| / b
///    droop      d' |Δr̈| + (d' / l + 3 d'') (|r̈| |Δr| + 4 ṙ |Δṙ| + ṙ² |Δr| / l)        d, s: drop and slope at the reach l
///               + (g + |r̈|) ((s' + s / l) |Δr| + s |Δϑ|)
/// ```
fn changed(
    (scene, effector): (&Scene<'_>, EffectorId),
    course: &Course,
    (rods, arm): (&Axes<'_, RODS>, &Axes<'_, MAX_JOINTS>),
    (gearing, tilt, droop): (&Gearing, f64, &DroopBounds),
) -> Vec<Changed> {
    let cell = scene.cell;
    let planar = scene.planar(effector);
    let described = &cell.robot.arms[effector.arm].effectors[effector.effector];
    let radius = 0.5 * cell.wafer.diameter;
    let twisting = 0.5 * radius * radius / described.support.lever(&cell.wafer);
    let (moving, count) = (course.track().moving(), course.times().len());
    let [x, y, _] = cell.robot.arms[effector.arm].mount;
    let mount = x.hypot(y);
    let rods_move = moving.first().is_some_and(|&axis| axis < RODS);
    let arm_moves = moving.iter().any(|axis| planar.axes().contains(axis));
    let mut before = rods.rates(0);
    let mut seen = planar.motion_in_wafer_frame(&arm.rates(0));
    let mut all = Changed::default();
    let mut changed = Vec::with_capacity(count);
    changed.push(all);
    for sample in 1..count {
        let mut change = 0.0;
        let now = if arm_moves { planar.motion_in_wafer_frame(&arm.rates(sample)) } else { seen };
        let [turn, _, spin] = std::array::from_fn(|k| (now.heading[k] - seen.heading[k]).abs());
        let (speed, far) = (seen.velocity.norm(), seen.place.norm() + planar.height().abs());
        let way = (now.place - seen.place).norm();
        let hurried = (now.velocity - seen.velocity).norm();
        if arm_moves {
            let urged = (now.acceleration - seen.acceleration).norm();
            let reach = (seen.place.norm() - mount).abs().max(SHORTEST);
            let pull = seen.acceleration.norm();
            let swept = pull * way + speed * (4.0 * hurried + speed * way / reach);
            let tipped = (droop.rate.slope + droop.turn) * way + droop.at.slope * turn;
            change += (1.0 + droop.rate.drop) * urged
                + (droop.rate.drop / reach + 3.0 * droop.bend.drop) * swept
                + (cell.gravity + pull) * tipped
                + cell.gravity * tilt * turn
                + twisting * spin;
        }
        if rods_move {
            let after = rods.rates(sample);
            let unlike = |order: usize| -> [f64; RODS] {
                std::array::from_fn(|rod| after[order][rod] - before[order][rod])
            };
            let of = |order: usize| SLACK * gearing.leaning(&after[order]);
            let [lean, turning, spinning] =
                [0, 1, 2].map(|order| SLACK * gearing.leaning(&unlike(order)));
            all.upward += SLACK * gearing.lift(&unlike(2));
            change += spinning * far
                + of(2) * (way + turn * far)
                + 2.0 * (turning * speed + of(1) * (hurried + turn * speed))
                + 2.0 * cell.gravity * lean;
            before = after;
        }
        seen = now;
        all.aside += SLACK * change;
        changed.push(all);
    }
    changed
}
