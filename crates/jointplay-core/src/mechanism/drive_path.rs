//! Paths of driven coordinates.

use nalgebra::DVector;

use crate::Error;
use crate::error::finite;

/// A joint coordinate driven from its current value to a target value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Target value (m or rad).
    pub to: f64,
}

/// Path of driven coordinates: straight segments between points, each with the same share of the path.
///
/// A curve is a path through many points.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivePath {
    coordinates: Vec<usize>,
    /// At least two points, each with a value for each coordinate (m or rad).
    points: Vec<Vec<f64>>,
}

impl DrivePath {
    /// The straight segment from a configuration to target values; all are reached at the same time.
    ///
    /// # Arguments
    /// * `from` – (f + M) coordinates of the configuration (m, rad)
    ///
    /// # Errors
    /// [`Error::NoSuchQuantity`] for an index that `from` does not have, [`Error::NotFinite`].
    pub fn line(from: &DVector<f64>, drives: &[Drive]) -> Result<Self, Error> {
        let coordinates: Vec<usize> = drives.iter().map(|drive| drive.coordinate).collect();
        crate::error::indices("coordinate", &coordinates, from.len())?;
        let start = coordinates.iter().map(|&k| from[k]).collect();
        let end = drives.iter().map(|drive| drive.to).collect();
        Self::through(coordinates, vec![start, end])
    }

    /// The path through points.
    ///
    /// # Arguments
    /// * `coordinates` – indices of the driven coordinates
    /// * `points` – values of these coordinates at each point, the start first (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] for a point with another number of values, or for fewer than two points; [`Error::NotFinite`].
    pub fn through(coordinates: Vec<usize>, points: Vec<Vec<f64>>) -> Result<Self, Error> {
        if points.len() < 2 {
            let what = "the list of points of a path";
            return Err(Error::LengthMismatch { what, found: points.len(), expected: 2 });
        }
        for point in &points {
            let (what, expected) = ("a point of a path", coordinates.len());
            if point.len() != expected {
                return Err(Error::LengthMismatch { what, found: point.len(), expected });
            }
            point.iter().try_for_each(|&value| finite(what, value).map(|_| ()))?;
        }
        Ok(Self { coordinates, points })
    }

    /// Indices of the driven coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// Number of segments between points.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.points.len() - 1
    }

    /// Values of the driven coordinates at a share of the path (m, rad).
    ///
    /// # Arguments
    /// * `share` – 0 at the start, 1 at the end
    pub fn values_at(&self, share: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (segment, within) = Self::locate(share, self.segments());
        let values = self.points[segment].iter().zip(&self.points[segment + 1]);
        let values = values.map(move |(from, to)| from + (to - from) * within);
        self.coordinates.iter().copied().zip(values)
    }

    /// Change of the driven coordinates per unit of the share (m, rad), on the segment that continues from a share; on the nearest segment that moves at all, where that one rests.
    pub(super) fn rate(&self, share: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let moves = |&segment: &usize| self.points[segment] != self.points[segment + 1];
        let (here, _) = Self::locate(share, self.segments());
        let next = (here..self.segments()).find(moves);
        let segment = next.or_else(|| (0..here).rev().find(moves)).unwrap_or(here);
        #[expect(clippy::cast_precision_loss, reason = "counts of segments")]
        let segments = self.segments() as f64;
        let ends = self.points[segment].iter().zip(&self.points[segment + 1]);
        self.coordinates.iter().copied().zip(ends.map(move |(from, to)| (to - from) * segments))
    }

    /// Index of the segment at a share of a path, and the share of the segment that is done there.
    ///
    /// # Arguments
    /// * `segments` – number of segments; each has the same share of the path
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of segments"
    )]
    pub fn locate(share: f64, segments: usize) -> (usize, f64) {
        let along = share.clamp(0.0, 1.0) * segments as f64;
        // The points themselves have to be met exactly.
        let near = along.round();
        let along = if (along - near).abs() <= 1e-12 * near { near } else { along };
        let segment = (along as usize).min(segments.saturating_sub(1));
        (segment, along - segment as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_meets_its_points_exactly_and_is_straight_between_them() {
        let points: Vec<Vec<f64>> =
            (0..=90).map(|k| vec![f64::from(k).sqrt(), 0.1 * f64::from(k % 7)]).collect();
        let path = DrivePath::through(vec![4, 1], points.clone()).unwrap();
        for (k, point) in points.iter().enumerate() {
            let at: Vec<(usize, f64)> = path.values_at(k as f64 / 90.0).collect();
            assert_eq!(at, vec![(4, point[0]), (1, point[1])], "{k}");
        }
        let between: Vec<(usize, f64)> = path.values_at(12.25 / 90.0).collect();
        let expected = points[12][0] + 0.25 * (points[13][0] - points[12][0]);
        assert!((between[0].1 - expected).abs() < 1e-13);
        let rate: Vec<(usize, f64)> = path.rate(12.25 / 90.0).collect();
        assert!((rate[0].1 - 90.0 * (points[13][0] - points[12][0])).abs() < 1e-12);
    }

    #[test]
    fn the_rate_where_a_path_rests_is_that_of_the_nearest_segment_that_moves() {
        let path = |values: [f64; 4]| {
            DrivePath::through(vec![0], values.map(|value| vec![value]).to_vec()).unwrap()
        };
        let rate = |values, share| path(values).rate(share).next().unwrap().1;
        assert_eq!(rate([0.0, 0.0, 2.0, 2.0], 0.0), 6.0);
        assert_eq!(rate([0.0, 0.0, 2.0, 2.0], 0.9), 6.0);
        assert_eq!(rate([1.0; 4], 0.5), 0.0);
    }

    #[test]
    fn points_that_are_no_path_are_refused() {
        let refused = |points: Vec<Vec<f64>>| DrivePath::through(vec![0], points).unwrap_err();
        assert!(matches!(refused(vec![vec![0.0]]), Error::LengthMismatch { found: 1, .. }));
        assert!(matches!(refused(vec![vec![0.0], vec![]]), Error::LengthMismatch { found: 0, .. }));
        let nan = refused(vec![vec![0.0], vec![f64::NAN]]);
        assert!(matches!(nan, Error::NotFinite { .. }), "{nan:?}");
        let drives = [Drive { coordinate: 3, to: 0.0 }];
        let index = DrivePath::line(&DVector::zeros(2), &drives).unwrap_err();
        assert!(matches!(index, Error::NoSuchQuantity { index: 3, count: 2, .. }));
    }
}
