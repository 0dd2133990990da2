//! Rank, null space, pseudo-inverse and least norm: the only singular value decomposition of the library.

#[cfg(feature = "std")]
mod product;
#[cfg(feature = "std")]
mod svd;
mod three;

#[cfg(feature = "std")]
pub(crate) use product::product;
#[cfg(feature = "std")]
pub use svd::{LinalgError, Svd, svd};
pub use three::{inverse_of_three, least_norm_of_three};
