//! Frames of stations from their first and last slot.

use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;

use super::error::TeachError;

/// Frame of a station from its first and last slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarrierAxis {
    /// Resting position of the wafer in the first slot, in the base frame (m).
    pub first: Vector3<f64>,
    /// Distance between slots along the line from first to last (m).
    pub pitch: f64,
    /// Horizontal distance of the last slot from the vertical through the first (m).
    pub horizontal_offset: f64,
    /// Tilt of the station.
    pub tilt: Tilt,
    /// Distance of the last slot from the first (m).
    pub length: f64,
    /// Standard deviation of each measured coordinate, if known (m).
    pub noise: Option<f64>,
}

/// The tilt of a station from the resting positions of wafers in its first and last slot.
///
/// # Arguments
/// * `noise` – standard deviation of each measured coordinate; `None` where it is not known (m)
///
/// # Errors
/// [`TeachError`] where there is only one slot, the last is not above the first, or the noise is not positive.
///
/// # Assumptions
/// The slots are perpendicular to the line through them.
pub fn carrier_axis(
    first: Vector3<f64>,
    last: Vector3<f64>,
    slots: usize,
    noise: Option<f64>,
) -> Result<CarrierAxis, TeachError> {
    if let Some(found) = noise.filter(|noise| !(*noise > 0.0 && noise.is_finite())) {
        return Err(TeachError::Noise { found });
    }
    if slots < 2 {
        return Err(TeachError::OneSlot { slots });
    }
    let up = last - first;
    if up.z.is_nan() || up.z <= 0.1 * up.norm() {
        return Err(TeachError::NotAbove { rise: up.z });
    }
    Ok(CarrierAxis {
        first,
        pitch: up.norm() / (slots as f64 - 1.0),
        horizontal_offset: up.x.hypot(up.y),
        tilt: Tilt::from_normal(&up),
        length: up.norm(),
        noise,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carrier_axis_determines_the_tilt() {
        let tilt = Tilt { azimuth: -1.0, angle: 0.8_f64.to_radians() };
        let first = Vector3::new(0.6, 0.1, 0.5);
        let found = carrier_axis(first, first + 0.24 * tilt.normal(), 25, None).unwrap();
        assert!((found.pitch - 0.01).abs() < 1e-15);
        assert!((found.tilt.normal() - tilt.normal()).norm() < 1e-14);
        assert!((found.horizontal_offset - 0.24 * tilt.angle.sin()).abs() < 1e-15);
        let refused = |last, slots, noise| carrier_axis(first, last, slots, noise).unwrap_err();
        assert_eq!(refused(first, 25, None), TeachError::NotAbove { rise: 0.0 });
        assert_eq!(refused(first + Vector3::z(), 1, None), TeachError::OneSlot { slots: 1 });
        let noise = TeachError::Noise { found: 0.0 };
        assert_eq!(refused(first + Vector3::z(), 2, Some(0.0)), noise);
    }
}
