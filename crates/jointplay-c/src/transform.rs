//! Homogeneous transforms and matrices as arrays by rows.

use jointplay::nalgebra::DMatrix;
use jointplay::spatial::Pose;

/// Entries of a homogeneous transform.
pub(crate) const ENTRIES: usize = 16;

/// Entries of a homogeneous transform by rows.
#[inline]
pub(crate) fn entries(pose: &Pose) -> [f64; ENTRIES] {
    let r = pose.rotation.matrix();
    let o = &pose.translation.vector;
    [
        r[(0, 0)],
        r[(0, 1)],
        r[(0, 2)],
        o[0],
        r[(1, 0)],
        r[(1, 1)],
        r[(1, 2)],
        o[1],
        r[(2, 0)],
        r[(2, 1)],
        r[(2, 2)],
        o[2],
        0.0,
        0.0,
        0.0,
        1.0,
    ]
}

/// Entries of a matrix by rows.
pub(crate) fn by_rows(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}
