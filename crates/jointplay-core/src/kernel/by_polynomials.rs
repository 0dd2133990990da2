//! The virtual joints by polynomials of the slopes: those of many poses side by side, or all those of one.

use pulp::{Scalar, Simd};

use super::found::{Ahead, Found, Gaps};
use super::geometry::{Geometry, Task};
use super::joint_polynomials::{Coefficients, JOINTS, JointPolynomials, Order, SINE, TERMS};
use super::lanes::{Lanes, MOST};
use super::model::Model;
use super::polar;
use super::pose::{InPlane, PlatformPoses};
use super::shape::{Balls, Shape, Three};
use super::solve::Method;

/// By polynomials of degree 2 N, for the slopes that they are made for; nowhere else.
#[derive(Clone, Copy)]
pub(crate) struct ByPolynomials<'p, const N: usize>(pub(crate) &'p JointPolynomials);

impl<const N: usize> Method for ByPolynomials<'_, N> {
    #[inline(always)]
    fn found<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
        _ahead: Ahead<S>,
    ) -> Found<S> {
        self.0.found::<S, M, N>(task, balls)
    }

    #[inline(always)]
    fn placed<S: Simd, M: Model>(
        &self,
        geometry: &Geometry,
        balls: &Balls<S>,
        _: &Found<S>,
    ) -> PlatformPoses<S> {
        let Self(polynomials) = self;
        let terms = polynomials.terms::<S, N>(balls);
        let rows = &polynomials.coefficients;
        let in_plane = InPlane {
            sine: value::<S, N>(rows, SINE, &terms),
            center: [value::<S, N>(rows, SINE + 1, &terms), value::<S, N>(rows, SINE + 2, &terms)],
        };
        PlatformPoses::at(geometry, balls, in_plane)
    }
}

impl JointPolynomials {
    /// The virtual joints of many poses, where the slopes are not too large and the sides are met.
    #[inline(always)]
    fn found<S: Simd, M: Model, const N: usize>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
    ) -> Found<S> {
        let terms = self.terms::<S, N>(balls);
        let rows = &self.coefficients;
        let mut joints = [terms[0].like(0.0); JOINTS];
        for (k, joint) in joints.iter_mut().enumerate() {
            if k < 3 || M::ACROSS && !(M::AROUND_CENTER && k == 5) {
                *joint = value::<S, N>(rows, k, &terms);
            }
        }
        let [a_1, a_2, a_3, b_1, b_2, b_3] = joints;
        self.checked::<S, M>(task, balls, [a_1, a_2, a_3], [b_1, b_2, b_3], &terms)
    }

    /// The virtual joints of one pose, side by side; met where the slopes are not too large and the sides are met.
    ///
    /// With the place of the platform in the plane, if `PLACED`.
    #[inline(always)]
    pub(super) fn found_one<W: Simd, M: Model, const PLACED: bool>(
        &self,
        wide: W,
        task: &Task<'_>,
        balls: &Balls<Scalar>,
    ) -> (Found<Scalar>, Option<InPlane<Scalar>>) {
        match self.order() {
            Order::Three => self.one::<W, M, 3, PLACED>(wide, task, balls),
            Order::Four => self.one::<W, M, 4, PLACED>(wide, task, balls),
        }
    }

    #[inline(always)]
    fn one<W: Simd, M: Model, const N: usize, const PLACED: bool>(
        &self,
        wide: W,
        task: &Task<'_>,
        balls: &Balls<Scalar>,
    ) -> (Found<Scalar>, Option<InPlane<Scalar>>) {
        let terms = self.terms::<Scalar, N>(balls);
        let count = if M::ACROSS { JOINTS } else { JOINTS / 2 };
        let joints = values::<W, N>(wide, &self.coefficients, 0, count, &terms);
        let in_plane = PLACED.then(
            #[inline(always)]
            || {
                let place = values::<W, N>(wide, &self.coefficients, SINE, 3, &terms);
                let [sine, x, y] = [0, 1, 2].map(|k| terms[0].like(place[k]));
                InPlane { sine, center: [x, y] }
            },
        );
        let (mut a, mut b) = ([terms[0]; 3], [terms[0]; 3]);
        for k in 0..3 {
            a[k] = terms[0].like(joints[k]);
            b[k] = terms[0].like(joints[3 + k]);
        }
        (self.checked::<Scalar, M>(task, balls, a, b, &terms), in_plane)
    }

    /// Terms for the slopes of planes through the balls.
    #[inline(always)]
    fn terms<S: Simd, const N: usize>(&self, balls: &Balls<S>) -> [Lanes<S>; TERMS] {
        let [first, second] = self.slopes;
        terms::<S, N>(slope(balls, first), slope(balls, second))
    }

    /// Sockets at given coordinates; met where their sides are, and the slopes are not too large.
    ///
    /// They have the sense of the base: between those for a level plane and them, no triangle that meets the sides has an area of zero.
    #[inline(always)]
    fn checked<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
        a: Three<S>,
        mut b: Three<S>,
        terms: &[Lanes<S>; TERMS],
    ) -> Found<S> {
        let mut met = terms[1].at_most(terms[0]);
        let missing = if M::AROUND_CENTER {
            // Turns of neighbours in opposite senses leave the sum of the angles as it is.
            b[2] = -(b[0] + b[1]);
            let (missing, exact) = polar::missing(task.geometry, balls, a, b);
            met = met & exact;
            missing
        } else {
            Shape::at::<M>(task.geometry, a, b).missing(balls)
        };
        let residual = self.residual(balls, &missing);
        met =
            met & residual.squared().at_most(residual.like(task.threshold * self.longest_squared));
        Found {
            a,
            b,
            gaps: Gaps::Largest(residual),
            laid: None,
            iterations: residual.like(0.0),
            met,
        }
    }

    /// Largest of |L − l| = |L² − l²|/(L + l), with a bound of 1/2 L that is linear in L² (m).
    ///
    /// # Numerics
    /// For slopes up to the largest, x, of the polynomials: never too small, and too large by 0.1 x⁴ of itself at most.
    #[inline(always)]
    fn residual<S: Simd>(&self, balls: &Balls<S>, missing: &Three<S>) -> Lanes<S> {
        let mut shares = *missing;
        for k in 0..3 {
            let [constant, linear] = self.half_inverses[k];
            let square = balls.squares[k];
            let half_inverse = square.times_plus(square.like(linear), square.like(constant));
            shares[k] = missing[k].abs() * half_inverse;
        }
        let [first, second, third] = shares;
        first.max(second).max(third)
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

/// Value of the polynomial of a virtual joint: two sums, so that neither waits for all terms.
#[inline(always)]
fn value<S: Simd, const N: usize>(
    coefficients: &Coefficients,
    joint: usize,
    terms: &[Lanes<S>; TERMS],
) -> Lanes<S> {
    let Coefficients(rows) = coefficients;
    let mut sum = terms[0].like(rows[0][joint]);
    for k in 1..4 {
        sum = terms[k].times_plus(sum.like(rows[k][joint]), sum);
    }
    let mut second = terms[4] * rows[4][joint];
    for k in 5..9 {
        second = terms[k].times_plus(sum.like(rows[k][joint]), second);
    }
    let mut third = terms[9] * rows[9][joint];
    for k in 10..(N + 1) * (N + 1) {
        third = terms[k].times_plus(sum.like(rows[k][joint]), third);
    }
    sum + second + third
}

/// Values of `count` polynomials from `start` on, side by side: a sum for each degree, so that none waits for the others.
#[inline(always)]
fn values<W: Simd, const N: usize>(
    wide: W,
    coefficients: &Coefficients,
    start: usize,
    count: usize,
    terms: &[Lanes<Scalar>; TERMS],
) -> [f64; MOST] {
    let mut values = [0.0; MOST];
    for from in (0..count).step_by(Lanes::<W>::COUNT) {
        let first = start + from;
        let constant = Lanes::of(wide, &coefficients.0[0][first..first + Lanes::<W>::COUNT]);
        let low = constant + degree(wide, coefficients, 1, first, terms);
        let high = degree(wide, coefficients, 2, first, terms)
            + degree(wide, coefficients, 3, first, terms);
        let mut sum = low + high;
        if N > 3 {
            sum = sum + degree(wide, coefficients, 4, first, terms);
        }
        sum.store(&mut values, from);
    }
    values
}

/// Sum of the terms of degree 2n.
#[inline(always)]
fn degree<W: Simd>(
    wide: W,
    coefficients: &Coefficients,
    n: usize,
    first: usize,
    terms: &[Lanes<Scalar>; TERMS],
) -> Lanes<W> {
    let Coefficients(rows) = coefficients;
    let (from, lanes) = (n * n, Lanes::<W>::COUNT);
    let mut sum = Lanes::of(wide, &rows[from][first..first + lanes]) * terms[from].number();
    for k in from + 1..(n + 1) * (n + 1) {
        let term = Lanes::splat(wide, terms[k].number());
        sum = Lanes::of(wide, &rows[k][first..first + lanes]).times_plus(term, sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::joint_polynomials::COLUMNS;
    use super::*;

    /// Programs and processors that differ in registers find the same virtual joints.
    #[test]
    fn values_have_the_same_bits_in_all_registers() {
        let mut next = 1.0_f64;
        let mut number = || {
            next = (next * 1.618_033_988_749_895).fract() + 1e-3;
            next - 0.5
        };
        let mut rows = [[0.0; COLUMNS]; TERMS];
        rows.iter_mut().for_each(|row| row[..JOINTS].fill_with(&mut number));
        let coefficients = Coefficients(rows);
        let terms =
            terms::<Scalar, 4>(Lanes::splat(Scalar, number()), Lanes::splat(Scalar, number()));
        let bits = |values: [f64; MOST]| values[..JOINTS].iter().map(|x| x.to_bits()).collect();
        let expected: Vec<u64> = bits(values::<_, 4>(Scalar, &coefficients, 0, JOINTS, &terms));
        for (joint, expected) in expected.iter().enumerate() {
            let alone = value::<Scalar, 4>(&coefficients, joint, &terms).number();
            assert!((alone - f64::from_bits(*expected)).abs() < 1e-14);
        }
        let check = |found: [f64; MOST]| assert_eq!(bits(found), expected);
        check(values::<_, 4>(pulp::Scalar128b, &coefficients, 0, JOINTS, &terms));
        check(values::<_, 4>(pulp::Scalar256b, &coefficients, 0, JOINTS, &terms));
        check(values::<_, 4>(pulp::Scalar512b, &coefficients, 0, JOINTS, &terms));
        struct Wide<'a>(&'a Coefficients, &'a [Lanes<Scalar>; TERMS]);
        impl pulp::WithSimd for Wide<'_> {
            type Output = [f64; MOST];

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
                values::<S, 4>(simd, self.0, 0, JOINTS, self.1)
            }
        }
        check(pulp::Arch::new().dispatch(Wide(&coefficients, &terms)));
    }
}
