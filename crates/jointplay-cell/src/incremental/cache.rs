//! Results of the previous and of the present generation, by their cache keys.

use std::collections::HashMap;
use std::sync::Arc;

use super::cache_key::CacheKey;

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

/// Results by their cache keys: the end of a generation removes results that it did not use.
pub(crate) struct GenerationalCache<T> {
    /// Inputs that all results share.
    shared: CacheKey,
    previous: HashMap<CacheKey, Arc<T>>,
    current: HashMap<CacheKey, Arc<T>>,
    stats: CacheStats,
}

impl<T> Default for GenerationalCache<T> {
    fn default() -> Self {
        let (previous, current) = (HashMap::new(), HashMap::new());
        Self { shared: CacheKey::default(), previous, current, stats: CacheStats::default() }
    }
}

impl<T> GenerationalCache<T> {
    /// Begins a generation; all results are invalidated where the shared inputs have changed.
    pub(crate) fn begin(&mut self, shared: &CacheKey) {
        // `current` still holds the results of a generation that did not end, because it was interrupted.
        self.previous.extend(self.current.drain());
        self.stats = CacheStats::default();
        if self.shared != *shared {
            self.previous.clear();
            shared.clone_into(&mut self.shared);
        }
    }

    /// The result for a cache key, computed if it is missing; errors are not cached.
    pub(crate) fn get_or_compute<E>(
        &mut self,
        key: CacheKey,
        compute: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(result) = self.current.get(&key) {
            self.stats.duplicates += 1;
            return Ok(Arc::clone(result));
        }
        let result = match self.previous.remove(&key) {
            Some(result) => {
                self.stats.hits += 1;
                result
            }
            None => {
                self.stats.misses += 1;
                Arc::new(compute()?)
            }
        };
        self.current.insert(key, Arc::clone(&result));
        Ok(result)
    }

    /// Whether the result for a cache key is there.
    pub(crate) fn contains(&self, key: &CacheKey) -> bool {
        self.current.contains_key(key) || self.previous.contains_key(key)
    }

    /// Ends a generation: removes results that it did not use.
    pub(crate) fn end(&mut self) {
        self.previous.clear();
    }

    /// Hits, duplicates and misses of this generation.
    pub(crate) fn stats(&self) -> CacheStats {
        self.stats
    }
}
