//! Definition of a study.

use jointplay_core::bulk::Quantity;
use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{SolveOptions, Virtualization};

use super::as_built::{RodsFrom, Tolerances};
use super::block::{BLOCK, CHUNK};
use super::output::{OutputQuantity, PlatformQuantity};
use super::variation::Variation;
use crate::Error;

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
    /// Places of the grid.
    ///
    /// # Errors
    /// [`Error::NoValues`] for an empty list, [`Error::TooManySamples`].
    pub fn grid(&self) -> Result<u64, Error> {
        let sizes = [&self.height, &self.tilt.first, &self.tilt.second].map(Variation::values);
        if sizes.contains(&0) {
            return Err(Error::NoValues);
        }
        sizes
            .iter()
            .try_fold(1_u64, |product, &size| product.checked_mul(size))
            .ok_or_else(|| self.too_many())
    }

    /// Number of threads that the plan keeps busy: one for each block of samples.
    ///
    /// # Errors
    /// As [`Self::grid`].
    pub fn most_threads(&self) -> Result<usize, Error> {
        let blocks = self.samples()?.div_ceil(BLOCK as u64);
        let most = crate::parallel::MOST_THREADS;
        Ok(usize::try_from(blocks).map_or(most, |blocks| blocks.clamp(1, most)))
    }

    /// Number of samples: places of the grid times draws.
    ///
    /// # Errors
    /// As [`Self::grid`].
    pub fn samples(&self) -> Result<u64, Error> {
        // As many as a signed number of 64 bits counts, which is what tables have.
        let samples = self.grid()?.checked_mul(self.draws);
        samples.filter(|&samples| i64::try_from(samples).is_ok()).ok_or_else(|| self.too_many())
    }

    /// Number of chunks of [`CHUNK`] samples, the last of which may be shorter.
    ///
    /// # Errors
    /// As [`Self::grid`].
    pub fn chunks(&self) -> Result<u64, Error> {
        Ok(self.samples()?.div_ceil(CHUNK))
    }

    /// Whether anything is random.
    #[must_use]
    pub fn draws_anything(&self) -> bool {
        let poses = [&self.height, &self.tilt.first, &self.tilt.second];
        poses.into_iter().any(Variation::is_random) || self.tolerances.any()
    }

    /// Whether samples have other bits on another kind of processor, see [`instruction_set`](jointplay_core::bulk::instruction_set).
    #[must_use]
    pub fn depends_on_processor(&self) -> bool {
        let of_processor = |wanted: &OutputQuantity| {
            let OutputQuantity::Model { measure, .. } = wanted else { return false };
            matches!(measure, PlatformQuantity::Quantity(Quantity::Sensitivity(_)))
        };
        self.wanted.iter().any(of_processor)
    }

    fn too_many(&self) -> Error {
        Error::TooManySamples {
            heights: self.height.values(),
            first: self.tilt.first.values(),
            second: self.tilt.second.values(),
            draws: self.draws,
        }
    }
}
