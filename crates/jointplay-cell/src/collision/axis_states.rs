//! States of some axes, sample by sample.

use crate::trajectory::StateColumns;

/// States of some axes at the samples of a window.
pub(crate) struct AxisStates<'a, const N: usize> {
    /// States by sample, of axes that move.
    pub(super) moving: [Option<&'a StateColumns>; N],
    /// Positions of the axes that do not move (m or rad).
    pub(super) fixed: [f64; N],
}

impl<const N: usize> AxisStates<'_, N> {
    /// Positions, velocities and accelerations at a sample.
    pub(crate) fn at(&self, sample: usize) -> [[f64; N]; 3] {
        let mut states = [self.fixed, [0.0; N], [0.0; N]];
        for (index, moving) in self.moving.iter().enumerate() {
            if let Some(moving) = moving {
                for (values, column) in states.iter_mut().zip(moving.columns()) {
                    values[index] = column[sample];
                }
            }
        }
        states
    }
}
