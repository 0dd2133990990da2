//! What the robot is told, and the steps that it comes to.
//!
//! ```text
//!    Program ──names──▶ instructions ──one after the other──▶ Step…
//!                            ▲                  ▲
//!              no end, no name: errors    wafers, reach, limits: errors
//! ```

mod carried;
mod expand;
mod extent;
mod places;
mod presence;
mod problem;
mod resolve;
mod sequence;
mod step;
mod stops;
mod syntax;

pub use carried::{Carried, carried};
pub use expand::expand;
pub(crate) use expand::expand_by;
pub use extent::{MAX_CALLS, MAX_INSTRUCTIONS};
pub(crate) use places::Places;
pub use problem::{Count, ProgramError, ProgramProblem};
pub use resolve::wrong_lines;
pub use step::{Handover, Path, Phase, Step};
pub use syntax::{
    AxisTarget, Command, Instruction, Name, Place, Program, Routine, SlotName, SlotNumber,
};
