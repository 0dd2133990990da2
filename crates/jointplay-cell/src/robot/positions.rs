//! Positions of all axes without allocation.

use std::ops::{Deref, DerefMut};

use super::hybrid_robot::MAX_AXES;

/// Positions of up to [`MAX_AXES`] axes, rods first (m or rad); dereferences to a slice.
#[derive(Clone, Copy, PartialEq)]
pub struct Positions {
    values: [f64; MAX_AXES],
    count: usize,
}

impl Positions {
    /// Copies the positions of a slice.
    ///
    /// # Panics
    /// The slice has more than [`MAX_AXES`] entries.
    #[must_use]
    pub fn new(positions: &[f64]) -> Self {
        let mut values = [0.0; MAX_AXES];
        values[..positions.len()].copy_from_slice(positions);
        Self { values, count: positions.len() }
    }
}

impl Deref for Positions {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

impl DerefMut for Positions {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.count]
    }
}

impl std::fmt::Debug for Positions {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.deref().fmt(formatter)
    }
}
