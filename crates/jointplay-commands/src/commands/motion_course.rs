//! The path of a motion of driven joints.

use jointplay::mechanism::DrivePath;
use jointplay::report::MotionParameter;

/// Default number of steps of a path.
pub(super) const STEPS: usize = jointplay::mechanism::DEFAULT_STEPS;

/// The path of a motion.
pub(super) struct Course {
    pub(super) path: DrivePath,
    pub(super) steps: usize,
    /// Parameter of a curve, at the points of the path.
    pub(super) parameter: Option<MotionParameter>,
}
