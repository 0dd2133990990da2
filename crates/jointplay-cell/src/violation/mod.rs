//! Violations: their kinds, their merging from sample to sample, and how a report lists them.

mod interval;
mod kind;
mod report_entry;

pub(crate) use interval::{About, Found, Hit, Stretch, When};
pub use kind::{Kind, Unit};
pub use report_entry::Violation;
