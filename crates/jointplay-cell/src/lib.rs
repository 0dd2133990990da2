//! Hybrid robots and offline programming: from stations to a checked, timed motion.
//!
//! ```text
//!   Program ──expand──▶ Step… ──plan_trajectory──▶ Trajectory ──check──▶ Report
//!               ▲                  ▲                 ▲
//!             Cell               limits       bodies, zones, budgets
//! ```
//!
//! | module | role |
//! | --- | --- |
//! | [`robot`] | a three-rod robot that carries planar arms: description, forward and inverse kinematics of the whole chain |
//! | [`wafer`] | what is carried: plates that sag, arms that droop, and how the platform makes up for it |
//! | [`station`] | where wafers are put: frames, slots, approach, and frames from taught points |
//! | [`cell`] | robot, stations, wafers, bodies and zones together |
//! | [`program`] | what the robot is told, and the steps that it comes to |
//! | [`trajectory`] | steps in time: jerk-limited, synchronised, straight where asked for |
//! | [`check`] | what is wrong with a motion, by sample and by instruction |
//! | [`jog`] | the robot moved by hand: as far as its limits let it go, and what stops it there |
//! | [`Memory`] | both for a plan that changes, at the cost of what changes |
//! | [`surface`] | shapes as triangles, for whoever shows them |
//!
//! Pure mathematics in SI: no files, no clock, no threads.

#[cfg(test)]
extern crate self as jointplay_cell;

pub mod cell;
pub mod check;
mod error;
pub mod jog;
mod memory;
mod placement;
pub mod program;
pub mod robot;
mod solid;
pub mod station;
pub mod surface;
pub mod trajectory;
pub mod wafer;

pub use error::CellError;
pub use memory::{Interrupted, Job, Memory, Reuse, Stop, Unplanned};
