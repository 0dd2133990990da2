//! A displacement of each socket in polar coordinates about its nominal place.

use super::polar::{polar_velocities, turned};
use super::{BuiltIn, Platform, Sockets, VirtualJoint, VirtualJointKind, Virtualization};

/// Sockets displaced by dr_k in the direction β_k + dφ_k: p_k = r_k u(β_k) + dr_k u(β_k + dφ_k).
///
/// At dr_k = 0, where every solve starts, dφ_k has no effect: these coordinates have a singular point there, and dφ_k stays near zero whatever the robot does.
/// [`Planar`](super::Planar) is the same freedom without that point.
///
/// # Source
/// \[Virtualization\], V.B, with the misprinted index of r_3 put right (`docs/explanation/errata.md`)
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Offset;

static JOINTS: [VirtualJoint; 6] =
    VirtualJoint::pairs(("dr", VirtualJointKind::Linear), ("dphi", VirtualJointKind::Angular));

impl Virtualization for Offset {
    fn name(&self) -> &str {
        "offset"
    }

    #[inline]
    fn joints(&self) -> &[VirtualJoint] {
        &JOINTS
    }

    fn as_built_in(&self) -> Option<BuiltIn> {
        Some(BuiltIn::Offset)
    }

    #[inline]
    fn nominal(&self, _platform: &Platform, x: &mut [f64]) {
        x.fill(0.0);
    }

    #[inline]
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        [0, 1, 2]
            .map(|k| platform.sockets()[k] + turned(&platform.directions()[k], x[3 + k]) * x[k])
    }

    #[inline]
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
        polar_velocities(platform, x, velocities);
    }
}
