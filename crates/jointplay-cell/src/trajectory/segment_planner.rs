//! From steps to a motion.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::blend::{Blend, Blends};
use super::cartesian_path::{Line, Task};
use super::limits::{axis_moves_effector, scaled_axis_limits};
use super::profile::JerkLimitedProfile;
use super::spline::Spline;
use super::synchronized::together;
use super::time_parameterization::TimeParameterization;
use super::{Segment, Trajectory};
use crate::incremental::{CacheStats, Interrupted, Kept, Key, Run, anew, extend, whole};
use crate::program::{Path, Place, Step};
use crate::robot::{ArmChain, AxisKind, EffectorId, KinematicLimits, RODS};
use crate::workcell::Cell;

/// The longest motion that is timed: a day [s].
pub const MAX_DURATION: f64 = 86_400.0;

/// What is left to choose of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryOptions {
    /// Largest distance of a wafer's centre from a straight line that it is told to keep to [m].
    pub line_deviation: f64,
}

impl Default for TrajectoryOptions {
    fn default() -> Self {
        Self { line_deviation: 1e-6 }
    }
}

/// Steps that cannot be timed, each with its reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct TrajectoryError {
    /// In the order of the steps; one at least.
    pub problems: Vec<StepError>,
}

/// A step that cannot be timed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {}: {message}", place.line)]
pub struct StepError {
    /// Index of the step.
    pub step: usize,
    /// Index of its instruction in the order of running.
    pub instruction: usize,
    /// Where that is written.
    pub place: Place,
    /// What is the matter, and what to try.
    pub message: String,
}

/// Steps in time: as fast as the limits of the axes allow, from rest to rest or, where that is asked for, one into the next.
///
/// # Errors
/// Every step that cannot be timed, none hidden by the first: a share of speed out of range, a start that is not the end before, a line that cannot be followed, an end after more than [`MAX_DURATION`].
pub fn plan_trajectory(
    cell: &Cell,
    steps: Vec<Step>,
    options: &TrajectoryOptions,
) -> Result<Trajectory, TrajectoryError> {
    whole(SegmentCache::default().plan_trajectory(cell, steps, options, Run::one_by_one()))
}

/// Mean duration of a straight path of all axes by its longest coordinate [s/m or s/rad].
const STRAIGHT_PACE: f64 = 2.0;
/// Shortest and longest duration of a straight path of all axes [s].
const STRAIGHT_DURATION: [f64; 2] = [0.02, 20.0];

/// One step whose axes go straight from its start to its end, all in proportion, from rest to rest; for what depends on the path and not on its time.
pub(crate) fn straight(step: Step) -> Trajectory {
    let way = |(from, to): (&f64, &f64)| (to - from).abs();
    let longest = step.from.iter().zip(&step.to).map(way).fold(0.0, f64::max);
    let way = if longest == 0.0 {
        Segment::Dwell { duration: 0.0 }
    } else {
        let [least, most] = STRAIGHT_DURATION;
        let quarter = 0.25 * (STRAIGHT_PACE * longest).clamp(least, most);
        let stretches = [(quarter, 1.0), (2.0 * quarter, -1.0), (quarter, 1.0)];
        let spline = Spline::straight(&step.from, &step.to);
        let line = Arc::new(Line { spline, length: 0.0, deviation: 0.0, plane: 0.0 });
        Segment::Line { line, pace: JerkLimitedProfile::through(0.0, 1.0, &stretches) }
    };
    let times = vec![0.0, way.duration()];
    Trajectory { steps: vec![step], times, ways: vec![Arc::new(way)], blends: vec![None] }
}

/// The ways of the last motion, by what they depend on.
#[derive(Default)]
pub(crate) struct SegmentCache {
    ways: Kept<Segment>,
    blends: Blends,
}

impl SegmentCache {
    /// See [`plan_trajectory`].
    pub(crate) fn plan_trajectory(
        &mut self,
        cell: &Cell,
        steps: Vec<Step>,
        options: &TrajectoryOptions,
        run: Run<'_>,
    ) -> Result<Result<Trajectory, TrajectoryError>, Interrupted> {
        let shared = shared(cell, options);
        self.ways.begin(&shared);
        self.blends.begin(cell, &shared);
        let keys: Vec<(usize, Key)> = (0..steps.len())
            .filter(|&index| fits(cell, &steps, index).is_none())
            .filter_map(|index| Some((index, moving(&steps[index])?)))
            .collect();
        let unknown = keys.iter().map(|(index, key)| (*index, key));
        let unknown = unknown.filter(|(_, key)| !self.ways.knows(key));
        let mut made = anew(unknown, run, |index| way(cell, &steps[index], options))?;
        let mut problems = Vec::new();
        let mut failed = |index: usize, message| {
            let Step { instruction, place, .. } = steps[index];
            problems.push(StepError { step: index, instruction, place, message });
            Arc::new(Segment::Dwell { duration: 0.0 })
        };
        let mut ways: Vec<Arc<Segment>> = Vec::with_capacity(steps.len());
        for (index, step) in steps.iter().enumerate() {
            let way = match fits(cell, &steps, index) {
                Some(message) => Err(message),
                None => self.way((cell, step, options), &mut made),
            };
            ways.push(way.unwrap_or_else(|message| failed(index, message)));
        }
        let factors = self.blends.slow(cell, &steps, &mut ways, run)?;
        let mut blends: Vec<Option<Blend>> = vec![None; steps.len()];
        let mut times = Vec::with_capacity(steps.len() + 1);
        let (mut now, mut over) = (0.0, false);
        times.push(now);
        for (index, step) in steps.iter().enumerate() {
            run.poll()?;
            if let Path::ProcessDwell { since, seconds } = step.path {
                // Known only now that it is known when the wafer was left.
                let way = if since < index {
                    // By the moves since then alone, so that the same moves make the same wait wherever they are in a program.
                    let moved: f64 = ways[since + 1..index].iter().map(|way| way.duration()).sum();
                    let gained = blends[since + 1..index].iter().flatten();
                    let gained: f64 = gained.map(|blend| blend.overlap).sum();
                    let half = blends[since].map_or(0.0, |blend| 0.5 * blend.overlap);
                    self.still((seconds - (moved - gained - half)).max(0.0), step)
                } else {
                    Err("waits for a station that gets its wafer only later".into())
                };
                ways[index] = way.unwrap_or_else(|message| failed(index, message));
            }
            if let Some(before) = index.checked_sub(1)
                && let Some(blend) = self.blends.at(cell, &steps, &ways, &factors, before)
            {
                // Half of the overlap belongs to either.
                times[index] -= 0.5 * blend.overlap;
                now -= blend.overlap;
                blends[before] = Some(blend);
            }
            now += ways[index].duration();
            times.push(now);
            // The first step that does not end in time; those after it end later still.
            let is_too_long = now.is_nan() || now > MAX_DURATION;
            if is_too_long && !over {
                over = true;
                let own = ways[index].duration();
                ways[index] = failed(index, too_long(now, own));
            }
        }
        self.ways.end();
        self.blends.end();
        problems.sort_by_key(|problem| problem.step);
        Ok(if problems.is_empty() {
            Ok(Trajectory { steps, times, ways, blends })
        } else {
            Err(TrajectoryError { problems })
        })
    }

    fn way(
        &mut self,
        (cell, step, options): (&Cell, &Step, &TrajectoryOptions),
        made: &mut BTreeMap<Key, Result<Segment, String>>,
    ) -> Result<Arc<Segment>, String> {
        if let Some(key) = moving(step) {
            // One that cannot be timed is not kept, and told of each step alike.
            let found = made.remove(&key);
            return self.ways.get(key, || found.unwrap_or_else(|| way(cell, step, options)));
        }
        match step.path {
            Path::Dwell(duration) => self.still(duration, step),
            // How long is known only when all before it is.
            _ => Ok(Arc::new(Segment::Dwell { duration: 0.0 })),
        }
    }

    /// Known by how long it is alone: where it stands is the step's.
    fn still(&mut self, duration: f64, step: &Step) -> Result<Arc<Segment>, String> {
        self.ways.get(vec![duration.to_bits()], || still(duration, step))
    }

    pub(crate) fn reuse(&self) -> CacheStats {
        self.ways.reuse()
    }
}

/// What every way depends on: numbers are printed so that no two of them look alike.
fn shared(cell: &Cell, options: &TrajectoryOptions) -> String {
    format!("{:?} {:?} {:?} {:?}", cell.robot, cell.wafer, cell.gravity, options.line_deviation)
}

/// What the way of a step depends on besides, unless it stands still.
fn moving(step: &Step) -> Option<Key> {
    matches!(step.path, Path::PointToPoint | Path::Line(_)).then(|| key(step))
}

/// How the axes go in a step that moves.
fn way(cell: &Cell, step: &Step, options: &TrajectoryOptions) -> Result<Segment, String> {
    match step.path {
        Path::Line(effector) => along(cell, step, effector, options),
        _ => together(&step.from, &step.to, |axis| scaled_axis_limits(&cell.robot, axis, step))
            .map(Segment::PointToPoint)
            .map_err(|error| error.to_string()),
    }
}

/// What the way of a step that moves depends on.
pub(super) fn key(step: &Step) -> Key {
    let mut key = match step.path {
        Path::Line(effector) => vec![1, effector.arm as u64, effector.effector as u64],
        _ => vec![0],
    };
    extend(&mut key, &step.from);
    extend(&mut key, &step.to);
    extend(&mut key, &[step.speed, step.line_speed.unwrap_or(f64::INFINITY)]);
    key.extend(step.loaded.iter().flat_map(|id| [id.arm as u64, id.effector as u64]));
    key
}

/// What is wrong with a step before it is looked at closely.
fn fits(cell: &Cell, steps: &[Step], index: usize) -> Option<String> {
    let step = &steps[index];
    let axes = cell.robot.axes.len();
    if step.from.len() != axes || step.to.len() != axes {
        return Some(format!(
            "a step from {} to {} positions, but the robot has {axes} axes",
            step.from.len(),
            step.to.len()
        ));
    }
    if let Some(value) = step.from.iter().chain(&step.to).find(|value| !value.is_finite()) {
        return Some(format!("a position is {value}, but has to be a finite number"));
    }
    if !(step.speed > 0.0 && step.speed <= 1.0) {
        return Some(format!(
            "the share of speed is {}, but has to be above 0 and at most 1",
            step.speed
        ));
    }
    let earlier = index.checked_sub(1).map(|before| &steps[before].to)?;
    let jump = earlier.iter().zip(&step.from).position(|(end, start)| end != start)?;
    Some(format!(
        "axis {} starts at {}, but the step before ends at {}: steps have to join",
        cell.robot.axes[jump].name, step.from[jump], earlier[jump]
    ))
}

/// Why a step ends too late.
fn too_long(end: f64, own: f64) -> String {
    let allowed = MAX_DURATION;
    if own > allowed {
        format!(
            "this motion alone takes {own:.0} s, but a program takes at most {allowed:.0} s, a day: raise the speed, acceleration and jerk limits of the axes that move, or SPEED"
        )
    } else {
        format!(
            "the program has run for {end:.0} s where this ends, but takes at most {allowed:.0} s, a day: raise limits or SPEED, wait for a shorter time, or divide the program"
        )
    }
}

fn still(duration: f64, step: &Step) -> Result<Segment, String> {
    if !(duration >= 0.0 && duration.is_finite()) {
        return Err(format!("waits {duration} s, but that has to be a finite time from 0 on"));
    }
    if step.from != step.to {
        return Err("stands still, but ends elsewhere than it starts".into());
    }
    Ok(Segment::Dwell { duration })
}

fn along(
    cell: &Cell,
    step: &Step,
    effector: EffectorId,
    options: &TrajectoryOptions,
) -> Result<Segment, String> {
    if step.from == step.to {
        return Ok(Segment::Dwell { duration: 0.0 });
    }
    let robot = &cell.robot;
    let loaded = step.loaded.contains(&effector);
    let planar = ArmChain::new(robot, effector);
    let pose = |positions: &[f64]| {
        let found = cell.wafer_pose_by((effector, &planar), positions, loaded);
        found.map_err(|error| error.to_string())
    };
    let jacobian = |positions: &[f64]| {
        robot.jacobian_by(&planar, positions).map_err(|error| error.to_string())
    };
    let variables: Vec<usize> =
        (0..robot.axes.len()).filter(|&axis| axis_moves_effector(robot, axis, effector)).collect();
    // Two motors of an arm place the wafer's centre; from three on they also turn it.
    let free = variables.len() >= RODS + 3;
    let turn: f64 = robot.arms[effector.arm]
        .joints
        .iter()
        .filter(|joint| joint.kind == AxisKind::Rotary)
        .flat_map(|joint| &joint.drives)
        .map(|&(axis, ratio)| ratio * (step.to[axis] - step.from[axis]))
        .sum();
    let task = Task {
        from: &step.from,
        to: &step.to,
        variables,
        turn: free.then_some(turn),
        pose: &pose,
        jacobian: &jacobian,
        deviation: options.line_deviation,
    };
    let line = task.follow().map_err(|stuck| stuck.told(robot))?;
    let limits: Vec<KinematicLimits> =
        (0..robot.axes.len()).map(|axis| scaled_axis_limits(robot, axis, step)).collect();
    let rate = match step.line_speed {
        Some(speed) if line.length > 0.0 => speed / line.length,
        _ => f64::INFINITY,
    };
    let pace = TimeParameterization::new(&line.spline, &limits, rate)
        .plan()
        .map_err(|error| error.to_string())?;
    Ok(Segment::Line { line: Arc::new(line), pace })
}
