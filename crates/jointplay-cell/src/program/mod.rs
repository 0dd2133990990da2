//! What the robot is told, and the steps that it comes to.
//!
//! ```text
//!    Program ──names──▶ instructions ──one after the other──▶ Step…
//!                            ▲                  ▲
//!              no end, no name: errors    wafers, reach, limits: errors
//! ```

mod bounds;
mod expand;
mod handover_deflection;
mod ik_cache;
mod occupancy;
mod problem;
mod resolve;
mod sequence;
mod step;
mod syntax;

pub use bounds::{MAX_CALLS, MAX_INSTRUCTIONS};
pub use expand::expand;
pub(crate) use expand::expand_by;
pub use handover_deflection::{HandoverDeflection, handover_deflections};
pub(crate) use ik_cache::IkCache;
pub use problem::{Count, Leveling, ProgramError, ProgramProblem};
pub use resolve::name_errors;
pub use step::{Handover, Path, Phase, Step};
pub use syntax::{
    AxisTarget, Command, Instruction, Name, Place, Program, Routine, SlotName, SlotNumber,
};
