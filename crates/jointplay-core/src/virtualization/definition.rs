//! The interface of a virtualization.

use super::platform::{Platform, Sides, Sockets};
use super::virtual_joint::VirtualJoint;

/// The virtualizations of this crate, which [`bulk`](crate::bulk) computes many poses at a time; each is the type of the same name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BuiltIn {
    /// [`Radial`](super::Radial).
    Radial,
    /// [`Polar`](super::Polar).
    Polar,
    /// [`Offset`](super::Offset).
    Offset,
    /// [`Planar`](super::Planar).
    Planar,
}

/// A model of the motion of the sockets in the platform plane.
///
/// All vectors are in the platform frame; `x` always has as many entries as [`joints`](Self::joints).
pub trait Virtualization {
    /// Name shown to users, in lower case.
    fn name(&self) -> &str;

    /// The virtual joints, in the order of X; from 3 to [`MAX_VIRTUAL_JOINTS`](super::MAX_VIRTUAL_JOINTS) of them.
    fn joints(&self) -> &[VirtualJoint];

    /// Writes the X at which every socket is at its nominal place, where every solve starts ((m), (rad)).
    fn nominal(&self, platform: &Platform, x: &mut [f64]);

    /// The three sockets p_k(X) (m).
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets;

    /// Writes ∂p/∂X: for each virtual joint, the velocities of the three sockets ((m/m), (m/rad)).
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]);

    /// The built-in virtualization with the same equations, whose poses [`bulk`](crate::bulk) computes many at a time; `None`, the default, computes them one by one.
    fn as_built_in(&self) -> Option<BuiltIn> {
        None
    }

    /// Writes the exact X of least displacement for these sides and returns `true`, where a closed form exists.
    ///
    /// # Arguments
    /// * `sides` – L_12, L_23, L_31, all positive and forming a triangle (m)
    fn closed_form(&self, platform: &Platform, sides: &Sides, x: &mut [f64]) -> bool {
        let _ = (platform, sides, x);
        false
    }
}
