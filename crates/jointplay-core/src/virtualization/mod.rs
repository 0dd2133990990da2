//! Virtual joints that relieve an overconstrained platform, and how their displacements are found.
//!
//! A *virtualization* is a map X → sockets p_k(X) in the platform plane; the sides between the sockets are then L_ij(X) = |p_j − p_i|.
//! Choosing X is choosing where the platform sits over the triangle of the ball centres: the three ball centres fix only the plane and the three sides.
//!
//! | virtualization | X | socket k |
//! | --- | --- | --- |
//! | [`Radial`] | l_k | l_k u(β_k) |
//! | [`Polar`] | l_k, φ_k | l_k u(β_k + φ_k) |
//! | [`Offset`] | dr_k, dφ_k | r_k u(β_k) + dr_k u(β_k + dφ_k) |
//! | [`Planar`] | u_k, v_k | r_k u(β_k) + (u_k, v_k) |
//!
//! with u(θ) = (cos θ, sin θ).
//! A virtualization of your own implements [`Virtualization`]; `examples/03_own_virtualization.rs` shows one.

mod metric;
mod offset;
mod planar;
mod platform;
mod polar;
mod radial;
mod solve;
mod virtual_joint;

pub use metric::Metric;
pub use offset::Offset;
pub use planar::Planar;
pub use platform::{Platform, Sides, Sockets};
pub use polar::Polar;
pub use radial::Radial;
pub use solve::{Solution, SolveOptions, Solver, solve};
pub use virtual_joint::{MAX_VIRTUAL_JOINTS, Motion, VirtualJoint, VirtualJoints};

use platform::unit;
pub(crate) use platform::{check_not_collinear, sides_of, signed_area};

/// The four virtualizations of this crate, in the order of the table above.
#[must_use]
pub fn built_in() -> [&'static dyn Virtualization; 4] {
    [&Radial, &Polar, &Offset, &Planar]
}

/// The virtualizations that [`bulk`](crate::bulk) knows; each is the type of the same name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// [`Radial`].
    Radial,
    /// [`Polar`].
    Polar,
    /// [`Offset`].
    Offset,
    /// [`Planar`].
    Planar,
}

/// A way to let the sockets move in the platform plane.
///
/// All vectors are in the platform frame; `x` always has as many entries as [`joints`](Self::joints).
pub trait Virtualization {
    /// The name that people use, in lower case.
    fn name(&self) -> &str;

    /// The virtual joints, in the order of X; from 3 to [`MAX_VIRTUAL_JOINTS`] of them.
    fn joints(&self) -> &[VirtualJoint];

    /// Writes the X at which every socket is at its nominal place, where every solve starts ([m], [rad]).
    fn nominal(&self, platform: &Platform, x: &mut [f64]);

    /// The three sockets p_k(X) [m].
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets;

    /// Writes ∂p/∂X: for each virtual joint, the velocities of the three sockets ([m/m], [m/rad]).
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]);

    /// The kernel that computes many poses of this virtualization at a time; `None`, as for one of your own, computes them one by one.
    fn kernel(&self) -> Option<Kernel> {
        None
    }

    /// Writes the exact X of least displacement for these sides and says `true`, where a closed form exists.
    ///
    /// # Arguments
    /// * `sides` – L_12, L_23, L_31, all positive and forming a triangle [m]
    fn closed_form(&self, platform: &Platform, sides: &Sides, x: &mut [f64]) -> bool {
        let _ = (platform, sides, x);
        false
    }
}
