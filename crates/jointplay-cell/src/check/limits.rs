//! Checks of axes, tilt, play and slip against their limits.

use jointplay_core::bulk::{Quantity, Status};

use super::report::Utilization;
use super::slip::HeldWafer;
use super::step_findings::{StepFindings, update_peak};
use crate::CellError;
use crate::collision::{MotionBoundModel, PoseError, SampledStep, Scene, UnknownPose};
use crate::columns::{largest_magnitude, range};
use crate::program::Step;
use crate::robot::{Axis, AxisKind, EffectorId, HybridRobot, Positions};
use crate::trajectory::{AxisState, StateColumns, axis_limits};
use crate::violation::{
    IntervalMerger, SampleTime, SampleViolation, Subject, ViolationKind, ViolationQuantity,
};
use crate::wafer::Droop;
use crate::workcell::Cell;

/// Relative tolerance of limits: a trajectory planned at a limit does not violate it by round-off.
const LIMIT_TOLERANCE: f64 = 1e-6;
/// Absolute tolerance of position limits (m or rad).
const POSITION_TOLERANCE: f64 = 1e-9;

/// Tilt of the platform and displacement of its virtual joints.
#[derive(Clone, Copy)]
struct PlatformState {
    /// Tilt (rad).
    tilt: f64,
    /// Displacement of the virtual joints from nominal (m).
    play: f64,
}

impl PlatformState {
    /// Largest tilt (rad) and play (m) that are no violation.
    fn limits(cell: &Cell) -> [f64; 2] {
        let tilt_max = cell.robot.gpr.limits().tilt_max;
        [tilt_max + POSITION_TOLERANCE, cell.play_budget * (1.0 + LIMIT_TOLERANCE)]
    }

    fn is_within_limits(&self, cell: &Cell) -> bool {
        let [tilt, play] = Self::limits(cell);
        self.tilt <= tilt && self.play <= play
    }
}

/// Platform states by sample; a single one where no rod moves.
struct PlatformStates<'a> {
    robot: &'a HybridRobot,
    status: Vec<Status>,
    tilts: Vec<f64>,
    plays: Vec<f64>,
}

/// Axis of the robot with its limits in a step.
struct LimitedAxis<'a> {
    index: usize,
    axis: &'a Axis,
    /// Limits of velocity, acceleration and jerk.
    limits: [f64; 3],
}

impl LimitedAxis<'_> {
    /// Adds the violations of the limits of position, velocity, acceleration and jerk at all samples.
    fn add_violations(
        &self,
        times: &[f64],
        state: impl Fn(usize) -> AxisState,
        violations: &mut IntervalMerger,
    ) {
        let Self { index, axis, limits } = *self;
        let quantity = match axis.kind {
            AxisKind::Rotary => ViolationQuantity::Angle,
            AxisKind::Linear => ViolationQuantity::Length,
        };
        for (sample, &time) in times.iter().enumerate() {
            let [position, rates @ ..] = state(sample);
            let mut add = |kind: ViolationKind, severity: f64, value: f64, limit: f64| {
                let subject = Subject { kind, first: index, second: 0 };
                let violation = SampleViolation { subject, kind, severity, value, limit, quantity };
                violations.add(SampleTime { time, sample }, violation, String::new);
            };
            if let Some(limit) = violated_limit(axis, position) {
                add(ViolationKind::Position, (position - limit).abs(), position, limit);
            }
            let kinds = [ViolationKind::Velocity, ViolationKind::Acceleration, ViolationKind::Jerk];
            for ((kind, limit), rate) in kinds.into_iter().zip(limits).zip(rates) {
                if exceeds(rate.abs(), limit) {
                    add(kind, rate.abs(), rate.abs(), limit);
                }
            }
        }
    }
}

impl StepFindings {
    /// Checks all samples of a window.
    pub(super) fn new(
        scene: &Scene<'_>,
        step: &Step,
        sampled: &SampledStep,
        bounds: &MotionBoundModel,
    ) -> Self {
        let robot = &scene.cell.robot;
        let mut findings = Self {
            velocity: None,
            acceleration: None,
            jerk: None,
            slip: None,
            tilt: 0.0,
            play: 0.0,
            samples: sampled.times().len(),
            violations: Vec::new(),
            runs: Vec::new(),
            swept_boxes: Vec::new(),
        };
        let mut violations = IntervalMerger::default();
        let (moving, times) = (sampled.moving_axes(), sampled.times());
        let mut moving = moving.moving().iter().zip(moving.states()).peekable();
        for (index, axis) in robot.axes.iter().enumerate() {
            let limits = axis_limits(robot, index, step);
            let limits = [limits.velocity, limits.acceleration, limits.jerk];
            let limited = LimitedAxis { index, axis, limits };
            let at_rest = [sampled.from()[index], 0.0, 0.0, 0.0];
            if let Some((_, states)) = moving.next_if(|(moving, _)| **moving == index) {
                if !findings.check_axis(&limited, times, states) {
                    limited.add_violations(times, |sample| states.at(sample), &mut violations);
                }
            } else if violated_limit(axis, at_rest[0]).is_some() {
                limited.add_violations(times, |_| at_rest, &mut violations);
            }
        }
        findings.check_platform(scene, sampled, &mut violations);
        let in_safe_zones = step.phase.is_in_safe_zones() && !scene.safe_zones.is_empty();
        for (index, id) in robot.effectors().enumerate() {
            if scene.held_wafer(id).is_some() {
                findings.check_slip(scene, sampled, bounds, index, id, &mut violations);
            }
            if in_safe_zones {
                findings.check_safe_zones(scene, sampled, bounds, index, id, &mut violations);
            }
        }
        findings.violations = violations.into_intervals();
        findings
    }

    /// Compares a moving axis with its limits; whether it is within them at all samples.
    fn check_axis(
        &mut self,
        limited: &LimitedAxis<'_>,
        times: &[f64],
        states: &StateColumns,
    ) -> bool {
        let LimitedAxis { index, axis, limits } = *limited;
        let [positions, rates @ ..] = states.columns();
        let peaks = rates.map(largest_magnitude);
        let utilizations = [&mut self.velocity, &mut self.acceleration, &mut self.jerk];
        for (((utilization, column), value), limit) in
            utilizations.into_iter().zip(rates).zip(peaks).zip(limits)
        {
            let ratio = value / limit;
            if value > 0.0 && utilization.as_ref().is_none_or(|most| ratio >= most.ratio) {
                let first = column.iter().position(|rate| rate.abs() == value);
                let time = first.map_or(f64::NAN, |sample| times[sample]);
                update_peak(utilization, Utilization { index, ratio, time });
            }
        }
        range(positions).iter().all(|&position| violated_limit(axis, position).is_none())
            && !peaks.iter().zip(limits).any(|(&peak, limit)| exceeds(peak, limit))
    }

    /// Checks the platform at all samples, and finds the runs of samples at which all poses are known.
    fn check_platform(
        &mut self,
        scene: &Scene<'_>,
        sampled: &SampledStep,
        violations: &mut IntervalMerger,
    ) {
        let cell = scene.cell;
        // A table of droop is finite: a pose is known only where it covers the reach, whichever arm moves.
        let has_table =
            |id: &EffectorId| matches!(cell.robot.arms[id.arm].droop, Droop::Table { .. });
        let tables: Vec<EffectorId> = cell.robot.effectors().filter(has_table).collect();
        let states = PlatformStates::new(cell, sampled);
        if let Some(most) = states.most().filter(|most| most.is_within_limits(cell))
            && tables.is_empty()
        {
            self.raise_tilt_and_play(cell, most);
            self.runs.push(0..sampled.times().len());
            return;
        }
        for (sample, &time) in sampled.times().iter().enumerate() {
            let at = SampleTime { time, sample };
            match states.state(sample, || sampled.positions(sample)) {
                Ok(state) => self.check_tilt_and_play(cell, state, at, violations),
                Err(error) => {
                    UnknownPose { at, error: PoseError::from(error) }.report(violations);
                    continue;
                }
            }
            let mut is_known = true;
            for &id in &tables {
                if let Err(error) = scene.wafer_pose(id, &sampled.positions(sample)) {
                    UnknownPose { at, error }.report(violations);
                    is_known = false;
                }
            }
            if is_known {
                match self.runs.last_mut() {
                    Some(run) if run.end == sample => run.end += 1,
                    _ => self.runs.push(sample..sample + 1),
                }
            }
        }
    }

    fn check_tilt_and_play(
        &mut self,
        cell: &Cell,
        state: PlatformState,
        at: SampleTime,
        violations: &mut IntervalMerger,
    ) {
        self.raise_tilt_and_play(cell, state);
        let PlatformState { tilt, play } = state;
        let [tilt_max, play_max] = PlatformState::limits(cell);
        let mut add = |kind: ViolationKind, value: f64, limit: f64, quantity: ViolationQuantity| {
            let (subject, severity) = (Subject::of(kind), value);
            let violation = SampleViolation { subject, kind, severity, value, limit, quantity };
            violations.add(at, violation, String::new);
        };
        if tilt > tilt_max {
            add(
                ViolationKind::Tilt,
                tilt,
                cell.robot.gpr.limits().tilt_max,
                ViolationQuantity::Angle,
            );
        }
        if play > play_max {
            add(ViolationKind::Play, play, cell.play_budget, ViolationQuantity::Length);
        }
    }

    /// Raises the shares of the limits of tilt and play to those of a state.
    fn raise_tilt_and_play(&mut self, cell: &Cell, PlatformState { tilt, play }: PlatformState) {
        self.tilt = self.tilt.max(tilt / cell.robot.gpr.limits().tilt_max);
        let ratio = if cell.play_budget > 0.0 { play / cell.play_budget } else { f64::INFINITY };
        self.play = self.play.max(ratio);
    }

    /// Checks the friction of a held wafer.
    fn check_slip(
        &mut self,
        scene: &Scene<'_>,
        sampled: &SampledStep,
        bounds: &MotionBoundModel,
        index: usize,
        id: EffectorId,
        violations: &mut IntervalMerger,
    ) {
        let kind = ViolationKind::Slip;
        let tilt = self.tilt * scene.cell.robot.gpr.limits().tilt_max;
        let mut wafer = HeldWafer::new(scene, sampled, bounds, id, tilt);
        self.runs.iter().for_each(|run| wafer.check_run(run));
        let mut evaluated = wafer.evaluated;
        evaluated.sort_unstable_by_key(|(sample, _)| *sample);
        for (sample, friction) in evaluated {
            let time = sampled.times()[sample];
            if friction.required > friction.available {
                let violation = SampleViolation {
                    subject: Subject { kind, first: index, second: 0 },
                    kind,
                    severity: friction.required - friction.available,
                    value: friction.required,
                    limit: friction.available,
                    quantity: ViolationQuantity::SpecificForce,
                };
                violations.add(SampleTime { time, sample }, violation, String::new);
            }
            update_peak(&mut self.slip, Utilization { index, ratio: friction.utilization(), time });
        }
    }
}

impl<'a> PlatformStates<'a> {
    fn new(cell: &'a Cell, sampled: &SampledStep) -> Self {
        let (robot, rods) = (&cell.robot, sampled.rods());
        let count = rods[0].len();
        let (mut tilts, mut plays) = (vec![0.0; count], vec![0.0; count]);
        let mut status = vec![Status::Solved; count];
        let mut quantities =
            [(Quantity::TiltAngle, &mut tilts[..]), (Quantity::Displacement, &mut plays[..])];
        if robot.model.forward_many(&robot.gpr, rods, &mut status, &mut quantities).is_err() {
            // An error of the whole computation is reported at each sample.
            status.fill(Status::NotFinite);
        }
        Self { robot, status, tilts, plays }
    }

    /// The largest tilt and the largest play; `None` where a state is unknown.
    fn most(&self) -> Option<PlatformState> {
        let are_known = self.status.iter().all(|status| *status == Status::Solved);
        let most = [&self.tilts, &self.plays].map(|values| largest_magnitude(values));
        are_known.then_some(PlatformState { tilt: most[0], play: most[1] })
    }

    /// State at a sample; where the columns have none, the single-pose solver states the reason.
    fn state(
        &self,
        sample: usize,
        positions: impl FnOnce() -> Positions,
    ) -> Result<PlatformState, CellError> {
        let row = sample.min(self.status.len() - 1);
        if self.status[row] == Status::Solved {
            return Ok(PlatformState { tilt: self.tilts[row], play: self.plays[row] });
        }
        let platform = self.robot.platform(&positions())?;
        let play = self.robot.model.displacement(&self.robot.gpr, &platform);
        Ok(PlatformState { tilt: platform.tilt().angle, play })
    }
}

/// Whether a magnitude exceeds its limit by more than round-off.
fn exceeds(value: f64, limit: f64) -> bool {
    value > limit * (1.0 + LIMIT_TOLERANCE)
}

/// The position limit that a position violates.
fn violated_limit(axis: &Axis, position: f64) -> Option<f64> {
    if position > axis.max + POSITION_TOLERANCE {
        Some(axis.max)
    } else if position < axis.min - POSITION_TOLERANCE {
        Some(axis.min)
    } else {
        None
    }
}
