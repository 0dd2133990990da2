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
//! | `syntax`, `quantity`, `location` | syntax tree |
//! | `visitor` | traversal of the names and numbers |
//! | `problem`, `parameter_kind` | errors |
//! | `resolve`, `resolver`, `scope`, `parameter_kinds`, `effector_choice` | resolution of names in the cell |
//! | `resolved` | program with its names resolved |
//! | `bounds` | bounds on the expansion |
//! | `robot_state` | state of the robot at rest between programs |
//! | `step` | steps: moves and dwells of all axes |
//! | `wafer_locations` | locations of all wafers during the steps of a program |
//! | `occupancy` | occupancy of effectors and slots during the expansion, also after errors |
//! | `ik_cache` | inverse kinematics of the last program |
//! | `limits` | limits of commanded positions |
//! | `retracted_pose` | positions of arms that are retracted for a station |
//! | `posture_choice` | choice of the postures for a visit of a station |
//! | `sequence` | motion sequences of instructions |
//! | `unreachable` | targets and lines into stations that an effector does not reach |
//! | `frame` | values of counters and arguments during the expansion |
//! | `expander` | numbers, slots and conditions during the expansion |
//! | `expand` | from instructions to steps |
//! | `handoff_deflection` | droop and sag of wafers at hand-offs |
//!
//! The text of programs is parsed and written by `jointplay-format`.

mod bounds;
mod effector_choice;
mod expand;
mod expander;
mod frame;
mod handoff_deflection;
mod ik_cache;
mod limits;
mod location;
mod occupancy;
mod parameter_kind;
mod parameter_kinds;
mod posture_choice;
mod problem;
mod quantity;
mod resolve;
mod resolved;
mod resolver;
mod retracted_pose;
mod robot_state;
mod scope;
mod sequence;
mod step;
mod syntax;
mod unreachable;
mod visitor;
mod wafer_locations;

pub use bounds::{MAX_CALL_DEPTH, MAX_INSTRUCTIONS};
pub use expand::expand;
pub(crate) use expand::{Expansion, expand_by};
pub use handoff_deflection::{HandoffDeflection, handoff_deflections};
pub(crate) use ik_cache::IkCache;
pub use location::{Name, SourceLocation};
pub use parameter_kind::ParameterKind;
pub use problem::{Count, ErrorContext, Leveling, ProgramError, ProgramProblem};
pub use quantity::{AllowedValues, Number, Quantity, Unit};
pub use resolve::name_errors;
pub use robot_state::RobotState;
pub use step::{Handoff, LinePostures, Path, Phase, Step};
pub use syntax::{
    AxisTarget, Branch, Command, Condition, Instruction, Parameter, Program, Relation, Routine,
    SlotName, TiltTarget,
};
pub use visitor::ProgramVisitor;
pub use wafer_locations::{LocationChange, WaferLocation, WaferLocations, WaferStay};
