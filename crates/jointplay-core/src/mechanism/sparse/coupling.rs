//! Couplings linearized in the twists of the links.

use nalgebra::{DVector, Vector6};

use super::block_cholesky::{Block, BlockMatrix, BlockPattern, EMPTY, Place};
use crate::mechanism::coupling_rows::{CouplingRow, coupling_rows};
use crate::mechanism::kinematics::Kinematics;

/// A coupling, with the joint of each of its coordinates.
#[derive(Debug, Clone)]
pub(super) struct SparseCoupling {
    row: CouplingRow,
    joints: Vec<usize>,
    /// Moving links of these joints, ascending, each once.
    links: Vec<usize>,
}

/// The couplings of a mechanism.
///
/// # Arguments
/// * `length` – characteristic length (m)
pub(super) fn sparse_couplings(kinematics: &Kinematics<'_>, length: f64) -> Vec<SparseCoupling> {
    let mechanism = kinematics.mechanism();
    let rows = coupling_rows(kinematics, length).into_iter();
    let couplings = rows.zip(mechanism.couplings()).map(|(row, coupling)| {
        let joints: Vec<usize> = coupling.coordinates().map(|one| one.joint).collect();
        let ends = joints.iter().flat_map(|&joint| mechanism.joints()[joint].links);
        let mut links: Vec<usize> = ends.filter(|&link| link != 0).collect();
        links.sort_unstable();
        links.dedup();
        SparseCoupling { row, joints, links }
    });
    couplings.collect()
}

impl SparseCoupling {
    /// Violation, in radians and characteristic lengths.
    pub(super) fn residual(&self, coordinates: &DVector<f64>) -> f64 {
        self.row.residual(|k| coordinates[k])
    }

    /// Pairs of different moving links that it connects, counted without the base.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        pairs(self.links.len()).map(|[a, b]| [self.links[a] - 1, self.links[b] - 1])
    }

    /// The coupling linearized at the joints of a mechanism.
    ///
    /// # Arguments
    /// * `by_twists` – for a joint and a coordinate: its two links, each with the derivative of the coordinate by the six numbers of its twist; nothing where the coordinate does not follow
    pub(super) fn linear(
        &self,
        by_twists: impl Fn(usize, usize) -> Option<[(usize, Vector6<f64>); 2]>,
    ) -> LinearCoupling {
        let mut gradients = vec![Vector6::zeros(); self.links.len()];
        for (&j, &(k, factor)) in self.joints.iter().zip(&self.row.entries) {
            for (link, derivative) in by_twists(j, k).into_iter().flatten() {
                // The base has no place.
                if let Ok(place) = self.links.binary_search(&link) {
                    gradients[place] += derivative * factor;
                }
            }
        }
        let gradient = self.links.iter().copied().zip(gradients).collect();
        LinearCoupling { gradient, terms: self.row.entries.clone() }
    }
}

/// Pairs of a number of links, the larger first.
fn pairs(links: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..links).flat_map(|a| (0..a).map(move |b| [a, b]))
}

/// A coupling in the twists of the links.
///
/// ```text
///    g · x  =  −violation − Σ factor · q̇        q̇: rates of the coordinates at x = 0
/// ```
#[derive(Debug, Clone)]
pub(super) struct LinearCoupling {
    /// Links, with the six derivatives by the twist of each.
    gradient: Vec<(usize, Vector6<f64>)>,
    /// Index and factor of each coordinate.
    terms: Vec<(usize, f64)>,
}

impl LinearCoupling {
    /// g · x.
    pub(super) fn apply(&self, x: &[f64]) -> f64 {
        let along = |&(link, ref gradient): &(usize, Vector6<f64>)| {
            (0..6).map(|axis| gradient[axis] * x[6 * (link - 1) + axis]).sum::<f64>()
        };
        self.gradient.iter().map(along).sum()
    }

    /// Adds g · y to a vector of twists.
    pub(super) fn add_transposed(&self, y: f64, x: &mut DVector<f64>) {
        for &(link, ref gradient) in &self.gradient {
            (0..6).for_each(|axis| x[6 * (link - 1) + axis] += gradient[axis] * y);
        }
    }

    /// Change of the violation by rates of coordinates (m, rad).
    pub(super) fn change(&self, rates: &DVector<f64>) -> f64 {
        self.terms.iter().map(|&(k, factor)| factor * rates[k]).sum()
    }

    /// Adds g gᵀ to the normal equations.
    ///
    /// # Arguments
    /// * `places` – of the blocks of [`SparseCoupling::pairs`]
    pub(super) fn add_to(
        &self,
        matrix: &mut BlockMatrix,
        pattern: &BlockPattern,
        places: &[Place],
    ) {
        for (link, gradient) in &self.gradient {
            matrix.add_diagonal(pattern, link - 1, &product(gradient, gradient));
        }
        for ([a, b], &place) in pairs(self.gradient.len()).zip(places) {
            matrix.add(place, &product(&self.gradient[a].1, &self.gradient[b].1));
        }
    }
}

/// a bᵀ
fn product(a: &Vector6<f64>, b: &Vector6<f64>) -> Block {
    let mut block = EMPTY;
    for (column, factor) in block.iter_mut().zip(b.iter()) {
        for (entry, value) in column.iter_mut().zip(a.iter()) {
            *entry = value * factor;
        }
    }
    block
}
