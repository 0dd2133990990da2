//! Columns of numbers, computed several rows at a time.
//!
//! The instructions are those that the processor has, of which none is fused: all processors find the same.

use pulp::Arch;

use crate::extrema::{larger, raise};

/// Rows that are computed side by side.
const LANES: usize = 8;

/// Computes columns from columns, row by row; all have the length of the first result.
///
/// # Arguments
/// * `of_row` – results of a row from its inputs, without branches
pub(crate) fn map_rows<const N: usize, const M: usize>(
    inputs: [&[f64]; N],
    results: [&mut [f64]; M],
    of_row: impl Fn([f64; N]) -> [f64; M],
) {
    Arch::new().dispatch(
        #[inline(always)]
        move || {
            let inputs = inputs.map(|column| column.as_chunks::<LANES>());
            let mut results = results.map(|column| column.as_chunks_mut::<LANES>());
            for block in 0..results[0].0.len() {
                let given: [&[f64; LANES]; N] = std::array::from_fn(|k| &inputs[k].0[block]);
                let mut found = [[0.0; LANES]; M];
                for lane in 0..LANES {
                    let row = of_row(std::array::from_fn(|k| given[k][lane]));
                    for k in 0..M {
                        found[k][lane] = row[k];
                    }
                }
                for (column, found) in results.iter_mut().zip(found) {
                    column.0[block] = found;
                }
            }
            for rest in 0..results[0].1.len() {
                let row = of_row(std::array::from_fn(|k| inputs[k].1[rest]));
                for (column, value) in results.iter_mut().zip(row) {
                    column.1[rest] = value;
                }
            }
        },
    );
}

/// Largest magnitude in a column, 0 in an empty one; NaN is passed over.
pub(crate) fn largest_magnitude(column: &[f64]) -> f64 {
    largest(column, 0.0, f64::abs)
}

/// Least and largest number of a column; NaN is passed over.
pub(crate) fn range(column: &[f64]) -> [f64; 2] {
    [
        -largest(column, f64::NEG_INFINITY, |value| -value),
        largest(column, f64::NEG_INFINITY, |value| value),
    ]
}

/// Largest value of a function over a column, at least `least`.
#[inline(always)]
fn largest(column: &[f64], least: f64, of: impl Fn(f64) -> f64) -> f64 {
    Arch::new().dispatch(
        #[inline(always)]
        move || {
            let (blocks, rest) = column.as_chunks::<LANES>();
            let mut most = [least; LANES];
            for block in blocks {
                for lane in 0..LANES {
                    raise(&mut most[lane], of(block[lane]));
                }
            }
            let most = most.into_iter().fold(least, |most, value| larger(value, most));
            rest.iter().fold(most, |most, &value| larger(of(value), most))
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_computed_each_by_itself_whatever_their_number() {
        for count in [0, 1, 7, 8, 9, 16, 37] {
            let column =
                |scale: f64| -> Vec<f64> { (0..count).map(|k| scale * f64::from(k)).collect() };
            let (a, b) = (column(0.1), column(-0.3));
            let (mut sum, mut product) = (column(0.0), column(0.0));
            map_rows([&a, &b], [&mut sum, &mut product], |[a, b]| [a + b, a * b]);
            for k in 0..count as usize {
                assert_eq!([sum[k], product[k]], [a[k] + b[k], a[k] * b[k]], "{k} of {count}");
            }
        }
    }

    #[test]
    fn extremes_pass_over_what_is_not_a_number() {
        let mut column: Vec<f64> = (0..21).map(|k| f64::from(k) - 15.0).collect();
        assert_eq!((range(&column), largest_magnitude(&column)), ([-15.0, 5.0], 15.0));
        (column[0], column[20]) = (f64::NAN, f64::NAN);
        assert_eq!((range(&column), largest_magnitude(&column)), ([-14.0, 4.0], 14.0));
        assert_eq!((range(&[]), largest_magnitude(&[])), ([f64::INFINITY, f64::NEG_INFINITY], 0.0));
    }
}
