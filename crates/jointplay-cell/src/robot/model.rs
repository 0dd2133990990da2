//! Where the platform sits over the rods.

use jointplay_core::Error;
use jointplay_core::bulk::{Column, Quantity, Status, Tally};
use jointplay_core::gpr::{Forward, Gpr};
use jointplay_core::virtualization::{
    Kernel, Offset, Planar, Polar, Radial, SolveOptions, Virtualization,
};

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

    /// The same of many, see [`Gpr::forward_many`].
    ///
    /// # Errors
    /// Those of [`Gpr::forward_many`].
    pub(crate) fn forward_many(
        &self,
        gpr: &Gpr,
        rods: [Column<'_>; 3],
        status: &mut [Status],
        wanted: &mut [(Quantity, &mut [f64])],
    ) -> Result<Tally, Error> {
        gpr.forward_many(rods, self.virtualization(), &self.options, status, wanted)
    }

    /// How far the virtual joints of a pose are from nominal, see [`Gpr::displacement`] [m].
    pub(crate) fn displacement(&self, gpr: &Gpr, pose: &Forward) -> f64 {
        gpr.displacement(pose, self.virtualization())
    }

    fn virtualization(&self) -> &'static dyn Virtualization {
        match self.virtualization {
            Kernel::Radial => &Radial,
            Kernel::Polar => &Polar,
            Kernel::Offset => &Offset,
            Kernel::Planar => &Planar,
        }
    }
}
