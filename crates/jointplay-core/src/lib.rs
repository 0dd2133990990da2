//! The mathematics of overconstrained robots, some of whose motions need play in the joints.
//!
//! Everything is in SI units (m, rad); nothing here reads a file, prints, or keeps state.
//! Symbols, frames, signs and the order of coordinates are those of `NOTATION.md`.
//!
//! | to… | use |
//! | --- | --- |
//! | describe a three-rod robot | [`gpr::Gpr`] |
//! | compute the rods for a tilt, or the pose for rods | [`gpr::Gpr::inverse`], [`gpr::Gpr::forward`] |
//! | compute derivatives of rods and poses | [`gpr::Gpr::rod_derivatives`], [`gpr::Gpr::platform_jacobian`], [`gpr::Gpr::platform_derivatives`] |
//! | compute many poses at a time | [`bulk`] |
//! | choose how play is modelled | [`virtualization`]: [`Radial`](virtualization::Radial), [`Polar`](virtualization::Polar), [`Offset`](virtualization::Offset), [`Planar`](virtualization::Planar), or your own |
//! | compute mobility | [`mobility`] |
//! | compute the play that a motion requires | [`sensitivity`], [`gpr::Gpr::tilt_play`] |
//! | use a mechanism of your own | implement [`constraint::System`] |
//! | evaluate an arithmetic expression | [`expression`] |
//! | convert units without changing decimals | [`decimal`] |
//! | sample a duration at a constant rate | [`sampling`] |
//! | decompose a matrix, with a rank | [`linalg`] |
//!
//! ```
//! use jointplay_core::gpr::{AxisHeight, Gpr};
//! use jointplay_core::spatial::Tilt;
//! use jointplay_core::virtualization::{Planar, SolveOptions};
//!
//! let gpr = Gpr::paper();
//! let tilt = Tilt { azimuth: 0.3, angle: 0.02 };
//! let rods = gpr.inverse(tilt, AxisHeight(0.5))?;
//! let platform = gpr.forward(rods, &Planar, &SolveOptions::default())?;
//! assert!((platform.tilt().angle - 0.02).abs() < 1e-12);
//! # Ok::<(), jointplay_core::Error>(())
//! ```

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
pub mod bulk;
#[cfg(feature = "std")]
pub mod constraint;
#[cfg(feature = "std")]
pub mod decimal;
mod error;
#[cfg(feature = "std")]
pub mod expression;
mod float;
pub mod gpr;
#[cfg(feature = "std")]
mod kernel;
pub mod linalg;
#[cfg(feature = "std")]
pub mod mechanism;
#[cfg(feature = "std")]
pub mod mobility;
#[cfg(feature = "std")]
mod random;
#[cfg(feature = "std")]
pub mod sampling;
#[cfg(feature = "std")]
pub mod sensitivity;
pub mod spatial;
mod tolerance;
pub mod virtualization;

pub use error::{Error, Unconverged, range_fault};
pub use nalgebra;
