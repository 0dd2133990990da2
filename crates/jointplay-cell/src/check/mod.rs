//! Checks of a trajectory against limits, slip, safe zones and required clearances.
//!
//! | file | contents |
//! | --- | --- |
//! | `options`, `report` | options and result of a check |
//! | `checker` | the check of all steps, with results of the last check reused |
//! | `step_checks` | checks of steps: limits, broad phase, distances |
//! | `step_findings`, `limits`, `slip`, `safe_zones` | checks without pairs of objects: axes, tilt, play, friction, safe zones |
//! | `aggregate` | results of all steps in one report |
//! | `pose` | one pose; a joint-space line up to a contact |
//!
//! Distances between samples are checked by `collision`, whose head states the guarantee.

mod aggregate;
mod checker;
mod limits;
mod options;
mod pose;
mod report;
mod safe_zones;
mod slip;
mod step_checks;
mod step_findings;

pub(crate) use checker::CheckCache;
pub use checker::check;
pub use options::CheckOptions;
pub use pose::{ContactFreePath, PoseContext, advance_until_contact, check_pose};
pub use report::{CheckResult, InstructionResult, MinimumDistance, Report, Utilization};

pub use crate::violation::{Violation, ViolationKind, ViolationQuantity};
