//! Supports: subspaces of self-stresses in which some joints and couplings carry nothing.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVectorView};

use crate::linalg::{LinalgError, svd};

/// Products of numbers in an enumeration of supports, each of which costs about their number times the square of the dimension.
const MAX_PRODUCTS: f64 = 3e8;

/// Subspace of the self-stresses without any wrench outside some joints.
pub(super) struct Support {
    /// Blocks with a wrench or force, ascending: joints, then couplings.
    pub(super) blocks: Vec<usize>,
    /// (redundancy, dimension) orthonormal.
    pub(super) basis: DMatrix<f64>,
}

/// Which shares of self-stresses count as zero.
pub(super) struct Evidence {
    pub(super) tolerance: f64,
    pub(super) largest_zero: f64,
    pub(super) smallest_nonzero: f64,
}

impl Evidence {
    /// Part of a subspace that a block maps to zero.
    pub(super) fn kernel(
        &mut self,
        block: &DMatrix<f64>,
        basis: &DMatrix<f64>,
    ) -> Result<DMatrix<f64>, LinalgError> {
        let mapped = block * basis;
        if mapped.nrows() == 1 {
            return Ok(self.kernel_of_row(&mapped, basis));
        }
        let found = svd(&mapped)?;
        let mut rank = 0;
        for &value in &found.singular_values {
            if value > self.tolerance {
                rank += 1;
                self.smallest_nonzero = self.smallest_nonzero.min(value);
            } else {
                self.largest_zero = self.largest_zero.max(value);
            }
        }
        Ok(basis * found.null_space(rank))
    }

    /// Part of a subspace that a row, applied to its basis, maps to zero: the basis reflected such that the row is along its first vector.
    fn kernel_of_row(&mut self, row: &DMatrix<f64>, basis: &DMatrix<f64>) -> DMatrix<f64> {
        let value = row.norm();
        if value <= self.tolerance {
            self.largest_zero = self.largest_zero.max(value);
            return basis.clone();
        }
        self.smallest_nonzero = self.smallest_nonzero.min(value);
        // The sign without cancellation.
        let mut normal = row.transpose() / value;
        normal[0] += if normal[0] < 0.0 { -1.0 } else { 1.0 };
        let factor = 2.0 / normal.norm_squared();
        let along = basis * &normal;
        let reflected = basis - along * normal.transpose() * factor;
        reflected.columns(1, basis.ncols() - 1).into_owned()
    }

    /// A basis of single self-stresses by elimination with full pivoting: each is zero in the components that are pivots of the others.
    pub(super) fn eliminated(&self, all: &DMatrix<f64>, blocks: &[DMatrix<f64>]) -> Vec<Support> {
        let n = all.ncols();
        let (mut rows, mut by) = (all.clone(), DMatrix::<f64>::identity(n, n));
        for k in 0..n {
            let (pivot, column) = rows.columns(k, n - k).iamax_full();
            rows.swap_columns(k, k + column);
            by.swap_columns(k, k + column);
            let value = rows[(pivot, k)];
            for other in (0..n).filter(|&other| other != k) {
                let share = rows[(pivot, other)] / value;
                for matrix in [&mut rows, &mut by] {
                    let taken = matrix.column(k) * share;
                    let mut from = matrix.column_mut(other);
                    from -= taken;
                }
            }
        }
        let support = |column: DVectorView<'_, f64>| {
            let basis = DMatrix::from_column_slice(n, 1, column.normalize().as_slice());
            let is_part = |&j: &usize| (&blocks[j] * &basis).amax() > self.tolerance;
            Support { blocks: (0..blocks.len()).filter(is_part).collect(), basis }
        };
        by.column_iter().map(support).collect()
    }

    /// All subspaces that remain where some blocks are zero, and whether these are all.
    pub(super) fn supports(
        &mut self,
        blocks: &[DMatrix<f64>],
        whole: &DMatrix<f64>,
        most: usize,
    ) -> Result<(Vec<Support>, bool), LinalgError> {
        let tolerance = self.tolerance;
        let nonzero = |basis: &DMatrix<f64>| -> Vec<usize> {
            (0..blocks.len()).filter(|&j| (&blocks[j] * basis).amax() > tolerance).collect()
        };
        let start = nonzero(whole);
        if start.is_empty() {
            return Ok((Vec::new(), true));
        }
        let rows: usize = blocks.iter().map(DMatrix::nrows).sum();
        #[expect(clippy::cast_precision_loss, reason = "an estimate")]
        let products = |kernels: usize, dimension: usize| {
            kernels as f64 * rows as f64 * whole.nrows() as f64 * dimension as f64
        };
        let mut done = products(start.len(), whole.ncols());
        if done > MAX_PRODUCTS {
            return Ok((vec![Support { blocks: start, basis: whole.clone() }], false));
        }
        // Blocks that vanish together are tried once: joints in series transmit the same wrench.
        let mut tried: Vec<(usize, Vec<usize>)> = Vec::new();
        for &j in &start {
            let kernel = self.kernel(&blocks[j], whole)?;
            let rest = if kernel.ncols() == 0 { Vec::new() } else { nonzero(&kernel) };
            if !tried.iter().any(|(_, known)| *known == rest && !known.contains(&j)) {
                tried.push((j, rest));
            }
        }
        let mut seen = BTreeSet::from([start.clone()]);
        let mut found = vec![Support { blocks: start, basis: whole.clone() }];
        // Small supports soon, in case there are too many.
        let mut open = vec![0];
        while let Some(next) = open.pop() {
            done += products(tried.len(), found[next].basis.ncols());
            if found.len() > most || done > MAX_PRODUCTS {
                return Ok((found, false));
            }
            for &(j, _) in &tried {
                if found[next].blocks.binary_search(&j).is_err() {
                    continue;
                }
                let basis = self.kernel(&blocks[j], &found[next].basis)?;
                if basis.ncols() == 0 {
                    continue;
                }
                let support = nonzero(&basis);
                if !support.is_empty() && seen.insert(support.clone()) {
                    open.push(found.len());
                    found.push(Support { blocks: support, basis });
                }
            }
        }
        Ok((found, true))
    }
}
