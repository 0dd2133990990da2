//! CheckCache of a motion against limits, slip, safe zones and required distances.

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
pub use pose::{Moment, Straight, advance_until_contact, check_pose};
pub use report::{InstructionResult, MinimumDistance, Report, Share, Verdict};

pub use crate::violation::{Kind, Unit, Violation};
