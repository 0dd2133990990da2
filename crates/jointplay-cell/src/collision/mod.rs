//! Continuous collision checking.
//!
//! **Guarantee.** Every pair of collision objects (bodies, wafers, keep-out zones) of which at least one moves is checked, except pairs on one body or on two bodies that a joint connects, pairs that the cell allows, and a wafer with the last link of the arm that holds it, or that picks or places it in this step.
//! Over an interval with the distances d₀ and d₁ at its ends, or lower bounds of them, in which no point of one object travels farther than w relative to the other,
//!
//! ```text
//!    min d  ≥  (d₀ + d₁ − w) / 2
//!    min d  ≥  min(g₀, g₁) − v dt / 4 − 2 u
//! ```
//! where g₀ and g₁ are the signed gaps along one separating direction, v bounds the variation of the velocity by the arms, and u the travel by platform and deflection.
//! An interval is bisected until one of these bounds reaches the required clearance c, or until w < 2 µm.
//! So a pair that comes closer than c − 10⁻⁸ m at a sample, or than c − 1 µm between two samples, is reported as a violation.
//! While a pair violates its clearance at a sample, the interval to the next sample is searched for contacts only.
//! Reported minimum distances are those at samples; a sample that was not evaluated may have a distance smaller by 2 % or 20 µm, whichever is larger.
//!
//! **Assumptions between samples.** The jerk of each axis is at most the larger of its limit and its jerk at both samples.
//! Bodies are rigid, wafers are flat discs, and the tilt is below 90°; the bound of deflections holds up to the tilt limit of the robot, and at least up to 60°.
//! The bounds are proven for the planar platform model, for arms and for deflections; the displacement of the platform in its own plane by other models is estimated from sampled derivatives, up to the sampled tilt.
//! A pose that is unknown is reported as a violation.
//! The derivation is in `docs/explanation/collision-guarantee.md`.
//!
//! | file | contents |
//! | --- | --- |
//! | `object`, `scene` | collision objects, what they are attached to, and their poses |
//! | `allowed_collisions` | required clearance of each pair |
//! | `sample_windows`, `sampled_step`, `axis_states`, `link_poses`, `unknown_pose` | axis states and link poses of a step at its samples |
//! | `motion_bound_coefficients`, `deflection_coefficients`, `in_plane_motion`, `motion_bound` | upper bounds of the travel of any point between two samples |
//! | `swept_aabb`, `broad_phase` | boxes around the path of each object, candidate pairs |
//! | `distance_bound`, `adaptive_bisection` | distances of candidate pairs over a step |

mod adaptive_bisection;
mod allowed_collisions;
mod axis_states;
mod broad_phase;
mod deflection_coefficients;
mod distance_bound;
mod in_plane_motion;
mod interval_motion_bound;
mod link_poses;
mod motion_bound;
mod motion_bound_coefficients;
#[cfg(test)]
mod motion_bound_tests;
mod object;
mod sample_windows;
mod sampled_step;
mod scene;
mod swept_aabb;
mod unknown_pose;

pub(crate) use adaptive_bisection::{
    CONTACT_RESOLUTION, CandidatePair, PairAccumulator, PairResults, StepDistanceQuery,
    distance_tolerance,
};
pub(crate) use allowed_collisions::ClearanceRule;
pub(crate) use axis_states::AxisStates;
pub(crate) use broad_phase::{BroadPhase, CandidatePairs};
pub(crate) use deflection_coefficients::droop_bounds;
pub(crate) use link_poses::{LinkPoses, PoseError};
pub(crate) use motion_bound::MotionBoundModel;
pub(crate) use motion_bound_coefficients::MotionBoundCoefficients;
pub(crate) use sample_windows::SampleWindows;
pub(crate) use sampled_step::SampledStep;
pub(crate) use scene::Scene;
pub(crate) use swept_aabb::SweptAabb;
pub(crate) use unknown_pose::UnknownPose;
