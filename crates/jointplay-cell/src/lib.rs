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
//! | [`workcell`] | robot, stations, wafers, bodies and zones together |
//! | [`program`] | what the robot is told, and the steps that it comes to |
//! | [`trajectory`] | steps in time: jerk-limited, synchronised, straight where asked for |
//! | [`check`] | what is wrong with a motion, by sample and by instruction |
//! | [`jog`] | the robot moved by hand: as far as its limits let it go, and what stops it there |
//! | [`IncrementalPlanner`] | both for a plan that changes, at the cost of what changes |
//! | [`geometry`] | shapes, and shapes as triangles |
//!
//! Pure mathematics in SI: no files, no clock, no threads.

#[cfg(test)]
extern crate self as jointplay_cell;

mod arm_placement;
pub mod check;
mod collision;
mod entity;
mod error;
pub mod geometry;
mod incremental;
pub mod jog;
mod planner;
pub mod program;
pub mod robot;
pub mod station;
pub mod trajectory;
mod violation;
pub mod wafer;
pub mod workcell;

pub use entity::EntityId;
pub use error::CellError;
pub use incremental::{CacheStats, Interrupted, Progress, Stop};
pub use planner::{IncrementalPlanner, PlanError, PlanOptions};
