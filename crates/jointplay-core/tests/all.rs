//! Laws, closed forms and limits of the mathematics: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod ball_clearance;
mod bulk;
mod commanded_balls;
mod couplings;
mod differential;
mod families;
mod laws;
mod limits;
mod mechanism_laws;
mod mechanisms;
mod mobility;
mod mobility_of_mechanisms;
mod mobility_of_small_systems;
mod near_closures;
mod nearest;
mod planar;
mod pose_solver;
mod positions;
mod reach;
mod robot;
mod robot_as_mechanism;
mod scales;
mod self_stress;
mod sparse;
mod suggest_brute_force;
mod undetermined;
