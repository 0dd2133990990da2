//! Motion of the platform in its plane, for the least displacement of the virtual joints.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::limb_state::LimbState;
use crate::linalg::inverse_of_three;
use crate::virtualization::BuiltIn;

/// How the motion of the platform in its plane is determined.
#[derive(Debug, Clone, Copy)]
pub(super) enum InPlane {
    /// Both virtual joints of a limb move its socket: by the inverse of their stiffness, Σ Sᵀ K S + (Σ p · μ) e_ω e_ωᵀ.
    Stiffness(Matrix3<f64>),
    /// There is one virtual joint for each limb: by T⁻¹, for the directions σ_2 that they leave.
    Directions(Matrix3<f64>),
    /// The second virtual joints move the sockets little or not at all: by directions, and the forces there.
    Both {
        /// T⁻¹ of σ_2 and the part of σ_1 that the second virtual joint follows.
        motion: Matrix3<f64>,
        /// Inverse of Tᵀ + B T⁻¹ C, with the compliance C in these directions.
        forces: Matrix3<f64>,
        /// B T⁻¹, with the stiffness B along the first virtual joints.
        stiffness: Matrix3<f64>,
        /// C
        compliance: Vector3<f64>,
    },
}

impl InPlane {
    /// `None` where the equations determine no motion, or the displacement is not least.
    #[inline(always)]
    pub(super) fn new(
        built_in: BuiltIn,
        limbs: &[LimbState; 3],
        sockets: &[Vector2<f64>; 3],
    ) -> Option<Self> {
        let mut directions = Matrix3::zeros();
        if built_in == BuiltIn::Radial {
            limbs.iter().enumerate().for_each(|(k, limb)| {
                directions.set_row(k, &limb.rows[1].transpose());
            });
            return directions.try_inverse().map(Self::Directions);
        }
        let tension: f64 = sockets.iter().zip(limbs).map(|(p, limb)| p.dot(&limb.force)).sum();
        let mut stiffness = Matrix3::zeros();
        stiffness[(2, 2)] = tension;
        if built_in != BuiltIn::Offset {
            for LimbState { inverse, hessian: [xy, yy], rows: [first, second], .. } in limbs {
                let (mixed, lateral) = (xy * inverse, yy * inverse * inverse);
                let of_first = first + second * mixed;
                let of_second = first * mixed + second * lateral;
                stiffness += first * of_first.transpose() + second * of_second.transpose();
            }
            return inverse_of_three(&stiffness).map(Self::Stiffness);
        }
        let mut compliance = Vector3::zeros();
        for (k, limb) in limbs.iter().enumerate() {
            let (xy, [first, second]) = (limb.hessian[0], limb.rows);
            let followed = second + first * (limb.across * xy * limb.inverse);
            directions.set_row(k, &followed.transpose());
            compliance[k] = limb.across * limb.across * limb.inverse;
            stiffness += first * first.transpose() * (1.0 - xy * xy * limb.inverse);
        }
        let motion = directions.try_inverse()?;
        let stiffness = stiffness * motion;
        let yielding = stiffness * Matrix3::from_diagonal(&compliance);
        let forces = (directions.transpose() + yielding).try_inverse()?;
        Some(Self::Both { motion, forces, stiffness, compliance })
    }

    /// Contribution of a limb to the balance of forces and moments, and to the motion in the direction that it leaves free.
    #[inline(always)]
    pub(super) fn load(
        &self,
        limb: &LimbState,
        wanted: [f64; 2],
        g: &Vector2<f64>,
    ) -> (Vector3<f64>, f64) {
        match self {
            Self::Stiffness(_) => {
                let [first, second] = limb.stiff(wanted, g).1;
                (limb.rows[0] * -first - limb.rows[1] * second, 0.0)
            }
            Self::Directions(_) => (Vector3::zeros(), wanted[1]),
            Self::Both { .. } => {
                let (rates, first) = limb.guided(wanted[0], 0.0, g);
                (limb.rows[0] * -first, wanted[1] - limb.across * rates.y)
            }
        }
    }

    /// (v_x, v_y, ω), and the forces in the directions that the limbs leave.
    #[inline(always)]
    pub(super) fn motion(
        &self,
        balance: &Vector3<f64>,
        open: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Self::Stiffness(inverse) => (inverse * balance, Vector3::zeros()),
            Self::Directions(inverse) => (inverse * open, Vector3::zeros()),
            Self::Both { motion, forces, stiffness, compliance } => {
                let lateral = forces * (balance - stiffness * open);
                (motion * (open + compliance.component_mul(&lateral)), lateral)
            }
        }
    }

    /// Virtual joints of each limb, and with `FORCES` the forces on the sockets, without it zeros.
    #[inline(always)]
    pub(super) fn follow<const FORCES: bool>(
        &self,
        limbs: &[LimbState; 3],
        motion: &Vector3<f64>,
        lateral: &Vector3<f64>,
        wanted: &[[f64; 2]; 3],
        g: &[Vector2<f64>; 3],
    ) -> ([Vector2<f64>; 3], [Vector2<f64>; 3]) {
        let of_limb = |k: usize| {
            let limb = &limbs[k];
            let left = [0, 1].map(|i| wanted[k][i] - limb.rows[i].dot(motion));
            let (joints, force) = match self {
                Self::Stiffness(_) => limb.stiff(left, &g[k]),
                // Three virtual joints for three sides: no force matters.
                Self::Directions(_) => return (Vector2::new(left[0], 0.0), Vector2::zeros()),
                Self::Both { .. } => {
                    let (rates, first) = limb.guided(left[0], lateral[k], &g[k]);
                    (rates, [first, lateral[k]])
                }
            };
            (joints, if FORCES { limb.vector(force) } else { Vector2::zeros() })
        };
        let [first, second, third] = [of_limb(0), of_limb(1), of_limb(2)];
        ([first.0, second.0, third.0], [first.1, second.1, third.1])
    }
}

/// Nothing, for each limb.
pub(super) const NO_LOADS: [Vector2<f64>; 3] = [Vector2::new(0.0, 0.0); 3];
