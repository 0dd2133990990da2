//! Incremental computation: results by fingerprints of their inputs, computed in parallel where they are missing.
//!
//! | file | contents |
//! | --- | --- |
//! | `fingerprint` | the inputs of a computation, bit by bit |
//! | `cache` | results of the last round and of the present one |
//! | `parallel` | map over jobs |
//! | `interruption` | stop of a computation before its end |
//!
//! Nothing in this folder knows of robots.

mod cache;
mod fingerprint;
mod interruption;
mod parallel;

pub use cache::CacheStats;
pub(crate) use cache::Kept;
pub(crate) use fingerprint::{Key, extend};
pub(crate) use interruption::whole;
pub use interruption::{Interrupted, Stop};
pub use parallel::Job;
pub(crate) use parallel::{Run, anew, each, never};
