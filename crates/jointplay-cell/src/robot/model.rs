//! Where the platform sits over the rods.

use jointplay_core::Error;
use jointplay_core::gpr::{Forward, Gpr};
use jointplay_core::virtualization::{Kernel, Offset, Planar, Polar, Radial, SolveOptions};

/// A virtualization and how its displacements are found.
///
/// The plane of the platform is geometry alone; where the platform stands within it is this model's say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformModel {
    /// Which virtualization.
    pub virtualization: Kernel,
    /// How its displacements are found.
    pub options: SolveOptions,
}

impl Default for PlatformModel {
    /// The planar virtualization in closed form.
    fn default() -> Self {
        Self { virtualization: Kernel::Planar, options: SolveOptions::default() }
    }
}

impl PlatformModel {
    /// Where the platform is for given rods [m].
    ///
    /// # Errors
    /// Those of [`Gpr::forward`].
    #[inline]
    pub fn forward(&self, gpr: &Gpr, rods: [f64; 3]) -> Result<Forward, Error> {
        match self.virtualization {
            Kernel::Radial => gpr.forward(rods, &Radial, &self.options),
            Kernel::Polar => gpr.forward(rods, &Polar, &self.options),
            Kernel::Offset => gpr.forward(rods, &Offset, &self.options),
            Kernel::Planar => gpr.forward(rods, &Planar, &self.options),
        }
    }
}
