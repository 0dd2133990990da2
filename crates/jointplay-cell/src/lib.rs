//! Hybrid robots and offline programming: from stations to a checked trajectory.
//!
//! A *hybrid robot* is a parallel robot that carries serial planar arms; here the parallel robot is the three-rod robot that its manufacturer calls GPR.
//! It is a 3-P̲S robot: a platform on three ball joints, each on a rod that one actuated vertical slide moves.
//! Its platform is overconstrained and can tilt only because its ball joints have *play*, the free travel within their clearance.
//! A *virtualization* models this play by virtual joints, whose displacements of least norm determine the pose of the platform over its rods.
//!
//! ```text
//!   Program ──expand──▶ Step… ──plan_trajectory──▶ Trajectory ──check──▶ Report
//!               ▲                  ▲                 ▲
//!             Cell               limits       bodies, zones, required clearances
//! ```
//!
//! | module | contents |
//! | --- | --- |
//! | [`geometry`] | shapes, their triangles, colliders and distances |
//! | [`robot`] | a three-rod robot that carries planar arms: description, forward and inverse kinematics of the whole chain |
//! | [`wafer`] | plates that sag, arms that droop, and the compensation by the platform |
//! | [`station`] | places for wafers: frames, slots, approach, and frames from taught points |
//! | [`workcell`] | robot, stations, wafers, bodies and zones |
//! | [`program`] | programs, and the steps that they expand to |
//! | [`trajectory`] | steps over time: jerk-limited, synchronized, along straight lines |
//! | [`schedule`] | stays of wafers, use of robot and stations, critical path, steady state |
//! | [`check`] | violations of a trajectory, minimum distances, and results by instruction |
//! | [`jog`] | interactive motion up to the limits |
//! | [`IncrementalPlanner`] | expansion, trajectory and check, with results of the previous plan reused |
//!
//! Internal modules are `incremental` (cache keys, caches, parallel map), `collision` (continuous collision checking, with the guarantee at its head) and `violation`.
//! No two files import each other, directly or through others; `geometry` and `incremental` know nothing of robots and cells.
//!
//! Pure mathematics in SI units: no files, no clock; results do not depend on the number of threads.

#[cfg(test)]
extern crate self as jointplay_cell;

mod arm_placement;
pub mod check;
mod collision;
mod conditions;
mod entity;
mod error;
pub mod geometry;
mod incremental;
pub mod jog;
mod planner;
pub mod program;
pub mod robot;
pub mod schedule;
pub mod station;
pub mod trajectory;
mod validate;
mod violation;
pub mod wafer;
pub mod workcell;

pub use entity::EntityId;
pub use error::CellError;
pub use incremental::{CacheStats, Interrupted, Progress, Stop};
pub use planner::{IncrementalPlanner, PlanError, PlanOptions, PlanStage};
pub use validate::{CellPart, InvalidPart, MAX_BODIES};
