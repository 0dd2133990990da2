//! Constraint systems Φ(P, X) = 0: what every analysis speaks to.

mod scaling;
mod system;

pub use scaling::Dimension;
pub(crate) use scaling::{scaled_jacobian, scaled_residual, units};
pub use system::{Configuration, System};
