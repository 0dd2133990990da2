//! Programs: their syntax, their expansion into steps, and their errors.
//!
//! ```text
//!    Program ──resolve──▶ ResolvedProgram ──expand──▶ Step…
//!                │                            │
//!     errors: unknown names,       errors: missing wafers,
//!     unbounded repetition         out of reach, limits
//! ```
//!
//! | file | contents |
//! | --- | --- |
//! | `syntax` | syntax tree |
//! | `problem` | errors |
//! | `resolved`, `resolve` | names resolved in the cell |
//! | `bounds` | bounds on the expansion |
//! | `step` | steps: moves and dwells of all axes |
//! | `wafer_locations` | locations of all wafers during the steps of a program |
//! | `occupancy` | occupancy of effectors and slots during the expansion, also after errors |
//! | `ik_cache` | inverse kinematics of the last program |
//! | `limits` | limits of commanded positions |
//! | `retracted_pose` | positions of arms that are retracted for a station |
//! | `sequence` | motion sequences of instructions |
//! | `expand` | from instructions to steps |
//! | `handoff_deflection` | droop and sag of wafers at hand-offs |
//!
//! The text of programs is parsed and written by `jointplay-format`.

mod bounds;
mod expand;
mod handoff_deflection;
mod ik_cache;
mod limits;
mod occupancy;
mod problem;
mod resolve;
mod resolved;
mod retracted_pose;
mod sequence;
mod step;
mod syntax;
mod wafer_locations;

pub use bounds::{MAX_CALLS, MAX_INSTRUCTIONS};
pub use expand::expand;
pub(crate) use expand::expand_by;
pub use handoff_deflection::{HandoffDeflection, handoff_deflections};
pub(crate) use ik_cache::IkCache;
pub use problem::{Count, Leveling, ProgramError, ProgramProblem};
pub use resolve::name_errors;
pub use step::{Handoff, LinePostures, Path, Phase, Step};
pub use syntax::{
    AxisTarget, Command, Instruction, Name, Program, Routine, SlotName, SlotNumber, SourceLocation,
};
pub use wafer_locations::{LocationChange, WaferLocation, WaferLocations, WaferStay};
