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
//! | [`displacement`] | displacement of a wafer by the tilt of the platform and by other causes, and the uncertainty of its position |
//! | [`station`] | places for wafers: frames, slots, approach, and frames from taught points |
//! | [`workcell`] | robot, stations, wafers, bodies and zones |
//! | [`program`] | programs, and the steps that they expand to |
//! | [`trajectory`] | steps over time: jerk-limited, synchronized, along straight lines |
//! | [`schedule`] | stays of wafers, use of robot and stations, critical path, steady state |
//! | [`check`] | violations of a trajectory, minimum distances, and results by instruction |
//! | [`controller`] | a simulated controller: one program after another, each checked before it moves |
//! | [`jog`] | interactive motion up to the limits |
//! | [`optimise`] | orders of hand-offs, arms, blends and speeds that are better than those of a program |
//! | [`IncrementalPlanner`] | expansion, trajectory and check, with results of the previous plan reused |
//! | [`EntityId`], [`CellError`], [`InvalidPart`] | parts that results refer to, errors of descriptions and arguments, invalid parts of a cell |
//!
//! Internal modules:
//!
//! | module | contents |
//! | --- | --- |
//! | `incremental` | cache keys, caches, parallel map, interruption |
//! | `collision` | continuous collision checking; its first lines state the guarantee |
//! | `violation` | violations, their kinds and groups; public in [`check`] |
//! | `planner` | the [`IncrementalPlanner`] |
//! | `kinematics_hash` | hash of the inputs of all poses of a cell |
//! | `arm_placement` | poses of links, end effectors and wafers with deflected arms |
//! | `columns` | columns of numbers, computed several rows at a time |
//! | `extrema` | maxima and minima in one instruction each |
//! | `conditions`, `validate` | conditions of numbers, and those that a cell has to fulfil |
//! | `entity`, `error` | [`EntityId`] and [`CellError`] |
//!
//! No two files import each other, directly or through others; `incremental` does not depend on robots or cells, and `geometry` only on their error type, [`CellError`].
//! Labels in brackets, such as \[Schwarzer\], are entries of the list of references in the repository, `REFERENCES.md`.
//!
//! Pure mathematics in SI units: no files, no clock; results do not depend on the number of threads.

#[cfg(test)]
extern crate self as jointplay_cell;

mod arm_placement;
pub mod check;
mod collision;
mod columns;
mod conditions;
pub mod controller;
pub mod displacement;
mod entity;
mod error;
mod extrema;
pub mod geometry;
mod incremental;
pub mod jog;
mod kinematics_hash;
pub mod optimise;
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
pub use incremental::{CacheStats, Interrupted, Progress, StopRequested};
pub use planner::{IncrementalPlanner, PlanError, PlanOptions, PlanStage};
pub use validate::{CellPart, InvalidPart, MAX_BODIES, MAX_COVERAGE_FACTOR};
