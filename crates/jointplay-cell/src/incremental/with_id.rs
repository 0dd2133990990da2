//! Values that are distinguished by an identity instead of their contents.

use std::fmt;
use std::ops::Deref;
use std::sync::atomic::{AtomicU64, Ordering};

use super::cache_key::{CacheKey, CacheKeyPart};

/// Value with an identity that no other value of this process has or will have.
///
/// It represents in cache keys contents that are too large to copy; results do not depend on its number.
pub(crate) struct WithId<T> {
    identity: u64,
    value: T,
}

impl<T> WithId<T> {
    pub(crate) fn new(value: T) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self { identity: NEXT.fetch_add(1, Ordering::Relaxed), value }
    }

    pub(crate) fn identity(&self) -> u64 {
        self.identity
    }
}

impl<T> Deref for WithId<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: fmt::Debug> fmt::Debug for WithId<T> {
    /// The value alone: identities differ from run to run.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(formatter)
    }
}

impl<T> CacheKeyPart for WithId<T> {
    fn append_to(&self, key: &mut CacheKey) {
        key.add(&self.identity);
    }
}
