//! Entries of the Functional Mock-up Interface, 2.0 and 3.0 for co-simulation: the library inside units.
//!
//! A unit has its model as files of its resources; [`jointplay::interop::fmu`] reads and computes it.
//! `jointplay.h` does not declare these entries: simulators have the headers of the standard.
//!
//! # Source
//! \[FMI2\], chapters 2 and 4; \[FMI3\], chapters 2 and 4

mod instance;
mod log;
mod place;
pub mod v2;
pub mod v3;
pub mod v3_unsupported;

pub use instance::{Instance, Saved};
pub use log::{Logger2, Logger3};

/// By this text the export recognises the library and its version.
#[used]
static MARK: &str = jointplay::interop::fmu::library_mark();
