//! Residuals at which constraints count as satisfied, in radians and characteristic lengths.
//!
//! There are two, since a configuration is computed more closely than it can be given.

#![cfg_attr(
    not(feature = "std"),
    allow(dead_code, unreachable_pub, reason = "of constraint systems")
)]

/// Largest residual of loops that a correction has closed: far above round-off, far below any play.
pub const CLOSURE_TOLERANCE: f64 = 1e-11;

/// Largest residual of a configuration that an analysis accepts as closed.
///
/// Looser than [`CLOSURE_TOLERANCE`], since configurations also come from files and from other programs, where coordinates are rounded.
pub const ACCEPTED_RESIDUAL: f64 = 1e-9;
