//! Definition of a study.

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{SolveOptions, Virtualization};

use super::as_built::{RodsFrom, Tolerances};
use super::output::OutputQuantity;
use super::variation::Variation;

/// Two angles that define a tilt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TiltForm {
    /// Azimuth γ, then tilt angle α.
    AzimuthAngle,
    /// Angles about e_b1 and about e_b2, as machine controllers have them.
    AboutXAndY,
}

/// The tilts of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Tilts {
    /// Meaning of the two angles.
    pub form: TiltForm,
    /// Azimuth, or the angle about e_b1.
    pub first: Variation,
    /// Tilt angle, or the angle about e_b2.
    pub second: Variation,
}

/// Definition of a study: what is varied, and what is computed of each sample.
///
/// Lists of values make a grid: every value with every other, the second angle running fastest, then the first, then the height.
/// Each draw of what is random runs through the whole grid: sample i has draw ⌊i / g⌋ at place i mod g of a grid of g.
#[derive(Clone)]
pub struct Plan {
    /// The robot as designed.
    pub gpr: Gpr,
    /// Height at which the platform plane crosses the base axis, as commanded (m).
    pub height: Variation,
    /// Tilts, as commanded (rad).
    pub tilt: Tilts,
    /// How dimensions of the robot differ from the design.
    pub tolerances: Tolerances,
    /// Whose dimensions the rods are computed from.
    pub rods_from: RodsFrom,
    /// Number of draws of the random quantities; 1 where nothing is random.
    pub draws: u64,
    /// Seed of the random draws.
    pub seed: u64,
    /// The virtualizations, side by side.
    pub models: Vec<&'static (dyn Virtualization + Sync)>,
    /// How their virtual joints are found.
    pub options: SolveOptions,
    /// Quantities to compute of each sample, a column each.
    pub wanted: Vec<OutputQuantity>,
}

impl Plan {
    /// Variations of the grid, the last running fastest.
    pub(super) fn pose(&self) -> [&Variation; 3] {
        [&self.height, &self.tilt.first, &self.tilt.second]
    }

    /// Whether anything is random.
    #[must_use]
    pub fn draws_anything(&self) -> bool {
        self.pose().into_iter().any(Variation::is_random) || self.tolerances.any()
    }
}
