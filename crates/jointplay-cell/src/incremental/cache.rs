//! Results of the previous and of the present generation, by their fingerprints.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::fingerprint::Fingerprint;

/// How many results of a plan were reused, and how many computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CacheStats {
    /// Results of the previous plan that were reused.
    pub hits: usize,
    /// Results that this plan needed more than once, without their first use.
    pub duplicates: usize,
    /// Results that were computed.
    pub misses: usize,
}

/// Results by their fingerprints: a generation keeps what it asks for and forgets the rest.
pub(crate) struct GenerationalCache<T> {
    /// Inputs that all results share.
    shared: Fingerprint,
    previous: BTreeMap<Fingerprint, Arc<T>>,
    current: BTreeMap<Fingerprint, Arc<T>>,
    stats: CacheStats,
}

impl<T> Default for GenerationalCache<T> {
    fn default() -> Self {
        let (previous, current) = (BTreeMap::new(), BTreeMap::new());
        Self { shared: Fingerprint::default(), previous, current, stats: CacheStats::default() }
    }
}

impl<T> GenerationalCache<T> {
    /// Begins a generation; all results are invalidated where the shared inputs have changed.
    pub(crate) fn begin(&mut self, shared: &Fingerprint) {
        // `current` still holds the results of a generation that did not end, because it was interrupted.
        self.previous.append(&mut self.current);
        self.stats = CacheStats::default();
        if self.shared != *shared {
            self.previous.clear();
            shared.clone_into(&mut self.shared);
        }
    }

    /// The result for a fingerprint, computed if it is missing; errors are not cached.
    pub(crate) fn get_or_compute<E>(
        &mut self,
        fingerprint: Fingerprint,
        compute: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(result) = self.current.get(&fingerprint) {
            self.stats.duplicates += 1;
            return Ok(Arc::clone(result));
        }
        let result = match self.previous.remove(&fingerprint) {
            Some(result) => {
                self.stats.hits += 1;
                result
            }
            None => {
                self.stats.misses += 1;
                Arc::new(compute()?)
            }
        };
        self.current.insert(fingerprint, Arc::clone(&result));
        Ok(result)
    }

    /// Whether the result for a fingerprint is there.
    pub(crate) fn contains(&self, fingerprint: &Fingerprint) -> bool {
        self.current.contains_key(fingerprint) || self.previous.contains_key(fingerprint)
    }

    /// Ends a generation: results that it did not ask for are forgotten.
    pub(crate) fn end(&mut self) {
        self.previous.clear();
    }

    /// Hits, duplicates and misses of this generation.
    pub(crate) fn stats(&self) -> CacheStats {
        self.stats
    }
}
