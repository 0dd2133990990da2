//! Cache keys: all inputs of a computation, bit by bit.

use std::hash::{DefaultHasher, Hash, Hasher};

use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

/// All inputs of a computation, bit by bit; equal cache keys mean equal results.
#[derive(Debug, Clone, Default)]
pub(crate) struct CacheKey {
    words: Vec<u64>,
    /// Has all words: keys are long, and each is looked up several times.
    hasher: DefaultHasher,
}

impl PartialEq for CacheKey {
    fn eq(&self, other: &Self) -> bool {
        self.words == other.words
    }
}

impl Eq for CacheKey {}

impl Hash for CacheKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.finish());
    }
}

/// Value that can be an input of a computation.
///
/// Implementations take a structure apart without `..`, so that the compiler reports a field that is missing.
pub(crate) trait CacheKeyPart {
    /// Appends the value, in a form that no other value of the same type has.
    fn append_to(&self, key: &mut CacheKey);
}

impl CacheKey {
    /// Hash of all inputs.
    pub(crate) fn finish(&self) -> u64 {
        self.hasher.finish()
    }

    fn push(&mut self, word: u64) {
        self.words.push(word);
        self.hasher.write_u64(word);
    }

    /// Appends a value.
    pub(crate) fn add<T: CacheKeyPart + ?Sized>(&mut self, value: &T) -> &mut Self {
        value.append_to(self);
        self
    }

    /// This cache key with a value appended.
    pub(crate) fn with<T: CacheKeyPart + ?Sized>(mut self, value: &T) -> Self {
        value.append_to(&mut self);
        self
    }
}

impl CacheKeyPart for CacheKey {
    fn append_to(&self, key: &mut CacheKey) {
        self.words.iter().for_each(|&word| key.push(word));
    }
}

impl CacheKeyPart for u64 {
    fn append_to(&self, key: &mut CacheKey) {
        key.push(*self);
    }
}

impl CacheKeyPart for u32 {
    fn append_to(&self, key: &mut CacheKey) {
        key.push(u64::from(*self));
    }
}

impl CacheKeyPart for usize {
    fn append_to(&self, key: &mut CacheKey) {
        key.push(*self as u64);
    }
}

impl CacheKeyPart for bool {
    fn append_to(&self, key: &mut CacheKey) {
        key.push(u64::from(*self));
    }
}

impl CacheKeyPart for f64 {
    fn append_to(&self, key: &mut CacheKey) {
        key.push(self.to_bits());
    }
}

impl CacheKeyPart for str {
    fn append_to(&self, key: &mut CacheKey) {
        self.len().append_to(key);
        self.bytes().for_each(|byte| key.push(u64::from(byte)));
    }
}

impl CacheKeyPart for String {
    fn append_to(&self, key: &mut CacheKey) {
        self.as_str().append_to(key);
    }
}

impl<T: CacheKeyPart> CacheKeyPart for [T] {
    fn append_to(&self, key: &mut CacheKey) {
        self.len().append_to(key);
        self.iter().for_each(|value| value.append_to(key));
    }
}

impl<T: CacheKeyPart> CacheKeyPart for Vec<T> {
    fn append_to(&self, key: &mut CacheKey) {
        self.as_slice().append_to(key);
    }
}

impl<T: CacheKeyPart, const N: usize> CacheKeyPart for [T; N] {
    fn append_to(&self, key: &mut CacheKey) {
        self.iter().for_each(|value| value.append_to(key));
    }
}

impl<T: CacheKeyPart> CacheKeyPart for Option<T> {
    fn append_to(&self, key: &mut CacheKey) {
        self.is_some().append_to(key);
        self.iter().for_each(|value| value.append_to(key));
    }
}

impl<T: CacheKeyPart + ?Sized> CacheKeyPart for &T {
    fn append_to(&self, key: &mut CacheKey) {
        (**self).append_to(key);
    }
}

impl<A: CacheKeyPart, B: CacheKeyPart> CacheKeyPart for (A, B) {
    fn append_to(&self, key: &mut CacheKey) {
        key.add(&self.0).add(&self.1);
    }
}

impl CacheKeyPart for Vector3<f64> {
    fn append_to(&self, key: &mut CacheKey) {
        self.iter().for_each(|value| value.append_to(key));
    }
}

impl CacheKeyPart for Pose {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { rotation, translation } = self;
        rotation.matrix().iter().for_each(|value| value.append_to(key));
        translation.vector.append_to(key);
    }
}
