//! Angles.

/// An angle reduced by whole revolutions to the range from −π to π [rad].
pub(crate) fn wrap_angle(angle: f64) -> f64 {
    let revolutions = (angle / std::f64::consts::TAU).round();
    angle - revolutions * std::f64::consts::TAU
}
