//! Sines, cosines and arc tangents of many angles at a time.

// The coefficients are those of the sources, to the last digit printed there.
#![expect(clippy::excessive_precision, reason = "coefficients are as their sources print them")]

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

use pulp::Simd;

use super::lanes::{Lanes, Mask};

/// π/2 and what its rounding has left of it: a fused multiply-add takes any number of the first from an angle exactly.
const HALF_PI: [f64; 2] = [FRAC_PI_2, 6.123_233_995_736_766e-17];
/// Angles beyond this are left to the standard library (rad).
const FAR: f64 = 1e6;
/// Added to a number below 2⁵¹, it leaves the nearest whole number in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of any angle (rad).
///
/// # Numerics
/// Off by less than 2·10⁻¹⁶.
///
/// # Source
/// Polynomials of \[fdlibm\], `k_sin.c`, `k_cos.c`
#[inline(always)]
pub(crate) fn sin_cos<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let (sine, cosine, opposite) = either_direction(angle);
    let near = (opposite.select(-sine, sine), opposite.select(-cosine, cosine));
    let far = !angle.abs().at_most(angle.like(FAR));
    if !far.any() {
        return near;
    }
    let (sine, cosine) = angle.outlined(
        #[inline(always)]
        move || (angle.each(libm::sin), angle.each(libm::cos)),
    );
    (far.select(sine, near.0), far.select(cosine, near.1))
}

/// Sine and cosine of an angle that is not [`FAR`], or of the opposite direction, and where of that (rad).
#[inline(always)]
fn either_direction<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>, Mask<S>) {
    let shifted = angle.times_plus(angle.like(FRAC_2_PI), angle.like(ROUNDING));
    let quarters = shifted - ROUNDING;
    let mut rest = angle;
    for part in HALF_PI {
        rest = quarters.times_from(angle.like(part), rest);
    }
    let (sine, cosine) = within_an_eighth(rest);
    let turned = shifted.bit(1);
    (turned.select(cosine, sine), turned.select(-sine, cosine), shifted.bit(2))
}

/// Gradient of a plane that tilts by an angle up to π/2 toward an azimuth (rad).
///
/// # Numerics
/// Off by less than 10⁻¹⁵ of itself for tilts up to 1 rad; steeper ones, and azimuths that are [`FAR`], by [`sin_cos`].
///
/// # Source
/// \[Lambert\], the ninth convergent of tan x = x/(1 − x²/(3 − x²/(5 − …))), whose coefficients are whole numbers
#[inline(always)]
pub(crate) fn gradient<S: Simd>(azimuth: Lanes<S>, tilt: Lanes<S>) -> [Lanes<S>; 2] {
    const ABOVE: [f64; 5] = [1.0, -990.0, 135_135.0, -4_729_725.0, 34_459_425.0];
    const BELOW: [f64; 5] = [45.0, -13_860.0, 945_945.0, -16_216_200.0, 34_459_425.0];
    let (sine, cosine, opposite) = either_direction(azimuth);
    let square = tilt.squared();
    let tangent = tilt * polynomial(square, &ABOVE) / polynomial(square, &BELOW);
    let slope = opposite.select(-tangent, tangent);
    let [x, y] = [slope * cosine, slope * sine];
    let near = azimuth.abs().at_most(azimuth.like(FAR)) & tilt.abs().at_most(tilt.like(1.0));
    if near.all() {
        return [x, y];
    }
    let [any_x, any_y] = azimuth.outlined(
        #[inline(always)]
        move || {
            let ((sine, cosine), (rise, run)) = (sin_cos(azimuth), sin_cos(tilt));
            let slope = rise / run;
            [slope * cosine, slope * sine]
        },
    );
    [near.select(x, any_x), near.select(y, any_y)]
}

/// Sine and cosine of angles up to π/4 (rad).
#[inline(always)]
fn within_an_eighth<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    const SINE: [f64; 6] = [
        1.589_690_995_211_550_102_21e-10,
        -2.505_076_025_340_686_341_95e-8,
        2.755_731_370_707_006_767_89e-6,
        -1.984_126_982_985_794_931_34e-4,
        8.333_333_333_322_489_461_24e-3,
        -1.666_666_666_666_663_243_48e-1,
    ];
    const COSINE: [f64; 6] = [
        -1.135_964_755_778_819_482_65e-11,
        2.087_572_321_298_174_827_90e-9,
        -2.755_731_435_139_066_330_35e-7,
        2.480_158_728_947_672_941_78e-5,
        -1.388_888_888_887_410_957_49e-3,
        4.166_666_666_666_660_190_37e-2,
    ];
    let square = angle.squared();
    let sine = (square * angle).times_plus(polynomial(square, &SINE), angle);
    let series = square.times_plus(polynomial(square, &COSINE), square.like(-0.5));
    (sine, square.times_plus(series, square.like(1.0)))
}

/// Sine and cosine of angles that are mostly far below 1/32 (rad).
///
/// # Numerics
/// Exact to round-off; a short series where the angle is small, else [`sin_cos`].
#[inline(always)]
pub(crate) fn sin_cos_of_step<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    const SINE: [f64; 3] = [-1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0];
    const COSINE: [f64; 3] = [-1.0 / 720.0, 1.0 / 24.0, -0.5];
    let square = angle.squared();
    let sine = (square * angle).times_plus(polynomial(square, &SINE), angle);
    let cosine = square.times_plus(polynomial(square, &COSINE), square.like(1.0));
    let small = square.at_most(square.like(1.0 / 1024.0));
    if small.all() {
        return (sine, cosine);
    }
    let (any_sine, any_cosine) = outlined_sin_cos(angle);
    (small.select(sine, any_sine), small.select(cosine, any_cosine))
}

/// [`sin_cos`] in one place for all rare cases.
#[inline(always)]
fn outlined_sin_cos<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    angle.outlined(
        #[inline(always)]
        move || sin_cos(angle),
    )
}

/// Sines and versines, 1 − cos, of three angles that are mostly far below 1/32 (rad).
///
/// # Numerics
/// Exact to round-off; a short series where all three are small, else [`sin_cos`].
#[inline(always)]
pub(crate) fn sin_cos_of_steps<S: Simd>(angles: [Lanes<S>; 3]) -> ([Lanes<S>; 3], [Lanes<S>; 3]) {
    const SINE: [f64; 3] = [-1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0];
    const VERSINE: [f64; 3] = [1.0 / 720.0, -1.0 / 24.0, 0.5];
    let squares = [angles[0].squared(), angles[1].squared(), angles[2].squared()];
    let (mut sines, mut versines) = (squares, squares);
    for k in 0..3 {
        let square = squares[k];
        sines[k] = (square * angles[k]).times_plus(polynomial(square, &SINE), angles[k]);
        versines[k] = square * polynomial(square, &VERSINE);
    }
    let [a, b, c] = squares;
    let small = a.max(b).max(c).at_most(a.like(1.0 / 1024.0));
    if !small.all() {
        for k in 0..3 {
            let (sine, cosine) = outlined_sin_cos(angles[k]);
            sines[k] = small.select(sines[k], sine);
            versines[k] = small.select(versines[k], a.like(1.0) - cosine);
        }
    }
    (sines, versines)
}

/// Sines and versines of three angles, and where they are those of the angles.
pub(crate) struct Series<S: Simd> {
    pub(crate) sines: [Lanes<S>; 3],
    pub(crate) versines: [Lanes<S>; 3],
    /// Where all three angles are so small that the series are exact to round-off in comparison with one.
    pub(crate) exact: Mask<S>,
}

impl<S: Simd> Series<S> {
    /// For angles below 10⁻⁴ (rad).
    #[inline(always)]
    pub(crate) fn of_tiny(angles: &[Lanes<S>; 3]) -> Self {
        let squares = [angles[0].squared(), angles[1].squared(), angles[2].squared()];
        let (mut sines, mut versines) = (squares, squares);
        for k in 0..3 {
            sines[k] = (angles[k] * (1.0 / 6.0)).times_from(squares[k], angles[k]);
            versines[k] = squares[k] * 0.5;
        }
        let [a, b, c] = squares;
        Self { sines, versines, exact: a.max(b).max(c).at_most(a.like(1e-8)) }
    }

    /// For angles below 0.01 (rad), by two terms more.
    #[inline(always)]
    pub(crate) fn of_small(angles: &[Lanes<S>; 3]) -> Self {
        let squares = [angles[0].squared(), angles[1].squared(), angles[2].squared()];
        let (mut sines, mut versines) = (squares, squares);
        for k in 0..3 {
            let square = squares[k];
            let series = square.times_plus(square.like(1.0 / 120.0), square.like(-1.0 / 6.0));
            sines[k] = (square * angles[k]).times_plus(series, angles[k]);
            let series = square.times_plus(square.like(1.0 / 720.0), square.like(-1.0 / 24.0));
            versines[k] = square * square.times_plus(series, square.like(0.5));
        }
        let [a, b, c] = squares;
        // x⁷/5040 is then below 2·10⁻¹⁸.
        Self { sines, versines, exact: a.max(b).max(c).at_most(a.like(1e-4)) }
    }

    /// Sines and versines, by [`sin_cos_of_steps`] where the series are not exact.
    #[inline(always)]
    pub(crate) fn or_any(mut self, angles: [Lanes<S>; 3]) -> ([Lanes<S>; 3], [Lanes<S>; 3]) {
        if !self.exact.all() {
            let (sines, versines) = sin_cos_of_steps(angles);
            for k in 0..3 {
                self.sines[k] = self.exact.select(self.sines[k], sines[k]);
                self.versines[k] = self.exact.select(self.versines[k], versines[k]);
            }
        }
        (self.sines, self.versines)
    }
}

/// The angle of a vector of length one, to ten digits, whose sine is mostly small (rad).
///
/// # Numerics
/// A series of the arc sine where the angle is below 1/32, else [`angle_of`].
#[inline(always)]
pub(crate) fn small_angle_of<S: Simd>(sine: Lanes<S>, cosine: Lanes<S>) -> Lanes<S> {
    const ARC_SINE: [f64; 5] = [63.0 / 2816.0, 35.0 / 1152.0, 5.0 / 112.0, 3.0 / 40.0, 1.0 / 6.0];
    let square = sine.squared();
    let angle = (square * sine).times_plus(polynomial(square, &ARC_SINE), sine);
    let small = sine.abs().at_most(cosine * (1.0 / 32.0));
    if small.all() {
        return angle;
    }
    small.select(
        angle,
        sine.outlined(
            #[inline(always)]
            move || angle_of(sine, cosine),
        ),
    )
}

/// The angle of a vector (x, y) of finite numbers, from −π to π; zero for no vector at all (rad).
///
/// # Numerics
/// Off by less than 5·10⁻¹⁶.
///
/// # Source
/// \[Cephes\], `atan.c`
#[inline(always)]
pub(crate) fn angle_of<S: Simd>(y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    const ABOVE: [f64; 5] = [
        -8.750_608_600_031_904_122_785e-1,
        -1.615_753_718_733_365_076_637e1,
        -7.500_855_792_314_704_667_340e1,
        -1.228_866_684_490_136_173_410e2,
        -6.485_021_904_942_025_371_773e1,
    ];
    const BELOW: [f64; 6] = [
        1.0,
        2.485_846_490_142_306_297_962e1,
        1.650_270_098_316_988_542_046e2,
        4.328_810_604_912_902_668_951e2,
        4.853_903_996_359_136_964_868e2,
        1.945_506_571_482_613_964_425e2,
    ];
    /// tan(π/8), above which the angle is measured from π/4.
    const TAN_OF_SIXTEENTH: f64 = 0.414_213_562_373_095_048_8;
    let zero = y.like(0.0);
    let (tall, wide) = (y.abs(), x.abs());
    let (most, least) = (tall.max(wide), tall.min(wide));
    let none = most.at_most(zero);
    let steep = (most * TAN_OF_SIXTEENTH).below(least);
    // (t − 1)/(t + 1) for t = least/most, with one division.
    let above = steep.select(least - most, least);
    let below = none.select(y.like(1.0), steep.select(least + most, most));
    let slope = above / below;
    let square = slope.squared();
    let share = square * polynomial(square, &ABOVE) / polynomial(square, &BELOW);
    let angle = slope.times_plus(share, slope) + steep.select(y.like(FRAC_PI_4), zero);
    let angle = wide.below(tall).select(y.like(FRAC_PI_2) - angle, angle);
    let angle = x.below(zero).select(y.like(PI) - angle, angle);
    y.below(zero).select(-angle, angle)
}

/// Σ c_i zⁿ⁻ⁱ, the coefficient of the highest power first.
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(z: Lanes<S>, coefficients: &[f64; N]) -> Lanes<S> {
    let square = z.squared();
    // Two coefficients at a time, so that half as many products wait for each other.
    let (first, pairs) = coefficients.split_at(2 - N % 2);
    let mut sum = z.like(first[0]);
    if let [_, second] = first {
        sum = sum.times_plus(z, z.like(*second));
    }
    for pair in pairs.chunks_exact(2) {
        let next = z.times_plus(z.like(pair[0]), z.like(pair[1]));
        sum = sum.times_plus(square, next);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    /// Runs a function of two columns on whatever the machine has.
    struct Run<'a, F>(&'a [f64], &'a [f64], F);

    trait OfTwo {
        fn call<S: Simd>(&self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S>;
    }

    impl<F: OfTwo> WithSimd for Run<'_, F> {
        type Output = Vec<f64>;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
            let count = Lanes::<S>::COUNT;
            let lanes = |numbers: &[f64]| {
                let mut all = numbers.to_vec();
                all.resize(count, 0.0);
                Lanes::of(simd, &all)
            };
            let mut found = vec![0.0; self.0.len()];
            for ((a, b), found) in
                self.0.chunks(count).zip(self.1.chunks(count)).zip(found.chunks_mut(count))
            {
                self.2.call(lanes(a), lanes(b)).store(found, 0);
            }
            found
        }
    }

    struct Sine;
    impl OfTwo for Sine {
        fn call<S: Simd>(&self, a: Lanes<S>, _b: Lanes<S>) -> Lanes<S> {
            sin_cos(a).0
        }
    }
    struct Cosine;
    impl OfTwo for Cosine {
        fn call<S: Simd>(&self, a: Lanes<S>, _b: Lanes<S>) -> Lanes<S> {
            sin_cos(a).1
        }
    }
    struct StepSine;
    impl OfTwo for StepSine {
        fn call<S: Simd>(&self, a: Lanes<S>, _b: Lanes<S>) -> Lanes<S> {
            sin_cos_of_step(a).0
        }
    }
    struct StepCosine;
    impl OfTwo for StepCosine {
        fn call<S: Simd>(&self, a: Lanes<S>, _b: Lanes<S>) -> Lanes<S> {
            sin_cos_of_step(a).1
        }
    }
    struct GradientX;
    impl OfTwo for GradientX {
        fn call<S: Simd>(&self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
            gradient(a, b)[0]
        }
    }
    struct GradientY;
    impl OfTwo for GradientY {
        fn call<S: Simd>(&self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
            gradient(a, b)[1]
        }
    }
    struct AngleOf;
    impl OfTwo for AngleOf {
        fn call<S: Simd>(&self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
            angle_of(a, b)
        }
    }

    #[track_caller]
    fn check(function: impl OfTwo, a: &[f64], b: &[f64], exact: fn(f64, f64) -> f64, within: f64) {
        let found = Arch::new().dispatch(Run(a, b, function));
        for ((found, a), b) in found.iter().zip(a).zip(b) {
            let exact = exact(*a, *b);
            let same = (found - exact).abs() <= within || (found.is_nan() && exact.is_nan());
            assert!(same, "{found:e} for {exact:e} at {a} {b}");
        }
    }

    fn angles() -> Vec<f64> {
        let mut angles: Vec<f64> = (-4000..4000).map(|i| f64::from(i) * 0.003_9).collect();
        angles.extend((-40..40).map(|i| f64::from(i) * FRAC_PI_4));
        angles.extend((-40..40).map(|i| f64::from(i) * 1e-9));
        angles.extend((-40..40).map(|i| f64::from(i) * 24_999.7));
        angles.extend([0.0, -0.0, 1e9, -1e300, f64::NAN, f64::INFINITY, 1.0 / 32.0, -0.031_3]);
        angles
    }

    #[test]
    fn sines_and_cosines() {
        let angles = angles();
        check(Sine, &angles, &angles, |a, _| a.sin(), 2.3e-16);
        check(Cosine, &angles, &angles, |a, _| a.cos(), 2.3e-16);
        check(StepSine, &angles, &angles, |a, _| a.sin(), 2.3e-16);
        check(StepCosine, &angles, &angles, |a, _| a.cos(), 2.3e-16);
    }

    #[test]
    fn gradients() {
        let azimuths = angles();
        for steepest in [0.05, 0.999, 1.4] {
            let tilts: Vec<f64> =
                (0..azimuths.len()).map(|i| steepest * (i as f64 * 0.37).sin()).collect();
            check(GradientX, &azimuths, &tilts, |a, t| t.tan() * a.cos(), 1e-15 * steepest.tan());
            check(GradientY, &azimuths, &tilts, |a, t| t.tan() * a.sin(), 1e-15 * steepest.tan());
        }
    }

    #[test]
    fn angles_of_vectors_in_all_quarters() {
        let angles: Vec<f64> = (-3141..=3141).map(|i| f64::from(i) * 1e-3).collect();
        for length in [1.0, 1e-9, 1e150] {
            let y: Vec<f64> = angles.iter().map(|a| length * a.sin()).collect();
            let x: Vec<f64> = angles.iter().map(|a| length * a.cos()).collect();
            check(AngleOf, &y, &x, f64::atan2, 5e-16);
        }
        let (y, x) = ([0.0, 1.0, 0.0, -1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0, 1.0, -1.0]);
        check(AngleOf, &y, &x, f64::atan2, 0.0);
    }
}
