//! Successive intervals of a squared rate, computed side by side.
//!
//! Loops over the lanes become instructions that the processor has, of which none is fused: all processors find the same.

/// Number of intervals of the spline, a multiple of [`LANES`].
pub(super) const INTERVALS: usize = 48;
/// Number of coefficients of the spline.
pub(super) const COEFFICIENTS: usize = INTERVALS + 2;
/// Intervals that are computed side by side.
pub(super) const LANES: usize = 8;

/// One number of each of several successive intervals.
pub(super) type Lanes = [f64; LANES];

/// Coefficients of a squared rate.
pub(super) type Coefficients = [f64; COEFFICIENTS];

/// The three basis splines in x and, up to the order `N − 1`, its derivatives, at one place of each of several successive intervals.
#[derive(Debug)]
pub(super) struct LanesOfBasis<const N: usize> {
    /// The first interval.
    first: usize,
    /// Of each order the three basis splines.
    basis: [[Lanes; 3]; N],
}

impl<const N: usize> LanesOfBasis<N> {
    /// # Arguments
    /// * `basis` – basis splines of each interval
    pub(super) fn new(first: usize, basis: impl Fn(usize) -> [[f64; 3]; N]) -> Self {
        let of_lane: [_; LANES] = std::array::from_fn(|lane| basis(first + lane));
        let basis = std::array::from_fn(|order| [0, 1, 2].map(|k| of_lane.map(|of| of[order][k])));
        Self { first, basis }
    }

    /// x and its derivatives.
    #[inline(always)]
    pub(super) fn values(&self, coefficients: &Coefficients) -> [Lanes; N] {
        let own = [0, 1, 2].map(|k| lanes_from(coefficients, self.first + k));
        let mut values = [[0.0; LANES]; N];
        for (value, [b0, b1, b2]) in values.iter_mut().zip(&self.basis) {
            for k in 0..LANES {
                value[k] = b0[k] * own[0][k] + b1[k] * own[1][k] + b2[k] * own[2][k];
            }
        }
        values
    }

    /// Adds the gradient with respect to the coefficients, from the one with respect to x and its derivatives.
    #[inline(always)]
    pub(super) fn add_gradient(&self, gradient: &[Lanes; N], to: &mut Coefficients) {
        for k in 0..3 {
            let to = lanes_from_mut(to, self.first + k);
            for (gradient, basis) in gradient.iter().zip(&self.basis) {
                add(to, |lane| gradient[lane] * basis[k][lane]);
            }
        }
    }

    /// Adds the second derivatives with respect to the coefficients, from those with respect to x and its derivatives.
    ///
    /// # Arguments
    /// * `hessian` – second derivatives, symmetric
    #[inline(always)]
    pub(super) fn add_hessian(&self, hessian: &[[Lanes; N]; N], to: &mut Banded) {
        for a in 0..3 {
            let mut along = [[0.0; LANES]; N];
            for (row, along) in hessian.iter().zip(&mut along) {
                for (second, basis) in row.iter().zip(&self.basis) {
                    add(along, |lane| second[lane] * basis[a][lane]);
                }
            }
            for b in a..3 {
                let to = lanes_from_mut(&mut to[b - a], self.first + a);
                for (along, basis) in along.iter().zip(&self.basis) {
                    add(to, |lane| along[lane] * basis[b][lane]);
                }
            }
        }
    }
}

/// A symmetric matrix: its main diagonal and the two above it, each from the first row on.
pub(super) type Banded = [Coefficients; 3];

#[inline(always)]
fn lanes_from(values: &Coefficients, first: usize) -> &Lanes {
    values[first..].first_chunk().expect("the last intervals have all their coefficients")
}

#[inline(always)]
fn lanes_from_mut(values: &mut Coefficients, first: usize) -> &mut Lanes {
    values[first..].first_chunk_mut().expect("the last intervals have all their coefficients")
}

/// One number of each lane.
#[inline(always)]
pub(super) fn lanes(of_lane: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(of_lane)
}

/// Adds one number of each lane.
///
/// A loop with one result becomes instructions over all lanes.
#[inline(always)]
pub(super) fn add(sum: &mut Lanes, of_lane: impl Fn(usize) -> f64) {
    for (lane, sum) in sum.iter_mut().enumerate() {
        *sum += of_lane(lane);
    }
}

/// Sum of the products of two columns.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).sum()
}

/// Solves a linear system with a positive definite matrix, in place.
#[inline(always)]
pub(super) fn solve_banded(mut matrix: Banded, right: &mut Coefficients) {
    // Factors L D Lᵀ: D in the main diagonal, the columns of L in the others.
    let [diagonal, first, second] = &mut matrix;
    for k in 0..COEFFICIENTS {
        let inverse = 1.0 / diagonal[k];
        let (l1, l2) = (first[k] * inverse, second[k] * inverse);
        if k + 1 < COEFFICIENTS {
            diagonal[k + 1] -= l1 * first[k];
            first[k + 1] -= l1 * second[k];
            right[k + 1] -= l1 * right[k];
        }
        if k + 2 < COEFFICIENTS {
            diagonal[k + 2] -= l2 * second[k];
            right[k + 2] -= l2 * right[k];
        }
        right[k] *= inverse;
        (first[k], second[k]) = (l1, l2);
    }
    for k in (0..COEFFICIENTS - 1).rev() {
        right[k] -= first[k] * right[k + 1];
        if k + 2 < COEFFICIENTS {
            right[k] -= second[k] * right[k + 2];
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Numbers without a pattern.
    fn number(k: usize) -> f64 {
        (0.754_877_666_246_692_8 * (k + 1) as f64).fract() - 0.3
    }

    fn coefficients(seed: usize) -> Coefficients {
        std::array::from_fn(|k| number(seed + k))
    }

    /// Another basis at each interval.
    fn basis(interval: usize) -> [[f64; 3]; 2] {
        [0, 3].map(|of| [0, 1, 2].map(|k| number(interval * interval + of + k)))
    }

    fn dense(matrix: &Banded) -> DMatrix<f64> {
        DMatrix::from_fn(COEFFICIENTS, COEFFICIENTS, |row, column| {
            matrix.get(row.abs_diff(column)).map_or(0.0, |diagonal| diagonal[row.min(column)])
        })
    }

    #[test]
    fn derivatives_by_coefficients_follow_from_those_by_the_rate() {
        for first in [0, LANES, INTERVALS - LANES] {
            let block = LanesOfBasis::new(first, basis);
            let (x, direction) = (coefficients(7), coefficients(90));
            let along = block.values(&direction);
            for lane in 0..LANES {
                for (order, splines) in basis(first + lane).iter().enumerate() {
                    let own = splines.iter().zip(&x[first + lane..]);
                    let expected: f64 = own.map(|(spline, value)| spline * value).sum();
                    assert!((block.values(&x)[order][lane] - expected).abs() < 1e-15);
                }
            }
            let gradient =
                [0, 1].map(|of| std::array::from_fn(|lane| number(20 + of * LANES + lane)));
            let mut found = [1.0; COEFFICIENTS];
            block.add_gradient(&gradient, &mut found);
            let expected: f64 = direction.iter().sum::<f64>()
                + (0..2).map(|order| dot(&gradient[order], &along[order])).sum::<f64>();
            assert!((dot(&found, &direction) - expected).abs() < 1e-14);
            let [h0, h1, h2] = [40, 60, 80].map(|of| lanes(|lane| number(of + lane)));
            let mut matrix = [[0.0; COEFFICIENTS]; 3];
            block.add_hessian(&[[h0, h1], [h1, h2]], &mut matrix);
            let expected: f64 = (0..LANES)
                .map(|k| {
                    let [v, w] = along.map(|along| along[k]);
                    v * (h0[k] * v + h1[k] * w) + w * (h1[k] * v + h2[k] * w)
                })
                .sum();
            let direction = DVector::from_row_slice(&direction);
            assert!(((dense(&matrix) * &direction).dot(&direction) - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn banded_systems_are_solved() {
        let mut matrix = [coefficients(3), coefficients(70), coefficients(150)];
        matrix[0].iter_mut().for_each(|value| *value += 3.0);
        let right = coefficients(400);
        let expected = dense(&matrix).lu().solve(&DVector::from_row_slice(&right)).unwrap();
        let mut found = right;
        solve_banded(matrix, &mut found);
        assert!((DVector::from_row_slice(&found) - expected).amax() < 1e-14);
    }
}
