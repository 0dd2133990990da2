//! Unit quaternions of rotations, with signs that do not jump along a motion.

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// The unit quaternion w, x, y, z of a rotation, of its two signs the one nearer to another quaternion; without one, w ≥ 0.
///
/// # Arguments
/// * `near` – (w, x, y, z) the quaternion before it
#[must_use]
pub fn continued_quaternion(rotation: &Rotation3<f64>, near: Option<&[f64; 4]>) -> [f64; 4] {
    let Quaternion { coords } = *UnitQuaternion::from_rotation_matrix(rotation).quaternion();
    let found = [coords.w, coords.x, coords.y, coords.z];
    let along = near.map_or(found[0], |near| near.iter().zip(&found).map(|(a, b)| a * b).sum());
    // Not a negative zero: it would be printed.
    found.map(|value| if along < 0.0 { 0.0 - value } else { 0.0 + value })
}

/// Rate of change of a unit quaternion w, x, y, z for an angular velocity (1/s).
///
/// ```text
///    q̇  =  ½ (0, ω) ⊗ q
/// ```
/// # Arguments
/// * `angular` – ω, in the frame from which the rotation is measured (rad/s)
#[must_use]
pub fn quaternion_rate(quaternion: &[f64; 4], angular: &Vector3<f64>) -> [f64; 4] {
    let [w, x, y, z] = *quaternion;
    let Quaternion { coords } = Quaternion::from_imag(angular * 0.5) * Quaternion::new(w, x, y, z);
    [coords.w, coords.x, coords.y, coords.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_do_not_jump_over_two_turns() {
        let axis = Vector3::new(0.3, -1.2, 0.4).normalize();
        let mut before: Option<[f64; 4]> = None;
        for k in 0..=720 {
            let found = continued_quaternion(
                &Rotation3::new(axis * f64::from(k).to_radians()),
                before.as_ref(),
            );
            if let Some(before) = before {
                let step: f64 = before.iter().zip(&found).map(|(a, b)| (a - b).powi(2)).sum();
                assert!(step.sqrt() < 0.01, "{k}°: {before:?}, then {found:?}");
            }
            before = Some(found);
        }
        // Two turns are the identity; one turn has the opposite sign.
        assert!(before.is_some_and(|q| (q[0] - 1.0).abs() < 1e-12));
    }

    #[test]
    fn the_rate_is_the_derivative() {
        let vector = Vector3::new(0.4, -0.9, 1.3);
        let angular = Vector3::new(-0.7, 0.2, 0.5);
        let turned = |by: f64| {
            let rotation = Rotation3::new(angular * by) * Rotation3::new(vector);
            continued_quaternion(&rotation, None)
        };
        let rate = quaternion_rate(&turned(0.0), &angular);
        let h = 1e-5;
        for ((rate, after), before) in rate.iter().zip(turned(h)).zip(turned(-h)) {
            assert!((rate - (after - before) / (2.0 * h)).abs() < 1e-9);
        }
    }
}
