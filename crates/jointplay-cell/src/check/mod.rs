//! Checks of a trajectory against limits, slip, safe zones and required clearances.
//!
//! | file | contents |
//! | --- | --- |
//! | `options`, `report` | options and result of a check |
//! | `checker` | the check of all segments, with results of the last check reused |
//! | `segments` | the check of one segment: limits, broad phase, distances |
//! | `segment_findings`, `limits`, `slip`, `safe_zones` | a segment by itself: axes, tilt, play, friction, safe zones |
//! | `aggregate` | results of all segments in one report |
//! | `pose` | one pose, and a straight path up to a contact |
//!
//! Distances between samples are checked by `collision`, whose head states the guarantee.

mod aggregate;
mod checker;
mod limits;
mod options;
mod pose;
mod report;
mod safe_zones;
mod segment_findings;
mod segments;
mod slip;

pub(crate) use checker::CheckCache;
pub use checker::check;
pub use options::CheckOptions;
pub use pose::{ContactFreePath, PoseContext, advance_until_contact, check_pose};
pub use report::{InstructionResult, MinimumDistance, Report, Share, Verdict};

pub use crate::violation::{Kind, Unit, Violation};
