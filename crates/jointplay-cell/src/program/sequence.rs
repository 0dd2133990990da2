//! The motion sequence of each instruction, step by step.

mod goal_positions;

use std::collections::BTreeMap;
use std::sync::Arc;

use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;

use super::effector_choice::effector_name;
use super::ik_cache::IkCache;
use super::limits::check_limits;
use super::posture_choice::PostureChoice;
use super::retracted_pose::retracted_positions;
use super::{Handoff, LinePostures, Path, Phase, ProgramProblem, RobotState, SourceLocation, Step};
use crate::robot::{EffectorId, PostureChange, RODS, WaferTarget};
use crate::station::LinePoint::{Retracted, Slot, Via};
use crate::station::{LinePoint, SlotId, Waypoints};
use crate::workcell::Cell;

/// Largest tilt of a platform that counts as level: it displaces a wafer at the reach of an arm by less than a micrometre (rad).
const LEVEL_TOLERANCE: f64 = 1e-6;

/// Largest distance of the motors for which a turn has no step of its own: they move together with the rods (m or rad).
const TURNED_TOLERANCE: f64 = 1e-6;

/// Largest distance of motors from their retracted position at which they are set to it exactly; the droop of a retracted arm displaces them by less (m or rad).
const RETRACTED_TOLERANCE: f64 = 1e-6;

/// Length below which a line is a step without motion: inverse kinematics is accurate to a tenth of it (m).
const NO_DISPLACEMENT: f64 = 1e-11;

/// The robot during a program, and the steps so far.
pub(super) struct MotionSequencer<'c> {
    pub(super) cell: &'c Cell,
    /// Inverse kinematics of the last program.
    ik_cache: &'c mut IkCache,
    pub(super) steps: Vec<Step>,
    /// Factor of the limits, see [`Step::speed_scaling`].
    pub(super) speed_scaling: f64,
    /// Blend radius (m).
    pub(super) blend_radius: f64,
    positions: Vec<f64>,
    /// Whether all arms are retracted.
    arms_retracted: bool,
    /// Whether each axis turns whole arms and does nothing else.
    turning: Vec<bool>,
    /// Height of the sagging wafer's mean plane over the supports, for each effector that has carried one (m).
    sag: BTreeMap<EffectorId, f64>,
    /// Motors that extend the arm, with their positions where the arm is retracted for a station and the platform level.
    retracted: BTreeMap<(EffectorId, usize), Vec<(usize, f64)>>,
    /// Postures of the present visit of a station.
    posture_choice: PostureChoice,
    /// Fraction of the line into a station at which the arm is.
    line_fraction: f64,
    instruction: usize,
    place: SourceLocation,
    loaded: Vec<EffectorId>,
}

/// The goal of a step.
#[derive(Clone, Copy)]
struct Goal<'g> {
    what: &'static str,
    effector: EffectorId,
    target: &'g WaferTarget,
    slot: SlotId,
    /// Where the target is on the line into the station.
    point: LinePoint,
}

impl<'c> MotionSequencer<'c> {
    /// In a state, without steps.
    pub(super) fn new(cell: &'c Cell, ik_cache: &'c mut IkCache, start: &RobotState) -> Self {
        let axes = &cell.robot.axes;
        Self {
            cell,
            ik_cache,
            steps: Vec::new(),
            speed_scaling: start.speed_scaling,
            blend_radius: start.blend_radius,
            positions: start.positions.clone(),
            arms_retracted: start.arms_retracted,
            turning: (0..axes.len()).map(|axis| cell.robot.turns_whole_arms(axis)).collect(),
            posture_choice: PostureChoice::default(),
            sag: BTreeMap::new(),
            retracted: BTreeMap::new(),
            line_fraction: 0.0,
            instruction: 0,
            place: SourceLocation::default(),
            loaded: Vec::new(),
        }
    }

    /// The state after the steps so far.
    pub(super) fn state(&self) -> RobotState {
        RobotState {
            positions: self.positions.clone(),
            arms_retracted: self.arms_retracted,
            speed_scaling: self.speed_scaling,
            blend_radius: self.blend_radius,
        }
    }

    /// Starts an instruction, to which the next steps belong, with the effectors that carry a wafer.
    pub(super) fn start(
        &mut self,
        instruction: usize,
        place: SourceLocation,
        loaded: Vec<EffectorId>,
    ) {
        (self.instruction, self.place, self.loaded) = (instruction, place, loaded);
    }

    /// HOME: retracts the arms, then moves all axes to their home positions.
    pub(super) fn home(&mut self) {
        self.posture_choice.end_visit();
        self.retract_arms();
        let robot = &self.cell.robot;
        let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
        for arm in 0..robot.arms.len() {
            self.change_posture(EffectorId { arm, effector: 0 }, &home);
        }
        self.move_to(Phase::Move, home, Path::PointToPoint);
    }

    /// MOVE: some axes to positions, within all limits.
    pub(super) fn move_axes(&mut self, targets: &[(usize, f64)]) -> Result<(), ProgramProblem> {
        let mut to = self.positions.clone();
        for &(axis, position) in targets {
            to[axis] = position;
        }
        check_limits(self.cell, "this MOVE", &to)?;
        self.posture_choice.end_visit();
        let extends_arm = |&(axis, _): &(usize, f64)| {
            axis >= RODS && !self.turning[axis] && self.positions[axis] != to[axis]
        };
        self.arms_retracted &= !targets.iter().any(extends_arm);
        self.move_to(Phase::Move, to, Path::PointToPoint);
        Ok(())
    }

    /// MOVE LINE: the wafer of an effector along a straight line, its plane and heading constant.
    pub(super) fn move_line(
        &mut self,
        effector: EffectorId,
        by: [f64; 3],
    ) -> Result<(), ProgramProblem> {
        let loaded = self.loaded.contains(&effector);
        let name = effector_name(&self.cell.robot, effector);
        let stopped = |source| ProgramProblem::Unreachable {
            target: "the end of this line".to_owned(),
            effector: name.to_owned(),
            loaded,
            leveling: None,
            source: Box::new(source),
        };
        let pose = self.cell.wafer_pose(effector, &self.positions, loaded).map_err(stopped)?;
        if Vector3::from(by).norm() < NO_DISPLACEMENT {
            self.push(Phase::Move, self.positions.clone(), Path::Line(effector));
            return Ok(());
        }
        let mut target = WaferTarget::from_pose(&pose);
        target.center += Vector3::from(by);
        let to = self.solve_line_end(effector, &target, loaded).map_err(stopped)?;
        self.arms_retracted = false;
        self.posture_choice.end_visit();
        self.move_to(Phase::Move, to, Path::Line(effector));
        Ok(())
    }

    /// TILT: the platform to a tilt, its plane crossing the base axis at constant height.
    pub(super) fn tilt(&mut self, tilt: Tilt) -> Result<(), ProgramProblem> {
        let to = self.positions_at_tilt(tilt);
        check_limits(self.cell, "this TILT", &to)?;
        self.move_to(Phase::Move, to, Path::PointToPoint);
        Ok(())
    }

    /// A dwell.
    pub(super) fn dwell(&mut self, path: Path) {
        let positions = self.positions.clone();
        self.push(Phase::Wait, positions, path);
    }

    /// GOTO: in front of a slot, retracted, at its height and tilt; above its resting plane with a wafer, below without.
    pub(super) fn goto(
        &mut self,
        effector: EffectorId,
        slot: SlotId,
    ) -> Result<(), ProgramProblem> {
        let waypoints = self.waypoints(effector, slot)?;
        let (what, target) = if self.loaded.contains(&effector) {
            ("the retracted pose above", &waypoints.retracted_above)
        } else {
            ("the retracted pose below", &waypoints.retracted_below)
        };
        self.pre_approach(Goal { what, effector, target, slot, point: Retracted })
    }

    /// GET: picks the wafer of a slot; returns the index of the step at whose end the effector carries it.
    ///
    /// # Arguments
    /// * `wait` – dwell in front of the slot
    pub(super) fn get(
        &mut self,
        effector: EffectorId,
        slot: SlotId,
        wait: Option<Path>,
    ) -> Result<usize, ProgramProblem> {
        self.loaded.retain(|&id| id != effector);
        let waypoints = self.waypoints(effector, slot)?;
        let goal = |what, point, target| Goal { what, effector, target, slot, point };
        let first = self.steps.len();
        self.pre_approach(goal("the retracted pose below", Retracted, &waypoints.retracted_below))?;
        if let Some(wait) = wait {
            self.dwell(wait);
        }
        for (k, via) in waypoints.via_below.iter().enumerate() {
            self.line(Phase::Extend, goal("a via point below", Via(k), via))?;
        }
        self.line(Phase::Extend, goal("the pose below", Slot, &waypoints.below))?;
        // The empty effector lifts to where the mean plane of the loaded wafer will be that of the slot.
        let resting = self.compensated_sag(effector, &waypoints.resting)?;
        self.line(Phase::Lift, goal("the resting pose in", Slot, &resting))?;
        let picked = self.hand_off(Handoff::Picked(effector, slot));
        self.loaded.push(effector);
        self.loaded.sort_unstable();
        self.line(Phase::Lift, goal("the pose above", Slot, &waypoints.above))?;
        for (k, via) in waypoints.via_above.iter().enumerate().rev() {
            self.line(Phase::Retract, goal("a via point above", Via(k), via))?;
        }
        self.line(
            Phase::Retract,
            goal("the retracted pose above", Retracted, &waypoints.retracted_above),
        )?;
        self.level();
        self.mark_in_station(slot, first);
        Ok(picked)
    }

    /// PUT: places the wafer into a slot; returns the index of the step at whose end it rests there.
    pub(super) fn put(
        &mut self,
        effector: EffectorId,
        slot: SlotId,
    ) -> Result<usize, ProgramProblem> {
        if !self.loaded.contains(&effector) {
            self.loaded.push(effector);
            self.loaded.sort_unstable();
        }
        let waypoints = self.waypoints(effector, slot)?;
        let goal = |what, point, target| Goal { what, effector, target, slot, point };
        let first = self.steps.len();
        self.pre_approach(goal("the retracted pose above", Retracted, &waypoints.retracted_above))?;
        for (k, via) in waypoints.via_above.iter().enumerate() {
            self.line(Phase::Extend, goal("a via point above", Via(k), via))?;
        }
        self.line(Phase::Extend, goal("the pose above", Slot, &waypoints.above))?;
        self.line(Phase::Lower, goal("the resting pose in", Slot, &waypoints.resting))?;
        let placed = self.hand_off(Handoff::Placed(effector, slot));
        self.loaded.retain(|&id| id != effector);
        self.line(Phase::Lower, goal("the pose below", Slot, &waypoints.below))?;
        for (k, via) in waypoints.via_below.iter().enumerate().rev() {
            self.line(Phase::Retract, goal("a via point below", Via(k), via))?;
        }
        self.line(
            Phase::Retract,
            goal("the retracted pose below", Retracted, &waypoints.retracted_below),
        )?;
        self.level();
        self.mark_in_station(slot, first);
        Ok(placed)
    }

    fn waypoints(
        &mut self,
        effector: EffectorId,
        slot: SlotId,
    ) -> Result<Arc<Waypoints>, ProgramProblem> {
        let found = self.ik_cache.waypoints(self.cell, effector, slot, &self.positions);
        found
            .map_err(|source| self.unreachable("the resting pose in", effector, slot, true, source))
    }

    /// Retracts the arms, levels, turns to a retracted pose with the motors alone, then moves there with the rods alone.
    fn pre_approach(&mut self, goal: Goal<'_>) -> Result<(), ProgramProblem> {
        self.retract_arms();
        self.level();
        let mut to = self.positions_at(goal)?;
        self.snap_to_retracted(&mut to, goal.effector, goal.slot.station);
        let mut turned = to.clone();
        turned[..RODS].copy_from_slice(&self.positions[..RODS]);
        self.change_posture(goal.effector, &turned);
        let distance = |(to, from): (&f64, &f64)| (to - from).abs();
        if turned.iter().zip(&self.positions).map(distance).fold(0.0, f64::max) > TURNED_TOLERANCE {
            self.push(Phase::Turn, turned, Path::PointToPoint);
        }
        self.move_to(Phase::Align, to, Path::PointToPoint);
        self.line_fraction = 0.0;
        Ok(())
    }

    /// Changes the posture of an arm to that of positions of all axes, where a single move to them would take the wafer outward.
    fn change_posture(&mut self, effector: EffectorId, to: &[f64]) {
        let robot = &self.cell.robot;
        let change = PostureChange::new(robot, effector, &self.positions, to);
        let Some(change) = change.filter(PostureChange::swings_out) else { return };
        let end = change.axes().map(|axis| to[axis]).collect();
        for waypoint in self.ik_cache.posture_change(robot, &change).iter().chain([&end]) {
            let mut to = self.positions.clone();
            change.axes().zip(waypoint).for_each(|(axis, &position)| to[axis] = position);
            self.push(Phase::PostureChange, to, Path::PointToPoint);
        }
    }

    /// Moves the motors that extend arms to their home positions, where an arm may be extended.
    fn retract_arms(&mut self) {
        if self.arms_retracted {
            return;
        }
        let mut to = self.positions.clone();
        for (axis, position) in to.iter_mut().enumerate().skip(RODS) {
            if !self.turning[axis] {
                *position = self.cell.robot.axes[axis].home;
            }
        }
        self.arms_retracted = true;
        self.move_to(Phase::RetractArms, to, Path::PointToPoint);
    }

    fn level(&mut self) {
        let rods = [self.positions[0], self.positions[1], self.positions[2]];
        if self.cell.robot.gpr.plane_tilt(&rods).angle > LEVEL_TOLERANCE {
            let to = self.positions_at_tilt(Tilt::LEVEL);
            let to = self.cell.robot.rounded(to, &self.positions);
            self.push(Phase::Level, to, Path::PointToPoint);
        }
    }

    /// Snaps an arm that is nearly retracted for a station to its retracted position, so that sequences repeat exactly and are found in caches.
    fn snap_to_retracted(&mut self, to: &mut [f64], effector: EffectorId, station: usize) {
        let found = self.retracted.entry((effector, station)).or_insert_with(|| {
            let motors = retracted_positions(self.cell, effector, station).unwrap_or_default();
            motors.into_iter().filter(|&(axis, _)| !self.turning[axis]).collect()
        });
        if found.iter().all(|&(axis, at)| (to[axis] - at).abs() <= RETRACTED_TOLERANCE) {
            found.iter().for_each(|&(axis, at)| to[axis] = at);
        }
    }

    /// Positions with another tilt, the platform plane crossing the base axis at the same height.
    fn positions_at_tilt(&self, tilt: Tilt) -> Vec<f64> {
        let gpr = &self.cell.robot.gpr;
        let rods = [self.positions[0], self.positions[1], self.positions[2]];
        let mut to = self.positions.clone();
        // Tilts beyond the limit have been rejected before.
        if let Ok(rods) = gpr.inverse(tilt, gpr.plane_height(&rods)) {
            to[..RODS].copy_from_slice(&rods);
        }
        to
    }

    /// A Cartesian line to a goal.
    fn line(&mut self, phase: Phase, goal: Goal<'_>) -> Result<(), ProgramProblem> {
        let mut to = self.positions_at(goal)?;
        if phase == Phase::Retract {
            self.snap_to_retracted(&mut to, goal.effector, goal.slot.station);
        }
        let from = self.line_fraction;
        self.push(phase, to, Path::Line(goal.effector));
        if let Some(postures) = self.postures(goal.effector, goal.slot.station)?
            && let Some(step) = self.steps.last_mut()
        {
            let fraction = postures.fraction(goal.point);
            step.postures = Some(LinePostures {
                path: Arc::clone(&postures.path),
                fractions: [from, fraction],
                prescribes_heading: postures.prescribes_heading,
            });
            self.line_fraction = fraction;
        }
        if matches!(phase, Phase::Lift | Phase::Lower) {
            let speed = self.cell.stations[goal.slot.station].stroke.speed;
            if let Some(step) = self.steps.last_mut() {
                step.line_speed = Some(speed);
            }
        }
        Ok(())
    }

    /// A step, unless the robot is there already.
    fn move_to(&mut self, phase: Phase, to: Vec<f64>, path: Path) {
        if to != self.positions {
            self.push(phase, to, path);
        }
    }

    fn push(&mut self, phase: Phase, to: Vec<f64>, path: Path) {
        let from = std::mem::replace(&mut self.positions, to.clone());
        self.steps.push(Step {
            instruction: self.instruction,
            place: self.place,
            phase,
            from,
            to,
            path,
            speed_scaling: self.speed_scaling,
            blend_radius: self.blend_radius,
            postures: None,
            line_speed: None,
            loaded: self.loaded.clone(),
            handoff: None,
            slot: None,
        });
    }

    /// Sets the hand-off at the end of the last step, a line, and returns the index of that step.
    fn hand_off(&mut self, handoff: Handoff) -> usize {
        let last = self.steps.len() - 1;
        self.steps[last].handoff = Some(handoff);
        last
    }

    /// Marks the steps from an index on that are within the station.
    fn mark_in_station(&mut self, slot: SlotId, first: usize) {
        for step in &mut self.steps[first..] {
            let is_in_station =
                matches!(step.phase, Phase::Extend | Phase::Lift | Phase::Lower | Phase::Retract);
            step.slot = is_in_station.then_some(slot);
        }
    }
}
