//! A rigid platform on rods that bend: what decides where the platform sits.
//!
//! Rod k is a cantilever of length q_k, so that its tip resists a sideways displacement with the stiffness 3EI/q_k³.
//! All rods have the same EI, so that only the ratios 1/q_k³ matter.

use jointplay::spatial::tilt_rotation;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector2, Vector3};

/// Position of O_p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// O_p in the base frame (m).
    pub origin: Vector3<f64>,
    /// Turn about the normal, beyond the shortest rotation (rad).
    pub torsion: f64,
}

/// The weighted fit within the plane of the balls: least Σ |p_k − P_k|² / q_k³.
///
/// # Arguments
/// * `sockets` – nominal sockets in the platform frame (m)
/// * `balls` – ball centres of straight rods in the base frame (m)
/// * `normal` – upward unit normal of their plane
#[must_use]
pub fn weighted_fit(
    sockets: &[Vector2<f64>; 3],
    balls: &[Vector3<f64>; 3],
    normal: &Vector3<f64>,
) -> Rest {
    let stiffness = balls.map(|ball| ball.z.powi(-3));
    let total: f64 = stiffness.iter().sum();
    let from = (0..3).fold(Vector2::zeros(), |sum, k| sum + sockets[k] * (stiffness[k] / total));
    let onto = (0..3).fold(Vector3::zeros(), |sum, k| sum + balls[k] * (stiffness[k] / total));
    let tilted = tilt_rotation(normal);
    let (mut cosine, mut sine) = (0.0, 0.0);
    for k in 0..3 {
        let target = (tilted.inverse() * (balls[k] - onto)).xy();
        let arm = sockets[k] - from;
        cosine += stiffness[k] * arm.dot(&target);
        sine += stiffness[k] * arm.perp(&target);
    }
    let torsion = sine.atan2(cosine);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), torsion);
    Rest { origin: onto - tilted * (turn * from.push(0.0)), torsion }
}

/// The equilibrium of the rods: least Σ (sideways displacement)² / q_k³, with every socket at its rod's height.
///
/// Unlike [`weighted_fit`] the rods bend sideways only, and the plane follows the bent tips.
/// Gauss–Newton on O_p's two sideways coordinates and the torsion; normal and height follow from the three heights.
///
/// # Panics
/// If the three heights fix no plane.
#[must_use]
pub fn equilibrium(sockets: &[Vector2<f64>; 3], balls: &[Vector3<f64>; 3]) -> Rest {
    let start = (balls[0] + balls[1] + balls[2]) / 3.0;
    let mut unknowns = Vector3::new(start.x, start.y, 0.0);
    let weights = balls.map(|ball| (ball.z / start.z).powf(-1.5));
    let misfit = |unknowns: &Vector3<f64>| {
        let (rotation, origin) = stand(sockets, balls, unknowns);
        DVector::from_iterator(
            6,
            (0..3).flat_map(|k| {
                let off = (origin + rotation * sockets[k].push(0.0) - balls[k]) * weights[k];
                [off.x, off.y]
            }),
        )
    };
    for _ in 0..20 {
        let now = misfit(&unknowns);
        let difference = [1e-6, 1e-6, 1e-5];
        let columns: Vec<DVector<f64>> = (0..3)
            .map(|m| {
                let mut there = (unknowns, unknowns);
                there.0[m] += difference[m];
                there.1[m] -= difference[m];
                (misfit(&there.0) - misfit(&there.1)) / (2.0 * difference[m])
            })
            .collect();
        let slope = DMatrix::from_columns(&columns);
        let gram = slope.transpose() * &slope;
        let step = gram.cholesky().expect("independent").solve(&(slope.transpose() * now));
        unknowns -= Vector3::from([step[0], step[1], step[2]]);
    }
    let (_, origin) = stand(sockets, balls, &unknowns);
    Rest { origin, torsion: unknowns[2] }
}

/// Rotation and O_p that bring each socket to the height of its rod, for O_p's sideways place and the torsion.
fn stand(
    sockets: &[Vector2<f64>; 3],
    balls: &[Vector3<f64>; 3],
    unknowns: &Vector3<f64>,
) -> (Rotation3<f64>, Vector3<f64>) {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), unknowns[2]);
    let (mut x, mut y, mut z) = (0.0_f64, 0.0_f64, balls[0].z);
    // With arms a_k = turn·p_k the heights are z − (n_x, n_y)·a_k: three linear equations.
    let rows = Matrix3::from_fn(|k, c| {
        let arm = turn * sockets[k].push(0.0);
        [1.0, -arm.x, -arm.y][c]
    });
    if let Some(found) = rows.lu().solve(&Vector3::from(balls.map(|ball| ball.z))) {
        (z, x, y) = (found[0], found[1], found[2]);
    }
    let normal = Vector3::new(x, y, (1.0 - x * x - y * y).sqrt());
    (tilt_rotation(&normal) * turn, Vector3::new(unknowns[0], unknowns[1], z))
}
