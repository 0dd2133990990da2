//! Second-order conditions on instantaneous motions.

use nalgebra::{DMatrix, DVector};

use super::InstantaneousMobility;
use crate::Error;
use crate::constraint::{Configuration, System, units};
use crate::linalg::svd;
use crate::random::Random;

/// Entries of the quadrics up to this share of the largest second derivative count as zero.
///
/// The quadrics are sums of a few products of orthonormal vectors, whose directions are known to about 10⁻¹⁰ where a rank was decided at 10⁻¹³.
const QUADRIC_THRESHOLD: f64 = 1e-8;

/// Steps of the search for a positive definite combination; a search that needs more ends as "none found", which only weakens the bound.
const COMBINATION_STEPS: usize = 400;

/// Starts and steps of the search for a direction on which all quadrics vanish, and the share of a direction that a step has to leave.
const ZERO_STARTS: usize = 3;
const ZERO_STEPS: usize = 20;
const LEAST_LEFT: f64 = 0.1;

/// Second-order conditions on the instantaneous motions.
///
/// Each self-stress s gives a quadric Q_s(a) = sᵀ Φ''[N a, N a] on the coordinates a of the null space; a finite motion has to start where all are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// (mobility, mobility) one symmetric matrix for each self-stress, dimensionless.
    pub quadrics: Vec<DMatrix<f64>>,
    /// Dimension of the motions on which every quadric vanishes identically together with its gradient.
    pub free: usize,
    /// (mobility, free) orthonormal basis of them.
    pub free_motions: DMatrix<f64>,
    /// Whether some combination of the quadrics is positive on all other motions, which stops them all.
    pub definite: bool,
    /// No finite motion has more freedoms.
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
            (_, true) => free,
            // One quadric that is not identically zero takes at least one dimension; one that is no product of planes shares no component with another, so that the two take two.
            (_, false) if has_irreducible_pair(&restricted, cut)? => mobility - 2,
            (_, false) => mobility - 1,
        };
        let free_motions = decomposition.v.columns(stopped, free).into_owned();
        Ok(Self { quadrics, free, free_motions, definite, upper_bound })
    }
}

/// Whether all quadrics vanish on some direction, as far as Newton's method finds one from a few starts.
fn have_common_zero(quadrics: &[DMatrix<f64>], cut: f64) -> Result<bool, Error> {
    let size = quadrics[0].nrows();
    let mut random = Random(6);
    for _ in 0..ZERO_STARTS {
        let start = DVector::from_fn(size, |_, _| random.next()).normalize();
        if zero_near(quadrics, start, cut)?.is_some() {
            return Ok(true);
        }
    }
    Ok(false)
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

fn zero_near(
    quadrics: &[DMatrix<f64>],
    mut there: DVector<f64>,
    cut: f64,
) -> Result<Option<DVector<f64>>, Error> {
    for _ in 0..ZERO_STEPS {
        let products: Vec<DVector<f64>> = quadrics.iter().map(|q| q * &there).collect();
        let values = products.iter().map(|product| product.dot(&there));
        let values = DVector::from_iterator(products.len(), values);
        if values.amax() <= cut {
            return Ok(Some(there));
        }
        let gradients = DMatrix::from_columns(&products).transpose() * 2.0;
        let decomposition = svd(&gradients)?;
        there -= decomposition.solve(&values, decomposition.rank(QUADRIC_THRESHOLD));
        let norm = there.norm();
        if norm < LEAST_LEFT {
            break;
        }
        there /= norm;
    }
    Ok(None)
}

/// Whether two of the quadrics are independent and some combination of them is of rank 3 or more, which makes it irreducible over the complex numbers.
///
/// # Source
/// Dimension of an intersection: \[CoxLittleOShea\], section 9.4
fn has_irreducible_pair(quadrics: &[DMatrix<f64>], cut: f64) -> Result<bool, Error> {
    let flat: Vec<DVector<f64>> =
        quadrics.iter().map(|quadric| DVector::from_column_slice(quadric.as_slice())).collect();
    let independent = svd(&DMatrix::from_columns(&flat))?;
    if independent.singular_values.iter().filter(|&&value| value > cut).count() < 2 {
        return Ok(false);
    }
    let mut random = Random(3);
    let size = quadrics[0].nrows();
    let mixed = quadrics
        .iter()
        .fold(DMatrix::zeros(size, size), |sum, quadric| sum + quadric * random.next());
    Ok(svd(&mixed)?.singular_values.iter().filter(|&&value| value > cut).count() >= 3)
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
