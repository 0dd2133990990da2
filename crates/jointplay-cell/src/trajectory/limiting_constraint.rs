//! Constraint that limits the duration of a step: an axis with one of its limits, a prescribed speed, or friction.

use std::collections::BTreeMap;

use super::limits::scaled_axis_limits;
use super::segment::Segment;
use super::segment_motion::SegmentMotion;
use super::slip::utilization;
use super::trajectory::Trajectory;
use crate::program::Step;
use crate::robot::EffectorId;
use crate::workcell::Cell;

/// Number of times at which the limits of a step are compared.
const SAMPLES: usize = 120;
/// Fraction of a limit from which on it binds: the slowdown of a whole segment leaves a few percent of all other limits unused.
const BINDING_FRACTION: f64 = 0.95;

/// A limit that a motion can reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionLimit {
    /// Velocity of an axis, by its index.
    Velocity(usize),
    /// Acceleration of an axis, by its index.
    Acceleration(usize),
    /// Jerk of an axis, by its index.
    Jerk(usize),
    /// The speed that the program or the station prescribes for a line.
    LineSpeed,
    /// Friction under the wafer of an effector.
    Friction(EffectorId),
}

/// The limit that determines the duration of a step: the one that binds for most of the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitingConstraint {
    /// The limit.
    pub limit: MotionLimit,
    /// Fraction of the duration in which the limit binds, from 0 to 1.
    pub time_fraction: f64,
    /// Fractions of the path at which it binds first and last: of the line, or of the displacement of the slowest axis.
    pub path_fractions: [f64; 2],
}

/// Times at which one limit binds.
struct Binding {
    count: usize,
    path_fractions: [f64; 2],
}

impl Trajectory {
    /// The limiting constraint of each step, from rest to rest without its blends; `None` where no limit binds for a hundredth of the time: at dwells, in steps that are slower for a longer blend, and where limits bind at single places of a path.
    #[must_use]
    pub fn limiting_constraints(&self, cell: &Cell) -> Vec<Option<LimitingConstraint>> {
        let mut known = BTreeMap::new();
        let steps = self.steps.iter().zip(&self.segments);
        let constraint = |(step, Segment { motion, .. }): (&Step, &Segment)| {
            // Neither limits nor friction depend on the height of the rods.
            *known
                .entry(motion.identity())
                .or_insert_with(|| limiting_constraint(cell, step, motion))
        };
        steps.map(constraint).collect()
    }
}

/// The limiting constraint of a motion.
fn limiting_constraint(
    cell: &Cell,
    step: &Step,
    motion: &SegmentMotion,
) -> Option<LimitingConstraint> {
    most_frequent(motion, |time| {
        axis_limit(cell, step, motion, time).or_else(|| friction_limit(cell, step, motion, time))
    })
}

/// The limit that binds at most of the sampled times.
fn most_frequent(
    motion: &SegmentMotion,
    binding: impl Fn(f64) -> Option<MotionLimit>,
) -> Option<LimitingConstraint> {
    let mut all: BTreeMap<MotionLimit, Binding> = BTreeMap::new();
    for k in 0..SAMPLES {
        let time = motion.duration() * (k as f64 + 0.5) / SAMPLES as f64;
        let Some(limit) = binding(time) else { continue };
        let fraction = motion.path_fraction(time);
        let new = Binding { count: 0, path_fractions: [fraction; 2] };
        let one = all.entry(limit).or_insert(new);
        one.count += 1;
        one.path_fractions[1] = fraction;
    }
    // Of equal counts the first limit, which is that of the velocity.
    let (limit, one) = all.into_iter().rev().max_by_key(|(_, one)| one.count)?;
    let time_fraction = one.count as f64 / SAMPLES as f64;
    Some(LimitingConstraint { limit, time_fraction, path_fractions: one.path_fractions })
}

/// The limit of an axis, or the prescribed speed, that is used most at a time, if it binds.
fn axis_limit(cell: &Cell, step: &Step, motion: &SegmentMotion, time: f64) -> Option<MotionLimit> {
    let mut most = (BINDING_FRACTION, None);
    let mut compare = |fraction: f64, limit: MotionLimit| {
        if fraction >= most.0 {
            most = (fraction, Some(limit));
        }
    };
    for axis in (0..step.from.len()).filter(|&axis| motion.moves(step, axis)) {
        let limits = scaled_axis_limits(&cell.robot, axis, step);
        let [_, velocity, acceleration, jerk] = motion.state(step, axis, time);
        compare(jerk.abs() / limits.jerk, MotionLimit::Jerk(axis));
        compare(acceleration.abs() / limits.acceleration, MotionLimit::Acceleration(axis));
        compare(velocity.abs() / limits.velocity, MotionLimit::Velocity(axis));
    }
    if let (SegmentMotion::Line { path, parameter }, Some(speed)) = (motion, step.line_speed) {
        compare(parameter.state(time)[1] * path.length / speed, MotionLimit::LineSpeed);
    }
    most.1
}

/// The effector whose wafer needs most of its friction at a time, if it binds.
fn friction_limit(
    cell: &Cell,
    step: &Step,
    motion: &SegmentMotion,
    time: f64,
) -> Option<MotionLimit> {
    let fractions = step.loaded.iter().map(|&id| (utilization(cell, step, motion, id, time), id));
    let most = fractions.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most.0 >= BINDING_FRACTION).then_some(MotionLimit::Friction(most.1))
}
