//! Continuous collision checking.

mod allowed_collisions;
mod axis_states;
mod broad_phase;
mod conservative_advancement;
mod in_plane_motion;
mod link_poses;
mod motion_bound;
mod motion_bound_coefficients;
#[cfg(test)]
mod motion_bound_tests;
mod object;
mod sample_times;
mod sampled_segment;
mod scene;
mod swept_aabb;
mod unknown_pose;

pub(crate) use axis_states::Axes;
pub(crate) use broad_phase::{Among, Cast};
pub(crate) use conservative_advancement::{Look, Near, Pair, Pairs, passed};
pub(crate) use link_poses::Unplaced;
pub(crate) use motion_bound::Gearing;
pub(crate) use motion_bound_coefficients::{Levers, droop_bounds};
pub(crate) use object::Role;
pub(crate) use sample_times::Samples;
pub(crate) use sampled_segment::Course;
pub(crate) use scene::Scene;
pub(crate) use swept_aabb::Around;
pub(crate) use unknown_pose::Lost;
