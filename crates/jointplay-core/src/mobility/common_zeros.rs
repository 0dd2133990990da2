//! Common zeros of quadrics: real ones by Newton's method, the dimension of the complex ones by elimination.

use nalgebra::{DMatrix, DVector};

use crate::Error;
use crate::linalg::svd;
use crate::random::Random;

/// Starts and steps of the search for a direction on which all quadrics vanish, and the share of a direction that a step has to leave.
const ZERO_STARTS: usize = 3;
const ZERO_STEPS: usize = 20;
const LEAST_LEFT: f64 = 0.1;

/// Relative rank threshold of the gradients of the quadrics.
const GRADIENT_THRESHOLD: f64 = 1e-8;

/// Monomials of a Macaulay matrix at most; beyond, the dimension is not reduced further, which only weakens the bound.
const MAX_MONOMIALS: usize = 210;

/// Whether all quadrics vanish on some direction, as far as Newton's method finds one from a few starts.
pub(super) fn have_common_zero(quadrics: &[DMatrix<f64>], cut: f64) -> Result<bool, Error> {
    let size = quadrics[0].nrows();
    let mut random = Random(6);
    for _ in 0..ZERO_STARTS {
        let start = DVector::from_fn(size, |_, _| random.next()).normalize();
        if zero_near(quadrics, start, cut)?.is_some() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// A direction on which no quadric exceeds `cut`, found from a direction near it; `None` where Newton's method finds none.
pub(super) fn zero_near(
    quadrics: &[DMatrix<f64>],
    mut there: DVector<f64>,
    cut: f64,
) -> Result<Option<DVector<f64>>, Error> {
    for _ in 0..ZERO_STEPS {
        let products: Vec<DVector<f64>> = quadrics.iter().map(|q| q * &there).collect();
        let values = products.iter().map(|product| product.dot(&there));
        let values = DVector::from_iterator(products.len(), values);
        if values.amax() <= cut {
            return Ok(Some(there));
        }
        let gradients = DMatrix::from_columns(&products).transpose() * 2.0;
        let decomposition = svd(&gradients)?;
        there -= decomposition.solve(&values, decomposition.rank(GRADIENT_THRESHOLD));
        let norm = there.norm();
        if norm < LEAST_LEFT {
            break;
        }
        there /= norm;
    }
    Ok(None)
}

/// Codimension of the common complex zeros of some quadrics, or a smaller number where its evaluation is too large.
///
/// The zeros have at most n dimensions if they meet some subspace of codimension n at the origin only, and a random one shows this if any does.
/// They meet it at the origin only if the multiples of the quadrics there span all forms of some degree: the rank of a Macaulay matrix.
///
/// # Arguments
/// * `quadrics` – symmetric matrices of one size, not all zero
/// * `cut` – singular values up to this one count as zero
///
/// # Source
/// \[CoxLittleOShea\], sections 8.3 and 9.4; the degree, one more than the number of variables: Macaulay's bound for quadrics, \[CoxLittleOSheaUsing\], section 3.4
pub(super) fn codimension(quadrics: &[DMatrix<f64>], cut: f64) -> Result<usize, Error> {
    let size = quadrics[0].nrows();
    let mut random = Random(3);
    let frame = DMatrix::from_fn(size, size, |_, _| random.next()).qr().q();
    // A quadric that is not zero vanishes on no random line.
    let mut codimension = 1;
    for variables in 2..=size {
        let section = frame.columns(0, variables);
        let restricted: Vec<DMatrix<f64>> =
            quadrics.iter().map(|quadric| section.transpose() * quadric * section).collect();
        if !vanish_at_origin_only(&restricted, cut)? {
            break;
        }
        codimension = variables;
    }
    Ok(codimension)
}

/// Whether quadrics have no common complex zero but the origin, as far as matrices of moderate size show it.
fn vanish_at_origin_only(quadrics: &[DMatrix<f64>], cut: f64) -> Result<bool, Error> {
    let variables = quadrics[0].nrows();
    let independent = independent(quadrics, cut)?;
    if independent.len() < variables {
        return Ok(false);
    }
    for degree in 2..=variables + 1 {
        let columns = monomials(variables, degree);
        if columns.len() > MAX_MONOMIALS {
            break;
        }
        let factors = monomials(variables, degree - 2);
        if independent.len() * factors.len() < columns.len() {
            continue;
        }
        let mut matrix = DMatrix::zeros(independent.len() * factors.len(), columns.len());
        let multiples = independent.iter().flat_map(|q| factors.iter().map(move |f| (q, f)));
        for (row, (quadric, factor)) in multiples.enumerate() {
            for i in 0..variables {
                for j in 0..variables {
                    let mut product = factor.clone();
                    product.extend([i, j]);
                    product.sort_unstable();
                    let column = columns.binary_search(&product).expect("a monomial of the degree");
                    matrix[(row, column)] += quadric[(i, j)];
                }
            }
        }
        let values = svd(&matrix)?.singular_values;
        if values[columns.len() - 1] > cut {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Orthogonal combinations of the quadrics that span them, each of the size of its singular value.
fn independent(quadrics: &[DMatrix<f64>], cut: f64) -> Result<Vec<DMatrix<f64>>, Error> {
    let flat: Vec<DVector<f64>> =
        quadrics.iter().map(|quadric| DVector::from_column_slice(quadric.as_slice())).collect();
    let decomposition = svd(&DMatrix::from_columns(&flat))?;
    let size = quadrics[0].nrows();
    let values = decomposition.singular_values.iter().enumerate();
    Ok(values
        .filter(|&(_, &value)| value > cut)
        .map(|(k, &value)| {
            DMatrix::from_column_slice(size, size, (decomposition.u.column(k) * value).as_slice())
        })
        .collect())
}

/// Monomials of a degree, ascending, each as the ascending indices of its variables.
fn monomials(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..degree {
        all = all
            .into_iter()
            .flat_map(|monomial| {
                let from = monomial.last().copied().unwrap_or(0);
                (from..variables).map(move |next| {
                    let mut longer = monomial.clone();
                    longer.push(next);
                    longer
                })
            })
            .collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σ of factors times products of two variables.
    fn form(size: usize, terms: &[(f64, usize, usize)]) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(size, size);
        for &(factor, i, j) in terms {
            matrix[(i, j)] += factor / 2.0;
            matrix[(j, i)] += factor / 2.0;
        }
        matrix
    }

    #[test]
    fn codimensions_of_zeros_known_by_thought() {
        let square = |size, i| form(size, &[(1.0, i, i)]);
        let product = |size, i, j| form(size, &[(1.0, i, j)]);
        let sum = form(3, &[(1.0, 0, 0), (1.0, 1, 1), (1.0, 2, 2)]);
        let cases: [(&str, Vec<DMatrix<f64>>, usize); 8] = [
            ("one double plane", vec![square(3, 0)], 1),
            ("a sum of squares has complex zeros", vec![sum.clone()], 1),
            ("a conic on a double plane", vec![sum, square(3, 0)], 2),
            ("a common factor x: xy = xz = 0", vec![product(3, 0, 1), product(3, 0, 2)], 1),
            (
                "three axes: xy = yz = zx = 0",
                vec![product(3, 0, 1), product(3, 1, 2), product(3, 0, 2)],
                2,
            ),
            ("the origin: x² = y² = z² = 0", (0..3).map(|i| square(3, i)).collect(), 3),
            (
                "two planes: x² = y² = 0 in four dimensions",
                (0..2).map(|i| square(4, i)).collect(),
                2,
            ),
            (
                "a twisted cubic: xz = y², xw = yz, yw = z²",
                vec![
                    form(4, &[(1.0, 0, 2), (-1.0, 1, 1)]),
                    form(4, &[(1.0, 0, 3), (-1.0, 1, 2)]),
                    form(4, &[(1.0, 1, 3), (-1.0, 2, 2)]),
                ],
                2,
            ),
        ];
        for (name, quadrics, expected) in cases {
            assert_eq!(codimension(&quadrics, 1e-8).unwrap(), expected, "{name}");
        }
    }
}
