//! The motion of all axes in one step over a height of the rods, before it is blended with its neighbours.

use std::hash::Hasher;
use std::sync::Arc;

use super::axis_state::AxisState;
use super::cartesian_path::CartesianPath;
use super::profile::{JerkLimitedProfile, hash_numbers};
use super::spline::Jet;
use super::synchronized::SynchronizedProfile;
use crate::program::Step;

/// The motion of all axes in one step, from rest to rest, over a height of the rods.
#[derive(Debug, Clone)]
pub(crate) enum SegmentMotion {
    /// No axis moves.
    Dwell {
        /// (s)
        duration: f64,
    },
    /// Each axis follows a profile of its own; all of them end together.
    PointToPoint(SynchronizedProfile),
    /// All axes follow a path, Cartesian or in joint space, whose parameter follows a profile.
    Line {
        /// Positions of all axes over the path parameter.
        path: Arc<CartesianPath>,
        /// Path parameter over time, from 0 to 1.
        parameter: JerkLimitedProfile,
    },
}

impl SegmentMotion {
    /// Time from the start of the segment to its end (s).
    pub(super) fn duration(&self) -> f64 {
        match self {
            Self::Dwell { duration } => *duration,
            Self::PointToPoint(profile) => profile.duration,
            Self::Line { parameter, .. } => parameter.duration(),
        }
    }

    /// The motion stretched in time by a factor; a dwell keeps its duration.
    pub(super) fn slowed(&self, factor: f64) -> Self {
        match self {
            Self::Dwell { duration } => Self::Dwell { duration: *duration },
            Self::PointToPoint(profile) => Self::PointToPoint(profile.slowed(factor)),
            Self::Line { path, parameter } => {
                Self::Line { path: Arc::clone(path), parameter: parameter.slowed(factor) }
            }
        }
    }

    /// Whether an axis moves during the segment.
    pub(super) fn moves(&self, step: &Step, axis: usize) -> bool {
        match self {
            Self::Dwell { .. } => false,
            Self::PointToPoint(_) => step.from[axis] != step.to[axis],
            Self::Line { path, .. } => path.spline.moves(axis),
        }
    }

    /// Times since the start of the segment at which the jerk of an axis is discontinuous (s).
    pub(super) fn jerk_discontinuities(&self) -> Vec<f64> {
        match self {
            Self::Dwell { .. } => Vec::new(),
            Self::PointToPoint(profile) => {
                profile.axes.iter().flat_map(JerkLimitedProfile::jerk_discontinuities).collect()
            }
            Self::Line { path, parameter } => {
                // The third derivative of the spline is discontinuous at its knots.
                let knots = parameter.times_at(path.spline.knots());
                parameter.jerk_discontinuities().chain(knots).collect()
            }
        }
    }

    /// Fraction of the path at a time since the start of the segment (s): of the line, or of the displacement of the axis with the longest minimum duration.
    pub(super) fn path_fraction(&self, time: f64) -> f64 {
        match self {
            Self::Dwell { .. } => 0.0,
            Self::PointToPoint(profile) => profile.limiting_axis.map_or(0.0, |axis| {
                let position = |time: f64| profile.axes[axis].state(time)[0];
                let from = position(0.0);
                (position(time) - from) / (position(profile.duration) - from)
            }),
            Self::Line { parameter, .. } => parameter.state(time)[0],
        }
    }

    /// States of all axes at a time since the start of the segment (s).
    pub(super) fn states(&self, step: &Step, time: f64) -> impl Iterator<Item = AxisState> {
        // A path is entered once for all axes.
        let along = match self {
            Self::Line { path, parameter } => {
                let along = parameter.state(time);
                Some((path, path.spline.interval(along[0]), along))
            }
            Self::Dwell { .. } | Self::PointToPoint(_) => None,
        };
        (0..step.from.len()).map(move |axis| match along {
            Some((path, interval, along)) => derivatives_along_path(path, interval, axis, along),
            None => self.state(step, axis, time),
        })
    }

    /// State of one axis at a time since the start of the segment (s).
    pub(super) fn state(&self, step: &Step, axis: usize, time: f64) -> AxisState {
        match self {
            Self::Dwell { .. } => [step.to[axis], 0.0, 0.0, 0.0],
            Self::PointToPoint(profile) => profile.axes[axis].state(time),
            Self::Line { path, parameter } => {
                let along = parameter.state(time);
                derivatives_along_path(path, path.spline.interval(along[0]), axis, along)
            }
        }
    }

    /// Adds everything that determines the motion to a hash.
    pub(super) fn hash(&self, hasher: &mut impl Hasher) {
        match self {
            Self::Dwell { duration } => {
                hasher.write_u8(0);
                hash_numbers(hasher, &[*duration]);
            }
            Self::PointToPoint(profile) => {
                hasher.write_u8(1);
                profile.axes.iter().for_each(|profile| profile.hash(hasher));
            }
            Self::Line { path, parameter } => {
                hasher.write_u8(2);
                path.spline.hash(hasher);
                parameter.hash(hasher);
            }
        }
    }
}

/// State of one axis on a path.
///
/// # Arguments
/// * `interval` – interval of the spline that holds the path parameter
/// * `parameter` – path parameter s with its first three derivatives in time
pub(super) fn derivatives_along_path(
    path: &CartesianPath,
    interval: usize,
    axis: usize,
    parameter: AxisState,
) -> AxisState {
    by_chain_rule(path.spline.jet(interval, axis, parameter[0]), parameter)
}

/// State of one axis by its derivatives with respect to a parameter, and those of the parameter in time.
#[inline(always)]
pub(super) fn by_chain_rule(
    [q, slope, curvature, third]: Jet,
    [_, rate, acceleration, jerk]: AxisState,
) -> AxisState {
    [
        q,
        slope * rate,
        curvature * rate * rate + slope * acceleration,
        third * (rate * rate * rate) + 3.0 * curvature * rate * acceleration + slope * jerk,
    ]
}
