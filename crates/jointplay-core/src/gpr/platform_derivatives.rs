//! Derivatives of the pose of the platform by the rods.

use nalgebra::{Matrix6x3, Vector3, Vector6};

use super::placement::{Placement, Rate};
use super::{Gpr, PlatformPose};
use crate::Error;
use crate::error::finite;
use crate::spatial::FrameTwist;
use crate::virtualization::{VirtualJoints, Virtualization};

/// First derivatives of a pose of the platform by the rods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformJacobian {
    /// (6,3) geometric Jacobian of the platform frame in the base frame: angular velocity, then velocity of O_p, for unit rates of the rods ((rad/m), (m/m)).
    pub matrix: Matrix6x3<f64>,
    /// ∂X/∂q_k for each rod, in the order of X ((m/m), (rad/m)).
    pub virtual_joints: [VirtualJoints; 3],
}

/// First and second derivatives of a pose of the platform by the rods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformDerivatives {
    /// First derivatives.
    pub jacobian: PlatformJacobian,
    /// ∂J/∂q_k of the geometric Jacobian J for each rod ((rad/m²), (m/m²)).
    ///
    /// Upper rows are not symmetric in their two rods: angular velocities are no derivatives.
    pub jacobian_derivatives: [Matrix6x3<f64>; 3],
    /// ∂²X/∂q_j∂q_k, in the order of X ((m/m²), (rad/m²)).
    pub virtual_joints: [[VirtualJoints; 3]; 3],
}

impl PlatformJacobian {
    /// Velocity of the platform frame for velocities of the rods (m/s).
    #[must_use]
    #[inline]
    pub fn velocity(&self, rods: &Vector3<f64>) -> FrameTwist {
        twist(&self.matrix, rods)
    }

    /// Velocities of the virtual joints for velocities of the rods (m/s), in the order of X ((m/s), (rad/s)).
    #[must_use]
    pub fn virtual_velocities(&self, rods: &Vector3<f64>) -> VirtualJoints {
        combined(&self.virtual_joints, rods)
    }
}

impl PlatformDerivatives {
    /// Acceleration of the platform frame for velocities (m/s) and accelerations (m/s²) of the rods: angular acceleration, and acceleration of O_p.
    #[must_use]
    pub fn acceleration(
        &self,
        velocities: &Vector3<f64>,
        accelerations: &Vector3<f64>,
    ) -> FrameTwist {
        let mut found = twist(&self.jacobian.matrix, accelerations);
        let changes = self.jacobian_derivatives.iter().zip(velocities.iter());
        let rate: Matrix6x3<f64> = changes.map(|(change, &velocity)| change * velocity).sum();
        let by_velocities = twist(&rate, velocities);
        found.angular += by_velocities.angular;
        found.linear += by_velocities.linear;
        found
    }

    /// Accelerations of the virtual joints for velocities (m/s) and accelerations (m/s²) of the rods, in the order of X ((m/s²), (rad/s²)).
    #[must_use]
    pub fn virtual_accelerations(
        &self,
        velocities: &Vector3<f64>,
        accelerations: &Vector3<f64>,
    ) -> VirtualJoints {
        let mut found = combined(&self.jacobian.virtual_joints, accelerations);
        let rows = self.virtual_joints.each_ref().map(|row| combined(row, velocities));
        for (total, change) in found.iter_mut().zip(combined(&rows, velocities).iter()) {
            *total += change;
        }
        found
    }
}

fn twist(matrix: &Matrix6x3<f64>, rods: &Vector3<f64>) -> FrameTwist {
    let all = matrix * rods;
    FrameTwist {
        angular: all.fixed_rows::<3>(0).into_owned(),
        linear: all.fixed_rows::<3>(3).into_owned(),
    }
}

fn combined(columns: &[VirtualJoints; 3], factors: &Vector3<f64>) -> VirtualJoints {
    let mut sum = VirtualJoints::zeros(columns[0].len());
    for (column, factor) in columns.iter().zip(factors.iter()) {
        for (total, value) in sum.iter_mut().zip(column.iter()) {
            *total += factor * value;
        }
    }
    sum
}

impl Gpr {
    /// First derivatives of a pose by the rods: geometric Jacobian of the platform, and derivatives of the virtual joints.
    ///
    /// ```text
    ///    ω × p_k + v + ∂p_k/∂q  =  ∂q_k/∂q Rᵀ e_b3         twist (ω, v) and sockets p_k in the platform frame
    ///    W (X − X_0) + Σ (∂p_k/∂X)ᵀ μ_k  =  0,    Σ μ_k = 0,    Σ p_k × μ_k = 0
    /// ```
    /// The second line is the least displacement; it and its derivatives hold at every pose.
    ///
    /// # Arguments
    /// * `pose` – as [`Self::forward`] returns it, with the same virtualization
    ///
    /// # Errors
    /// [`Error::OwnVirtualization`] for a virtualization that is not [built in](crate::virtualization::BuiltIn), [`Error::NewtonSolution`] for six virtual joints by [`Solver::Newton`](crate::virtualization::Solver::Newton),
    /// [`Error::NotClosed`] for a pose of another robot or virtualization, [`Error::DependentSides`] where the least displacement is not unique, [`Error::NotFinite`] where numbers overflow.
    ///
    /// # Numerics
    /// Closed form: the largest system has three equations. Does not allocate.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/kinematics.md`
    ///
    /// # Example
    /// ```
    /// use jointplay_core::gpr::Gpr;
    /// use jointplay_core::nalgebra::Vector3;
    /// use jointplay_core::virtualization::{Planar, SolveOptions};
    ///
    /// let gpr = Gpr::paper();
    /// let pose = gpr.forward([0.501, 0.5, 0.499], &Planar, &SolveOptions::default())?;
    /// let jacobian = gpr.platform_jacobian(&pose, &Planar)?;
    /// // All rods alike raise the platform.
    /// let velocity = jacobian.velocity(&Vector3::repeat(0.1));
    /// assert!((velocity.linear - Vector3::z() * 0.1).norm() < 1e-15);
    /// assert!(velocity.angular.norm() < 1e-14);
    /// # Ok::<(), jointplay_core::Error>(())
    /// ```
    #[inline]
    pub fn platform_jacobian<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> Result<PlatformJacobian, Error> {
        let placement = Placement::new(self, pose, virtualization)?;
        jacobian(&placement, &placement.first_rates::<false>(), pose)
    }

    /// First and second derivatives of a pose by the rods.
    ///
    /// # Arguments
    /// * `pose` – as [`Self::forward`] returns it, with the same virtualization
    ///
    /// # Errors
    /// Those of [`Self::platform_jacobian`].
    ///
    /// # Numerics
    /// Closed form; derivatives of the equations of [`Self::platform_jacobian`]. Does not allocate.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/kinematics.md`
    ///
    /// # Example
    /// ```
    /// use jointplay_core::gpr::{AxisHeight, Gpr};
    /// use jointplay_core::nalgebra::Vector3;
    /// use jointplay_core::spatial::Tilt;
    /// use jointplay_core::virtualization::{Radial, SolveOptions};
    ///
    /// let gpr = Gpr::paper();
    /// // Tilting at 0.1 rad/s through level: the platform turns about an axis in its plane.
    /// let rods = gpr.rod_derivatives(Tilt::LEVEL, AxisHeight(0.5))?;
    /// let rates = Vector3::new(0.1, 0.0, 0.0);
    /// let (velocities, accelerations) =
    ///     (rods.velocities(&rates), rods.accelerations(&rates, &Vector3::zeros()));
    /// let pose = gpr.forward(rods.rods, &Radial, &SolveOptions::default())?;
    /// let platform = gpr.platform_derivatives(&pose, &Radial)?;
    /// assert!((platform.jacobian.velocity(&velocities).angular - rates).norm() < 1e-14);
    /// // Its centre begins to leave the base axis, because sockets slide along their radii only.
    /// let acceleration = platform.acceleration(&velocities, &accelerations);
    /// assert!(acceleration.angular.norm() < 1e-14 && acceleration.linear.norm() > 1e-4);
    /// # Ok::<(), jointplay_core::Error>(())
    /// ```
    pub fn platform_derivatives<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> Result<PlatformDerivatives, Error> {
        let placement = Placement::new(self, pose, virtualization)?;
        let rates = placement.first_rates::<true>();
        let rotation = pose.base_from_platform.rotation;
        let empty = VirtualJoints::zeros(pose.solution.virtual_joints.len());
        let mut jacobian_derivatives = [Matrix6x3::zeros(); 3];
        let mut virtual_joints = [[empty; 3]; 3];
        for (b, by) in rates.iter().enumerate() {
            for (a, of) in rates.iter().enumerate() {
                let second = placement.second_rate(a, of, by);
                let angular = second.angular + by.angular.cross(&of.angular);
                let linear = second.linear + by.angular.cross(&of.linear);
                let column = &mut jacobian_derivatives[b];
                column.fixed_view_mut::<3, 1>(0, a).copy_from(&(rotation * angular));
                column.fixed_view_mut::<3, 1>(3, a).copy_from(&(rotation * linear));
                placement.write_virtual_joints(&second, &mut virtual_joints[a][b]);
            }
        }
        let total: f64 = jacobian_derivatives.iter().map(Matrix6x3::sum).sum();
        finite(DERIVATIVE, total)?;
        let jacobian = jacobian(&placement, &rates, pose)?;
        Ok(PlatformDerivatives { jacobian, jacobian_derivatives, virtual_joints })
    }
}

/// Name of the quantity that is not finite where products of lengths overflow or vanish.
const DERIVATIVE: &str = "a derivative of the pose";

#[inline]
fn jacobian(
    placement: &Placement,
    rates: &[Rate; 3],
    pose: &PlatformPose,
) -> Result<PlatformJacobian, Error> {
    let rotation = pose.base_from_platform.rotation;
    let column = |a: usize| {
        let (angular, linear) = (rotation * rates[a].angular, rotation * rates[a].linear);
        Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z)
    };
    let matrix = Matrix6x3::from_columns(&[column(0), column(1), column(2)]);
    let empty = VirtualJoints::zeros(pose.solution.virtual_joints.len());
    let of_rod = |a: usize| {
        let mut found = empty;
        placement.write_virtual_joints(&rates[a], &mut found);
        found
    };
    let virtual_joints = [of_rod(0), of_rod(1), of_rod(2)];
    finite(DERIVATIVE, matrix.sum())?;
    Ok(PlatformJacobian { matrix, virtual_joints })
}
