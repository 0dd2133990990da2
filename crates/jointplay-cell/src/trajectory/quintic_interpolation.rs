//! Interpolation of axis positions by a quintic spline, and its resampling to the knots of a cubic one.
//!
//! Limits of the jerk depend on third derivatives of a path.
//! Those of a cubic spline are constant in each interval and jump by a large part of their value at the knots; those of a quintic spline are parabolas without jumps.

use nalgebra::DMatrix;

use super::spline::Spline;

/// Degree of the polynomial pieces.
const DEGREE: usize = 5;
/// Number of basis splines that are not zero at one parameter.
const ORDER: usize = DEGREE + 1;
/// Least number of intervals of the resampled spline.
const RESAMPLED_INTERVALS: usize = 48;
/// Largest ratio of the widths of two intervals between which a quintic spline is well conditioned.
const MAX_WIDTH_RATIO: f64 = 64.0;

/// The cubic spline through points of the quintic spline through `values` at `knots`; the cubic spline through the values themselves where the knots are very uneven, or fewer than twelve.
///
/// # Arguments
/// * `values` – one column for each knot, with one row for each axis
pub(super) fn resampled_spline(knots: &[f64], values: DMatrix<f64>) -> Spline {
    let widths = || knots.windows(2).map(|pair| pair[1] - pair[0]);
    let (min, max) =
        widths().fold((f64::INFINITY, 0.0_f64), |(a, b), width| (a.min(width), b.max(width)));
    if knots.len() < 2 * ORDER || max > MAX_WIDTH_RATIO * min {
        return Spline::through(knots, &values);
    }
    let intervals = knots.len() - 1;
    let count = RESAMPLED_INTERVALS.div_ceil(intervals);
    let mut fine = Vec::with_capacity(count * intervals + 1);
    for pair in knots.windows(2) {
        let inner = (1..count).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64);
        fine.push(pair[0]);
        fine.extend(inner);
    }
    fine.extend(knots.last());
    let mut resampled = DMatrix::zeros(values.nrows(), fine.len());
    for (k, column) in values.column_iter().enumerate() {
        resampled.set_column(k * count, &column);
    }
    let is_at_rest = |axis: usize| values.row(axis).iter().all(|&one| one == values[(axis, 0)]);
    let at_rest: Vec<bool> = (0..values.nrows()).map(is_at_rest).collect();
    let quintic = QuinticSpline::through(knots, values);
    for (k, &s) in fine.iter().enumerate().filter(|(k, _)| k % count != 0) {
        let (first, basis) = basis(&quintic.knots, s);
        for (axis, &at_rest) in at_rest.iter().enumerate() {
            // Round-off would move an axis at rest.
            resampled[(axis, k)] =
                if at_rest { resampled[(axis, 0)] } else { quintic.position(first, &basis, axis) };
        }
    }
    Spline::through(&fine, &resampled)
}

/// A quintic spline as a sum of basis splines.
struct QuinticSpline {
    /// Knots of the basis splines, those at both ends six times.
    knots: Vec<f64>,
    /// Coefficients of all axes, one column for each basis spline.
    coefficients: DMatrix<f64>,
}

impl QuinticSpline {
    /// The spline through values at parameters that grow, at least six; the first three intervals share one polynomial, and so do the last three.
    ///
    /// # Arguments
    /// * `values` – one column for each parameter, with one row for each axis
    ///
    /// # Numerics
    /// The matrix is totally positive: elimination needs no exchange of rows.
    ///
    /// # Source
    /// \[deBoor\], chapter XIII
    fn through(parameters: &[f64], values: DMatrix<f64>) -> Self {
        let count = parameters.len();
        let mut knots = vec![parameters[0]; ORDER];
        knots.extend(&parameters[ORDER / 2..count - ORDER / 2]);
        knots.extend([parameters[count - 1]; ORDER]);
        // Band of each row: columns row − DEGREE to row + DEGREE.
        let mut matrix = vec![[0.0; 2 * DEGREE + 1]; count];
        for (row, &s) in parameters.iter().enumerate() {
            let (first, basis) = basis(&knots, s);
            for (k, value) in basis.into_iter().enumerate() {
                matrix[row][first + k + DEGREE - row] = value;
            }
        }
        let (axes, mut coefficients) = (values.nrows(), values);
        for pivot in 0..count {
            let pivot_row = matrix[pivot];
            for row in pivot + 1..count.min(pivot + ORDER) {
                let factor = matrix[row][pivot + DEGREE - row] / pivot_row[DEGREE];
                if factor == 0.0 {
                    continue;
                }
                for column in pivot..=(pivot + DEGREE).min(count - 1) {
                    matrix[row][column + DEGREE - row] -=
                        factor * pivot_row[column + DEGREE - pivot];
                }
                for axis in 0..axes {
                    let pivot_value = coefficients[(axis, pivot)];
                    coefficients[(axis, row)] -= factor * pivot_value;
                }
            }
        }
        for row in (0..count).rev() {
            for axis in 0..axes {
                let mut own = coefficients[(axis, row)];
                for (known, factor) in (row + 1..count).zip(&matrix[row][ORDER..]) {
                    own -= factor * coefficients[(axis, known)];
                }
                coefficients[(axis, row)] = own / matrix[row][DEGREE];
            }
        }
        Self { knots, coefficients }
    }

    /// Position of an axis where the first basis spline that is not zero is known, and the values of it and those after it (m or rad).
    fn position(&self, first: usize, basis: &[f64; ORDER], axis: usize) -> f64 {
        let terms = basis.iter().enumerate();
        terms.fold(0.0, |sum, (k, weight)| sum + weight * self.coefficients[(axis, first + k)])
    }
}

/// Index of the first basis spline that is not zero at `s`, and the values of it and the five after it.
///
/// # Source
/// \[deBoor\], chapter X, the algorithm BSPLVB
fn basis(knots: &[f64], s: f64) -> (usize, [f64; ORDER]) {
    let last = knots.len() - ORDER - 1;
    let interval = (knots.partition_point(|&knot| knot <= s) - 1).clamp(DEGREE, last);
    let mut values = [0.0; ORDER];
    values[0] = 1.0;
    for degree in 1..ORDER {
        let mut saved = 0.0;
        for k in 0..degree {
            let (right, left) = (knots[interval + 1 + k], knots[interval + 1 + k - degree]);
            let term = values[k] / (right - left);
            values[k] = saved + (right - s) * term;
            saved = (s - left) * term;
        }
        values[degree] = saved;
    }
    (interval - DEGREE, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uneven() -> Vec<f64> {
        (0..=16).map(|k| f64::from(k) / 16.0).map(|s| s + 0.1 * s * (1.0 - s)).collect()
    }

    #[test]
    fn quintic_spline_reproduces_a_quintic_on_uneven_knots() {
        let quintic = |s: f64| 1.0 + s * (-2.0 + s * (0.5 + s * (3.0 + s * (-4.0 + 2.0 * s))));
        let knots = uneven();
        let values = DMatrix::from_fn(2, 17, |axis, k| [quintic(knots[k]), -knots[k]][axis]);
        let spline = QuinticSpline::through(&knots, values);
        for k in 0..=100 {
            let s = f64::from(k) / 100.0;
            let (first, basis) = basis(&spline.knots, s);
            let found = [0, 1].map(|axis| spline.position(first, &basis, axis));
            assert!((found[0] - quintic(s)).abs() < 1e-13 && (found[1] + s).abs() < 1e-13, "{s}");
        }
    }

    #[test]
    fn third_derivatives_of_a_resampled_spline_are_close_to_those_of_the_function() {
        let knots = uneven();
        let values = DMatrix::from_fn(2, 17, |axis, k| [(4.0 * knots[k]).sin(), 0.3][axis]);
        let deviation = |spline: &Spline| {
            let at = |k: i32| f64::from(k) / 500.0;
            let third = |s: f64| -64.0 * (4.0 * s).cos();
            let found = |s: f64| spline.jet(spline.interval(s), 0, s)[3];
            (0..=500).map(at).map(|s| (found(s) - third(s)).abs()).fold(0.0, f64::max)
        };
        let (cubic, resampled) = (
            deviation(&Spline::through(&knots, &values)),
            deviation(&resampled_spline(&knots, values.clone())),
        );
        // Third derivatives of cubics are constant between knots, of which the resampled spline has twice as many.
        assert!(resampled < 0.4 * cubic, "{resampled} {cubic}");
        let spline = resampled_spline(&knots, values.clone());
        assert!(!spline.moves(1), "an axis at rest stays at rest");
        for (&s, value) in knots.iter().zip(values.column_iter()) {
            assert!((spline.positions(s).next().unwrap() - value[0]).abs() < 1e-15);
        }
    }
}
