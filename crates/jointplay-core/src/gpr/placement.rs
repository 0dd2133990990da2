//! Equations of a pose in the platform frame, and their derivatives.

use nalgebra::{Vector2, Vector3};

use super::in_plane::{InPlane, NO_LOADS};
use super::limb_state::{LimbState, each, limbs, perpendicular};
use super::{Gpr, PlatformPose};
use crate::Error;
use crate::float::sqrt;
use crate::tolerance::CLOSURE_TOLERANCE;
use crate::virtualization::{BuiltIn, Solver, VirtualJoints, Virtualization, signed_area};

/// Derivatives of a pose along one or two rods, in the platform frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rate {
    /// Of the rotation ((rad/m), (rad/m²)).
    pub(super) angular: Vector3<f64>,
    /// Of O_p ((m/m), (m/m²)).
    pub(super) linear: Vector3<f64>,
    /// Of the two virtual joints of each limb.
    joints: [Vector2<f64>; 3],
    /// Of the forces on the sockets.
    forces: [Vector2<f64>; 3],
    /// Of the sockets.
    sockets: [Vector2<f64>; 3],
}

/// Right-hand sides of the equations between rates.
#[derive(Debug, Clone, Copy)]
struct Loads {
    /// Normal velocity of the platform at each socket.
    normal: [f64; 3],
    /// Velocity of each socket in space, in the platform plane.
    in_plane: [Vector2<f64>; 3],
    /// Velocity of each socket that the virtual joints have without rates of their own.
    curved: [Vector2<f64>; 3],
    /// Generalized forces g on the virtual joints of each limb.
    joints: [Vector2<f64>; 3],
    /// Moment about O_p.
    moment: f64,
}

/// A pose with its equations between rates, factored.
///
/// ```text
///    v_z + ω_x p_ky − ω_y p_kx  =  normal_k
///    Σ μ̇_k = 0,    Σ p_k × μ̇_k + (Σ p_k · μ_k) ω_z  =  moment
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    limbs: [LimbState; 3],
    /// Whether the second virtual joint of each limb turns.
    turning: bool,
    count: usize,
    sockets: [Vector2<f64>; 3],
    center: Vector2<f64>,
    /// e_b3 in the platform frame.
    vertical: Vector3<f64>,
    /// Gradients of the barycentric coordinates.
    gradients: [Vector2<f64>; 3],
    in_plane: InPlane,
}

impl Placement {
    #[inline(always)]
    pub(super) fn new<V: Virtualization + ?Sized>(
        gpr: &Gpr,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> Result<Self, Error> {
        let built_in = virtualization.as_built_in().ok_or(Error::OwnVirtualization)?;
        let solution = &pose.solution;
        let x = &solution.virtual_joints;
        let count = virtualization.joints().len();
        if x.len() != count {
            let (what, found) = ("the virtual joint vector", x.len());
            return Err(Error::LengthMismatch { what, found, expected: count });
        }
        if solution.solver == Solver::Newton && count > 3 {
            return Err(Error::NewtonSolution { virtual_joints: count });
        }
        let (sockets, off_plane) = sockets(gpr, pose);
        let edges = each(|k| sockets[(k + 1) % 3] - sockets[k]);
        let rho = solution.characteristic_length;
        let dependent =
            Error::DependentSides { characteristic_length: rho, iterations: solution.iterations };
        let Some(limbs) = limbs(gpr, built_in, x, rho * rho, &sockets, &edges) else {
            return Err(dependent);
        };
        check_closed(gpr, off_plane + distance(gpr, built_in, x, &sockets, &limbs))?;
        let Some(in_plane) = InPlane::new(built_in, &limbs, &sockets) else {
            return Err(dependent);
        };
        let inverse_area = 1.0 / signed_area(&sockets);
        Ok(Self {
            limbs,
            turning: matches!(built_in, BuiltIn::Polar | BuiltIn::Offset),
            count,
            center: (sockets[0] + sockets[1] + sockets[2]) * THIRD,
            vertical: pose.base_from_platform.rotation.matrix().row(2).transpose(),
            gradients: each(|k| perpendicular(&edges[(k + 1) % 3]) * inverse_area),
            sockets,
            in_plane,
        })
    }

    /// Derivatives along each rod; without `SECOND`, those of forces and sockets, which only second derivatives need, are zero.
    #[inline(always)]
    pub(super) fn first_rates<const SECOND: bool>(&self) -> [Rate; 3] {
        let horizontal = self.vertical.xy();
        each(|k| {
            let limb = &self.limbs[k];
            let mut wanted = [[0.0; 2]; 3];
            wanted[k] = limb.components(&horizontal);
            // No other limb has a load.
            let (mut balance, open_here) = self.in_plane.load(limb, wanted[k], &Vector2::zeros());
            balance.z -= horizontal.perp(&limb.force);
            let mut open = Vector3::zeros();
            open[k] = open_here;
            let (motion, lateral) = self.in_plane.motion(&balance, &open);
            let (joints, forces) =
                self.in_plane.follow::<SECOND>(&self.limbs, &motion, &lateral, &wanted, &NO_LOADS);
            let mut in_plane = NO_LOADS;
            in_plane[k] = horizontal;
            let gradient = self.gradients[k] * self.vertical.z;
            let normal = self.vertical.z * THIRD - gradient.dot(&self.center);
            self.rate::<SECOND>(&gradient, normal, &motion, &in_plane, joints, forces)
        })
    }

    /// Derivative along one rod of the derivative `of` along rod `rod`.
    pub(super) fn second_rate(&self, rod: usize, of: &Rate, by: &Rate) -> Rate {
        let mut loads = Loads::NONE;
        let turned = self.vertical.cross(&by.angular);
        for k in 0..3 {
            let moved = by.sockets[k];
            loads.normal[k] = of.angular.y * moved.x - of.angular.x * moved.y;
            loads.in_plane[k] = perpendicular(&moved) * -of.angular.z;
            if k == rod {
                loads.normal[k] += turned.z;
                loads.in_plane[k] += turned.xy();
            }
            if self.turning {
                (loads.curved[k], loads.joints[k]) = self.curvature(k, of, by);
            }
            loads.moment -= of.sockets[k].perp(&by.forces[k])
                + moved.perp(&of.forces[k])
                + loads.in_plane[k].perp(&self.limbs[k].force);
        }
        self.solve(&loads)
    }

    /// ∂²p/∂x² and the change of generalized forces for rates of the joints of a limb, of which the second turns the first.
    #[inline]
    fn curvature(&self, k: usize, of: &Rate, by: &Rate) -> (Vector2<f64>, Vector2<f64>) {
        let limb = &self.limbs[k];
        let (along, across, length) = (limb.along, perpendicular(&limb.along), limb.across);
        let (a, b) = (of.joints[k], by.joints[k]);
        let (mixed, turns) = (a.x * b.y + b.x * a.y, a.y * b.y);
        let curved = across * mixed - along * (length * turns);
        // ∂(∂p/∂x)ᵀ/∂x along one rate, times the force of the other.
        let changed = |rates: &Vector2<f64>, force: &Vector2<f64>| {
            let turn = across * rates.x - along * (length * rates.y);
            Vector2::new(rates.y * across.dot(force), turn.dot(force))
        };
        let third = Vector2::new(
            -turns * along.dot(&limb.force),
            -(along * mixed + across * (length * turns)).dot(&limb.force),
        );
        (curved, changed(&b, &of.forces[k]) + changed(&a, &by.forces[k]) + third)
    }

    /// Rates under loads.
    #[inline]
    fn solve(&self, loads: &Loads) -> Rate {
        let mut gradient = Vector2::zeros();
        let mut normal = 0.0;
        for k in 0..3 {
            gradient += self.gradients[k] * loads.normal[k];
            normal += loads.normal[k] * THIRD;
        }
        normal -= gradient.dot(&self.center);

        let mut balance = Vector3::new(0.0, 0.0, loads.moment);
        let mut open = Vector3::zeros();
        let mut wanted = [[0.0; 2]; 3];
        for (k, limb) in self.limbs.iter().enumerate() {
            wanted[k] = limb.components(&(loads.in_plane[k] - loads.curved[k]));
            let of_limb = self.in_plane.load(limb, wanted[k], &loads.joints[k]);
            balance += of_limb.0;
            open[k] = of_limb.1;
        }
        let (motion, lateral) = self.in_plane.motion(&balance, &open);
        let (joints, forces) =
            self.in_plane.follow::<true>(&self.limbs, &motion, &lateral, &wanted, &loads.joints);
        self.rate::<true>(&gradient, normal, &motion, &loads.in_plane, joints, forces)
    }

    /// Rates for a gradient of the normal velocity, its value at O_p, and the motion in the plane.
    #[inline(always)]
    fn rate<const SECOND: bool>(
        &self,
        gradient: &Vector2<f64>,
        normal: f64,
        motion: &Vector3<f64>,
        in_plane: &[Vector2<f64>; 3],
        joints: [Vector2<f64>; 3],
        forces: [Vector2<f64>; 3],
    ) -> Rate {
        let (shift, turn) = (motion.xy(), motion.z);
        let moved = |k: usize| in_plane[k] - shift - perpendicular(&self.sockets[k]) * turn;
        let sockets = if SECOND { each(moved) } else { NO_LOADS };
        Rate {
            angular: Vector3::new(gradient.y, -gradient.x, turn),
            linear: shift.push(normal),
            joints,
            forces,
            sockets,
        }
    }

    /// Writes the rates of the virtual joints in the order of X.
    #[inline(always)]
    pub(super) fn write_virtual_joints(&self, rate: &Rate, x: &mut VirtualJoints) {
        for (k, joints) in rate.joints.iter().enumerate() {
            x[k] = joints.x;
            if self.count > 3 {
                x[3 + k] = joints.y;
            }
        }
    }
}

impl Loads {
    const NONE: Self = Self {
        normal: [0.0; 3],
        in_plane: NO_LOADS,
        curved: NO_LOADS,
        joints: NO_LOADS,
        moment: 0.0,
    };
}

const THIRD: f64 = 1.0 / 3.0;

/// Balls of a pose in the platform frame, and the sum of their squared distances from its plane.
#[inline(always)]
fn sockets(gpr: &Gpr, pose: &PlatformPose) -> ([Vector2<f64>; 3], f64) {
    let rotation = pose.base_from_platform.rotation.matrix();
    let mut off_plane = 0.0;
    let sockets = gpr.ball_centers(&pose.rods).map(|ball| {
        let arm = ball - pose.base_from_platform.translation.vector;
        let off = rotation.column(2).dot(&arm);
        off_plane += off * off;
        Vector2::new(rotation.column(0).dot(&arm), rotation.column(1).dot(&arm))
    });
    (sockets, off_plane)
}

/// Sum of squared distances of the sockets from where the virtual joints have them; angles of the polar virtualization are taken as they are.
#[inline(always)]
fn distance(
    gpr: &Gpr,
    built_in: BuiltIn,
    x: &VirtualJoints,
    sockets: &[Vector2<f64>; 3],
    limbs: &[LimbState; 3],
) -> f64 {
    let nominal = gpr.platform().sockets();
    let of_limb = |k: usize| match built_in {
        BuiltIn::Radial => (sockets[k] - limbs[k].along * x[k]).norm_squared(),
        BuiltIn::Planar => (sockets[k] - nominal[k] + limbs[k].force).norm_squared(),
        BuiltIn::Polar => {
            let excess = limbs[k].along.norm_squared() - 1.0;
            excess * excess * x[k] * x[k]
        }
        BuiltIn::Offset => (sockets[k] - nominal[k] - limbs[k].along * x[k]).norm_squared(),
    };
    of_limb(0) + of_limb(1) + of_limb(2)
}

/// Whether the sockets of a pose are at the balls, by the sum of the squares of their distances.
#[inline(always)]
fn check_closed(gpr: &Gpr, squares: f64) -> Result<(), Error> {
    let (length, allowed) = (gpr.platform().mean_radius(), CLOSURE_TOLERANCE);
    let most = allowed * length;
    if squares <= most * most {
        return Ok(());
    }
    Err(Error::NotClosed { residual: sqrt(squares) / length, allowed })
}
