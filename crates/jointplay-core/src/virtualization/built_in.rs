//! The virtualizations of this crate.

use super::definition::Virtualization;
use super::{Offset, Planar, Polar, Radial};

/// The four virtualizations of this crate, in the order of the table in [`crate::virtualization`].
#[must_use]
pub fn built_in() -> [&'static dyn Virtualization; 4] {
    [&Radial, &Polar, &Offset, &Planar]
}
