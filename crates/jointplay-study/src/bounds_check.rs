//! The first-order bounds of sensitivity over a whole study.

use jointplay_core::gpr::{EvaluatedBounds, Gpr};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{SolveOptions, Virtualization};

use crate::{Error, Raster};

/// Number of poses whose true virtual displacement satisfies the bounds, by where their derivatives are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BoundsCheck {
    /// Poses checked: all that tilt.
    pub poses: usize,
    /// Held with derivatives at the level start, where the bounds are zero.
    pub held_at_start: usize,
    /// Held with derivatives midway.
    pub held_at_midpoint: usize,
    /// Held with derivatives at the tilted end.
    pub held_at_end: usize,
}

/// Compares the true displacement of every tilted pose, from level at the same height, with its bounds.
///
/// Poses beyond the limits are computed too.
///
/// # Arguments
/// * `progress` – called with the number of samples done, from time to time
///
/// # Errors
/// [`Error::Pose`] with the first pose that cannot be computed.
///
/// # Source
/// \[Virtualization\], eq. (4) and (5)
pub fn check_bounds<V: Virtualization + ?Sized>(
    gpr: &Gpr,
    raster: &Raster,
    virtualization: &V,
    options: &SolveOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<BoundsCheck, Error> {
    let gpr = &gpr.without_limit_checks();
    let mut check = BoundsCheck::default();
    let pose = |tilt: Tilt, sample: usize| {
        gpr.inverse(tilt, raster.height)
            .and_then(|rods| gpr.forward(rods, virtualization, options))
            .map_err(|source| Error::pose(sample, tilt, source))
    };
    let level = pose(Tilt::LEVEL, 0)?;
    for (sample, tilt) in raster.tilts().enumerate() {
        if tilt.angle != 0.0 {
            let play = gpr
                .play_between(level, pose(tilt, sample)?, virtualization)
                .map_err(|source| Error::pose(sample, tilt, source))?;
            let held = |bounded: &EvaluatedBounds| usize::from(bounded.held);
            check.poses += 1;
            check.held_at_start += held(&play.at_start);
            check.held_at_midpoint += held(&play.at_midpoint);
            check.held_at_end += held(&play.at_end);
        }
        if sample % 64 == 63 {
            progress(sample + 1);
        }
    }
    progress(raster.len());
    Ok(check)
}
