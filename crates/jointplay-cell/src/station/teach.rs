//! Frames of stations from taught points.

use jointplay_core::linalg::svd;
use jointplay_core::spatial::{Pose, Tilt, leaning};
use nalgebra::{DMatrix, Rotation3, Vector3};

/// Points nearer than this many times the threshold to one line leave the tilt about it open.
const SPREAD: f64 = 10.0;

/// The plane that fits taught points with the least sum of squares.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneFit {
    /// Middle of the points, in the base frame [m].
    pub center: Vector3<f64>,
    /// Unit normal, upward, in the base frame.
    pub normal: Vector3<f64>,
    /// How it leans.
    pub tilt: Tilt,
    /// Distance of each point from the plane, above positive [m].
    pub distances: Vec<f64>,
    /// Root of the mean square of the distances [m].
    pub residual: f64,
    /// Largest distance [m].
    pub worst: f64,
    /// The points, in the base frame [m].
    pub points: Vec<Vector3<f64>>,
    /// Root of the mean square of how far the points lie from the line that fits them best, within the plane: what holds the tilt about that line [m].
    pub spread: f64,
    /// What the largest distance may be [m].
    pub threshold: f64,
    /// Whether the plane is to be trusted.
    pub verdict: Verdict,
}

/// Whether a fitted plane is to be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All points lie within the threshold of it, and there are more than three.
    Fits,
    /// Three points: they lie on their plane whatever is wrong with them; a fourth would tell.
    Unproven,
    /// A point lies farther off than the threshold.
    Scattered,
}

/// Why taught points give no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TeachError {
    /// Not enough points for a plane.
    #[error("{found} taught points make no plane; teach 3, and better 4, that are not on one line")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// A number that is none.
    #[error("a taught point is not finite")]
    NotFinite,
    /// Points on one line.
    #[error(
        "the taught points lie within {:.1} µm of one line, and leave the tilt about it open: teach one at least {:.1} mm beside it",
        spread * 1e6, least * 1e3
    )]
    Collinear {
        /// Root of the mean square of their distances from the line [m].
        spread: f64,
        /// What it has to be at least [m].
        least: f64,
    },
    /// A plane that stands upright.
    #[error("the plane of the taught points stands upright: its normal leans {:.3}° from vertical", tilt.to_degrees())]
    Upright {
        /// How far the normal leans [rad].
        tilt: f64,
    },
    /// First and last slot in the wrong order, or in one place.
    #[error("the last slot was taught {} mm above the first; it has to be above it, by the slots between them", rise * 1e3)]
    NotAbove {
        /// How far it is above [m].
        rise: f64,
    },
    /// First and last slot of a station that has only one.
    #[error("drift is between the first and the last of several slots, but there are {slots}")]
    OneSlot {
        /// How many slots there are.
        slots: usize,
    },
}

/// The plane through taught points.
///
/// # Arguments
/// * `points` – three or more, in the base frame [m]
/// * `threshold` – how far from the plane a point may lie [m]
///
/// # Errors
/// [`TeachError`] for too few points, points on a line, and a plane that stands upright.
///
/// # Numerics
/// Singular values of the centred points: the last direction is the normal.
pub fn fit_plane(points: &[Vector3<f64>], threshold: f64) -> Result<PlaneFit, TeachError> {
    let count = points.len();
    if count < 3 {
        return Err(TeachError::TooFew { found: count });
    }
    let center = points.iter().sum::<Vector3<f64>>() / count as f64;
    let centered = DMatrix::from_fn(count, 3, |i, j| points[i][j] - center[j]);
    let Ok(found) = svd(&centered) else { return Err(TeachError::NotFinite) };
    let mean = |value: f64| value / (count as f64).sqrt();
    let spread = mean(found.singular_values[1]);
    // Round-off of the coordinates bounds what can be told from below, however good the points are.
    let least = (SPREAD * threshold).max(1e-9 * center.norm().max(found.largest()));
    if spread <= least {
        return Err(TeachError::Collinear { spread, least });
    }
    let direction = Vector3::new(found.v[(0, 2)], found.v[(1, 2)], found.v[(2, 2)]);
    let normal = if direction.z < 0.0 { -direction } else { direction };
    let tilt = Tilt::from_normal(&normal);
    if normal.z < 0.1 {
        return Err(TeachError::Upright { tilt: tilt.pitch });
    }
    let distances: Vec<f64> = points.iter().map(|point| (point - center).dot(&normal)).collect();
    let worst = distances.iter().fold(0.0_f64, |worst, distance| worst.max(distance.abs()));
    let residual = mean(distances.iter().map(|d| d * d).sum::<f64>().sqrt());
    let verdict = match count {
        _ if worst > threshold => Verdict::Scattered,
        3 => Verdict::Unproven,
        _ => Verdict::Fits,
    };
    let points = points.to_vec();
    Ok(PlaneFit {
        center,
        normal,
        tilt,
        distances,
        residual,
        worst,
        points,
        spread,
        threshold,
        verdict,
    })
}

impl PlaneFit {
    /// The nominal frame laid into the plane: its origin moved up or down, its yaw kept.
    #[must_use]
    pub fn frame(&self, origin: &Vector3<f64>, yaw: f64) -> Pose {
        let beside = origin - self.center;
        let rise = -(self.normal.x * beside.x + self.normal.y * beside.y) / self.normal.z;
        let in_plane = Vector3::new(origin.x, origin.y, self.center.z + rise);
        frame(in_plane, &self.normal, yaw)
    }
}

/// The frame at an origin with this normal, turned by a yaw about the vertical before it leans.
#[must_use]
pub fn frame(origin: Vector3<f64>, normal: &Vector3<f64>, yaw: f64) -> Pose {
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
    Pose::from_parts(origin.into(), leaning(normal) * turned)
}

/// The turn about the vertical of a frame before it leans: the yaw that [`frame`] makes it from [rad].
#[must_use]
pub fn yaw(frame: &Pose) -> f64 {
    let normal = frame.rotation * Vector3::z();
    let along = leaning(&normal).inverse() * (frame.rotation * Vector3::x());
    along.y.atan2(along.x)
}

/// What the places of the first and the last slot tell of a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Where the wafer of the first slot rests, in the base frame [m].
    pub first: Vector3<f64>,
    /// From slot to slot, along the line between first and last [m].
    pub pitch: f64,
    /// How far the last slot stands off the vertical above the first [m].
    pub drift: f64,
    /// How the station leans.
    pub tilt: Tilt,
}

/// The tilt of a station from where the wafers of its first and its last slot rest.
///
/// # Errors
/// [`TeachError`] where there is only one slot, or the last is not above the first.
///
/// # Assumptions
/// The slots are perpendicular to the line through them.
pub fn drift(first: Vector3<f64>, last: Vector3<f64>, slots: usize) -> Result<Drift, TeachError> {
    if slots < 2 {
        return Err(TeachError::OneSlot { slots });
    }
    let up = last - first;
    if up.z.is_nan() || up.z <= 0.1 * up.norm() {
        return Err(TeachError::NotAbove { rise: up.z });
    }
    Ok(Drift {
        first,
        pitch: up.norm() / (slots as f64 - 1.0),
        drift: up.x.hypot(up.y),
        tilt: Tilt::from_normal(&up),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(tilt: Tilt, places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
        let frame = frame(Vector3::new(0.7, -0.2, 0.9), &tilt.normal(), 0.4);
        places
            .iter()
            .map(|&(x, y)| frame.rotation * Vector3::new(x, y, 0.0))
            .map(|p| p + frame.translation.vector)
            .collect()
    }

    const SQUARE: [(f64, f64); 4] = [(0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)];

    #[test]
    fn points_of_a_plane_give_it_back() {
        let tilt = Tilt { yaw: 2.0, pitch: 0.0139 };
        let fit = fit_plane(&plane(tilt, &SQUARE), 1e-4).unwrap();
        assert_eq!(fit.verdict, Verdict::Fits);
        assert!((fit.normal - tilt.normal()).norm() < 1e-14 && fit.worst < 1e-15, "{fit:?}");
        let frame = fit.frame(&Vector3::new(0.7, -0.2, 0.0), 0.4);
        assert!((yaw(&frame) - 0.4).abs() < 1e-14);
        assert!((frame.translation.vector.z - 0.9).abs() < 1e-14);
        assert!((frame.rotation * Vector3::z() - tilt.normal()).norm() < 1e-14);
        assert_eq!(fit_plane(&plane(tilt, &SQUARE[..3]), 1e-4).unwrap().verdict, Verdict::Unproven);
    }

    #[test]
    fn a_point_that_is_off_shows() {
        let mut points = plane(Tilt::LEVEL, &SQUARE);
        points[2].z += 4e-4;
        let fit = fit_plane(&points, 5e-5).unwrap();
        // The fit shares it out over all four: a quarter each.
        assert_eq!(fit.verdict, Verdict::Scattered);
        assert!((fit.worst - 1e-4).abs() < 1e-8 && (fit.residual - 1e-4).abs() < 1e-8, "{fit:?}");
        assert_eq!(fit_plane(&points, 2e-4).unwrap().verdict, Verdict::Fits);
    }

    #[test]
    fn what_makes_no_plane_is_refused() {
        let tilt = Tilt { yaw: 0.3, pitch: 0.01 };
        let refused = |places: &[(f64, f64)]| fit_plane(&plane(tilt, places), 1e-4).unwrap_err();
        assert_eq!(refused(&SQUARE[..2]), TeachError::TooFew { found: 2 });
        assert!(matches!(refused(&[(0.0, 0.0); 3]), TeachError::Collinear { .. }));
        let line = [(0.0, 0.0), (0.1, 0.1), (0.2, 0.2), (0.3, 0.3)];
        assert!(matches!(refused(&line), TeachError::Collinear { .. }));
        let nearly = refused(&[(0.0, 0.0), (0.1, 1e-5), (0.2, 0.0)]);
        assert!(nearly.to_string().contains("of one line"), "{nearly}");
        let upright = [Vector3::zeros(), Vector3::z(), Vector3::x(), Vector3::new(1.0, 0.0, 1.0)];
        assert!(matches!(fit_plane(&upright, 1e-4), Err(TeachError::Upright { .. })));
        let nan = [Vector3::repeat(f64::NAN), Vector3::z(), Vector3::x()];
        assert_eq!(fit_plane(&nan, 1e-4), Err(TeachError::NotFinite));
    }

    #[test]
    fn drift_is_a_tilt() {
        let tilt = Tilt { yaw: -1.0, pitch: 0.8_f64.to_radians() };
        let first = Vector3::new(0.6, 0.1, 0.5);
        let found = drift(first, first + 0.24 * tilt.normal(), 25).unwrap();
        assert!((found.pitch - 0.01).abs() < 1e-15);
        assert!((found.tilt.normal() - tilt.normal()).norm() < 1e-14);
        assert!((found.drift - 0.24 * tilt.pitch.sin()).abs() < 1e-15);
        assert_eq!(drift(first, first, 25), Err(TeachError::NotAbove { rise: 0.0 }));
        assert_eq!(drift(first, first + Vector3::z(), 1), Err(TeachError::OneSlot { slots: 1 }));
    }
}
