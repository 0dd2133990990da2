//! Couplings that commanded coordinates contradict, and coordinates that couplings determine.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::coupling_rows::coupling_rows;
use super::kinematics::Kinematics;
use super::{MAX_DENSE, Mechanism};
use crate::Error;
use crate::constraint::CLOSURE_TOLERANCE;
use crate::linalg::svd;

/// Singular values, and shares of a coefficient that eliminations leave, up to this share of the largest are round-off.
const ROUND_OFF: f64 = 1e-9;

/// Names of the couplings that hold at the commanded values for no values of the other joints, the most violated first; empty beyond dense algebra.
///
/// # Arguments
/// * `length` – characteristic length (m)
/// * `coordinates` – at least the (f) coordinates of the joints, the commanded ones at their values (m, rad)
/// * `commanded` – indices of the commanded coordinates
pub(super) fn contradicted(
    kinematics: &Kinematics<'_>,
    length: f64,
    coordinates: &DVector<f64>,
    commanded: &[usize],
) -> Result<Vec<String>, Error> {
    let rows = coupling_rows(kinematics, length);
    let mut free: Vec<usize> =
        rows.iter().flat_map(|row| &row.entries).map(|&(coordinate, _)| coordinate).collect();
    free.retain(|coordinate| !commanded.contains(coordinate));
    free.sort_unstable();
    free.dedup();
    if rows.len().max(free.len()) > MAX_DENSE {
        return Ok(Vec::new());
    }
    let violation = rows.iter().map(|row| row.residual(|k| coordinates[k]));
    let mut left = DVector::from_iterator(rows.len(), violation);
    if !(rows.is_empty() || free.is_empty()) {
        let mut jacobian = DMatrix::zeros(rows.len(), free.len());
        for (r, row) in rows.iter().enumerate() {
            for &(k, factor) in &row.entries {
                if let Ok(column) = free.binary_search(&k) {
                    jacobian[(r, column)] = factor * kinematics.dimensions()[k].unit(length);
                }
            }
        }
        let decomposition = svd(&jacobian)?;
        let by = decomposition.solve(&left, decomposition.rank(ROUND_OFF));
        left -= jacobian * by;
    }
    let mut violated: Vec<usize> =
        (0..left.len()).filter(|&r| left[r].abs() > CLOSURE_TOLERANCE).collect();
    violated.sort_by(|&a, &b| left[b].abs().total_cmp(&left[a].abs()));
    let couplings = kinematics.mechanism().couplings();
    Ok(violated.into_iter().map(|r| couplings[r].name.clone()).collect())
}

/// Those of some coordinates that couplings determine from the driven coordinates and the others: as few as possible, the last ones first.
///
/// ```text
///    C q = d        a column of C in which an elimination has its pivot belongs to a determined coordinate
/// ```
///
/// # Arguments
/// * `driven` – indices of coordinates that have values of their own
/// * `candidates` – indices of the coordinates in question, ascending; all other coordinates are determined in preference
pub(super) fn determined(
    mechanism: &Mechanism,
    driven: &[usize],
    candidates: &[usize],
) -> Vec<usize> {
    // Rows without the driven coordinates, each with its determined coordinate; and the row of each determined coordinate.
    let mut rows: Vec<(usize, BTreeMap<usize, f64>)> = Vec::new();
    let mut row_of = BTreeMap::new();
    for row in coupling_rows(&Kinematics::new(mechanism), 1.0) {
        let entries = row.entries.into_iter().filter(|(k, _)| !driven.contains(k));
        let mut rest: BTreeMap<usize, f64> = entries.collect();
        let size = rest.values().fold(0.0_f64, |size, factor| size.max(factor.abs()));
        // A row has no determined coordinates of the rows before it, so that eliminations in order do not undo each other.
        while let Some(&next) = rest.keys().filter_map(|k| row_of.get(k)).min() {
            let (pivot, eliminated): &(usize, BTreeMap<usize, f64>) = &rows[next];
            let share = rest[pivot] / eliminated[pivot];
            for (&k, other) in eliminated {
                *rest.entry(k).or_insert(0.0) -= share * other;
            }
            rest.remove(pivot);
        }
        rest.retain(|_, factor| factor.abs() > ROUND_OFF * size);
        let rank = |k: usize| candidates.binary_search(&k).map_or(usize::MAX, |place| place);
        // Of coordinates that are no candidates the one with the largest factor, which loses least to round-off.
        let best = rest.iter().max_by(|(a, of_a), (b, of_b)| {
            rank(**a).cmp(&rank(**b)).then(of_a.abs().total_cmp(&of_b.abs()))
        });
        if let Some((&pivot, _)) = best {
            row_of.insert(pivot, rows.len());
            rows.push((pivot, rest));
        }
    }
    let mut found: Vec<usize> = row_of.into_keys().collect();
    found.retain(|pivot| candidates.binary_search(pivot).is_ok());
    found
}
