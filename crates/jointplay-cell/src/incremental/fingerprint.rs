//! Fingerprints: the inputs of a computation, bit by bit.

/// Inputs, bit by bit.
pub(crate) type Key = Vec<u64>;

/// Adds numbers to a key.
pub(crate) fn extend(key: &mut Key, numbers: &[f64]) {
    key.extend(numbers.iter().map(|number| number.to_bits()));
}
