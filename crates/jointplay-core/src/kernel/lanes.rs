//! As many poses side by side as the machine's registers hold.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use pulp::{Scalar, Simd};

/// One number of each pose in a block, in one register: eight with AVX-512, four with AVX2, two with NEON, else one.
///
/// One, since the numbers of two blocks exceed the registers; while one block waits for a step, the processor begins the next one by itself.
/// Arithmetic is lane by lane, so that poses are independent of each other.
/// In memory they begin where a line of the cache begins: a register that lies across two lines takes both.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// A Boolean for each pose in a block.
#[derive(Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

/// The most lanes that any machine has.
pub(crate) const MOST: usize = 8;

// Everything here is inlined, always: what is not would be compiled without the machine's wide instructions.
impl<S: Simd> Lanes<S> {
    /// Poses in a block.
    pub(crate) const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// The same number as another, of the same machine.
    #[inline(always)]
    pub(crate) fn like(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The first numbers of a slice, of which there are as many as lanes.
    #[inline(always)]
    pub(crate) fn of(simd: S, numbers: &[f64]) -> Self {
        let (whole, _) = S::as_simd_f64s(numbers);
        Self { simd, value: whole[0] }
    }

    /// The first numbers of a slice; zero in lanes beyond its end.
    #[inline(always)]
    pub(crate) fn up_to_all(simd: S, numbers: &[f64]) -> Self {
        Self { simd, value: simd.partial_load_f64s(numbers) }
    }

    /// Writes the lanes to a column from `first` on, up to its end.
    #[inline(always)]
    pub(crate) fn store(&self, column: &mut [f64], first: usize) {
        if first + Self::COUNT <= column.len() {
            let (whole, _) = S::as_mut_simd_f64s(&mut column[first..first + Self::COUNT]);
            whole[0] = self.value;
        } else {
            self.simd.partial_store_f64s(&mut column[first..], self.value);
        }
    }

    #[inline(always)]
    pub(crate) fn from_register(simd: S, value: S::f64s) -> Self {
        Self { simd, value }
    }

    /// The register.
    #[inline(always)]
    pub(crate) fn register(self) -> S::f64s {
        self.value
    }

    /// The numbers of all lanes; those that the machine does not have are zero.
    #[inline(always)]
    pub(crate) fn numbers(self) -> [f64; MOST] {
        let mut numbers = [0.0; MOST];
        let (whole, _) = S::as_mut_simd_f64s(&mut numbers[..Self::COUNT]);
        whole[0] = self.value;
        numbers
    }

    /// A scalar function of each lane, for rare cases.
    #[inline(always)]
    pub(crate) fn each(self, function: impl Fn(f64) -> f64) -> Self {
        let mut numbers = self.numbers();
        for number in &mut numbers[..Self::COUNT] {
            *number = function(*number);
        }
        Self::of(self.simd, &numbers[..Self::COUNT])
    }

    /// Calls a function that is compiled for the same instructions, but not into its caller: for rare cases, whose numbers would take registers from the others.
    ///
    /// What it calls has to be inlined, always.
    #[inline(always)]
    pub(crate) fn outlined<T>(self, function: impl FnOnce() -> T) -> T {
        self.simd.vectorize(function)
    }

    /// `self · factor + addend`, rounded once on every processor: in software where it has no fused multiply-add.
    #[inline(always)]
    pub(crate) fn times_plus(self, factor: Self, addend: Self) -> Self {
        Self { value: self.simd.mul_add_f64s(self.value, factor.value, addend.value), ..self }
    }

    /// `minuend − self · factor`, rounded once.
    #[inline(always)]
    pub(crate) fn times_from(self, factor: Self, minuend: Self) -> Self {
        (-self).times_plus(factor, minuend)
    }

    #[inline(always)]
    pub(crate) fn squared(self) -> Self {
        self * self
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { value: self.simd.sqrt_f64s(self.value), ..self }
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { value: self.simd.abs_f64s(self.value), ..self }
    }

    /// One over it.
    #[inline(always)]
    pub(crate) fn inverse(self) -> Self {
        self.like(1.0) / self
    }

    /// The larger of two; either where one is not a number.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { value: self.simd.max_f64s(self.value, other.value), ..self }
    }

    /// The smaller of two; either where one is not a number.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { value: self.simd.min_f64s(self.value, other.value), ..self }
    }

    /// Where `self ≤ other`; false where either is not a number.
    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> Mask<S> {
        let simd = self.simd;
        Mask { simd, value: simd.less_than_or_equal_f64s(self.value, other.value) }
    }

    /// Where `self < other`; false where either is not a number.
    #[inline(always)]
    pub(crate) fn below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, value: self.simd.less_than_f64s(self.value, other.value) }
    }

    /// Where this bit of the number's representation is set.
    #[inline(always)]
    pub(crate) fn bit(self, bit: u64) -> Mask<S> {
        let (simd, bit) = (self.simd, self.simd.splat_u64s(bit));
        let bits = simd.and_u64s(simd.transmute_u64s_f64s(self.value), bit);
        Mask { simd, value: simd.equal_u64s(bits, bit) }
    }
}

impl Lanes<Scalar> {
    /// The number of a machine with one lane.
    #[inline(always)]
    pub(crate) fn number(self) -> f64 {
        self.value
    }
}

impl<S: Simd> Mask<S> {
    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        let simd = self.simd;
        Lanes { simd, value: simd.select_f64s(self.value, yes.value, no.value) }
    }

    /// Whether all lanes are true.
    #[inline(always)]
    pub(crate) fn all(self) -> bool {
        !(!self).any()
    }

    /// Whether any lane is true.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.simd.first_true_m64s(self.value) < S::F64_LANES
    }

    /// The value of each lane; false for lanes that the machine does not have.
    #[inline(always)]
    pub(crate) fn answers(self) -> [bool; MOST] {
        let (one, zero) = (Lanes::splat(self.simd, 1.0), Lanes::splat(self.simd, 0.0));
        let numbers = self.select(one, zero).numbers();
        let mut answers = [false; MOST];
        for (answer, number) in answers.iter_mut().zip(numbers) {
            *answer = number == 1.0;
        }
        answers
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident :: $method:ident = $of_simd:ident),*) => {$(
        impl<S: Simd> $operator for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { value: self.simd.$of_simd(self.value, other.value), ..self }
            }
        }

        impl<S: Simd> $operator<f64> for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.like(other))
            }
        }
    )*};
}

lane_by_lane!(Add::add = add_f64s, Sub::sub = sub_f64s, Mul::mul = mul_f64s, Div::div = div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: self.simd.neg_f64s(self.value), ..self }
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { value: self.simd.and_m64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { value: self.simd.or_m64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { value: self.simd.not_m64s(self.value), ..self }
    }
}
