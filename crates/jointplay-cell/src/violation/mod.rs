//! Violations: their kinds, their merging over time, and their entry in a report.

mod interval;
mod kind;
mod report_entry;

pub(crate) use interval::{
    IntervalMerger, SampleTime, SampleViolation, Subject, ViolationInterval,
};
pub use kind::{ViolationKind, ViolationQuantity};
pub use report_entry::Violation;
