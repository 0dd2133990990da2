//! States of some axes, sample by sample.

use crate::trajectory::AxisState;

/// What some axes do.
pub(crate) struct Axes<'a, const N: usize> {
    /// By sample, of those that do anything.
    pub(super) moving: [Option<&'a [AxisState]>; N],
    /// Where the others stand.
    pub(super) standing: [f64; N],
}

impl<const N: usize> Axes<'_, N> {
    /// Positions, velocities and accelerations at a sample.
    pub(crate) fn rates(&self, sample: usize) -> [[f64; N]; 3] {
        let mut rates = [self.standing, [0.0; N], [0.0; N]];
        for (place, states) in self.moving.iter().enumerate() {
            if let Some(states) = states {
                for (order, rates) in rates.iter_mut().enumerate() {
                    rates[place] = states[sample][order];
                }
            }
        }
        rates
    }
}
