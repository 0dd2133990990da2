//! From steps to a trajectory.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector3;

use super::blend::Blend;
use super::blend_planner::{BlendPlanner, StepSegments};
use super::cartesian_path::{CartesianLine, CartesianPath, PathError};
use super::error::{StepError, StepErrorKind, TrajectoryError};
use super::lift::LoweredStep;
use super::limits::{axis_moves_effector, scaled_axis_limits};
use super::options::TrajectoryOptions;
use super::posture_spline::PostureSpline;
use super::segment::Segment;
use super::segment_key::{moves, shared_key};
use super::segment_motion::SegmentMotion;
use super::slip::{friction_constraints, without_slip};
use super::synchronized::synchronized_profile;
use super::time_parameterization::TimeParameterization;
use super::trajectory::Trajectory;
use crate::incremental::{
    CacheKey, CacheStats, GenerationalCache, Interrupted, JobContext, WithId, compute_missing,
    uninterrupted,
};
use crate::program::{Path, Step};
use crate::robot::{ArmChain, AxesMotion, AxisKind, EffectorId, KinematicLimits, RODS};
use crate::workcell::Cell;

/// Longest duration of a trajectory: a day (s).
pub const MAX_DURATION: f64 = 86_400.0;

/// Plans the trajectory of steps: as fast as the limits of the axes allow, from rest to rest or, where the steps ask for it, blended.
///
/// # Errors
/// [`TrajectoryError`] with every step that has no trajectory.
pub fn plan_trajectory(
    cell: &Cell,
    steps: Vec<Step>,
    options: &TrajectoryOptions,
) -> Result<Trajectory, TrajectoryError> {
    uninterrupted(SegmentCache::default().plan_trajectory(
        cell,
        steps,
        options,
        JobContext::unmonitored(),
    ))
}

/// Segments and blends of the last trajectory, by what they depend on.
#[derive(Default)]
pub(crate) struct SegmentCache {
    motions: GenerationalCache<WithId<SegmentMotion>>,
    blends: BlendPlanner,
}

/// Result of planning one segment.
type Planned<T> = Result<T, StepErrorKind>;

/// Errors of steps, found while their segments are planned.
struct Errors<'a> {
    steps: &'a [Step],
    found: Vec<StepError>,
}

impl Errors<'_> {
    /// The segment of a step; the error is recorded, and a dwell without duration takes its place.
    fn or_empty(&mut self, step: usize, planned: Planned<Segment>) -> Segment {
        planned.unwrap_or_else(|kind| {
            let Step { instruction, place, phase, .. } = self.steps[step];
            self.found.push(StepError { step, instruction, place, phase, kind });
            Segment::dwell(0.0)
        })
    }
}

/// Start times and blends of all segments.
struct Timeline {
    times: Vec<f64>,
    blends: Vec<Option<Blend>>,
}

impl SegmentCache {
    /// As [`plan_trajectory`], with the results of the last trajectory.
    pub(crate) fn plan_trajectory(
        &mut self,
        cell: &Cell,
        steps: Vec<Step>,
        options: &TrajectoryOptions,
        context: JobContext<'_>,
    ) -> Result<Result<Trajectory, TrajectoryError>, Interrupted> {
        let shared = shared_key(cell, options);
        self.motions.begin(&shared);
        self.blends.begin(cell, &shared);
        let mut errors = Errors { steps: &steps, found: Vec::new() };
        let mut segments = self.segments_of(cell, options, &mut errors, context)?;
        self.blends.slow(cell, &steps, &mut segments, context)?;
        let timeline = self.timeline(cell, &mut segments, &mut errors, context)?;
        self.motions.end();
        self.blends.end();
        let mut found = errors.found;
        found.sort_by_key(|error| error.step);
        let Timeline { times, blends } = timeline;
        Ok(if found.is_empty() {
            Ok(Trajectory { steps, times, segments, blends })
        } else {
            Err(TrajectoryError { steps: found })
        })
    }

    /// Segments of all steps, from rest to rest; the duration of waits for processes is still open.
    fn segments_of(
        &mut self,
        cell: &Cell,
        options: &TrajectoryOptions,
        errors: &mut Errors<'_>,
        context: JobContext<'_>,
    ) -> Result<Vec<Segment>, Interrupted> {
        let steps = errors.steps;
        let moving: BTreeMap<usize, LoweredStep> = (0..steps.len())
            .filter(|&index| moves(&steps[index]) && invalid(cell, steps, index).is_none())
            .map(|index| (index, LoweredStep::new(&cell.robot, &steps[index])))
            .collect();
        let missing = moving.iter().map(|(index, lowered)| (*index, &lowered.key));
        let missing = missing.filter(|(_, key)| !self.motions.contains(key));
        let plan = |lowered: &LoweredStep| plan_motion(cell, lowered, options);
        let mut computed = compute_missing(missing, context, |index| plan(&moving[&index]))?;
        let mut segments = Vec::with_capacity(steps.len());
        for (index, step) in steps.iter().enumerate() {
            let planned = match (invalid(cell, steps, index), moving.get(&index)) {
                (Some(error), _) => Err(error),
                (None, Some(lowered)) => {
                    // Errors are not cached: a second step like this one plans again and reports its own.
                    let found = computed.remove(&lowered.key);
                    let motion = || found.unwrap_or_else(|| plan(lowered)).map(WithId::new);
                    let motion = self.motions.get_or_compute(lowered.key.clone(), motion);
                    motion.map(|motion| Segment::lifted(motion, lowered.lift))
                }
                (None, None) => match step.path {
                    Path::Dwell(duration) => self.dwell(duration, step),
                    // The duration is known once the start times of all steps before are known.
                    _ => Ok(Segment::dwell(0.0)),
                },
            };
            segments.push(errors.or_empty(index, planned));
        }
        Ok(segments)
    }

    /// A dwell, which depends on its duration alone.
    fn dwell(&mut self, duration: f64, step: &Step) -> Planned<Segment> {
        let inputs = CacheKey::default().with(&duration);
        let plan = || plan_dwell(duration, step).map(WithId::new);
        self.motions.get_or_compute(inputs, plan).map(|motion| Segment::lifted(motion, 0.0))
    }

    /// Determines the start times of all segments: blends neighbours, and determines the waits for processes.
    fn timeline(
        &mut self,
        cell: &Cell,
        segments: &mut [Segment],
        errors: &mut Errors<'_>,
        context: JobContext<'_>,
    ) -> Result<Timeline, Interrupted> {
        let steps = errors.steps;
        let mut blends: Vec<Option<Blend>> = vec![None; steps.len()];
        let mut times = Vec::with_capacity(steps.len() + 1);
        let (mut now, mut is_over) = (0.0, false);
        times.push(now);
        for (index, step) in steps.iter().enumerate() {
            context.check_interruption()?;
            if let Path::ProcessDwell { placed_at_step, seconds } = step.path {
                let planned = if placed_at_step < index {
                    // Summed over the steps since the wafer was placed, not as a difference of times: the same steps make the same wait wherever they are in a program, to the bit.
                    let moved: f64 =
                        segments[placed_at_step + 1..index].iter().map(|one| one.duration()).sum();
                    let overlaps = blends[placed_at_step + 1..index].iter().flatten();
                    let overlaps: f64 = overlaps.map(|blend| blend.overlap).sum();
                    let half = blends[placed_at_step].map_or(0.0, |blend| 0.5 * blend.overlap);
                    self.dwell((seconds - (moved - overlaps - half)).max(0.0), step)
                } else {
                    Err(StepErrorKind::ProcessNotStarted)
                };
                segments[index] = errors.or_empty(index, planned);
            }
            let planned = StepSegments { steps, segments };
            if let Some(before) = index.checked_sub(1)
                && let Some(blend) = self.blends.blend(cell, planned, before)
            {
                // Each of the two steps owns half of the overlap.
                times[index] -= 0.5 * blend.overlap;
                now -= blend.overlap;
                blends[before] = Some(blend);
            }
            now += segments[index].duration();
            times.push(now);
            // Only the first step that ends too late is reported: all later ones end later still.
            let is_too_long = now.is_nan() || now > MAX_DURATION;
            if is_too_long && !is_over {
                is_over = true;
                let (end, step) = (now, segments[index].duration());
                let error = StepErrorKind::TooLong { end, step, allowed: MAX_DURATION };
                segments[index] = errors.or_empty(index, Err(error));
            }
        }
        Ok(Timeline { times, blends })
    }

    /// Cache statistics of the segments in the last trajectory.
    pub(crate) fn stats(&self) -> CacheStats {
        self.motions.stats()
    }
}

/// Error of a step that is invalid whatever the robot can do.
fn invalid(cell: &Cell, steps: &[Step], index: usize) -> Option<StepErrorKind> {
    let step = &steps[index];
    let axes = cell.robot.axes.len();
    if step.from.len() != axes || step.to.len() != axes {
        let (from, to) = (step.from.len(), step.to.len());
        return Some(StepErrorKind::PositionCount { from, to, axes });
    }
    if let Some(&value) = step.from.iter().chain(&step.to).find(|value| !value.is_finite()) {
        return Some(StepErrorKind::PositionNotFinite { value });
    }
    if !(step.speed_scaling > 0.0 && step.speed_scaling <= 1.0) {
        return Some(StepErrorKind::SpeedScaling { value: step.speed_scaling });
    }
    let previous = index.checked_sub(1).map(|before| &steps[before].to)?;
    let axis = previous.iter().zip(&step.from).position(|(end, start)| end != start)?;
    let (start, previous_end) = (step.from[axis], previous[axis]);
    Some(StepErrorKind::NotContinuous { axis, start, previous_end })
}

fn plan_dwell(duration: f64, step: &Step) -> Planned<SegmentMotion> {
    if !(duration >= 0.0 && duration.is_finite()) {
        return Err(StepErrorKind::DwellDuration { duration });
    }
    if step.from != step.to {
        return Err(StepErrorKind::DwellMoves);
    }
    Ok(SegmentMotion::Dwell { duration })
}

/// The motion of a step over the height of its rods; places in errors are those of the step.
fn plan_motion(
    cell: &Cell,
    lowered: &LoweredStep,
    options: &TrajectoryOptions,
) -> Planned<SegmentMotion> {
    plan_step(cell, &lowered.step, options).map_err(|error| match error {
        StepErrorKind::Path(PathError { fraction, position, kind }) => {
            let position = position.map(|position| position + Vector3::z() * lowered.lift);
            StepErrorKind::Path(PathError { fraction, position, kind })
        }
        error => error,
    })
}

/// The motion of a step that moves.
fn plan_step(cell: &Cell, step: &Step, options: &TrajectoryOptions) -> Planned<SegmentMotion> {
    match step.path {
        Path::Line(_) if step.from == step.to => Ok(SegmentMotion::Dwell { duration: 0.0 }),
        Path::Line(effector) => {
            parameterized_line(cell, step, follow_line(cell, step, effector, options)?)
        }
        _ => {
            let limits = |axis| scaled_axis_limits(&cell.robot, axis, step);
            let motion =
                SegmentMotion::PointToPoint(synchronized_profile(&step.from, &step.to, limits)?);
            Ok(without_slip(cell, step, motion, || joint_line_with_friction(cell, step)))
        }
    }
}

/// A step along its joint-space line, as fast as its axes and the friction of the wafers allow; `None` where no rate satisfies the constraints.
fn joint_line_with_friction(cell: &Cell, step: &Step) -> Option<SegmentMotion> {
    let path = Arc::new(CartesianPath::joint_space_line(&step.from, &step.to));
    let limits = step_limits(cell, step);
    let constraints = |at: &AxesMotion<'_>| friction_constraints(cell, step, at);
    let parameter = TimeParameterization::new(&path.spline, &limits, f64::INFINITY)
        .plan_with_friction(&constraints)?;
    Some(SegmentMotion::Line { path, parameter })
}

/// Limits of all axes in a step.
fn step_limits(cell: &Cell, step: &Step) -> Vec<KinematicLimits> {
    let robot = &cell.robot;
    (0..robot.axes.len()).map(|axis| scaled_axis_limits(robot, axis, step)).collect()
}

/// A line as fast as its axes, a prescribed speed and the friction of the wafers allow.
fn parameterized_line(cell: &Cell, step: &Step, path: CartesianPath) -> Planned<SegmentMotion> {
    let limits = step_limits(cell, step);
    let max_rate = match step.line_speed {
        Some(speed) if path.length > 0.0 => speed / path.length,
        _ => f64::INFINITY,
    };
    let path = Arc::new(path);
    let parameterization = TimeParameterization::new(&path.spline, &limits, max_rate);
    let line = |parameter| SegmentMotion::Line { path: Arc::clone(&path), parameter };
    Ok(without_slip(cell, step, line(parameterization.plan()?), || {
        let constraints = |at: &AxesMotion<'_>| friction_constraints(cell, step, at);
        parameterization.plan_with_friction(&constraints).map(line)
    }))
}

/// The path of the axes along a Cartesian line.
fn follow_line(
    cell: &Cell,
    step: &Step,
    effector: EffectorId,
    options: &TrajectoryOptions,
) -> Planned<CartesianPath> {
    let robot = &cell.robot;
    let loaded = step.loaded.contains(&effector);
    let chain = ArmChain::new(robot, effector);
    let pose = |positions: &[f64]| cell.wafer_pose_by(&chain, positions, loaded);
    let jacobian = |positions: &[f64]| robot.jacobian_by(&chain, positions);
    let variables: Vec<usize> =
        (0..robot.axes.len()).filter(|&axis| axis_moves_effector(robot, axis, effector)).collect();
    // Three rods and two motors determine the centre and the plane; with a third motor the heading can be controlled, unless the postures determine it.
    let heading_is_controlled = variables.len() >= RODS + 3
        && step.postures.as_ref().is_none_or(|postures| postures.prescribes_heading);
    let postures = step.postures.as_ref().map(|postures| PostureSpline::new(&chain, postures));
    let turn: f64 = robot.arms[effector.arm]
        .joints
        .iter()
        .filter(|joint| joint.kind == AxisKind::Rotary)
        .flat_map(|joint| &joint.drives)
        .map(|&(axis, ratio)| ratio * (step.to[axis] - step.from[axis]))
        .sum();
    let line = CartesianLine {
        from: &step.from,
        to: &step.to,
        variables,
        turn: heading_is_controlled.then_some(turn),
        pose: &pose,
        jacobian: &jacobian,
        max_deviation: options.max_line_deviation,
        postures: postures.as_ref(),
    };
    Ok(line.follow()?)
}
