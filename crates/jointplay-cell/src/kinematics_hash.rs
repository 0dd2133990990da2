//! Hash of the inputs of all poses of a cell.

use crate::incremental::CacheKey;
use crate::workcell::Cell;

impl Cell {
    /// Hash of robot, wafers and gravity, on which the poses of all bodies along a motion depend.
    ///
    /// It distinguishes all bits of all numbers; versions of this program and of its compiler may have different hashes.
    #[must_use]
    pub fn kinematics_hash(&self) -> u64 {
        let mut inputs = CacheKey::default();
        inputs.add(&self.robot).add(&self.wafer).add(&self.gravity);
        inputs.finish()
    }
}
