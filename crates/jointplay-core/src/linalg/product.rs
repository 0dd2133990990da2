//! Products of matrices that do not depend on the processor.

use nalgebra::DMatrix;

/// A B, column by column: products of large matrices of the matrix library are fused on some processors and not on others.
pub(crate) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(a.nrows(), b.ncols());
    for (mut image, column) in product.column_iter_mut().zip(b.column_iter()) {
        image.gemv(1.0, a, &column, 0.0);
    }
    product
}
