//! Second-order conditions on instantaneous motions.

use nalgebra::{DMatrix, DVector};

use super::InstantaneousMobility;
use super::common_zeros::{codimension, have_common_zero, zero_near};
use crate::Error;
use crate::constraint::{Configuration, System, units};
use crate::linalg::svd;

/// Entries of the quadrics up to this share of the largest second derivative count as zero.
///
/// The quadrics are sums of a few products of orthonormal vectors, whose directions are known to about 10⁻¹⁰ where a rank was decided at 10⁻¹³.
const QUADRIC_THRESHOLD: f64 = 1e-8;

/// Steps of the search for a positive definite combination; a search that needs more ends as "none found", which only weakens the bound.
const COMBINATION_STEPS: usize = 400;

/// Second-order conditions on the instantaneous motions.
///
/// Each self-stress s gives a quadric Q_s(a) = sᵀ Φ''[N a, N a] on the coordinates a of the null space; a finite motion has to start where all are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// (mobility, mobility) one symmetric matrix for each self-stress, dimensionless.
    pub quadrics: Vec<DMatrix<f64>>,
    /// Dimension of the motions that are in the null space of every quadric.
    pub free: usize,
    /// (mobility, free) orthonormal basis of the motions that are in the null space of every quadric.
    pub free_motions: DMatrix<f64>,
    /// Whether some combination of the quadrics is positive on all other motions, so that every finite motion is tangent to the free ones.
    ///
    /// This alone does not bound the dimension: x² + y² = z³ is a surface, and all its curves through the origin are tangent to the z axis.
    pub definite: bool,
    /// Largest possible dimension of the finite motions: that of the common complex zeros of the quadrics, and 0 where a combination is positive on all motions.
    pub upper_bound: usize,
}

pub(super) fn second_order<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    first: &InstantaneousMobility,
) -> Result<SecondOrder, Error> {
    SecondOrder::from_quadrics(quadrics(system, at, first), first.mobility)
}

impl SecondOrder {
    /// The conditions that follow from the quadrics of some motions.
    pub(crate) fn from_quadrics(
        quadrics: Vec<DMatrix<f64>>,
        mobility: usize,
    ) -> Result<Self, Error> {
        let largest = quadrics.iter().map(DMatrix::amax).fold(0.0, f64::max);
        let stacked = DMatrix::from_fn(mobility * quadrics.len(), mobility, |row, column| {
            quadrics[row / mobility][(row % mobility, column)]
        });
        let decomposition = svd(&stacked)?;
        // Against the largest possible quadric, not the largest found: a null result has to stay null.
        let cut = QUADRIC_THRESHOLD * largest.max(1.0);
        let stopped = decomposition.singular_values.iter().filter(|&&value| value > cut).count();
        let free = mobility - stopped;
        let directions = decomposition.v.columns(0, stopped);
        let restricted: Vec<DMatrix<f64>> =
            quadrics.iter().map(|quadric| directions.transpose() * quadric * directions).collect();
        // Where all vanish, no combination is positive: this takes a few steps to find, the other hundreds.
        let definite = stopped > 0
            && !have_common_zero(&restricted, cut)?
            && has_definite_combination(&restricted, cut);
        let upper_bound = match (stopped, definite) {
            (0, _) => mobility,
            (_, true) if free == 0 => 0,
            // Complex configurations have the dimension of their tangent cone, which lies in the common zeros.
            _ => mobility - codimension(&restricted, cut)?,
        };
        let free_motions = decomposition.v.columns(stopped, free).into_owned();
        Ok(Self { quadrics, free, free_motions, definite, upper_bound })
    }
}

/// A direction on which all quadrics vanish, found from a direction near it; `None` where Newton's method finds none.
pub(super) fn common_zero_near(
    quadrics: &[DMatrix<f64>],
    start: DVector<f64>,
) -> Result<Option<DVector<f64>>, Error> {
    let largest = quadrics.iter().map(DMatrix::amax).fold(1.0, f64::max);
    if quadrics.is_empty() {
        return Ok(None);
    }
    zero_near(quadrics, start, QUADRIC_THRESHOLD * largest)
}

/// sᵀ Φ''[N a, N b] for each self-stress, by polarisation.
pub(crate) fn quadrics<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    first: &InstantaneousMobility,
) -> Vec<DMatrix<f64>> {
    let rows = units(&system.constraint_dimensions(), first.characteristic_length);
    let columns = units(&system.coordinate_dimensions(), first.characteristic_length);
    let along = |direction: DVector<f64>| {
        system.second_derivative(at, &direction.component_mul(&columns)).component_div(&rows)
    };
    let h = first.mobility;
    let mut quadrics = vec![DMatrix::zeros(h, h); first.redundancy];
    for a in 0..h {
        for b in 0..=a {
            let (n_a, n_b) = (first.null_space.column(a), first.null_space.column(b));
            let mixed = (along(n_a + n_b) - along(n_a - n_b)) * 0.25;
            for (quadric, stress) in quadrics.iter_mut().zip(first.self_stress.column_iter()) {
                quadric[(a, b)] = stress.dot(&mixed);
                quadric[(b, a)] = quadric[(a, b)];
            }
        }
    }
    quadrics
}

/// Whether Σ λ_s Q_s is positive definite for some λ: ascent of its least eigenvalue, which is concave in λ.
fn has_definite_combination(quadrics: &[DMatrix<f64>], cut: f64) -> bool {
    let combine = |weights: &DVector<f64>| {
        let size = quadrics[0].nrows();
        quadrics
            .iter()
            .zip(weights)
            .fold(DMatrix::zeros(size, size), |sum, (quadric, weight)| sum + quadric * *weight)
    };
    // A positive definite combination has a positive trace: start along the traces, and in both senses of each quadric.
    let count = quadrics.len();
    let traces = DVector::from_iterator(count, quadrics.iter().map(DMatrix::trace));
    let mut starts = vec![traces];
    for s in 0..count {
        for sign in [1.0, -1.0] {
            let mut start = DVector::zeros(count);
            start[s] = sign;
            starts.push(start);
        }
    }
    starts.into_iter().filter(|start| start.norm() > cut).any(|start| {
        let mut weights = start.normalize();
        for step in 0..COMBINATION_STEPS {
            let eigen = combine(&weights).symmetric_eigen();
            let least = eigen.eigenvalues.imin();
            if eigen.eigenvalues[least] > cut {
                return true;
            }
            let direction = eigen.eigenvectors.column(least);
            let gradient = DVector::from_iterator(
                count,
                quadrics.iter().map(|quadric| direction.dot(&(quadric * direction))),
            );
            if gradient.norm() <= cut {
                return false;
            }
            #[expect(clippy::cast_precision_loss, reason = "a small counter")]
            let length = 1.0 / ((step + 2) as f64).sqrt();
            weights = (weights + gradient.normalize() * length).normalize();
        }
        false
    })
}
