//! Position and orientation of a body.

use crate::float::sqrt;
use nalgebra::{
    IsometryMatrix3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3,
};

/// A rigid transform, named by its target frame and its source frame: `base_from_platform`.
///
/// `base_from_platform * point_in_platform` is the point in the base frame (m).
pub type Pose = IsometryMatrix3<f64>;

/// The shortest rotation that carries e_b3 onto `normal`.
///
/// ```text
///    R = Rz(γ) Ry(α) Rz(−γ)      for the normal of the tilt (γ, α)
/// ```
///
/// # Arguments
/// * `normal` – unit vector in the base frame, not −e_b3
///
/// # Numerics
/// Algebraic: no angle is formed, exact to round-off for every tilt below π.
#[must_use]
#[inline(always)]
pub fn tilt_rotation(normal: &Vector3<f64>) -> Rotation3<f64> {
    let (x, y, z) = (normal.x, normal.y, normal.z);
    let k = 1.0 / (1.0 + z);
    let xy = -x * y * k;
    Rotation3::from_matrix_unchecked(Matrix3::new(
        1.0 - x * x * k,
        xy,
        x,
        xy,
        1.0 - y * y * k,
        y,
        -x,
        -y,
        z,
    ))
}

/// Cosines of turns below this are of nearly half a turn, whose axis the antisymmetric part does not show.
pub(crate) const NEARLY_HALF: f64 = -0.9;

/// Axis times angle of a rotation, the angle from 0 to π (rad).
///
/// # Numerics
/// Exact to round-off everywhere: by the antisymmetric part, and near half turns, where that vanishes, by the quaternion.
/// From the cosine of the angle it would be off by 10⁻⁸ for small turns, and not a number where round-off puts the cosine above one.
#[must_use]
pub fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let m = rotation.matrix();
    let cosine = (m.m11 + m.m22 + m.m33 - 1.0) * 0.5;
    let vector = Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * 0.5;
    let sine = sqrt(vector.norm_squared());
    if cosine < NEARLY_HALF {
        UnitQuaternion::from_rotation_matrix(rotation).scaled_axis()
    } else if sine == 0.0 {
        vector
    } else {
        vector * (libm::atan2(sine, cosine) / sine)
    }
}

/// The pose that carries three points of a platform's own plane onto three points of space, fitted within the plane.
///
/// The platform plane is laid on the plane of `targets`, the centroids on each other, and the platform turned within the plane to the least sum of squared distances.
/// Where both triangles have the same sides, every point falls on its target.
///
/// # Arguments
/// * `points_in_platform` – three points in the plane z = 0 of the platform frame (m)
/// * `targets_in_base` – three points in the base frame, run round in the same sense seen from above (m)
/// * `normal` – unit normal of the plane of the targets, upward, in the base frame
///
/// # Numerics
/// The in-plane turn is the two-dimensional Procrustes fit in closed form: two sums and one root.
///
/// # Source
/// \[Umeyama\], eq. (40), in two dimensions.
#[must_use]
// Always, like `tilt_rotation`: a quarter of the time of a closed-form pose.
#[inline(always)]
pub fn fit_in_plane(
    points_in_platform: &[Vector2<f64>; 3],
    targets_in_base: &[Vector3<f64>; 3],
    normal: &Vector3<f64>,
) -> Pose {
    const THIRD: f64 = 1.0 / 3.0;
    let from_center =
        (points_in_platform[0] + points_in_platform[1] + points_in_platform[2]) * THIRD;
    let onto_center = (targets_in_base[0] + targets_in_base[1] + targets_in_base[2]) * THIRD;
    let tilted = tilt_rotation(normal);
    let (e_1, e_2) = (tilted.matrix().column(0), tilted.matrix().column(1));
    let (mut cosine, mut sine) = (0.0, 0.0);
    for k in 0..3 {
        let from = points_in_platform[k] - from_center;
        let target = targets_in_base[k] - onto_center;
        let onto = Vector2::new(e_1.dot(&target), e_2.dot(&target));
        cosine += from.dot(&onto);
        sine += from.perp(&onto);
    }
    let scale = 1.0 / sqrt(cosine * cosine + sine * sine);
    let (c, s) = (cosine * scale, sine * scale);
    let turned_1 = e_1 * c + e_2 * s;
    let turned_2 = e_2 * c - e_1 * s;
    let rotation = Matrix3::from_columns(&[turned_1, turned_2, *normal]);
    let origin = onto_center - turned_1 * from_center.x - turned_2 * from_center.y;
    Pose::from_parts(Translation3::from(origin), Rotation3::from_matrix_unchecked(rotation))
}

/// Heading about the vertical of a frame before its tilt (rad): its rotation about its normal, beyond the [`tilt_rotation`] to the normal.
#[must_use]
pub fn heading(frame: &Pose) -> f64 {
    let normal = frame.rotation * Vector3::z();
    let along = tilt_rotation(&normal).inverse() * (frame.rotation * Vector3::x());
    libm::atan2(along.y, along.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Tilt;

    const DIRECTIONS: [(f64, f64); 6] =
        [(0.0, 0.0), (0.4, 0.02), (-2.0, 1e-9), (3.0, 0.5), (1.0, 1.5), (2.0, 3.0)];

    #[test]
    fn heading_of_a_tilted_frame_is_that_before_the_tilt() {
        for (azimuth, angle) in DIRECTIONS {
            for heading_before in [-3.0, -0.5, 0.0, 1.7, 3.1] {
                let about = Rotation3::from_axis_angle(&Vector3::z_axis(), heading_before);
                let rotation = tilt_rotation(&Tilt { azimuth, angle }.normal()) * about;
                let found = heading(&Pose::from_parts(Translation3::identity(), rotation));
                assert!((found - heading_before).abs() < 1e-13, "{azimuth} {angle} {found}");
            }
        }
    }

    #[test]
    fn tilt_rotation_is_the_shortest_rotation_to_the_normal() {
        for (azimuth, tilt_angle) in DIRECTIONS {
            let normal = Tilt { azimuth, angle: tilt_angle }.normal();
            let found = tilt_rotation(&normal);
            let about_z = |angle| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            let about_y = Rotation3::from_axis_angle(&Vector3::y_axis(), tilt_angle);
            let expected = about_z(azimuth) * about_y * about_z(-azimuth);
            assert!((found.matrix() - expected.matrix()).amax() < 1e-13, "{azimuth} {tilt_angle}");
            assert!((found * Vector3::z() - normal).norm() < 1e-15);
            assert!((found.angle() - tilt_angle).abs() < 1e-7, "no turn beyond the tilt");
        }
    }

    #[test]
    fn equal_triangles_fall_on_each_other() {
        for points in [
            [Vector2::new(1.0, 0.0), Vector2::new(-0.5, 0.9), Vector2::new(-0.4, -0.8)],
            [Vector2::new(0.1, 0.2), Vector2::new(0.3, -5.0), Vector2::new(0.2, 0.4)],
        ] {
            for (azimuth, tilt_angle) in DIRECTIONS {
                let normal = Tilt { azimuth, angle: tilt_angle }.normal();
                let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 7.0 * azimuth + 2.0);
                let placed = Pose::from_parts(
                    Translation3::new(4.0, -5.0, 6.0),
                    tilt_rotation(&normal) * turn,
                );
                let targets = points
                    .map(|point| placed.rotation * point.push(0.0) + placed.translation.vector);
                let found = fit_in_plane(&points, &targets, &normal);
                let off = found.to_homogeneous() - placed.to_homogeneous();
                assert!(off.amax() < 1e-13, "{azimuth} {tilt_angle} {off}");
            }
        }
    }

    #[test]
    fn unequal_triangles_are_fitted_by_least_squares() {
        let points = [Vector2::new(1.0, 0.0), Vector2::new(-0.5, 0.9), Vector2::new(-0.4, -0.8)];
        let targets = [
            Vector3::new(0.1, 1.2, 2.0),
            Vector3::new(-0.9, -0.5, 2.0),
            Vector3::new(0.8, -0.3, 2.0),
        ];
        let found = fit_in_plane(&points, &targets, &Vector3::z());
        let error = |turn: f64, x: f64, y: f64| -> f64 {
            let moved = Pose::from_parts(
                Translation3::new(x, y, 0.0) * found.translation,
                Rotation3::from_axis_angle(&Vector3::z_axis(), turn) * found.rotation,
            );
            points
                .iter()
                .zip(&targets)
                .map(|(p, t)| {
                    (moved.rotation * p.push(0.0) + moved.translation.vector - t).norm_squared()
                })
                .sum()
        };
        let least = error(0.0, 0.0, 0.0);
        for (turn, x, y) in
            [(1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4), (1e-4, 2e-4, -1e-4)]
        {
            assert!(error(turn, x, y) > least && error(-turn, -x, -y) > least);
        }
        assert_eq!(found.translation.z, 2.0);
    }

    #[test]
    fn rotation_vectors_of_small_and_half_turns() {
        let half = std::f64::consts::PI;
        for vector in [
            Vector3::zeros(),
            Vector3::new(1e-9, -2e-9, 3e-9),
            Vector3::new(1e-4, 0.0, 0.0),
            Vector3::new(1.0, 2.0, -1.0),
            // On both sides of the change of method, at 2.69 rad.
            Vector3::new(2.6, 0.3, 0.55),
            Vector3::new(2.6, 0.3, 0.65),
            Vector3::new(0.0, half - 1e-9, 0.0),
            Vector3::new(0.0, 0.0, half),
        ] {
            let found = rotation_vector(&Rotation3::new(vector));
            // A half turn is one about either sense of its axis.
            let off = (found - vector).norm().min(if vector.norm() == half {
                (found + vector).norm()
            } else {
                f64::INFINITY
            });
            assert!(off < 1e-14, "{vector} {found}");
        }
        // A product of turns and their inverses, whose trace round-off puts above three.
        let mut noisy = Matrix3::identity();
        noisy[(0, 0)] += 4.0 * f64::EPSILON;
        let found = rotation_vector(&Rotation3::from_matrix_unchecked(noisy));
        assert!(found.norm() < 1e-14, "{found}");
    }
}
