//! Sensitivity of the virtual joints to a small motion of the mechanism.

use nalgebra::{DMatrix, DVector};

use crate::Error;
use crate::constraint::{Configuration, Dimension, ScaledSystem, System, scaled_jacobian, units};
use crate::linalg::{Svd, product, svd};

/// ∂X/∂P at a configuration, in the metric, with its singular values and vectors.
///
/// ```text
///    ∂X/∂P  =  −(∂Φ/∂X)†  ∂Φ/∂P          singular values σ_1 ≥ … ≥ σ_r > 0, right vectors v_1 … v_r
///    (M,n)       (M,c)    (c,n)
/// ```
/// Angles are multiplied by the characteristic length ρ of the metric, so that all entries are lengths per length and the singular values have no unit.
/// Of all dX that keep the constraints, it is the least one: in the metric, or of the least elastic energy Σ k dx² where all virtual joints have a stiffness k:
///
/// ```text
///    ∂X/∂P  =  −K^(−1/2) (∂Φ/∂X K^(−1/2))†  ∂Φ/∂P
/// ```
/// Where X is displaced and there are more virtual joints than constraints, the least dX differs from the change of the least X.
///
/// # Source
/// \[Virtualization\], eq. (3)
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// ∂X/∂P in the metric.
    pub matrix: DMatrix<f64>,
    /// Rank r: 3 for three sides.
    pub rank: usize,
    /// ρ by which angles are multiplied (m).
    pub characteristic_length: f64,
    /// Singular values and vectors of `matrix`.
    pub decomposition: Svd,
    /// (M, c) −(∂Φ/∂X)†, in the metric; column s is what constraint s asks of the virtual joints.
    by_constraint: DMatrix<f64>,
    /// (c, n) ∂Φ/∂P, scaled like the columns of `by_constraint`.
    constraint_jacobian: DMatrix<f64>,
}

/// Lower and upper bounds of ‖dX‖ for a given dP, in the metric.
///
/// # Source
/// \[Virtualization\], eq. (4) and (5)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// (5), lower: σ_r ‖V_rᵀ dP‖ (m).
    pub lower: f64,
    /// (5), upper: σ_1 ‖V_rᵀ dP‖ (m).
    pub upper: f64,
    /// (4), lower: the same from the eigenvalues of (∂X/∂P)ᵀ ∂X/∂P (m).
    pub eigenvalue_lower: f64,
    /// (4), upper (m).
    pub eigenvalue_upper: f64,
    /// The bound that holds for every dP of this length: σ_1 ‖dP‖ (m).
    pub coarse_upper: f64,
    /// ‖∂X/∂P dP‖ itself (m).
    pub linear: f64,
}

impl Bounds {
    /// Whether a displacement (m) lies within (5), with `slack` as a share of it for round-off.
    #[must_use]
    pub fn hold(&self, displacement: f64, slack: f64) -> bool {
        displacement >= self.lower * (1.0 - slack) && displacement <= self.upper * (1.0 + slack)
    }
}

/// The sensitivity of the virtual joints to the coordinates.
///
/// # Arguments
/// * `characteristic_length` – ρ of the metric of X (m)
/// * `relative_threshold` – singular values up to this share of the largest count as zero, see [`RANK_THRESHOLD`](crate::mobility::RANK_THRESHOLD)
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
///
/// # Numerics
/// Two singular value decompositions.
pub fn sensitivity<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    characteristic_length: f64,
    relative_threshold: f64,
) -> Result<Sensitivity, Error> {
    system.check(at)?;
    let scaled = Scaled::new(system, at, characteristic_length)?;
    Sensitivity::from_jacobians(
        &scaled.of_virtual_joints,
        scaled.of_coordinates,
        &scaled.weights,
        characteristic_length,
        relative_threshold,
    )
}

/// The sensitivity of the virtual joints to some coordinates that are commanded, while all others follow.
///
/// ```text
///    Zᵀ ∂Φ/∂P_follow = 0        ∂X/∂P_commanded  =  −(Zᵀ ∂Φ/∂X)†  Zᵀ ∂Φ/∂P_commanded
/// ```
/// The effect of the following coordinates is eliminated from the constraints first; the rest is as in [`sensitivity`].
///
/// # Arguments
/// * `commanded` – indices in P; motions given to the result have these entries only
/// * `characteristic_length`, `relative_threshold` – as for [`sensitivity`]
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
pub fn commanded_sensitivity<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    commanded: &[usize],
    characteristic_length: f64,
    relative_threshold: f64,
) -> Result<Sensitivity, Error> {
    system.check(at)?;
    let all = ScaledSystem::new(system, system.characteristic_length()).jacobian(at);
    let following: Vec<usize> = (0..all.ncols()).filter(|k| !commanded.contains(k)).collect();
    let follow = svd(&all.select_columns(&following))?;
    let open = follow.left_null_space(follow.rank(relative_threshold)).transpose();
    let scaled = Scaled::new(system, at, characteristic_length)?;
    Sensitivity::from_jacobians(
        &(&open * scaled.of_virtual_joints),
        &open * scaled.of_coordinates.select_columns(commanded),
        &scaled.weights,
        characteristic_length,
        relative_threshold,
    )
}

/// Both Jacobians, rows in units of the mechanism, columns in the metric.
struct Scaled {
    of_virtual_joints: DMatrix<f64>,
    of_coordinates: DMatrix<f64>,
    /// (M) 1/√k of each virtual joint, with its stiffness k in the metric; 1 where there is none.
    weights: DVector<f64>,
}

impl Scaled {
    fn new<S: System + ?Sized>(
        system: &S,
        at: &Configuration,
        characteristic_length: f64,
    ) -> Result<Self, Error> {
        crate::error::finite("the characteristic length", characteristic_length)?;
        let rows = units(&system.constraint_dimensions(), system.characteristic_length());
        let per_metric = |dimensions: Vec<Dimension>| {
            dimensions.into_iter().map(|dimension| match dimension {
                Dimension::Angle => 1.0 / characteristic_length,
                Dimension::Length | Dimension::SquaredLength => 1.0,
            })
        };
        let scaled = |jacobian: DMatrix<f64>, dimensions: Vec<Dimension>| {
            let count = dimensions.len();
            let units = DVector::from_iterator(count, per_metric(dimensions));
            scaled_jacobian(&jacobian, &rows, &units)
        };
        let dimensions = system.virtual_joint_dimensions();
        let weights = match system.virtual_joint_stiffness() {
            Some(stiffness) => DVector::from_iterator(
                stiffness.len(),
                per_metric(dimensions).zip(&stiffness).map(|(unit, k)| 1.0 / (unit * k.sqrt())),
            ),
            None => DVector::repeat(dimensions.len(), 1.0),
        };
        Ok(Self {
            weights,
            of_virtual_joints: scaled(
                system.virtual_jacobian(at),
                system.virtual_joint_dimensions(),
            ),
            of_coordinates: scaled(system.constraint_jacobian(at), system.coordinate_dimensions()),
        })
    }
}

impl Sensitivity {
    fn from_jacobians(
        of_virtual_joints: &DMatrix<f64>,
        constraint_jacobian: DMatrix<f64>,
        weights: &DVector<f64>,
        characteristic_length: f64,
        relative_threshold: f64,
    ) -> Result<Self, Error> {
        let mut weighed = of_virtual_joints.clone();
        for (mut column, &weight) in weighed.column_iter_mut().zip(weights) {
            column *= weight;
        }
        let weighed = svd(&weighed)?;
        let mut by_constraint = -weighed.pseudo_inverse(weighed.rank(relative_threshold));
        for (mut row, &weight) in by_constraint.row_iter_mut().zip(weights) {
            row *= weight;
        }
        let matrix = product(&by_constraint, &constraint_jacobian);
        let decomposition = svd(&matrix)?;
        Ok(Self {
            rank: decomposition.rank(relative_threshold),
            matrix,
            characteristic_length,
            decomposition,
            by_constraint,
            constraint_jacobian,
        })
    }

    /// Singular values of ∂X/∂P, non-zero ones first, in metres of the metric per metre.
    #[must_use]
    pub fn singular_values(&self) -> &DVector<f64> {
        &self.decomposition.singular_values
    }

    /// (n, r) right singular vectors of the non-zero singular values.
    #[must_use]
    pub fn right_vectors(&self) -> DMatrix<f64> {
        self.decomposition.v.columns(0, self.rank).into_owned()
    }

    /// Bounds of ‖dX‖ for a motion dP (m).
    ///
    /// # Errors
    /// [`Error::LengthMismatch`].
    pub fn bounds(&self, motion: &DVector<f64>) -> Result<Bounds, Error> {
        self.check(motion)?;
        let effective = (self.right_vectors().transpose() * motion).norm();
        let values = self.singular_values();
        let (largest, smallest) = match self.rank.checked_sub(1) {
            Some(last) => (values[0], values[last]),
            None => (0.0, 0.0),
        };
        // The other product has the same eigenvalues, but for zeros, and is the smaller one.
        let eigen = (&self.matrix * self.matrix.transpose()).symmetric_eigen();
        let mut eigenvalues: Vec<f64> = eigen.eigenvalues.iter().map(|d| d.max(0.0)).collect();
        eigenvalues.sort_by(|a, b| b.total_cmp(a));
        let root = |index: Option<usize>| index.map_or(0.0, |k| eigenvalues[k].sqrt());
        Ok(Bounds {
            lower: smallest * effective,
            upper: largest * effective,
            eigenvalue_lower: root(self.rank.checked_sub(1)) * effective,
            eigenvalue_upper: root(self.rank.checked_sub(1).map(|_| 0)) * effective,
            coarse_upper: largest * motion.norm(),
            linear: (&self.matrix * motion).norm(),
        })
    }

    /// Share of dX = ∂X/∂P dP that each group of coordinates causes; `None` where dX vanishes.
    ///
    /// ```text
    ///    share_g  =  ⟨∂X/∂P dP_g, dX⟩ / ‖dX‖²        Σ shares = 1 if every coordinate is in one group
    /// ```
    /// A share is negative where a group works against the rest.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`].
    pub fn shares_by_coordinates(
        &self,
        motion: &DVector<f64>,
        groups: &[&[usize]],
    ) -> Result<Option<Vec<f64>>, Error> {
        self.check(motion)?;
        let parts = groups.iter().map(|group| {
            let mut part = DVector::zeros(self.matrix.nrows());
            for &i in *group {
                part.axpy(motion[i], &self.matrix.column(i), 1.0);
            }
            part
        });
        Ok(shares(&(&self.matrix * motion), parts))
    }

    /// Share of dX that each constraint requires; `None` where dX vanishes.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`].
    pub fn shares_by_constraints(
        &self,
        motion: &DVector<f64>,
        constraints: &[usize],
    ) -> Result<Option<Vec<f64>>, Error> {
        self.check(motion)?;
        let violated = &self.constraint_jacobian * motion;
        let parts = constraints.iter().map(|&s| self.by_constraint.column(s) * violated[s]);
        Ok(shares(&(&self.matrix * motion), parts))
    }

    fn check(&self, motion: &DVector<f64>) -> Result<(), Error> {
        let (found, expected) = (motion.len(), self.matrix.ncols());
        if found == expected {
            Ok(())
        } else {
            Err(Error::LengthMismatch { what: "the motion", found, expected })
        }
    }
}

fn shares(whole: &DVector<f64>, parts: impl Iterator<Item = DVector<f64>>) -> Option<Vec<f64>> {
    let squared = whole.norm_squared();
    let shares: Vec<f64> = parts.map(|part| part.dot(whole) / squared).collect();
    shares.iter().all(|share| share.is_finite()).then_some(shares)
}
