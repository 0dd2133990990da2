//! Sines and cosines of many angles.

use pulp::{Arch, Simd, WithSimd};

use super::column::same_lengths;
use crate::Error;
use crate::kernel::{self, Lanes};

/// Writes the sine and the cosine of each angle (rad).
///
/// # Errors
/// [`Error::LengthMismatch`] for columns of different lengths.
///
/// # Numerics
/// Off by less than 2·10⁻¹⁶; NaN for an angle that is not finite. Does not allocate.
///
/// # Example
/// ```
/// use std::f64::consts::PI;
///
/// let (mut sines, mut cosines) = ([0.0; 3], [0.0; 3]);
/// jointplay_core::bulk::sin_cos(&[0.0, PI / 6.0, PI], &mut sines, &mut cosines)?;
/// assert!((sines[1] - 0.5).abs() < 2e-16 && cosines[2] == -1.0);
/// # Ok::<(), jointplay_core::Error>(())
/// ```
pub fn sin_cos(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) -> Result<(), Error> {
    let written = [("the sines", sines.len()), ("the cosines", cosines.len())];
    same_lengths(angles.len(), written)?;
    Arch::new().dispatch(Blocks { angles, sines, cosines });
    Ok(())
}

/// Angles cut into blocks of as many as the machine computes side by side.
struct Blocks<'a> {
    angles: &'a [f64],
    sines: &'a mut [f64],
    cosines: &'a mut [f64],
}

impl WithSimd for Blocks<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for first in (0..self.angles.len()).step_by(Lanes::<S>::COUNT) {
            let (sine, cosine) = kernel::sin_cos(Lanes::up_to_all(simd, &self.angles[first..]));
            sine.store(self.sines, first);
            cosine.store(self.cosines, first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_angles_have_the_sines_of_the_standard_library() {
        for count in [0, 1, 3, 8, 61] {
            let angles: Vec<f64> = (0..count).map(|k| f64::from(k * k - 400) * 0.37).collect();
            let (mut sines, mut cosines) = (vec![0.0; angles.len()], vec![0.0; angles.len()]);
            sin_cos(&angles, &mut sines, &mut cosines).unwrap();
            for ((angle, sine), cosine) in angles.iter().zip(&sines).zip(&cosines) {
                let (s, c) = angle.sin_cos();
                assert!((sine - s).abs() < 3e-16 && (cosine - c).abs() < 3e-16, "{angle}");
            }
        }
        let (mut sine, mut cosine) = ([0.0], [0.0]);
        sin_cos(&[f64::INFINITY], &mut sine, &mut cosine).unwrap();
        assert!(sine[0].is_nan() && cosine[0].is_nan());
        assert!(sin_cos(&[1.0, 2.0], &mut sine, &mut cosine).is_err());
    }
}
