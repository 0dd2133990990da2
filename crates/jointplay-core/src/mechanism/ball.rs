//! The rotation of a ball, and how its three coordinates change.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::spatial::rotation_vector;

/// Angle from which the coefficients of [`BallChange::body_rate`] are computed by sines and cosines, and below which by their series (rad).
const SMALL: f64 = 0.5;

/// How displacements of the three coordinates of a ball, its rotation vector, change its rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BallChange {
    /// The ball turns on in its own frame, by [`cayley`] of the displacement: no direction is distinguished, and all three coordinates change.
    Turned,
    /// Displacements are added to the rotation vector: coordinates that are commanded have their values, whatever the others do.
    Added,
}

impl BallChange {
    /// Rotation of a displaced ball.
    pub(super) fn rotation(self, home: &Vector3<f64>, by: &Vector3<f64>) -> Rotation3<f64> {
        match self {
            Self::Turned => Rotation3::new(*home) * cayley(by),
            Self::Added => Rotation3::new(home + by),
        }
    }

    /// Coordinates of a displaced ball.
    pub(super) fn displaced(self, home: &Vector3<f64>, by: &Vector3<f64>) -> Vector3<f64> {
        match self {
            // Without round-off for a ball at rest.
            Self::Turned if *by == Vector3::zeros() => *home,
            Self::Turned => rotation_vector(&self.rotation(home, by)),
            Self::Added => home + by,
        }
    }

    /// Difference of two configurations: the rotation vector from the first to the second in the turned frame, or the difference of the coordinates.
    pub(super) fn difference(self, from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Turned => {
                rotation_vector(&(Rotation3::new(*from).inverse() * Rotation3::new(*to)))
            }
            Self::Added => to - from,
        }
    }

    /// Angular velocity in the turned frame, for a rate of the displacement.
    pub(super) fn body_rate(
        self,
        home: &Vector3<f64>,
        by: &Vector3<f64>,
        rate: &Vector3<f64>,
    ) -> Vector3<f64> {
        match self {
            Self::Turned => cayley_rate(by, rate),
            Self::Added => {
                let vector = home + by;
                let [a, b, ..] = coefficients(vector.norm());
                let once = vector.cross(rate);
                rate - once * a + vector.cross(&once) * b
            }
        }
    }

    /// Rate of change of [`Self::body_rate`] at a constant rate of the displacement.
    pub(super) fn body_acceleration(
        self,
        home: &Vector3<f64>,
        by: &Vector3<f64>,
        rate: &Vector3<f64>,
    ) -> Vector3<f64> {
        match self {
            Self::Turned => {
                let factor = -0.5 * by.dot(rate) / (1.0 + 0.25 * by.norm_squared());
                cayley_rate(by, rate) * factor
            }
            Self::Added => {
                let vector = home + by;
                let [_, b, a_rate, b_rate] = coefficients(vector.norm());
                let (once, along) = (vector.cross(rate), vector.dot(rate));
                vector.cross(&once) * (b_rate * along) - once * (a_rate * along)
                    + rate.cross(&once) * b
            }
        }
    }
}

/// The rotation with the quaternion (1, p/2), normalised: its angle is |p| up to third order, and it needs no trigonometry.
pub(super) fn cayley(p: &Vector3<f64>) -> Rotation3<f64> {
    let u = p * 0.5;
    let cross = u.cross_matrix();
    let scale = 2.0 / (1.0 + u.norm_squared());
    Rotation3::from_matrix_unchecked(Matrix3::identity() + (cross + cross * cross) * scale)
}

/// Angular velocity of [`cayley`] in the turned frame.
fn cayley_rate(p: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    (rate - p.cross(rate) * 0.5) / (1.0 + 0.25 * p.norm_squared())
}

/// Derivative of a rotation vector by the angular velocity in the base frame.
pub(super) fn rotation_vector_rate(vector: &Vector3<f64>) -> Matrix3<f64> {
    let angle = vector.norm();
    let cross = vector.cross_matrix();
    // (1 − (θ/2) cot(θ/2)) / θ², by its series for small angles.
    let factor = if angle < 1e-3 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * factor
}

/// Coefficients of the angular velocity of a rotation vector, and their derivatives over the angle:
///
/// ```text
///    a = (1 − cos θ) / θ²      b = (θ − sin θ) / θ³      a′ / θ      b′ / θ
/// ```
fn coefficients(angle: f64) -> [f64; 4] {
    let square = angle * angle;
    if angle >= SMALL {
        let (sin, cos) = angle.sin_cos();
        let (a, b) = ((1.0 - cos) / square, (angle - sin) / (square * angle));
        return [a, b, (sin / angle - 2.0 * a) / square, (a - 3.0 * b) / square];
    }
    // a = Σ (−θ²)ᵏ / (2k + 2)!, and b = Σ (−θ²)ᵏ / (2k + 3)!
    let mut sums = [0.0; 4];
    let (mut power, mut before, mut factorial) = (1.0, 0.0, 2.0);
    for k in 0..10_u32 {
        let order = f64::from(2 * k);
        let next = factorial * (order + 3.0);
        sums[0] += power / factorial;
        sums[1] += power / next;
        sums[2] += order * before / factorial;
        sums[3] += order * before / next;
        // (−1)ᵏ θ²ᵏ⁻² of the next k.
        before = -power;
        power *= -square;
        factorial = next * (order + 4.0);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(largest: f64) -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-largest..largest).prop_map(Vector3::from)
    }

    proptest! {
        /// Rates against central differences of rotations.
        #[test]
        fn rates_are_derivatives_of_rotations(
            home in vector(3.0), small in vector(0.2), by in vector(0.8), rate in vector(1.0),
        ) {
            for (home, change) in [home, small, Vector3::zeros()]
                .into_iter()
                .flat_map(|home| [BallChange::Turned, BallChange::Added].map(|it| (home, it)))
            {
                let step = 1e-5;
                let [before, here, after] =
                    [-step, 0.0, step].map(|s| change.rotation(&home, &(by + rate * s)));
                let derivative = (after.matrix() - before.matrix()) / (2.0 * step);
                let body = here.matrix().transpose() * derivative;
                let found = change.body_rate(&home, &by, &rate);
                prop_assert!((body - found.cross_matrix()).norm() < 1e-8, "{change:?} {home}");

                let [before, after] =
                    [-step, step].map(|s| change.body_rate(&home, &(by + rate * s), &rate));
                let found = change.body_acceleration(&home, &by, &rate);
                let expected = (after - before) / (2.0 * step);
                prop_assert!((found - expected).norm() < 1e-8, "{change:?} {found} {expected}");
            }
        }

        #[test]
        fn coordinates_of_a_displaced_ball_have_its_rotation(home in vector(3.0), by in vector(0.8)) {
            for change in [BallChange::Turned, BallChange::Added] {
                let rotation = change.rotation(&home, &by);
                let displaced = change.displaced(&home, &by);
                let turned = (Rotation3::new(displaced).matrix() - rotation.matrix()).norm();
                prop_assert!(turned < 1e-13, "{change:?} {turned}");
            }
            prop_assert_eq!(BallChange::Turned.displaced(&home, &Vector3::zeros()), home);
            let difference = BallChange::Added.difference(&home, &(home + by));
            prop_assert!((difference - by).norm() < 1e-14);
        }
    }

    #[test]
    fn the_series_continues_the_closed_forms() {
        let (below, above) = (SMALL * (1.0 - 1e-15), SMALL);
        for (series, closed) in coefficients(below).into_iter().zip(coefficients(above)) {
            assert!((series / closed - 1.0).abs() < 1e-13, "{series} {closed}");
        }
        assert_eq!(coefficients(0.0), [0.5, 1.0 / 6.0, -1.0 / 12.0, -1.0 / 60.0]);
    }
}
