//! Constraint systems Φ(P, X) = 0: the interface of every analysis.

mod newton;
mod scaled_system;
mod scaling;
mod system;

pub use crate::tolerance::{ACCEPTED_RESIDUAL, CLOSURE_TOLERANCE};
pub(crate) use newton::{NewtonLimits, backtrack, newton_at_rank};
pub(crate) use scaled_system::ScaledSystem;
pub use scaling::Dimension;
pub(crate) use scaling::{scaled_jacobian, scaled_residual, units};
pub use system::{Configuration, System};
