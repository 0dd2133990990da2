//! Values that are distinguished by an identity instead of their contents.

use std::fmt;
use std::ops::Deref;
use std::sync::atomic::{AtomicU64, Ordering};

use super::fingerprint::{Fingerprint, Fingerprinted};

/// Value with an identity that no other value of this process has or will have.
///
/// It represents in fingerprints contents that are too large to copy; results do not depend on its number.
pub(crate) struct Unique<T> {
    identity: u64,
    value: T,
}

impl<T> Unique<T> {
    pub(crate) fn new(value: T) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self { identity: NEXT.fetch_add(1, Ordering::Relaxed), value }
    }

    pub(crate) fn identity(&self) -> u64 {
        self.identity
    }
}

impl<T> Deref for Unique<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: fmt::Debug> fmt::Debug for Unique<T> {
    /// The value alone: identities differ from run to run.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(formatter)
    }
}

impl<T> Fingerprinted for Unique<T> {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.add(&self.identity);
    }
}
