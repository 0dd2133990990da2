//! A radial slide and a turn about O_p at each socket.

use nalgebra::Vector2;

use super::platform::unit;
use super::{BuiltIn, Platform, Sockets, VirtualJoint, VirtualJointKind, Virtualization};

/// Sockets in polar coordinates about O_p: p_k = l_k u(β_k + φ_k).
///
/// Six unknowns for three sides: the metric decides.
///
/// # Source
/// \[Virtualization\], V.A, with the signs of ∂F_31/∂φ put right (`docs/explanation/errata.md`)
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Polar;

static JOINTS: [VirtualJoint; 6] =
    VirtualJoint::pairs(("l", VirtualJointKind::Linear), ("phi", VirtualJointKind::Angular));

impl Virtualization for Polar {
    fn name(&self) -> &str {
        "polar"
    }

    #[inline]
    fn joints(&self) -> &[VirtualJoint] {
        &JOINTS
    }

    fn as_built_in(&self) -> Option<BuiltIn> {
        Some(BuiltIn::Polar)
    }

    #[inline]
    fn nominal(&self, platform: &Platform, x: &mut [f64]) {
        x[..3].copy_from_slice(platform.radii());
        x[3..].fill(0.0);
    }

    #[inline]
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        [0, 1, 2].map(|k| turned(&platform.directions()[k], x[3 + k]) * x[k])
    }

    #[inline]
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
        polar_velocities(platform, x, velocities);
    }
}

/// Derivatives of x_k u(β_k + x_(3+k)) by all x.
#[inline]
pub(super) fn polar_velocities(platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
    velocities.fill(Sockets::default());
    for k in 0..3 {
        let direction = turned(&platform.directions()[k], x[3 + k]);
        velocities[k][k] = direction;
        velocities[3 + k][k] = Vector2::new(-direction.y, direction.x) * x[k];
    }
}

/// A direction turned by an angle; exactly itself where the angle is zero.
#[inline]
pub(super) fn turned(direction: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    let u = unit(angle);
    Vector2::new(direction.x * u.x - direction.y * u.y, direction.y * u.x + direction.x * u.y)
}
