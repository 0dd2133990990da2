//! Incremental computation: results by cache keys of their inputs, computed in parallel where they are missing.
//!
//! | file | contents |
//! | --- | --- |
//! | `cache_key` | all inputs of a computation, bit by bit |
//! | `with_id` | values distinguished by an identity |
//! | `cache` | results of the previous and of the present generation |
//! | `parallel` | parallel map over jobs |
//! | `interruption` | stop condition and progress of a computation |
//!
//! Nothing in this folder knows of robots.

mod cache;
mod cache_key;
mod interruption;
mod parallel;
mod with_id;

pub use cache::CacheStats;
pub(crate) use cache::GenerationalCache;
pub(crate) use cache_key::{CacheKey, CacheKeyPart};
pub use interruption::{Interrupted, Progress, StopRequested};
pub(crate) use interruption::{JobContext, Observer, uninterrupted};
pub(crate) use parallel::{compute_missing, parallel_map};
pub(crate) use with_id::WithId;
