//! Steps over time: trajectories of all axes within their velocity, acceleration and jerk limits.
//!
//! ```text
//!   Path::PointToPoint   from ──▶ to     a jerk-limited profile for each axis, synchronized to the slowest
//!   Path::Line           from ──▶ to     q(s): the wafer's centre on a straight line, its plane rotating uniformly;  s(t): every axis within its limits
//! ```
//!
//! | file | contents |
//! | --- | --- |
//! | `axis_state` | state of one coordinate, at one time and at many |
//! | `profile` | jerk-limited profile of one coordinate |
//! | `sample` | state of all axes at one time; uniform sampling |
//! | `limits` | limits of the axes in a step |
//! | `synchronized` | point-to-point moves: all axes end together |
//! | `spline` | positions of all axes over a path parameter |
//! | `quintic_interpolation` | positions between the points of a path |
//! | `cartesian_path` | straight lines of the wafer, followed by inverse kinematics |
//! | `posture_spline` | postures that the axes stay near along a line |
//! | `squared_rate`, `collocation`, `rate_constraints`, `rate_search` | the fastest parameterization of a path: variables, places of constraints, constraints, interior-point method |
//! | `rate_lanes` | successive intervals of a squared rate, computed side by side |
//! | `time_parameterization` | path parameter over time, within the limits of all axes |
//! | `slip` | slowdown of segments on which a wafer would slip |
//! | `lift` | steps that differ by a common height of all rods |
//! | `segment_motion`, `segment` | motion of all axes in one step: over a height of the rods, and at it |
//! | `blend`, `trajectory` | segments and blends of all steps over time |
//! | `sampler` | states of the moving axes of a step at many times |
//! | `blend_candidate`, `blend_planner` | the longest overlap of two segments; the overlaps of all |
//! | `limiting_constraint` | what limits the duration of a step |
//! | `options`, `error`, `segment_planner` | from steps to a trajectory |
//! | `joint_space_line` | all axes in proportion, for checks of poses |
//! | `adaptive_sampling` | adaptive sample times for plots |
//!
//! A trajectory is independent of the shapes of bodies: this folder uses geometry only for safe zones.

mod adaptive_sampling;
mod axis_state;
mod blend;
mod blend_candidate;
mod blend_planner;
mod cartesian_path;
mod collocation;
mod error;
mod joint_space_line;
mod lift;
mod limiting_constraint;
mod limits;
mod options;
mod posture_spline;
mod profile;
mod quintic_interpolation;
mod rate_constraints;
mod rate_lanes;
mod rate_search;
mod sample;
mod sampler;
mod segment;
mod segment_key;
mod segment_motion;
mod segment_planner;
mod slip;
mod spline;
mod squared_rate;
mod synchronized;
mod time_parameterization;
#[expect(clippy::module_inception, reason = "the type that the folder is named after")]
mod trajectory;

pub(crate) use axis_state::{AxisState, StateColumns};
pub use blend::Blend;
pub use cartesian_path::{PathError, PathErrorKind};
pub use error::{StepError, StepErrorKind, TrajectoryError};
pub(crate) use joint_space_line::joint_space_line;
pub use limiting_constraint::{LimitingConstraint, MotionLimit};
pub use limits::{axis_limits, axis_moves_effector, scaled_axis_limits};
pub use options::TrajectoryOptions;
pub use sample::{Sample, UniformSampling};
pub(crate) use sampler::AxisSampler;
pub(crate) use segment_planner::SegmentCache;
pub use segment_planner::{MAX_DURATION, plan_trajectory};
pub use synchronized::NoProfile;
pub use trajectory::{LineDeviation, Trajectory};
