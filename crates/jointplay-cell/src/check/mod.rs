//! Checks of a trajectory against limits, slip, safe zones and required clearances.
//!
//! | file | contents |
//! | --- | --- |
//! | `options`, `report` | options and result of a check |
//! | `checker` | the check of all steps, with results of the last check reused |
//! | `key_figures` | cycle time and margins of a checked program |
//! | `step_checks` | checks of steps: limits, broad phase, distances |
//! | `step_findings`, `limits`, `slip`, `safe_zones` | checks without pairs of objects: axes, tilt, play, friction, safe zones |
//! | `aggregate` | results of all steps in one report |
//! | `remedy` | translations of fixed bodies that remove violations |
//! | `zone_bodies` | fixed bodies in keep-out zones |
//! | `pose` | one pose; a joint-space line up to a contact |
//!
//! Distances between samples are checked by `collision`, whose head states the guarantee.

mod aggregate;
mod checker;
mod key_figures;
mod limits;
mod options;
mod plane_budget;
mod pose;
mod remedy;
mod report;
mod safe_zones;
mod slip;
mod step_checks;
mod step_findings;
mod unmodelled;
mod zone_bodies;

pub(crate) use checker::CheckCache;
pub use checker::check;
pub use key_figures::KeyFigures;
pub use options::CheckOptions;
pub use pose::{ContactFreePath, PoseContext, advance_until_contact, check_pose, nearest_points};
pub use remedy::{Remedy, remedies};
pub use report::{CheckResult, InstructionResult, MinimumDistance, Report, Utilization};
pub use unmodelled::{Unmodelled, unmodelled};
pub use zone_bodies::{BodyInZone, bodies_in_zones};

pub use crate::violation::{
    Violation, ViolationGroup, ViolationKind, ViolationOccurrence, ViolationQuantity,
    group_violations,
};
