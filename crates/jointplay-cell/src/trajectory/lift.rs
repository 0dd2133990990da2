//! Steps that differ by a common height of all rods have the same motion over it.

use super::segment_key::segment_key;
use crate::incremental::CacheKey;
use crate::program::Step;
use crate::robot::{HybridRobot, RODS, RodMultiples};

/// A step from a height of the rods that others may share, and that height.
///
/// A lift of all rods by the same length raises platform and arms as they are, and changes neither limits nor forces.
pub(super) struct LoweredStep {
    /// The step with the first rod at 0 at its start; the step itself where its rods are not multiples of their resolution, or the robot's kinematics depends on its height because it checks limits.
    pub(super) step: Step,
    /// Height to add to all rods (m).
    pub(super) lift: f64,
    /// Cache key of the motion over that height.
    pub(super) key: CacheKey,
}

impl LoweredStep {
    pub(super) fn new(robot: &HybridRobot, step: &Step) -> Self {
        let (mut lowered, mut lift) = (step.clone(), 0.0);
        let rods = [&step.from, &step.to].map(|positions| RodMultiples::exact(positions));
        if let [Some(from), Some(to)] = rods
            && !robot.gpr.checks_limits()
        {
            lowered.from[..RODS].copy_from_slice(&from.over(from));
            lowered.to[..RODS].copy_from_slice(&to.over(from));
            lift = step.from[0];
        }
        let key = segment_key(&lowered);
        Self { step: lowered, lift, key }
    }
}
