//! The poses of a study: a raster over yaw and pitch.

use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::Tilt;

/// In which order the poses of a raster follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// Every yaw runs through the pitches from first to last, as in the paper; jumps back at the end of each.
    #[default]
    Raster,
    /// Every other yaw runs through the pitches backwards: continuous in time, for motion.
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
    /// Yaw angles γ, the slow direction (rad).
    pub yaws: Vec<f64>,
    /// Pitch angles α, the fast direction (rad).
    pub pitches: Vec<f64>,
    /// Height at which the platform plane crosses the base axis.
    pub height: AxisHeight,
    /// Order of the poses.
    pub order: Order,
}

impl Raster {
    /// The paper's raster: pitch −2° to 2° by 0.2° for each yaw from 0° to 360°, at 500 mm.
    ///
    /// The yaw step is not printed; 10° is our choice, both ends included: 37 × 21 = 777 poses.
    ///
    /// # Source
    /// \[Virtualization\], VI.A
    #[must_use]
    pub fn paper() -> Self {
        Self {
            yaws: (0..=36).map(|i| (f64::from(i) * 10.0).to_radians()).collect(),
            pitches: (-10..=10).map(|i| (f64::from(i) / 5.0).to_radians()).collect(),
            height: AxisHeight(0.5),
            order: Order::Raster,
        }
    }

    /// The raster reduced to one yaw, with `intervals` pitches in place of each: the curves of one tilt direction.
    ///
    /// The yaw is the one at a ninth of the raster (40° for the paper's), where no rod stays at rest.
    #[must_use]
    pub fn one_direction(&self, intervals: u32) -> Self {
        Self {
            yaws: self.yaws.get(self.yaws.len() / 9).copied().into_iter().collect(),
            pitches: refine(&self.pitches, intervals),
            height: self.height,
            order: self.order,
        }
    }

    /// Number of poses.
    #[must_use]
    pub fn len(&self) -> usize {
        self.yaws.len() * self.pitches.len()
    }

    /// Whether there is no pose at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The poses, in order.
    pub fn tilts(&self) -> impl Iterator<Item = Tilt> + '_ {
        self.yaws.iter().enumerate().flat_map(move |(row, &yaw)| {
            let backwards = self.order == Order::Serpentine && row % 2 == 1;
            let count = self.pitches.len();
            (0..count).map(move |i| {
                let pitch = self.pitches[if backwards { count - 1 - i } else { i }];
                Tilt { yaw, pitch }
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
    fn one_direction_of_the_papers_raster_is_a_yaw_of_40_deg() {
        let one = Raster::paper().one_direction(10);
        assert_eq!((one.yaws.len(), one.pitches.len()), (1, 201));
        assert!((one.yaws[0].to_degrees() - 40.0).abs() < 1e-12);
        assert_eq!(one.pitches.last(), Raster::paper().pitches.last());
    }
}
