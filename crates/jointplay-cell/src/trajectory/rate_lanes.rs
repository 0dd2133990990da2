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

    /// Adds derivatives with respect to the coefficients, from those with respect to x and its derivatives.
    ///
    /// # Arguments
    /// * `hessian` – second derivatives, symmetric
    #[expect(
        clippy::needless_range_loop,
        reason = "sums over the indices of a product of matrices"
    )]
    #[inline(always)]
    pub(super) fn add_derivatives(
        &self,
        gradient: &[Lanes; N],
        hessian: &[[Lanes; N]; N],
        to: &mut Derivatives,
    ) {
        let first = self.first;
        let to_gradient = to.gradient.each_mut().map(|column| lanes_from_mut(column, first));
        let to_hessian = to.hessian.each_mut();
        let to_hessian =
            to_hessian.map(|row| row.each_mut().map(|column| lanes_from_mut(column, first)));
        // One loop over all of it becomes instructions over all lanes.
        for lane in 0..LANES {
            for a in 0..3 {
                let mut along = [0.0; N];
                for n in 0..N {
                    to_gradient[a][lane] += gradient[n][lane] * self.basis[n][a][lane];
                    for m in 0..N {
                        along[n] += hessian[n][m][lane] * self.basis[m][a][lane];
                    }
                }
                for b in a..3 {
                    for n in 0..N {
                        to_hessian[a][b][lane] += along[n] * self.basis[n][b][lane];
                    }
                }
            }
        }
    }
}

/// First and second derivatives with respect to the three coefficients of each interval.
pub(super) struct Derivatives {
    gradient: [[f64; INTERVALS]; 3],
    /// The upper triangle.
    hessian: [[[f64; INTERVALS]; 3]; 3],
}

impl Derivatives {
    pub(super) const ZERO: Self =
        Self { gradient: [[0.0; INTERVALS]; 3], hessian: [[[0.0; INTERVALS]; 3]; 3] };

    /// Second derivatives and gradient with respect to all coefficients.
    #[inline(always)]
    pub(super) fn assembled(&self) -> (Banded, Coefficients) {
        let (mut matrix, mut gradient) = ([[0.0; COEFFICIENTS]; 3], [0.0; COEFFICIENTS]);
        for a in 0..3 {
            add_column(&mut gradient[a..], &self.gradient[a]);
            for b in a..3 {
                add_column(&mut matrix[b - a][a..], &self.hessian[a][b]);
            }
        }
        (matrix, gradient)
    }
}

#[inline(always)]
fn add_column(to: &mut [f64], values: &[f64; INTERVALS]) {
    to.iter_mut().zip(values).for_each(|(to, value)| *to += value);
}

/// A symmetric matrix: its main diagonal and the two above it, each from the first row on.
pub(super) type Banded = [Coefficients; 3];

#[inline(always)]
fn lanes_from(values: &Coefficients, first: usize) -> &Lanes {
    values[first..].first_chunk().expect("the last intervals have all their coefficients")
}

#[inline(always)]
fn lanes_from_mut(values: &mut [f64; INTERVALS], first: usize) -> &mut Lanes {
    values[first..].first_chunk_mut().expect("blocks end with the last interval")
}

/// One number of each lane.
#[inline(always)]
pub(super) fn lanes(of_lane: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(of_lane)
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
            let gradient = [20, 30].map(|of| lanes(|lane| number(of + lane)));
            let [h0, h1, h2] = [40, 60, 80].map(|of| lanes(|lane| number(of + lane)));
            let mut derivatives = Derivatives::ZERO;
            block.add_derivatives(&gradient, &[[h0, h1], [h1, h2]], &mut derivatives);
            let (matrix, found) = derivatives.assembled();
            let expected = dot(&gradient[0], &along[0]) + dot(&gradient[1], &along[1]);
            assert!((dot(&found, &direction) - expected).abs() < 1e-14);
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
