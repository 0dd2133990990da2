//! Incremental computation: results by fingerprints of their inputs, computed in parallel where they are missing.
//!
//! | file | contents |
//! | --- | --- |
//! | `fingerprint` | all inputs of a computation, bit by bit |
//! | `unique` | values distinguished by an identity |
//! | `cache` | results of the previous and of the present generation |
//! | `parallel` | parallel map over jobs |
//! | `interruption` | stop condition and progress of a computation |
//!
//! Nothing in this folder knows of robots.

mod cache;
mod fingerprint;
mod interruption;
mod parallel;
mod unique;

pub use cache::CacheStats;
pub(crate) use cache::GenerationalCache;
pub(crate) use fingerprint::{Fingerprint, Fingerprinted};
pub(crate) use interruption::{Execution, Observer, uninterrupted};
pub use interruption::{Interrupted, Progress, Stop};
pub(crate) use parallel::{compute_missing, parallel_map};
pub(crate) use unique::Unique;
