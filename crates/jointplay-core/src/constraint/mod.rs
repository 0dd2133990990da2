//! Constraint systems Φ(P, X) = 0: what every analysis speaks to.

mod scaling;
mod system;
mod tolerance;

pub use scaling::Dimension;
pub(crate) use scaling::{scaled_jacobian, scaled_residual, units};
pub use system::{Configuration, System};
pub use tolerance::{ACCEPTED_RESIDUAL, CLOSURE_TOLERANCE};
