//! A displacement of each socket in Cartesian coordinates.

use nalgebra::Vector2;

use super::{Motion, Platform, Sides, Sockets, VirtualJoint, Virtualization};

/// Sockets displaced by (u_k, v_k) in the platform plane: p_k = r_k u(β_k) + (u_k, v_k).
///
/// All unknowns are lengths, so that the metric has no say; no direction is preferred and no point is singular.
/// Least displacement places the platform by the centroids and the in-plane turn of the Procrustes fit, for any geometry in closed form.
///
/// # Source
/// Own derivation, `docs/theory.md`; the fit is [Umeyama], eq. (40), in two dimensions
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Planar;

static JOINTS: [VirtualJoint; 6] =
    VirtualJoint::pairs(("u", Motion::Linear), ("v", Motion::Linear));

impl Virtualization for Planar {
    fn name(&self) -> &str {
        "planar"
    }

    #[inline]
    fn joints(&self) -> &[VirtualJoint] {
        &JOINTS
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
        let nominal = platform.sockets();
        let [l_12, l_23, l_31] = *sides;
        let along = 0.5 * (l_12 + (l_31 - l_23) * (l_31 + l_23) / l_12);
        let across = ((l_31 - along) * (l_31 + along)).max(0.0).sqrt();
        let sense = super::signed_area(nominal).signum();
        let triangle =
            [Vector2::zeros(), Vector2::new(l_12, 0.0), Vector2::new(along, sense * across)];
        let triangle_center = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let nominal_center = (nominal[0] + nominal[1] + nominal[2]) / 3.0;
        let (mut cosine, mut sine) = (0.0, 0.0);
        for k in 0..3 {
            let from = triangle[k] - triangle_center;
            let onto = nominal[k] - nominal_center;
            cosine += from.dot(&onto);
            sine += from.perp(&onto);
        }
        let scale = 1.0 / (cosine * cosine + sine * sine).sqrt();
        let (c, s) = (cosine * scale, sine * scale);
        for k in 0..3 {
            let from = triangle[k] - triangle_center;
            let placed =
                nominal_center + Vector2::new(c * from.x - s * from.y, s * from.x + c * from.y);
            x[k] = placed.x - nominal[k].x;
            x[3 + k] = placed.y - nominal[k].y;
        }
        true
    }
}
