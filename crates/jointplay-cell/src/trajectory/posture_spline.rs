//! Postures of an arm over the fraction of a Cartesian line.

use nalgebra::DMatrix;

use super::spline::Spline;
use crate::program::LinePostures;
use crate::robot::{ArmChain, PosturePath};

/// Postures of an arm over the fraction of a line.
pub(crate) struct PostureSpline {
    /// Indices of the arm's axes.
    axes: Vec<usize>,
    spline: Spline,
    /// Fractions of the spline at both ends of the line.
    fractions: [f64; 2],
    ends: [Vec<f64>; 2],
}

impl PostureSpline {
    pub(crate) fn new(chain: &ArmChain, postures: &LinePostures) -> Self {
        let PosturePath { fractions, positions } = postures.path.as_ref();
        let axes = positions[0].len();
        let values =
            DMatrix::from_iterator(axes, fractions.len(), positions.iter().flatten().copied());
        let spline = Spline::through(fractions, &values);
        let ends = postures.fractions.map(|fraction| spline.positions(fraction).collect());
        Self { axes: chain.axes().to_vec(), spline, fractions: postures.fractions, ends }
    }

    /// Adds the deviation of the postures from their own joint-space line to a point of the joint-space line of all axes; it is zero at both ends.
    pub(super) fn apply(&self, s: f64, positions: &mut [f64]) {
        let [from, to] = self.fractions;
        let postures = self.spline.positions(from + s * (to - from));
        let [start, end] = &self.ends;
        for ((&axis, posture), (start, end)) in
            self.axes.iter().zip(postures).zip(start.iter().zip(end))
        {
            positions[axis] += posture - (start + s * (end - start));
        }
    }
}
