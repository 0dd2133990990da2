//! Fingerprints: all inputs of a computation, bit by bit.

use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

/// All inputs of a computation, bit by bit; equal fingerprints mean equal results.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Fingerprint(Vec<u64>);

/// Value that can be an input of a computation.
///
/// Implementations take a structure apart without `..`, so that the compiler reports a field that is missing.
pub(crate) trait Fingerprinted {
    /// Appends the value, in a form that no other value of the same type has.
    fn append_to(&self, fingerprint: &mut Fingerprint);
}

impl Fingerprint {
    /// Appends a value.
    pub(crate) fn add<T: Fingerprinted + ?Sized>(&mut self, value: &T) -> &mut Self {
        value.append_to(self);
        self
    }

    /// This fingerprint with a value appended.
    pub(crate) fn with<T: Fingerprinted + ?Sized>(mut self, value: &T) -> Self {
        value.append_to(&mut self);
        self
    }
}

impl Fingerprinted for Fingerprint {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.extend(&self.0);
    }
}

impl Fingerprinted for u64 {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.push(*self);
    }
}

impl Fingerprinted for u32 {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.push(u64::from(*self));
    }
}

impl Fingerprinted for usize {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.push(*self as u64);
    }
}

impl Fingerprinted for bool {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.push(u64::from(*self));
    }
}

impl Fingerprinted for f64 {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.0.push(self.to_bits());
    }
}

impl Fingerprinted for str {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.len().append_to(fingerprint);
        fingerprint.0.extend(self.bytes().map(u64::from));
    }
}

impl Fingerprinted for String {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.as_str().append_to(fingerprint);
    }
}

impl<T: Fingerprinted> Fingerprinted for [T] {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.len().append_to(fingerprint);
        self.iter().for_each(|value| value.append_to(fingerprint));
    }
}

impl<T: Fingerprinted> Fingerprinted for Vec<T> {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.as_slice().append_to(fingerprint);
    }
}

impl<T: Fingerprinted, const N: usize> Fingerprinted for [T; N] {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.iter().for_each(|value| value.append_to(fingerprint));
    }
}

impl<T: Fingerprinted> Fingerprinted for Option<T> {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.is_some().append_to(fingerprint);
        self.iter().for_each(|value| value.append_to(fingerprint));
    }
}

impl<T: Fingerprinted + ?Sized> Fingerprinted for &T {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        (**self).append_to(fingerprint);
    }
}

impl<A: Fingerprinted, B: Fingerprinted> Fingerprinted for (A, B) {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.add(&self.0).add(&self.1);
    }
}

impl Fingerprinted for Vector3<f64> {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        self.iter().for_each(|value| value.append_to(fingerprint));
    }
}

impl Fingerprinted for Pose {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { rotation, translation } = self;
        rotation.matrix().iter().for_each(|value| value.append_to(fingerprint));
        translation.vector.append_to(fingerprint);
    }
}
