//! Aggregation of the findings of all steps into a report.

use std::collections::{BTreeMap, HashMap};

use super::plane_budget::plane_violations;
use super::report::{CheckResult, InstructionResult, MinimumDistance, Report, Utilization};
use super::step_findings::{StepFindings, update_peak};
use crate::EntityId;
use crate::collision::{PairResults, Scene, distance_tolerance};
use crate::trajectory::Trajectory;
use crate::violation::{IntervalMerger, Subject, Violation, ViolationInterval, ViolationKind};
use crate::workcell::Cell;

/// Report under construction.
pub(super) struct Aggregator<'a> {
    cell: &'a Cell,
    trajectory: &'a Trajectory,
    rows: Vec<InstructionResult>,
    violations: Vec<Violation>,
    /// Violations that reach to the end of their last step, and may continue in the next.
    open: BTreeMap<Subject, Open>,
    /// Minimum distances by pair of entities, each by its first object.
    minima: HashMap<[usize; 2], Minimum>,
    /// Minimum of the present instruction.
    nearest: Option<([usize; 2], Minimum)>,
    samples: usize,
}

#[derive(Clone, Copy)]
struct Open {
    violation: usize,
    severity: f64,
    step: usize,
}

#[derive(Clone, Copy)]
struct Minimum {
    distance: f64,
    time: f64,
    step: usize,
}

impl<'a> Aggregator<'a> {
    pub(super) fn new(cell: &'a Cell, trajectory: &'a Trajectory) -> Self {
        Self {
            cell,
            trajectory,
            rows: Vec::new(),
            violations: Vec::new(),
            open: BTreeMap::new(),
            minima: HashMap::new(),
            nearest: None,
            samples: 0,
        }
    }

    /// Adds the results of the next step.
    ///
    /// # Arguments
    /// * `objects` – candidates of its distances, as indices in the scene
    pub(super) fn add(
        &mut self,
        scene: &Scene<'_>,
        index: usize,
        findings: &StepFindings,
        distances: &PairResults,
        objects: &[usize],
    ) {
        self.begin_step(scene, index);
        let start = self.trajectory.times[index];
        self.samples += findings.samples;
        if let Some(row) = self.rows.last_mut() {
            for (axis, time) in row.moving_time.iter_mut().enumerate() {
                *time += self.trajectory.moving_time(index, axis);
            }
            row.tilt = row.tilt.max(findings.tilt);
            row.play = row.play.max(findings.play);
            for (most, found) in [
                (&mut row.velocity, findings.velocity),
                (&mut row.acceleration, findings.acceleration),
                (&mut row.jerk, findings.jerk),
                (&mut row.slip, findings.slip),
            ] {
                if let Some(Utilization { index, ratio, time }) = found {
                    update_peak(most, Utilization { index, ratio, time: start + time });
                }
            }
        }
        for interval in &findings.violations {
            let Subject { kind, first, second } = interval.worst.subject;
            self.add_violation(index, findings.samples, interval, interval.worst.subject, || {
                entities_of_step(scene.cell, kind, first, second)
            });
        }
        // All objects of an entity are one in the report.
        let first_object = |object: usize| scene.first_object_of_entity(objects[object]);
        let mut by_entity = IntervalMerger::default();
        let of_entities = |interval: &ViolationInterval| {
            let mut interval = interval.clone();
            let Subject { kind, first, second } = interval.worst.subject;
            let [first, second] = [first, second].map(first_object);
            interval.worst.subject = Subject { kind, first, second };
            interval
        };
        by_entity.join(distances.violations.iter().map(of_entities).collect(), 0);
        for interval in by_entity.into_intervals() {
            let subject = interval.worst.subject;
            let entities = [subject.first, subject.second].map(|it| scene.objects[it].entity);
            let entities = || entities.to_vec();
            self.add_violation(index, findings.samples, &interval, subject, entities);
        }
        for minimum in &distances.minima {
            let mut pair = minimum.objects.map(first_object);
            pair.sort_unstable();
            let (distance, time) = (minimum.distance, start + minimum.time);
            let here = Minimum { distance, time, step: index };
            if self.nearest.is_none_or(|(_, nearest)| distance < nearest.distance) {
                self.nearest = Some((pair, here));
            }
            let known = self.minima.entry(pair).or_insert(here);
            if distance < known.distance {
                *known = here;
            }
        }
    }

    fn begin_step(&mut self, scene: &Scene<'_>, index: usize) {
        let step = &self.trajectory.steps[index];
        let start = self.trajectory.times[index];
        if self.rows.last().is_none_or(|row| row.instruction != step.instruction) {
            self.end_instruction(scene);
            self.rows.push(InstructionResult {
                instruction: step.instruction,
                place: step.place,
                steps: index..index,
                start,
                duration: 0.0,
                moving_time: vec![0.0; self.cell.robot.axes.len()],
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
            row.duration = self.trajectory.times[index + 1] - row.start;
        }
    }

    /// Ends an instruction.
    fn end_instruction(&mut self, scene: &Scene<'_>) {
        let nearest = self.nearest.take();
        if let Some(row) = self.rows.last_mut() {
            row.nearest = nearest.map(|(pair, nearest)| minimum_distance(scene, pair, nearest));
        }
    }

    /// Adds a violation of a step; it extends the violation of its subject that reaches to the end of the step before.
    fn add_violation(
        &mut self,
        index: usize,
        samples: usize,
        interval: &ViolationInterval,
        subject: Subject,
        entities: impl FnOnce() -> Vec<EntityId>,
    ) {
        let step = &self.trajectory.steps[index];
        let begin = self.trajectory.times[index];
        let worst = &interval.worst;
        let known = self.open.get(&subject).copied().filter(|open| {
            interval.first == 0
                && open.step + 1 == index
                && self.violations[open.violation].instruction == step.instruction
        });
        let (violation, severity) = match known {
            Some(open) => (open.violation, open.severity),
            None => {
                self.violations.push(Violation {
                    kind: worst.kind,
                    entities: entities(),
                    instruction: step.instruction,
                    place: step.place,
                    step: index,
                    phase: step.phase,
                    start: begin + interval.start,
                    end: begin + interval.end,
                    worst_time: begin + interval.worst_time,
                    worst: worst.value,
                    limit: worst.limit,
                    quantity: worst.quantity,
                    detail: interval.detail.clone(),
                });
                (self.violations.len() - 1, worst.severity)
            }
        };
        let whole = &mut self.violations[violation];
        whole.end = begin + interval.end;
        if worst.severity > severity {
            (whole.kind, whole.worst, whole.limit) = (worst.kind, worst.value, worst.limit);
            (whole.worst_time, whole.step, whole.phase) =
                (begin + interval.worst_time, index, step.phase);
        }
        let severity = severity.max(worst.severity);
        if interval.last + 1 == samples {
            self.open.insert(subject, Open { violation, severity, step: index });
        }
    }

    /// The report of all steps.
    ///
    /// # Arguments
    /// * `wafers` – number of different wafers that were placed
    /// * `rule_violations` – violations that concern no single step
    pub(super) fn into_report(
        mut self,
        scene: &Scene<'_>,
        wafers: usize,
        rule_violations: Vec<Violation>,
    ) -> Report {
        self.end_instruction(scene);
        let mut violations = self.violations;
        violations.extend(rule_violations);
        violations.extend(plane_violations(self.cell, self.trajectory));
        violations.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.kind.cmp(&b.kind)));
        for violation in &violations {
            let row = self.rows.iter_mut().find(|row| row.instruction == violation.instruction);
            if let Some(row) = row {
                row.violations += 1;
            }
        }
        let mut moving_time = vec![0.0; self.cell.robot.axes.len()];
        for row in &self.rows {
            for (all, time) in moving_time.iter_mut().zip(&row.moving_time) {
                *all += time;
            }
        }
        let mut least: Vec<([usize; 2], Minimum)> = self.minima.into_iter().collect();
        least.sort_by(|(pair, a), (other, b)| {
            let nearer = a.distance.total_cmp(&b.distance).then(a.time.total_cmp(&b.time));
            nearer.then(pair.cmp(other))
        });
        let distances: Vec<MinimumDistance> = least
            .into_iter()
            .map(|(pair, nearest)| minimum_distance(scene, pair, nearest))
            .collect();
        let duration = self.trajectory.duration();
        let hourly = (wafers > 0 && duration > 0.0).then(|| 3600.0 * wafers as f64 / duration);
        let result = match (violations.is_empty(), self.trajectory.moves()) {
            (false, _) => CheckResult::Failed,
            (true, true) => CheckResult::Passed,
            (true, false) => CheckResult::NoMotion,
        };
        Report {
            result,
            distances,
            violations,
            by_instruction: self.rows,
            moving_time,
            duration,
            wafers,
            wafers_per_hour: hourly,
            samples: self.samples,
        }
    }
}

fn minimum_distance(scene: &Scene<'_>, pair: [usize; 2], minimum: Minimum) -> MinimumDistance {
    let Minimum { distance, time, step } = minimum;
    let entities = pair.map(|object| scene.objects[object].entity);
    MinimumDistance {
        entities,
        distance,
        tolerance: distance_tolerance(distance).min(distance),
        time,
        step,
    }
}

/// Entities of a violation that concerns one step and no pair of objects.
fn entities_of_step(
    cell: &Cell,
    kind: ViolationKind,
    first: usize,
    second: usize,
) -> Vec<EntityId> {
    let effector = || cell.robot.effectors().nth(first).map(EntityId::Effector);
    match kind {
        ViolationKind::Position
        | ViolationKind::Velocity
        | ViolationKind::Acceleration
        | ViolationKind::Jerk => {
            vec![EntityId::Axis(first)]
        }
        ViolationKind::Slip => effector().into_iter().collect(),
        ViolationKind::SafeZone => effector().into_iter().chain([EntityId::Zone(second)]).collect(),
        _ => Vec::new(),
    }
}
