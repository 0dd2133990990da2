//! What is wrong with a motion.
//!
//! | file | role |
//! | --- | --- |
//! | `report` | what a check finds |
//! | `found` | violations, merged from sample to sample |
//! | `axes` | axes, tilt and play against their limits |
//! | `slip` | whether friction holds a wafer |
//! | `scene` | bodies, wafers and zones, and where they are |
//! | `solid` | shapes, and distances between them |
//! | `travel` | how far things can have gone between samples |
//! | `watch` | distances between all pairs, looked at only as often as they can matter |

mod axes;
mod found;
mod report;
mod scene;
mod slip;
mod solid;
mod travel;
mod watch;

pub use report::{InstructionRow, Kind, PairDistance, Report, Share, Unit, Verdict, Violation};

use crate::cell::Cell;
use crate::motion::{Motion, Sample};
use crate::program::Phase;
use crate::robot::EffectorId;
use axes::Use;
use found::{Found, Hit, When};
use jointplay_core::spatial::Pose;
use scene::{Places, Role, Scene, effector_name};
use solid::Placed;
use watch::{Now, Watch};

/// How closely a motion is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckOptions {
    /// Samples a second [Hz].
    pub rate: f64,
    /// Distances of bodies are followed below this; farther ones count as far [m].
    pub near: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { rate: 1000.0, near: 0.05 }
    }
}

/// Everything that is wrong with a motion, none hidden by the first.
///
/// Axes, tilt, play, slip and zones are looked at in each sample; contact of bodies also between samples:
///
/// ```text
///    d(t)  ≥  d(t_0) − way of a, at most − way of b, at most
/// ```
/// A pair is passed over as long as this bound keeps it apart, and where two samples do not rule out a contact between them, the interval is halved until they do, or the contact is found.
/// So a wall that is thinner than a sample's way is not jumped.
///
/// # Numerics
/// Least distances are exact at the samples looked at; those passed over may be nearer by `within` of each row.
///
/// # Assumptions
/// Links and wafers are rigid where distances are concerned; wafers lie as flat discs, lowered and turned by the droop of their arm.
#[must_use]
pub fn check(cell: &Cell, motion: &Motion, options: &CheckOptions) -> Report {
    let mut check = Check::new(cell, motion, options);
    let (mut before, mut sample) = (Sample::default(), Sample::default());
    if !motion.steps.is_empty() {
        check.begin(0);
        for (number, time) in motion.sample_times(options.rate).enumerate() {
            motion.fill(time, &mut sample);
            // Nothing changes while all stand still; the end of the step is looked at again.
            if number > 0 && before.step == sample.step && motion.stands(sample.step) {
                continue;
            }
            check.up_to((number > 0).then_some(&before), &sample);
            std::mem::swap(&mut before, &mut sample);
        }
    }
    check.finished()
}

struct Check<'a> {
    cell: &'a Cell,
    motion: &'a Motion,
    scene: Scene<'a>,
    watch: Watch,
    found: Found,
    uses: Use,
    rows: Vec<InstructionRow>,
    /// Step whose rules hold.
    step: usize,
    /// Whether each axis moved in that step.
    moved: Vec<bool>,
    effectors: Vec<EffectorId>,
    samples: usize,
}

impl<'a> Check<'a> {
    fn new(cell: &'a Cell, motion: &'a Motion, options: &CheckOptions) -> Self {
        let scene = Scene::new(cell);
        let watch = Watch::new(&scene, options.near);
        Self {
            cell,
            motion,
            scene,
            watch,
            found: Found::default(),
            uses: Use::new(cell),
            rows: Vec::new(),
            step: 0,
            moved: vec![false; cell.robot.axes.len()],
            effectors: cell.robot.effectors().collect(),
            samples: 0,
        }
    }

    /// A step begins.
    fn begin(&mut self, index: usize) {
        let step = &self.motion.steps[index];
        self.step = index;
        let start = self.motion.times[index];
        if self.rows.last().is_none_or(|row| row.instruction != step.instruction) {
            self.close();
            self.rows.push(InstructionRow {
                instruction: step.instruction,
                place: step.place,
                steps: index..index,
                start,
                duration: 0.0,
                moving: vec![0.0; self.cell.robot.axes.len()],
                velocity: None,
                acceleration: None,
                jerk: None,
                tilt: 0.0,
                play: 0.0,
                slip: None,
                nearest: None,
                violations: 0,
            });
        }
        if let Some(row) = self.rows.last_mut() {
            row.steps.end = index + 1;
            row.duration = self.motion.times[index + 1] - row.start;
        }
        self.watch.begin(&self.scene, step);
    }

    /// A step ends: wafers change hands.
    fn end(&mut self) {
        let step = &self.motion.steps[self.step];
        let duration = self.motion.step_duration(self.step);
        if let Some(row) = self.rows.last_mut() {
            for (time, moved) in row.moving.iter_mut().zip(&mut self.moved) {
                if std::mem::take(moved) {
                    *time += duration;
                }
            }
        }
        if let Some(item) = step.handover.and_then(|handover| self.scene.hand_over(handover)) {
            self.watch.forget(&self.scene, item);
        }
    }

    /// An instruction ends.
    fn close(&mut self) {
        let nearest = self.watch.nearest.take();
        if let Some(row) = self.rows.last_mut() {
            row.nearest = nearest.map(|nearest| self.watch.row(&self.scene, nearest));
        }
    }

    /// All samples up to one, that of each step's end among them: what is asked changes there.
    fn up_to(&mut self, before: Option<&Sample>, sample: &Sample) {
        let mut ended: Option<Sample> = None;
        while self.step < sample.step {
            let mut rest = Sample::default();
            self.motion.fill_in(self.step, self.motion.times[self.step + 1], &mut rest);
            self.sample(ended.as_ref().or(before), &rest);
            self.end();
            self.begin(self.step + 1);
            ended = Some(rest);
        }
        self.sample(ended.as_ref().or(before), sample);
    }

    fn sample(&mut self, before: Option<&Sample>, sample: &Sample) {
        self.samples += 1;
        let (motion, index) = (self.motion, self.step);
        let step = &motion.steps[index];
        let when = When { time: sample.time, sample: self.samples, index, step };
        if let Some(before) = before {
            self.watch.advance(&self.scene, before, sample);
        }
        for (moved, velocity) in self.moved.iter_mut().zip(&sample.velocities) {
            *moved |= *velocity != 0.0;
        }
        let Some(row) = self.rows.last_mut() else { return };
        self.uses.axes(self.cell, sample, when, row, &mut self.found);
        let places = match self.scene.places(&sample.positions) {
            Ok(places) => places,
            Err((platform, why)) => {
                let kind = if platform { Kind::Platform } else { Kind::Droop };
                let hit = Hit {
                    about: (kind, 0, 0),
                    kind,
                    severity: 0.0,
                    value: 0.0,
                    limit: 0.0,
                    unit: Unit::None,
                };
                self.found.add(when, &hit, || (Vec::new(), why));
                self.watch.lose();
                return;
            }
        };
        self.uses.platform(self.cell, &places.platform, when, row, &mut self.found);
        self.slips(&places, sample, when);
        self.zones(&places, when);
        let now = Now { motion, scene: &self.scene, when, places: &places, before };
        self.watch.look(&now, &mut self.found);
    }

    fn slips(&mut self, places: &Places, sample: &Sample, when: When<'_>) {
        for (place, &id) in self.effectors.iter().enumerate() {
            if self.scene.carried_by(id).is_none() {
                continue;
            }
            let now = &places.wafers[id.arm][id.effector];
            // What the droop does not know was reported with the places.
            let Ok(push) = slip::push(self.cell, sample, id, now) else { continue };
            if push.needed > push.held {
                let hit = Hit {
                    about: (Kind::Slip, place, 0),
                    kind: Kind::Slip,
                    severity: push.needed - push.held,
                    value: push.needed,
                    limit: push.held,
                    unit: Unit::Acceleration,
                };
                let cell = self.cell;
                self.found.add(when, &hit, || (vec![effector_name(cell, id)], String::new()));
            }
            if let Some(row) = self.rows.last_mut() {
                let share = if push.held > 0.0 { push.needed / push.held } else { f64::INFINITY };
                axes::raise(&mut row.slip, place, share, when.time);
            }
        }
    }

    /// Wafers' centres stay in the safe zones while the robot turns.
    fn zones(&mut self, places: &Places, when: When<'_>) {
        if when.step.phase != Phase::Turn {
            return;
        }
        for (zone, solid) in &self.scene.safe {
            let placed = Placed { solid, base_from_carrier: &Pose::identity() };
            for (place, id) in self.effectors.iter().enumerate() {
                let center = places.wafers[id.arm][id.effector].translation.vector;
                let off = solid::outside(placed, &center);
                if off > 0.0 {
                    let hit = Hit {
                        about: (Kind::SafeZone, place, *zone),
                        kind: Kind::SafeZone,
                        severity: off,
                        value: off,
                        limit: 0.0,
                        unit: Unit::Length,
                    };
                    let cell = self.cell;
                    self.found.add(when, &hit, || {
                        (
                            vec![effector_name(cell, *id), cell.zones[*zone].name.clone()],
                            String::new(),
                        )
                    });
                }
            }
        }
    }

    fn finished(mut self) -> Report {
        if !self.rows.is_empty() {
            self.end();
        }
        self.close();
        let violations = self.found.finished();
        for violation in &violations {
            let row = self.rows.iter_mut().find(|row| row.instruction == violation.instruction);
            if let Some(row) = row {
                row.violations += 1;
            }
        }
        let mut moving = vec![0.0; self.cell.robot.axes.len()];
        for row in &self.rows {
            for (all, time) in moving.iter_mut().zip(&row.moving) {
                *all += time;
            }
        }
        let wafers =
            self.scene.items.iter().filter(|item| item.role == Role::Wafer && item.laid).count();
        let duration = self.motion.duration();
        let hourly = (wafers > 0 && duration > 0.0).then(|| 3600.0 * wafers as f64 / duration);
        Report {
            verdict: if violations.is_empty() { Verdict::Sound } else { Verdict::Broken },
            distances: self.watch.distances(&self.scene),
            violations,
            by_instruction: self.rows,
            moving,
            duration,
            wafers,
            wafers_per_hour: hourly,
            samples: self.samples,
        }
    }
}
