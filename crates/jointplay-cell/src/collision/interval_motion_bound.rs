//! Bound of the relative motion of two collision objects in an interval of time.

/// Bound of the relative motion of a pair in an interval.
#[derive(Clone, Copy)]
pub(super) struct IntervalMotionBound {
    /// Travel in any direction (m).
    pub(super) total: f64,
    /// Travel along the platform's normal (m).
    pub(super) along_normal: f64,
    /// Travel by the rods alone (m).
    pub(super) platform: f64,
    /// Travel by changes of the arms' deflection alone (m).
    pub(super) deflection: f64,
    /// Horizontal part of `deflection` (m).
    pub(super) lateral_deflection: f64,
    /// Rotation of the platform's normal (rad).
    pub(super) normal_rotation: f64,
    /// Deviation of the arms' part of the motion from the chord (m).
    pub(super) chord_deviation: f64,
}

impl IntervalMotionBound {
    /// Bound for either half of the interval: travel is bounded by the largest speed over the whole time, and so is additive over halves.
    pub(super) fn half(self) -> Self {
        let Self {
            total,
            along_normal,
            platform,
            deflection,
            lateral_deflection,
            normal_rotation,
            chord_deviation,
        } = self;
        Self {
            total: 0.5 * total,
            along_normal: 0.5 * along_normal,
            platform: 0.5 * platform,
            deflection: 0.5 * deflection,
            lateral_deflection: 0.5 * lateral_deflection,
            normal_rotation: 0.5 * normal_rotation,
            // Not additive: the bound of the whole interval is one for each half.
            chord_deviation,
        }
    }
}
