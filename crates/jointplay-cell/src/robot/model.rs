//! Pose of the platform over the rods.

use jointplay_core::Error;
use jointplay_core::bulk::{Column, Quantity, Status, StatusCounts};
use jointplay_core::gpr::{Gpr, PlatformPose};
use jointplay_core::virtualization::{
    BuiltIn, Offset, Planar, Polar, Radial, SolveOptions, Virtualization,
};

/// A virtualization, and the options of its solver.
///
/// The plane of the platform follows from geometry alone; the virtualization determines its position and rotation within the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformModel {
    /// The virtualization.
    pub virtualization: BuiltIn,
    /// Options of its solver.
    pub options: SolveOptions,
}

impl Default for PlatformModel {
    /// The planar virtualization, solved in closed form.
    fn default() -> Self {
        Self { virtualization: BuiltIn::Planar, options: SolveOptions::default() }
    }
}

impl PlatformModel {
    /// Pose of the platform for given rods (m).
    ///
    /// # Errors
    /// Those of [`Gpr::forward`].
    #[inline]
    pub fn forward(&self, gpr: &Gpr, rods: [f64; 3]) -> Result<PlatformPose, Error> {
        match self.virtualization {
            BuiltIn::Radial => gpr.forward(rods, &Radial, &self.options),
            BuiltIn::Polar => gpr.forward(rods, &Polar, &self.options),
            BuiltIn::Offset => gpr.forward(rods, &Offset, &self.options),
            BuiltIn::Planar => gpr.forward(rods, &Planar, &self.options),
        }
    }

    /// Poses for many sets of rods, see [`Gpr::forward_many`].
    ///
    /// # Errors
    /// Those of [`Gpr::forward_many`].
    pub(crate) fn forward_many(
        &self,
        gpr: &Gpr,
        rods: [Column<'_>; 3],
        status: &mut [Status],
        wanted: &mut [(Quantity, &mut [f64])],
    ) -> Result<StatusCounts, Error> {
        gpr.forward_many(rods, self.virtualization(), &self.options, status, wanted)
    }

    /// Displacement of the virtual joints of a pose from nominal, see [`Gpr::displacement`] (m).
    #[must_use]
    pub fn displacement(&self, gpr: &Gpr, pose: &PlatformPose) -> f64 {
        gpr.displacement(pose, self.virtualization())
    }

    fn virtualization(&self) -> &'static dyn Virtualization {
        match self.virtualization {
            BuiltIn::Radial => &Radial,
            BuiltIn::Polar => &Polar,
            BuiltIn::Offset => &Offset,
            BuiltIn::Planar => &Planar,
        }
    }
}
