//! The virtual joints of many poses by polynomials of the slopes.

use pulp::Simd;

use super::found::Found;
use super::geometry::Task;
use super::joint_polynomials::{JointPolynomials, Order, TERMS};
use super::lanes::Lanes;
use super::model::Model;
use super::polar;
use super::shape::{Balls, Shape};
use super::solve::{LeastNorm, Method, closed};

/// The least displacement by polynomials of degree 2 N for the slopes that they are made for, else by steps.
pub(crate) struct ByPolynomials<const N: usize>;

impl<const N: usize> Method for ByPolynomials<N> {
    #[inline(always)]
    fn found<S: Simd, M: Model>(task: &Task<'_>, balls: &Balls<S>) -> Found<S> {
        let Some(polynomials) = task.polynomials else {
            return LeastNorm::outlined::<S, M>(task, balls);
        };
        let found = polynomials.found::<S, M, N>(task, balls);
        if found.met.all() {
            return found;
        }
        found.completed_by(&LeastNorm::outlined::<S, M>(task, balls))
    }
}

impl JointPolynomials {
    /// As [`Self::found`], by their own order.
    #[inline(always)]
    pub(super) fn found_by_order<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
    ) -> Found<S> {
        match self.order() {
            Order::Three => self.found::<S, M, 3>(task, balls),
            Order::Four => self.found::<S, M, 4>(task, balls),
        }
    }

    /// The virtual joints of many poses, where the slopes are not too large and the sides are met.
    #[inline(always)]
    fn found<S: Simd, M: Model, const N: usize>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
    ) -> Found<S> {
        let [first, second] = self.slopes;
        let (x, y) = (slope(balls, first), slope(balls, second));
        let terms = terms::<S, N>(x, y);
        let rows = &self.coefficients;
        let a = [
            value::<S, N>(&rows[0], &terms),
            value::<S, N>(&rows[1], &terms),
            value::<S, N>(&rows[2], &terms),
        ];
        let mut b = [x.like(0.0); 3];
        if M::ACROSS {
            b[0] = value::<S, N>(&rows[3], &terms);
            b[1] = value::<S, N>(&rows[4], &terms);
            // Turns of neighbours in opposite senses leave the sum of the angles as it is.
            b[2] = if M::AROUND_CENTER { -(b[0] + b[1]) } else { value::<S, N>(&rows[5], &terms) };
        }
        let found = if M::AROUND_CENTER {
            polar::closed(task, balls, a, b)
        } else {
            closed(balls, task, Shape::at::<M>(task.geometry, a, b))
        };
        Found { met: found.met & terms[1].at_most(terms[0]), ..found }
    }
}

/// A slope of the plane through the balls, divided by the largest.
#[inline(always)]
fn slope<S: Simd>(balls: &Balls<S>, row: [f64; 2]) -> Lanes<S> {
    let [first, second, _] = balls.rises;
    first.times_plus(first.like(row[0]), second * row[1])
}

/// Terms of a polynomial, as those of [`JointPolynomials`].
#[inline(always)]
fn terms<S: Simd, const N: usize>(x: Lanes<S>, y: Lanes<S>) -> [Lanes<S>; TERMS] {
    let (zero, one) = (x.like(0.0), x.like(1.0));
    let square = y * y;
    let s = x.times_plus(x, square);
    let (a, b) = (x.times_plus(x, -square), (x + x) * y);
    // z⁴, z⁶ and z⁸, their real and their imaginary parts.
    let (a_2, b_2) = (b.times_from(b, a * a), (a + a) * b);
    let (a_3, b_3) = (b_2.times_from(b, a_2 * a), b_2.times_plus(a, a_2 * b));
    // Without a loop: the compiler keeps only numbers with names in registers.
    let (s_2, as_1, bs_1) = (s * s, a * s, b * s);
    let (s_3, as_2, bs_2, as_3, bs_3) = (s_2 * s, as_1 * s, bs_1 * s, a_2 * s, b_2 * s);
    let mut rest = [zero; 9];
    if N > 3 {
        let (a_4, b_4) = (b_2.times_from(b_2, a_2 * a_2), (a_2 + a_2) * b_2);
        let (a_3s, b_3s) = (a_3 * s, b_3 * s);
        rest = [s_3 * s, as_2 * s, bs_2 * s, as_3 * s, bs_3 * s, a_3s, b_3s, a_4, b_4];
    }
    let [c_0, c_1, c_2, c_3, c_4, c_5, c_6, c_7, c_8] = rest;
    [
        one, s, a, b, s_2, as_1, bs_1, a_2, b_2, s_3, as_2, bs_2, as_3, bs_3, a_3, b_3, c_0, c_1,
        c_2, c_3, c_4, c_5, c_6, c_7, c_8,
    ]
}

/// Value of a polynomial: two sums, so that neither waits for all terms.
#[inline(always)]
fn value<S: Simd, const N: usize>(row: &[f64; TERMS], terms: &[Lanes<S>; TERMS]) -> Lanes<S> {
    let (low, high) = (N * N, (N + 1) * (N + 1));
    let mut sum = terms[0].like(row[0]);
    for k in (1..low).rev() {
        sum = terms[k].times_plus(sum.like(row[k]), sum);
    }
    let mut rest = terms[low] * row[low];
    for k in low + 1..high {
        rest = terms[k].times_plus(sum.like(row[k]), rest);
    }
    sum + rest
}
