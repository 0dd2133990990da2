//! One limb at a pose, with the force of the least displacement on its socket.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::Gpr;
use crate::virtualization::{BuiltIn, VirtualJoints, unit};

/// One limb at a pose, in the frame of its virtual joints: the first moves the socket along a direction, the second across it.
///
/// ```text
///    ẋ_1 + σ_1 = r_1,    a ẋ_2 + σ_2 = r_2                σ = v + ω p⊥: motion of the platform at the socket
///    H ẋ + (μ̇_1, a μ̇_2) + g = 0                           μ: force of the least displacement on the socket
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct LimbState {
    /// Direction of the first virtual joint in the platform frame.
    pub(super) along: Vector2<f64>,
    /// a: motion of the socket across it for a unit of the second virtual joint; 0 where there is none, or no effect ((m/m), (m/rad)).
    pub(super) across: f64,
    /// xy and yy of the Hessian H of W and μ·∂²p/∂x², whose xx is 1.
    pub(super) hessian: [f64; 2],
    /// 1/a where the motion of the socket determines the second virtual joint, 1/H_yy where its own equation does.
    pub(super) inverse: f64,
    /// μ in the platform frame (m).
    pub(super) force: Vector2<f64>,
    /// σ_1 and σ_2 for a unit of v_x, v_y and ω.
    pub(super) rows: [Vector3<f64>; 2],
}

impl LimbState {
    #[inline(always)]
    pub(super) fn new(
        socket: &Vector2<f64>,
        along: Vector2<f64>,
        across: f64,
        hessian: [f64; 2],
        force: Vector2<f64>,
    ) -> Self {
        let row = |direction: Vector2<f64>| direction.push(socket.perp(&direction));
        let rows = [row(along), row(perpendicular(&along))];
        Self { along, across, hessian, inverse: 1.0, force, rows }
    }

    /// Components along the first virtual joint and across it.
    #[inline(always)]
    pub(super) fn components(&self, vector: &Vector2<f64>) -> [f64; 2] {
        [self.along.dot(vector), self.along.perp(vector)]
    }

    /// The vector with these components.
    #[inline(always)]
    pub(super) fn vector(&self, [along, across]: [f64; 2]) -> Vector2<f64> {
        self.along * along + perpendicular(&self.along) * across
    }
}

impl LimbState {
    /// Virtual joints, and the components of the force, for a motion of the socket.
    #[inline(always)]
    pub(super) fn stiff(&self, moved: [f64; 2], g: &Vector2<f64>) -> (Vector2<f64>, [f64; 2]) {
        let [xy, yy] = self.hessian;
        let rates = Vector2::new(moved[0], moved[1] * self.inverse);
        let first = -(rates.x + xy * rates.y + g.x);
        let second = -(xy * rates.x + yy * rates.y + g.y) * self.inverse;
        (rates, [first, second])
    }

    /// Virtual joints, and the force along the first, for a motion along it and a force across it.
    #[inline(always)]
    pub(super) fn guided(&self, moved: f64, lateral: f64, g: &Vector2<f64>) -> (Vector2<f64>, f64) {
        let xy = self.hessian[0];
        let second = -(g.y + xy * moved + self.across * lateral) * self.inverse;
        (Vector2::new(moved, second), -(moved + xy * second + g.x))
    }
}

/// A value for each limb; written out, since maps of arrays copy large values.
#[inline(always)]
pub(super) fn each<T>(of: impl Fn(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// A vector turned by a quarter.
#[inline(always)]
pub(super) fn perpendicular(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}

/// Adds forces along the sides to those on the sockets.
#[inline(always)]
fn add_side_forces(
    edges: &[Vector2<f64>; 3],
    sizes: &Vector3<f64>,
    forces: &mut [Vector2<f64>; 3],
) {
    for k in 0..3 {
        let force = edges[k] * sizes[k];
        forces[(k + 1) % 3] += force;
        forces[k] -= force;
    }
}

/// The limbs of a pose; `None` where the forces of the least displacement are not determined.
#[inline(always)]
pub(super) fn limbs(
    gpr: &Gpr,
    built_in: BuiltIn,
    x: &VirtualJoints,
    angular_weight: f64,
    sockets: &[Vector2<f64>; 3],
    edges: &[Vector2<f64>; 3],
) -> Option<[LimbState; 3]> {
    const EVEN: [f64; 2] = [0.0, 1.0];
    let platform = gpr.platform();
    let turning = |k: usize, along: Vector2<f64>, length: f64, force: Vector2<f64>| {
        let hessian = [along.perp(&force), angular_weight - length * along.dot(&force)];
        LimbState::new(&sockets[k], along, length, hessian, force)
    };
    Some(match built_in {
        // Three virtual joints for three sides: no force matters.
        BuiltIn::Radial => each(|k| {
            let along = platform.directions()[k];
            LimbState::new(&sockets[k], along, 0.0, EVEN, Vector2::zeros())
        }),
        BuiltIn::Planar => each(|k| {
            let force = Vector2::new(-x[k], -x[3 + k]);
            LimbState::new(&sockets[k], Vector2::x(), 1.0, EVEN, force)
        }),
        BuiltIn::Polar => each(|k| {
            let (length, turn) = (x[k], x[3 + k]);
            let inverse = 1.0 / length;
            let along = sockets[k] * inverse;
            let force = along * (platform.radii()[k] - length)
                - perpendicular(&along) * (angular_weight * turn * inverse);
            LimbState { inverse, ..turning(k, along, length, force) }
        }),
        BuiltIn::Offset => {
            // The slides balance the components of the forces along them, which determine all forces.
            let along = each(|k| {
                let (turn, along) = (unit(x[3 + k]), platform.directions()[k]);
                along * turn.x + perpendicular(&along) * turn.y
            });
            let mut balance = Matrix3::zeros();
            for k in 0..3 {
                let before = (k + 2) % 3;
                balance[(k, k)] = -along[k].dot(&edges[k]);
                balance[(k, before)] = along[k].dot(&edges[before]);
            }
            let sizes = balance.try_inverse()? * Vector3::new(-x[0], -x[1], -x[2]);
            let mut forces = [Vector2::zeros(); 3];
            add_side_forces(edges, &sizes, &mut forces);
            each(|k| {
                let limb = turning(k, along[k], x[k], forces[k]);
                LimbState { inverse: 1.0 / limb.hessian[1], ..limb }
            })
        }
    })
}
