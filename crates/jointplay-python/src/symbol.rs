//! Symbols of virtual joints defined in Python.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Symbols with the lifetime of the process, each stored once.
static SYMBOLS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// The symbol with the lifetime of the process.
pub(crate) fn symbol(text: &str) -> &'static str {
    let mut symbols = SYMBOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = symbols.get(text) {
        return known;
    }
    let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
    symbols.insert(kept);
    kept
}
