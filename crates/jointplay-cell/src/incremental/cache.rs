//! Results of the last round and of the present one, by their fingerprints.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::fingerprint::Key;

/// How much of the last plan was made anew, and how much was known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CacheStats {
    /// Known from the plan before.
    pub hits: usize,
    /// The same as an earlier one of this plan.
    pub duplicates: usize,
    /// Made anew.
    pub misses: usize,
}

/// Results by their inputs: those of the last round, and those of this one.
pub(crate) struct Kept<T> {
    /// Inputs that all results share.
    shared: String,
    last: BTreeMap<Key, Arc<T>>,
    now: BTreeMap<Key, Arc<T>>,
    reuse: CacheStats,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        let (last, now) = (BTreeMap::new(), BTreeMap::new());
        Self { shared: String::new(), last, now, reuse: CacheStats::default() }
    }
}

impl<T> Kept<T> {
    /// A round begins; nothing is known where the shared inputs are others.
    pub(crate) fn begin(&mut self, shared: &str) {
        // What is left of the round before last is of a round that was interrupted.
        self.last.append(&mut self.now);
        self.reuse = CacheStats::default();
        if self.shared != shared {
            self.last.clear();
            shared.clone_into(&mut self.shared);
        }
    }

    /// The result for a key, made where it is not known.
    pub(crate) fn get<E>(
        &mut self,
        key: Key,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(known) = self.now.get(&key) {
            self.reuse.duplicates += 1;
            return Ok(Arc::clone(known));
        }
        let found = match self.last.remove(&key) {
            Some(known) => {
                self.reuse.hits += 1;
                known
            }
            None => {
                self.reuse.misses += 1;
                Arc::new(make()?)
            }
        };
        self.now.insert(key, Arc::clone(&found));
        Ok(found)
    }

    /// Whether [`Self::get`] would not have to make it.
    pub(crate) fn knows(&self, key: &Key) -> bool {
        self.now.contains_key(key) || self.last.contains_key(key)
    }

    /// A round ends: what it did not ask for is forgotten.
    pub(crate) fn end(&mut self) {
        self.last.clear();
    }

    pub(crate) fn reuse(&self) -> CacheStats {
        self.reuse
    }
}
