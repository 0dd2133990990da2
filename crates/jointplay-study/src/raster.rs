//! The poses of a study: a raster over azimuth and tilt angle.

use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::Tilt;

/// In which order the poses of a raster follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// Every azimuth runs through the tilt angles from first to last, as in the paper; jumps back at the end of each.
    #[default]
    Raster,
    /// Every other azimuth runs through the tilt angles backwards: continuous in time, for motion.
    Serpentine,
}

/// Values with `intervals` equal intervals in place of each one, for the smooth curves of a figure.
///
/// The given values are kept to the bit.
#[must_use]
pub fn refine(values: &[f64], intervals: u32) -> Vec<f64> {
    let inner = values.windows(2).flat_map(|pair| {
        (0..intervals).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / f64::from(intervals))
    });
    inner.chain(values.last().copied()).collect()
}

/// A raster of tilts at one axis height.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Azimuth angles γ, the slow direction (rad).
    pub azimuths: Vec<f64>,
    /// Tilt angles α, the fast direction (rad).
    pub tilt_angles: Vec<f64>,
    /// Height at which the platform plane crosses the base axis.
    pub height: AxisHeight,
    /// Order of the poses.
    pub order: Order,
}

impl Raster {
    /// The paper's raster: tilt angle −2° to 2° by 0.2° for each azimuth from 0° to 360°, at 500 mm.
    ///
    /// The azimuth step is not printed; 10° is our choice, both ends included: 37 × 21 = 777 poses.
    ///
    /// # Source
    /// \[Virtualization\], VI.A
    #[must_use]
    pub fn paper() -> Self {
        Self {
            azimuths: (0..=36).map(|i| (f64::from(i) * 10.0).to_radians()).collect(),
            tilt_angles: (-10..=10).map(|i| (f64::from(i) / 5.0).to_radians()).collect(),
            height: AxisHeight(0.5),
            order: Order::Raster,
        }
    }

    /// The raster reduced to one azimuth, with `intervals` tilt angles in place of each: the curves of one tilt direction.
    ///
    /// The azimuth is the one at a ninth of the raster (40° for the paper's), where no rod stays at rest.
    #[must_use]
    pub fn one_direction(&self, intervals: u32) -> Self {
        Self {
            azimuths: self.azimuths.get(self.azimuths.len() / 9).copied().into_iter().collect(),
            tilt_angles: refine(&self.tilt_angles, intervals),
            height: self.height,
            order: self.order,
        }
    }

    /// Number of poses.
    #[must_use]
    pub fn len(&self) -> usize {
        self.azimuths.len() * self.tilt_angles.len()
    }

    /// Whether there is no pose at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The poses, in order.
    pub fn tilts(&self) -> impl Iterator<Item = Tilt> + '_ {
        self.azimuths.iter().enumerate().flat_map(move |(row, &azimuth)| {
            let backwards = self.order == Order::Serpentine && row % 2 == 1;
            let count = self.tilt_angles.len();
            (0..count).map(move |i| {
                let tilt_angle = self.tilt_angles[if backwards { count - 1 - i } else { i }];
                Tilt { azimuth, angle: tilt_angle }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refinement_keeps_the_given_values() {
        assert_eq!(refine(&[0.0, 1.0, 3.0], 2), [0.0, 0.5, 1.0, 2.0, 3.0]);
        assert_eq!(refine(&[0.3], 10), [0.3]);
        assert_eq!(refine(&[], 10), [0.0; 0]);
    }

    #[test]
    fn one_direction_of_the_papers_raster_is_an_azimuth_of_40_deg() {
        let one = Raster::paper().one_direction(10);
        assert_eq!((one.azimuths.len(), one.tilt_angles.len()), (1, 201));
        assert!((one.azimuths[0].to_degrees() - 40.0).abs() < 1e-12);
        assert_eq!(one.tilt_angles.last(), Raster::paper().tilt_angles.last());
    }
}
