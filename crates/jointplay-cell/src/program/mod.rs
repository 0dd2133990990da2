//! What the robot is told, and the steps that it comes to.

mod step;
mod syntax;

pub use step::{Handover, Path, Phase, Step};
pub use syntax::{
    AxisTarget, Command, Instruction, Name, Place, Program, Routine, SlotName, SlotNumber,
};
