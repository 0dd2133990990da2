//! The virtualizations of this crate.

use super::definition::{BuiltIn, Virtualization};
use super::{Offset, Planar, Polar, Radial};

/// The four virtualizations of this crate, in the order of the table in [`crate::virtualization`].
#[must_use]
pub fn built_in() -> [&'static dyn Virtualization; 4] {
    [&Radial, &Polar, &Offset, &Planar]
}

impl BuiltIn {
    /// The virtualization itself.
    #[must_use]
    pub fn model(self) -> &'static (dyn Virtualization + Sync) {
        match self {
            Self::Radial => &Radial,
            Self::Polar => &Polar,
            Self::Offset => &Offset,
            Self::Planar => &Planar,
        }
    }
}
