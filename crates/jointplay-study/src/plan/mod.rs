//! Studies of any length: what is varied over which values or at random, what is wanted of each sample, computed in chunks.
//!
//! | to… | use |
//! | --- | --- |
//! | say what is varied, and what is wanted | [`Plan`], [`Spread`], [`Tolerances`], [`Wanted`] |
//! | compute some samples | [`compute`] → [`Block`] |
//! | compute all of them over all cores, in order, in memory that does not grow | [`run`] |
//! | sum columns up on the way | [`Totals`], [`Moments`] |
//! | know medians and other quantiles | [`quantiles`] |
//!
//! Every sample depends on the plan and its number alone: not on chunks, threads, or where a run was taken up again.
//!
//! ```
//! use jointplay_core::{bulk::Quantity, gpr::Gpr, virtualization::{Planar, SolveOptions}};
//! use jointplay_study::plan::*;
//!
//! let plan = Plan {
//!     gpr: Gpr::paper(),
//!     height: Spread::Values(vec![0.5]),
//!     tilt: Tilts { form: TiltForm::YawPitch, first: Spread::Uniform { from: 0.0, to: 6.28 }, second: Spread::Values(vec![0.01, 0.02]) },
//!     tolerances: Tolerances::default(),
//!     rods_from: RodsFrom::Nominal,
//!     draws: 1000,
//!     seed: 7,
//!     models: vec![&Planar],
//!     options: SolveOptions::default(),
//!     wanted: vec![Wanted::Model { model: 0, measure: Measure::CenterShift }],
//! };
//! let block = compute(&plan, &[0, 1999])?;
//! assert_eq!((plan.samples()?, block.columns[0].len()), (2000, 2));
//! # Ok::<(), jointplay_study::Error>(())
//! ```

mod built;
mod compute;
mod inputs;
mod quantiles;
mod random;
mod run;
mod spread;
mod totals;
mod wanted;

pub use built::{Dimension, RodsFrom, Tolerances};
pub use compute::{Block, Outcome, compute};
pub use quantiles::{QUANTILE_SAMPLES, quantiles};
pub use run::{BLOCK, CHUNK, run};
pub use spread::Spread;
pub use totals::{Moments, Outcomes, Totals};
pub use wanted::{Measure, Wanted};

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{SolveOptions, Virtualization};

use crate::Error;

/// Two angles that say a tilt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TiltForm {
    /// Yaw γ, then pitch α.
    YawPitch,
    /// Angles about e_b1 and about e_b2, as machine controllers have them.
    AboutXAndY,
}

/// The tilts of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Tilts {
    /// What the two angles are.
    pub form: TiltForm,
    /// Yaw, or the angle about e_b1.
    pub first: Spread,
    /// Pitch, or the angle about e_b2.
    pub second: Spread,
}

/// What a study computes.
///
/// Lists of values make a grid: every value with every other, the second angle running fastest, then the first, then the height.
/// Each draw of what is random runs through the whole grid: sample i has draw ⌊i / g⌋ at place i mod g of a grid of g.
#[derive(Clone)]
pub struct Plan {
    /// The robot as designed.
    pub gpr: Gpr,
    /// Where the platform plane crosses the base axis, as commanded [m].
    pub height: Spread,
    /// Tilts, as commanded [rad].
    pub tilt: Tilts,
    /// How dimensions of the robot differ from the design.
    pub tolerances: Tolerances,
    /// Whose dimensions the rods are computed from.
    pub rods_from: RodsFrom,
    /// How often what is random is drawn; 1 where nothing is.
    pub draws: u64,
    /// What the draws start from.
    pub seed: u64,
    /// The virtualizations, side by side.
    pub models: Vec<&'static (dyn Virtualization + Sync)>,
    /// How their virtual joints are found.
    pub options: SolveOptions,
    /// What is wanted of each sample, a column each.
    pub wanted: Vec<Wanted>,
}

impl Plan {
    /// Places of the grid.
    ///
    /// # Errors
    /// [`Error::NoValues`] for an empty list, [`Error::TooManySamples`].
    pub fn grid(&self) -> Result<u64, Error> {
        let sizes = [&self.height, &self.tilt.first, &self.tilt.second].map(Spread::values);
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
        let blocks = self.samples()?.div_ceil(run::BLOCK as u64);
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

    /// Whether anything is random.
    #[must_use]
    pub fn draws_anything(&self) -> bool {
        let poses = [&self.height, &self.tilt.first, &self.tilt.second];
        poses.into_iter().any(Spread::is_random) || self.tolerances.any()
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
