//! Paths of a wafer in the arm's plane, and postures of the arm along them.

use nalgebra::Vector2;

/// A path of the wafer's centre in the arm's plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlanarPath {
    /// Corners of the path, in the platform frame (m).
    pub(crate) corners: Vec<Vector2<f64>>,
    /// Heading of the wafer from the platform's x axis, where it is prescribed (rad).
    pub(crate) heading: Option<f64>,
}

/// Positions of an arm's motors along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PosturePath {
    /// Fractions of the path's length, growing from 0 to 1.
    pub fractions: Vec<f64>,
    /// Positions of the arm's axes at each fraction, without the rods, in the order of the first joint that each drives (m or rad).
    pub positions: Vec<Vec<f64>>,
}

impl PosturePath {
    /// Positions of the arm's axes at a fraction of the path's length, between the samples on a straight path (m or rad).
    pub(crate) fn at(&self, fraction: f64) -> Vec<f64> {
        let next =
            self.fractions.partition_point(|&s| s <= fraction).clamp(1, self.fractions.len() - 1);
        let [from, to] = [self.fractions[next - 1], self.fractions[next]];
        let t = (fraction - from) / (to - from);
        let pairs = self.positions[next - 1].iter().zip(&self.positions[next]);
        pairs.map(|(a, b)| a + t * (b - a)).collect()
    }
}

/// No motion of an arm's motors follows a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoPosturePath {
    /// Largest fraction of the path's length that can be followed from its start.
    pub(crate) fraction: f64,
}

impl PlanarPath {
    /// Fractions of the path's length at the corners.
    pub(crate) fn fractions(&self) -> Vec<f64> {
        let mut lengths = vec![0.0];
        for pair in self.corners.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let whole = lengths[lengths.len() - 1];
        lengths.iter().map(|length| if whole > 0.0 { length / whole } else { 1.0 }).collect()
    }

    pub(super) fn length(&self) -> f64 {
        self.corners.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    /// The point at a fraction of the path's length (m).
    pub(crate) fn at(&self, fraction: f64) -> Vector2<f64> {
        let fractions = self.fractions();
        let leg = fractions.partition_point(|&s| s <= fraction).clamp(1, fractions.len() - 1);
        let [from, to] = [fractions[leg - 1], fractions[leg]];
        let t = if to > from { (fraction - from) / (to - from) } else { 0.0 };
        self.corners[leg - 1] + (self.corners[leg] - self.corners[leg - 1]) * t
    }
}
