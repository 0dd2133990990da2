//! Three radial slides, one at each socket.

use crate::float::sqrt;

use super::{BuiltIn, Platform, Sides, Sockets, VirtualJoint, VirtualJointKind, Virtualization};

/// Sockets that slide along their radii: p_k = l_k u(β_k).
///
/// Three unknowns for three sides, so that the metric has no effect.
/// With sockets 120° apart O_p is the Fermat point of the ball centres, the point from which all sides are seen under 120°.
///
/// # Source
/// \[Virtualization\], III and Fig. 3; closed form: own derivation, `docs/explanation/kinematics.md`
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Radial;

static JOINTS: [VirtualJoint; 3] = VirtualJoint::on_each_limb("l", VirtualJointKind::Linear);

impl Virtualization for Radial {
    fn name(&self) -> &str {
        "radial"
    }

    #[inline]
    fn joints(&self) -> &[VirtualJoint] {
        &JOINTS
    }

    fn as_built_in(&self) -> Option<BuiltIn> {
        Some(BuiltIn::Radial)
    }

    #[inline]
    fn nominal(&self, platform: &Platform, x: &mut [f64]) {
        x.copy_from_slice(platform.radii());
    }

    #[inline]
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        let [u_1, u_2, u_3] = platform.directions();
        [u_1 * x[0], u_2 * x[1], u_3 * x[2]]
    }

    #[inline]
    fn socket_velocities(&self, platform: &Platform, _x: &[f64], velocities: &mut [Sockets]) {
        for (k, velocity) in velocities.iter_mut().enumerate() {
            *velocity = Sockets::default();
            velocity[k] = platform.directions()[k];
        }
    }

    /// ```text
    ///    S  =  √((L_12² + L_23² + L_31²)/2 + 2√3 area)  =  l_1 + l_2 + l_3
    ///    l_1 − l_3 = (L_12² − L_23²)/S     and in turn
    /// ```
    /// Only for sockets 120° apart, and only where the Fermat point lies within the triangle (no angle of it above 120°).
    #[inline]
    fn closed_form(&self, platform: &Platform, sides: &Sides, x: &mut [f64]) -> bool {
        if !platform.equally_spaced() {
            return false;
        }
        let [l_12, l_23, l_31] = *sides;
        // Sixteen times the squared area, by Heron's formula in factors that do not cancel.
        let heron = (l_12 + l_23 + l_31)
            * (l_23 + l_31 - l_12)
            * (l_31 + l_12 - l_23)
            * (l_12 + l_23 - l_31);
        let area = 0.25 * sqrt(heron.max(0.0));
        let sum = sqrt(0.5 * (l_12 * l_12 + l_23 * l_23 + l_31 * l_31) + 2.0 * sqrt(3.0) * area);
        let difference = |a: f64, b: f64| (a - b) * (a + b) / sum;
        let (d_13, d_21, d_32) =
            (difference(l_12, l_23), difference(l_23, l_31), difference(l_31, l_12));
        x[0] = (sum + d_13 - d_21) / 3.0;
        x[1] = (sum + d_21 - d_32) / 3.0;
        x[2] = (sum + d_32 - d_13) / 3.0;
        x.iter().all(|&l| l > 0.0)
    }
}
