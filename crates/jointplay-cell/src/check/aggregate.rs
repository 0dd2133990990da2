//! Findings of all segments, put together into a report.

use std::collections::{BTreeMap, HashMap};

use super::report::{InstructionResult, MinimumDistance, Report, Share, Verdict};
use super::segment_findings::{Alone, raise};
use crate::EntityId;
use crate::collision::{Near, Role, Scene, passed};
use crate::trajectory::Trajectory;
use crate::violation::{About, Kind, Stretch, Violation};
use crate::workcell::Cell;

/// The report as it grows.
pub(super) struct Summary<'a> {
    cell: &'a Cell,
    motion: &'a Trajectory,
    rows: Vec<InstructionResult>,
    violations: Vec<Violation>,
    /// What may go on in the next step: the violation, its severity, and the step at whose end it was broken.
    open: BTreeMap<About, Open>,
    /// Of pairs of items.
    least: HashMap<[usize; 2], Nearest>,
    /// Of the last instruction.
    nearest: Option<([usize; 2], Nearest)>,
    samples: usize,
}

#[derive(Clone, Copy)]
struct Open {
    violation: usize,
    severity: f64,
    step: usize,
}

#[derive(Clone, Copy)]
struct Nearest {
    distance: f64,
    time: f64,
    step: usize,
}

impl<'a> Summary<'a> {
    pub(super) fn new(cell: &'a Cell, motion: &'a Trajectory) -> Self {
        Self {
            cell,
            motion,
            rows: Vec::new(),
            violations: Vec::new(),
            open: BTreeMap::new(),
            least: HashMap::new(),
            nearest: None,
            samples: 0,
        }
    }

    /// The next step, and the items of the scene that its distances are about.
    pub(super) fn add(
        &mut self,
        scene: &Scene<'_>,
        index: usize,
        alone: &Alone,
        near: &Near,
        items: &[usize],
    ) {
        self.begin(scene, index);
        let start = self.motion.times[index];
        self.samples += alone.samples;
        if let Some(row) = self.rows.last_mut() {
            for (time, moved) in row.moving.iter_mut().zip(&alone.moved) {
                if *moved {
                    *time += self.motion.step_duration(index);
                }
            }
            row.tilt = row.tilt.max(alone.tilt);
            row.play = row.play.max(alone.play);
            for (most, found) in [
                (&mut row.velocity, alone.velocity),
                (&mut row.acceleration, alone.acceleration),
                (&mut row.jerk, alone.jerk),
                (&mut row.slip, alone.slip),
            ] {
                if let Some(Share { of, share, time }) = found {
                    raise(most, Share { of, share, time: start + time });
                }
            }
        }
        for stretch in &alone.found {
            let (kind, first, second) = stretch.hit.about;
            self.broken(index, alone.samples, stretch, (kind, first, second), || {
                entities_of_segment(scene.cell, kind, first, second)
            });
        }
        for stretch in &near.found {
            let (kind, a, b) = stretch.hit.about;
            let [a, b] = [items[a], items[b]];
            self.broken(index, alone.samples, stretch, (kind, a, b), || {
                [a, b].map(|item| scene.items[item].entity).to_vec()
            });
        }
        for found in &near.least {
            let mut pair = found.items.map(|item| items[item]);
            pair.sort_unstable();
            let (distance, time) = (found.distance, start + found.time);
            let here = Nearest { distance, time, step: index };
            if self.nearest.is_none_or(|(_, nearest)| distance < nearest.distance) {
                self.nearest = Some((pair, here));
            }
            let known = self.least.entry(pair).or_insert(here);
            if distance < known.distance {
                *known = here;
            }
        }
    }

    fn begin(&mut self, scene: &Scene<'_>, index: usize) {
        let step = &self.motion.steps[index];
        let start = self.motion.times[index];
        if self.rows.last().is_none_or(|row| row.instruction != step.instruction) {
            self.close(scene);
            self.rows.push(InstructionResult {
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
    }

    /// An instruction ends.
    fn close(&mut self, scene: &Scene<'_>) {
        let nearest = self.nearest.take();
        if let Some(row) = self.rows.last_mut() {
            row.nearest = nearest.map(|(pair, nearest)| named(scene, pair, nearest));
        }
    }

    /// Adds what is broken in a step, to what was broken at the end of the step before where that is the same.
    fn broken(
        &mut self,
        index: usize,
        samples: usize,
        stretch: &Stretch,
        about: About,
        entities: impl FnOnce() -> Vec<EntityId>,
    ) {
        let step = &self.motion.steps[index];
        let begin = self.motion.times[index];
        let hit = &stretch.hit;
        let known = self.open.get(&about).copied().filter(|open| {
            stretch.first == 0
                && open.step + 1 == index
                && self.violations[open.violation].instruction == step.instruction
        });
        let (violation, severity) = match known {
            Some(open) => (open.violation, open.severity),
            None => {
                self.violations.push(Violation {
                    kind: hit.kind,
                    entities: entities(),
                    instruction: step.instruction,
                    place: step.place,
                    step: index,
                    phase: step.phase,
                    start: begin + stretch.start,
                    end: begin + stretch.end,
                    worst_time: begin + stretch.worst,
                    worst: hit.value,
                    limit: hit.limit,
                    unit: hit.unit,
                    detail: stretch.detail.clone(),
                });
                (self.violations.len() - 1, hit.severity)
            }
        };
        let whole = &mut self.violations[violation];
        whole.end = begin + stretch.end;
        if hit.severity > severity {
            (whole.kind, whole.worst, whole.limit) = (hit.kind, hit.value, hit.limit);
            (whole.worst_time, whole.step, whole.phase) =
                (begin + stretch.worst, index, step.phase);
        }
        let severity = severity.max(hit.severity);
        if stretch.last + 1 == samples {
            self.open.insert(about, Open { violation, severity, step: index });
        }
    }

    /// What all of it comes to.
    pub(super) fn finished(mut self, scene: &Scene<'_>) -> Report {
        self.close(scene);
        let mut violations = self.violations;
        violations.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.kind.cmp(&b.kind)));
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
        let mut least: Vec<([usize; 2], Nearest)> = self.least.into_iter().collect();
        least.sort_by(|(pair, a), (other, b)| {
            let nearer = a.distance.total_cmp(&b.distance).then(a.time.total_cmp(&b.time));
            nearer.then(pair.cmp(other))
        });
        let distances: Vec<MinimumDistance> =
            least.into_iter().map(|(pair, nearest)| named(scene, pair, nearest)).collect();
        let wafers = scene.items.iter().filter(|item| item.role == Role::Wafer && item.laid);
        let (wafers, duration) = (wafers.count(), self.motion.duration());
        let hourly = (wafers > 0 && duration > 0.0).then(|| 3600.0 * wafers as f64 / duration);
        Report {
            verdict: if violations.is_empty() { Verdict::Sound } else { Verdict::Broken },
            distances,
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

fn named(scene: &Scene<'_>, pair: [usize; 2], nearest: Nearest) -> MinimumDistance {
    let Nearest { distance, time, step } = nearest;
    let entities = pair.map(|item| scene.items[item].entity);
    MinimumDistance { entities, distance, within: passed(distance).min(distance), time, step }
}

/// Entities of a violation that concerns one segment by itself.
fn entities_of_segment(cell: &Cell, kind: Kind, first: usize, second: usize) -> Vec<EntityId> {
    let effector = || cell.robot.effectors().nth(first).map(EntityId::Effector);
    match kind {
        Kind::Position | Kind::Velocity | Kind::Acceleration | Kind::Jerk => {
            vec![EntityId::Axis(first)]
        }
        Kind::Slip => effector().into_iter().collect(),
        Kind::SafeZone => effector().into_iter().chain([EntityId::Zone(second)]).collect(),
        _ => Vec::new(),
    }
}
