//! A displacement of each socket in Cartesian coordinates.

use nalgebra::Vector2;

use crate::float::sqrt;

use super::{BuiltIn, Platform, Sides, Sockets, VirtualJoint, VirtualJointKind, Virtualization};

/// Sockets displaced by (u_k, v_k) in the platform plane: p_k = r_k u(β_k) + (u_k, v_k).
///
/// All unknowns are lengths, so that the metric has no effect; no direction is preferred and no point is singular.
/// Least displacement places the platform by the centroids and the in-plane turn of the Procrustes fit, for any geometry in closed form.
///
/// # Source
/// Own derivation, `docs/explanation/kinematics.md`; the fit is \[Umeyama\], eq. (40), in two dimensions
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Planar;

static JOINTS: [VirtualJoint; 6] =
    VirtualJoint::pairs(("u", VirtualJointKind::Linear), ("v", VirtualJointKind::Linear));

impl Virtualization for Planar {
    fn name(&self) -> &str {
        "planar"
    }

    #[inline]
    fn joints(&self) -> &[VirtualJoint] {
        &JOINTS
    }

    fn as_built_in(&self) -> Option<BuiltIn> {
        Some(BuiltIn::Planar)
    }

    #[inline]
    fn nominal(&self, _platform: &Platform, x: &mut [f64]) {
        x.fill(0.0);
    }

    #[inline]
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        let [p_1, p_2, p_3] = platform.sockets();
        [
            p_1 + Vector2::new(x[0], x[3]),
            p_2 + Vector2::new(x[1], x[4]),
            p_3 + Vector2::new(x[2], x[5]),
        ]
    }

    #[inline]
    fn socket_velocities(&self, _platform: &Platform, _x: &[f64], velocities: &mut [Sockets]) {
        velocities.fill(Sockets::default());
        for k in 0..3 {
            velocities[k][k] = Vector2::x();
            velocities[3 + k][k] = Vector2::y();
        }
    }

    /// Lays out the triangle of the sides and fits it onto the nominal sockets: a centroid and one turn.
    #[inline]
    fn closed_form(&self, platform: &Platform, sides: &Sides, x: &mut [f64]) -> bool {
        const THIRD: f64 = 1.0 / 3.0;
        let nominal = platform.sockets();
        let [l_12, l_23, l_31] = *sides;
        // The first corner at the origin, the second along x; the third on the side on which the sockets run round.
        let along = 0.5 * (l_12 + (l_31 - l_23) * (l_31 + l_23) / l_12);
        let across = sqrt(((l_31 - along) * (l_31 + along)).max(0.0));
        let up = across.copysign(super::signed_area(nominal));
        let triangle_center = Vector2::new((l_12 + along) * THIRD, up * THIRD);
        let nominal_center = (nominal[0] + nominal[1] + nominal[2]) * THIRD;
        // Sums over the corners of triangle · socket and triangle × socket, sockets from their centroid; the first corner adds nothing.
        let (second, third) = (nominal[1] - nominal_center, nominal[2] - nominal_center);
        let cosine = l_12 * second.x + along * third.x + up * third.y;
        let sine = l_12 * second.y + along * third.y - up * third.x;
        let scale = 1.0 / sqrt(cosine * cosine + sine * sine);
        let (c, s) = (cosine * scale, sine * scale);
        let corners = [Vector2::zeros(), Vector2::new(l_12, 0.0), Vector2::new(along, up)];
        for k in 0..3 {
            let from = corners[k] - triangle_center;
            x[k] = nominal_center.x + (c * from.x - s * from.y) - nominal[k].x;
            x[3 + k] = nominal_center.y + (s * from.x + c * from.y) - nominal[k].y;
        }
        true
    }
}
