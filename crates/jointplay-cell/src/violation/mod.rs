//! Violations: their kinds, their merging over time, their entry in a report, and their causes.

mod group;
mod interval;
mod kind;
mod report_entry;

pub use group::{ViolationGroup, ViolationOccurrence, group_violations};
pub(crate) use interval::{
    IntervalMerger, SampleTime, SampleViolation, Subject, ViolationInterval,
};
pub use kind::{ViolationKind, ViolationQuantity};
pub use report_entry::Violation;
