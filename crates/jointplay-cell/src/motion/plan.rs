//! From steps to a motion.

use super::axes::together;
use super::blend::{Blend, blend};
use super::limits::{dynamics, moves};
use super::line::Task;
use super::pace::Pace;
use super::{Motion, Way};
use crate::cell::Cell;
use crate::program::{Path, Place, Step};
use crate::robot::{Dynamics, EffectorId, MotionKind, RODS};

/// What is left to choose of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionOptions {
    /// Largest distance of a wafer's centre from a straight line that it is told to keep to [m].
    pub line_deviation: f64,
}

impl Default for MotionOptions {
    fn default() -> Self {
        Self { line_deviation: 1e-6 }
    }
}

/// Steps that cannot be timed, each with its reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct MotionError {
    /// In the order of the steps; one at least.
    pub problems: Vec<StepProblem>,
}

/// A step that cannot be timed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {}: {message}", place.line)]
pub struct StepProblem {
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
/// Every step that cannot be timed, none hidden by the first: a share of speed out of range, a start that is not the end before, a line that cannot be followed.
pub fn timed(
    cell: &Cell,
    steps: Vec<Step>,
    options: &MotionOptions,
) -> Result<Motion, MotionError> {
    let mut problems = Vec::new();
    let mut times = Vec::with_capacity(steps.len() + 1);
    let mut ways: Vec<Way> = Vec::with_capacity(steps.len());
    let mut blends: Vec<Option<Blend>> = vec![None; steps.len()];
    // How much of a step has run by the end of the one before.
    let mut early = 0.0;
    let mut now = 0.0;
    times.push(now);
    for (index, step) in steps.iter().enumerate() {
        let way = match fits(cell, &steps, index) {
            Some(message) => Err(message),
            None => way(cell, step, options, now, &times),
        };
        let way = way.unwrap_or_else(|message| {
            let (instruction, place) = (step.instruction, step.place);
            problems.push(StepProblem { step: index, instruction, place, message });
            Way::Still { duration: 0.0 }
        });
        if let Some(before) = index.checked_sub(1).filter(|_| problems.is_empty()) {
            let (pair, two) = ([&steps[before], step], [&ways[before], &way]);
            if let Some(found) = blend(cell, pair, two) {
                early = found.overlap;
                times[index] = now - 0.5 * early;
                blends[before] = Some(found);
            }
        }
        now += way.duration() - std::mem::take(&mut early);
        times.push(now);
        ways.push(way);
    }
    if problems.is_empty() {
        Ok(Motion { steps, times, ways, blends })
    } else {
        Err(MotionError { problems })
    }
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

fn way(
    cell: &Cell,
    step: &Step,
    options: &MotionOptions,
    now: f64,
    times: &[f64],
) -> Result<Way, String> {
    let limits = |axis| dynamics(&cell.robot, axis, step);
    match step.path {
        Path::Still(duration) => still(duration, step),
        Path::Processed { since, seconds } => {
            let left = times
                .get(since + 1)
                .ok_or("waits for a station that gets its wafer only later".to_string())?;
            still((left + seconds - now).max(0.0), step)
        }
        Path::Axes => together(&step.from, &step.to, limits).map(Way::Axes),
        Path::Line(effector) => along(cell, step, effector, options),
    }
}

fn still(duration: f64, step: &Step) -> Result<Way, String> {
    if !(duration >= 0.0 && duration.is_finite()) {
        return Err(format!("waits {duration} s, but that has to be a finite time from 0 on"));
    }
    if step.from != step.to {
        return Err("stands still, but ends elsewhere than it starts".into());
    }
    Ok(Way::Still { duration })
}

fn along(
    cell: &Cell,
    step: &Step,
    effector: EffectorId,
    options: &MotionOptions,
) -> Result<Way, String> {
    if step.from == step.to {
        return Ok(Way::Still { duration: 0.0 });
    }
    let robot = &cell.robot;
    let loaded = step.loaded.contains(&effector);
    let pose = |positions: &[f64]| {
        cell.wafer_pose(effector, positions, loaded).map_err(|error| error.to_string())
    };
    let jacobian = |positions: &[f64]| {
        robot.effector_jacobian(positions, effector).map_err(|error| error.to_string())
    };
    let variables: Vec<usize> =
        (0..robot.axes.len()).filter(|&axis| moves(robot, axis, effector)).collect();
    // Two motors of an arm place the wafer's centre; from three on they also turn it.
    let free = variables.len() >= RODS + 3;
    let turn: f64 = robot.arms[effector.arm]
        .joints
        .iter()
        .filter(|joint| joint.kind == MotionKind::Turn)
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
    let line = task
        .follow()
        .map_err(|stuck| format!("{:.1} % along the line: {}", 100.0 * stuck.at, stuck.why))?;
    let limits: Vec<Dynamics> =
        (0..robot.axes.len()).map(|axis| dynamics(robot, axis, step)).collect();
    let rate = match step.line_speed {
        Some(speed) if line.length > 0.0 => speed / line.length,
        _ => f64::INFINITY,
    };
    let pace = Pace { spline: &line.spline, limits: &limits, rate }.plan()?;
    Ok(Way::Line { line, pace })
}
