//! Positions of all axes over a path parameter: cubic pieces with continuous first and second derivatives.

use std::hash::Hasher;
use std::ops::Range;

use nalgebra::DMatrix;

use super::profile::hash_numbers;

/// Position of one axis with its first three derivatives with respect to the path parameter.
pub(crate) type Jet = [f64; 4];

/// A cubic spline through positions of all axes, over knots that grow from 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Spline {
    knots: Vec<f64>,
    /// Number of axes.
    axes: usize,
    /// Jets of all axes at the start of each interval, one interval after the other.
    jets: Vec<Jet>,
}

impl Spline {
    /// The spline through `values` at `knots`, at least four; the first two intervals share one cubic, and so do the last two.
    ///
    /// # Arguments
    /// * `values` – one column for each knot, with one row for each axis
    ///
    /// # Numerics
    /// A diagonally dominant tridiagonal matrix, factorized once for all axes; the error on a smooth path falls with the fourth power of the interval.
    ///
    /// # Source
    /// \[deBoor\], chapter IV, the "not-a-knot" end condition
    pub(crate) fn through(knots: &[f64], values: &DMatrix<f64>) -> Self {
        let axes = values.nrows();
        let h: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut jets = vec![[0.0; 4]; h.len() * axes];
        let system = CurvatureSystem::new(&h);
        let mut curvature = vec![0.0; knots.len()];
        for axis in 0..axes {
            let y = |k: usize| values[(axis, k)];
            system.solve(&h, &y, &mut curvature);
            for k in 0..h.len() {
                let third = (curvature[k + 1] - curvature[k]) / h[k];
                let slope =
                    (y(k + 1) - y(k)) / h[k] - h[k] * (2.0 * curvature[k] + curvature[k + 1]) / 6.0;
                jets[k * axes + axis] = [y(k), slope, curvature[k], third];
            }
        }
        Self { knots: knots.to_vec(), axes, jets }
    }

    /// The straight path from one position of all axes to another.
    pub(crate) fn straight(from: &[f64], to: &[f64]) -> Self {
        let jet = |(from, to): (&f64, &f64)| [*from, to - from, 0.0, 0.0];
        let jets = from.iter().zip(to).map(jet).collect();
        Self { knots: vec![0.0, 1.0], axes: from.len(), jets }
    }

    /// Number of intervals.
    fn pieces(&self) -> usize {
        self.knots.len() - 1
    }

    /// Index of the interval that holds `s`.
    pub(crate) fn interval(&self, s: f64) -> usize {
        self.knots.partition_point(|&knot| knot <= s).clamp(1, self.pieces()) - 1
    }

    /// As [`Self::interval`], for parameters in growing order: each call continues the search where the last one ended.
    pub(crate) fn intervals_in_order(&self) -> impl FnMut(f64) -> usize + '_ {
        let mut interval = 0;
        move |s| {
            while interval + 1 < self.pieces() && self.knots[interval + 1] <= s {
                interval += 1;
            }
            interval
        }
    }

    /// Parameters in growing order, by intervals: each interval with the range of the parameters that it holds.
    pub(super) fn runs(&self, parameters: &[f64]) -> impl Iterator<Item = (usize, Range<usize>)> {
        let mut first = 0;
        (0..self.pieces()).map(move |interval| {
            let rest = &parameters[first..];
            let held = if interval + 1 < self.pieces() {
                rest.partition_point(|&s| s < self.knots[interval + 1])
            } else {
                rest.len()
            };
            let run = first..first + held;
            first = run.end;
            (interval, run)
        })
    }

    /// Parameter at the start of an interval, and the jet of an axis there.
    pub(super) fn piece(&self, interval: usize, axis: usize) -> (f64, Jet) {
        (self.knots[interval], self.jets[interval * self.axes + axis])
    }

    /// Jet of an axis at `s`, by the cubic of an interval.
    pub(crate) fn jet(&self, interval: usize, axis: usize, s: f64) -> Jet {
        let (start, jet) = self.piece(interval, axis);
        advanced(&jet, s - start)
    }

    /// Jets of all axes at the start of each interval.
    pub(crate) fn jets(&self) -> impl Iterator<Item = &[Jet]> {
        self.jets.chunks_exact(self.axes)
    }

    /// Number of axes.
    pub(crate) fn axes(&self) -> usize {
        self.axes
    }

    /// Whether an axis moves along the path.
    pub(crate) fn moves(&self, axis: usize) -> bool {
        self.jets().any(|jets| jets[axis][1..] != [0.0; 3])
    }

    /// Positions of all axes at `s`, in their order (m or rad).
    pub(crate) fn positions(&self, s: f64) -> impl Iterator<Item = f64> + '_ {
        let interval = self.interval(s);
        (0..self.axes).map(move |axis| self.jet(interval, axis, s)[0])
    }

    /// Largest absolute slope of an axis: it is at a knot, or where the curvature of a piece is zero.
    pub(crate) fn max_slope(&self, axis: usize) -> f64 {
        let pieces = self.jets().zip(self.knots.windows(2));
        pieces.fold(0.0, |most, (jets, ends)| {
            let [_, slope, curvature, third] = jets[axis];
            let whole = ends[1] - ends[0];
            let turn = (-curvature / third).clamp(0.0, whole);
            let at = |t: f64| (slope + t * (curvature + t * third / 2.0)).abs();
            // Without a third derivative `turn` is NaN, which `max` passes over.
            most.max(at(0.0)).max(at(whole)).max(at(turn))
        })
    }

    /// Adds everything that determines the path to a hash.
    pub(crate) fn hash(&self, hasher: &mut impl Hasher) {
        hash_numbers(hasher, &self.knots);
        self.jets.iter().for_each(|jet| hash_numbers(hasher, jet));
    }

    /// Path parameters at which the pieces meet, and both ends.
    pub(crate) fn knots(&self) -> &[f64] {
        &self.knots
    }
}

/// A jet advanced along its cubic.
#[inline(always)]
pub(crate) fn advanced([y, slope, curvature, third]: &Jet, t: f64) -> Jet {
    [
        y + t * (slope + t * (curvature / 2.0 + t * third / 6.0)),
        slope + t * (curvature + t * third / 2.0),
        curvature + t * third,
        *third,
    ]
}

/// The linear equations for second derivatives at the knots, by the "not-a-knot" end condition, its matrix factorized.
struct CurvatureSystem {
    /// Multiple of the row before that each row has lost.
    factors: Vec<f64>,
    diagonal: Vec<f64>,
    above: Vec<f64>,
    /// Ratios by which the curvature is extrapolated linearly beyond the first and the last inner knot.
    ends: [f64; 2],
}

impl CurvatureSystem {
    /// # Arguments
    /// * `h` – widths of the intervals, at least three
    fn new(h: &[f64]) -> Self {
        let last = h.len();
        let inner = last - 1;
        let mut below = h[..inner].to_vec();
        let mut diagonal: Vec<f64> = h.windows(2).map(|pair| 2.0 * (pair[0] + pair[1])).collect();
        let mut above = h[1..].to_vec();
        // The extrapolation makes the third derivative continuous at the first and last inner knot.
        let ends = [h[0] / h[1], h[last - 1] / h[last - 2]];
        diagonal[0] += below[0] * (1.0 + ends[0]);
        above[0] -= below[0] * ends[0];
        diagonal[inner - 1] += above[inner - 1] * (1.0 + ends[1]);
        below[inner - 1] -= above[inner - 1] * ends[1];
        let mut factors = below;
        for row in 1..inner {
            factors[row] /= diagonal[row - 1];
            diagonal[row] -= factors[row] * above[row - 1];
        }
        Self { factors, diagonal, above, ends }
    }

    /// Writes the second derivatives of an axis with values `y` at the knots.
    fn solve(&self, h: &[f64], y: &dyn Fn(usize) -> f64, m: &mut [f64]) {
        let (last, inner) = (h.len(), self.diagonal.len());
        for k in 1..last {
            m[k] = 6.0 * ((y(k + 1) - y(k)) / h[k] - (y(k) - y(k - 1)) / h[k - 1]);
        }
        for row in 1..inner {
            m[row + 1] -= self.factors[row] * m[row];
        }
        m[inner] /= self.diagonal[inner - 1];
        for row in (0..inner - 1).rev() {
            m[row + 1] = (m[row + 1] - self.above[row] * m[row + 2]) / self.diagonal[row];
        }
        m[0] = m[1] + self.ends[0] * (m[1] - m[2]);
        m[last] = m[last - 1] + self.ends[1] * (m[last - 1] - m[last - 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_reproduces_a_cubic_on_uneven_knots() {
        let cubic = |s: f64| 1.0 + s * (-2.0 + s * (0.5 + s * 3.0));
        let knots = [0.0, 0.1, 0.35, 0.4, 0.8, 1.0];
        let values = DMatrix::from_fn(2, 6, |axis, k| [cubic(knots[k]), -cubic(knots[k])][axis]);
        let spline = Spline::through(&knots, &values);
        for s in [0.0, 0.05, 0.1, 0.2, 0.39, 0.77, 0.9, 1.0] {
            let jet = spline.jet(spline.interval(s), 0, s);
            let expected = [cubic(s), -2.0 + s + 9.0 * s * s, 1.0 + 18.0 * s, 18.0];
            for (found, expected) in jet.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-11, "{s}: {found} {expected}");
            }
            assert!((spline.positions(s).nth(1).unwrap() + cubic(s)).abs() < 1e-13);
        }
        // The slope of the cubic is −2 + s + 9 s²; that of 4 s (1 − s)² is 4 (1 − s) (1 − 3 s), with its extremum at 2/3.
        assert!((spline.max_slope(0) - 8.0).abs() < 1e-11);
        let both = |s: f64| [4.0 * s * (1.0 - s).powi(2) - 3.5 * s, 2.0 * s];
        let values = DMatrix::from_fn(2, 6, |axis, k| both(knots[k])[axis]);
        let spline = Spline::through(&knots, &values);
        assert!((spline.max_slope(0) - (4.0 / 3.0 + 3.5)).abs() < 1e-11);
        assert!((spline.max_slope(1) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn error_falls_with_the_fourth_power_of_the_interval() {
        let error = |pieces: u32| {
            let knots: Vec<f64> = (0..=pieces).map(|k| f64::from(k) / f64::from(pieces)).collect();
            let values = DMatrix::from_fn(1, knots.len(), |_, k| (3.0 * knots[k]).sin());
            let spline = Spline::through(&knots, &values);
            (0..1000)
                .map(|k| f64::from(k) / 1000.0)
                .map(|s| (spline.positions(s).next().unwrap() - (3.0 * s).sin()).abs())
                .fold(0.0, f64::max)
        };
        let gain = error(16) / error(32);
        assert!(gain > 10.0 && gain < 40.0, "{gain}");
    }
}
