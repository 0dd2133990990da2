//! Sets of candidates for virtual joints, and their linear estimates.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use super::suggest_options::SuggestOptions;
use crate::Error;
use crate::linalg::svd;

/// Symmetric sets: the most that are compared of each kind of symmetry.
const MAX_SYMMETRIC: usize = 2_000;
/// A set that leaves more than this share of what is asked, by the linear estimate, is not tried.
const LEFT_OPEN: f64 = 0.1;

/// Mismatch that the virtual joints have to close for a command.
pub(super) struct Need {
    /// (open) mismatch that no passive joint can close.
    pub(super) open: DVector<f64>,
    /// (open, M) effect of the virtual joints on it.
    pub(super) relieving: DMatrix<f64>,
}

/// Which symmetries a set was formed from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Orbits under the symmetries of the mechanism.
    Mechanism,
    /// Orbits under those of its symmetries that map the commands onto each other.
    Commands,
    /// Single candidates.
    Any,
}

/// A set of candidates by their indices, in increasing order.
pub(super) struct Set {
    pub(super) members: Vec<usize>,
    pub(super) kind: Kind,
}

/// Candidates, and which of them may be in one set.
pub(super) struct Class {
    /// Candidates with an effect on some command.
    pub(super) useful: Vec<usize>,
    /// (candidates, candidates) whether two may be in one set.
    pub(super) compatible: Vec<Vec<bool>>,
    /// Orbits of the candidates under groups of symmetries.
    pub(super) orbits: Vec<(Kind, Vec<Vec<usize>>)>,
}

/// The sets of a class.
pub(super) struct Searched {
    pub(super) sets: Vec<Set>,
    pub(super) cut_short: bool,
    pub(super) in_class: f64,
}

impl Class {
    fn allows(&self, members: &[usize]) -> bool {
        members
            .iter()
            .enumerate()
            .all(|(n, &a)| members[..n].iter().all(|&b| self.compatible[a][b]))
    }

    /// Unions of orbits, then sets of single candidates up to as many as there are directions to relieve.
    pub(super) fn sets(&self, needs: &[Need], options: &SuggestOptions) -> Searched {
        let most = options.joints.unwrap_or(usize::MAX);
        let directions = needs.iter().map(|need| need.relieving.nrows()).max().unwrap_or(0);
        let (mut sets, mut cut_short, mut in_class) = (Vec::new(), false, 0.0);
        let mut known: BTreeSet<Vec<usize>> = BTreeSet::new();
        let mut chosen: Vec<usize> = Vec::new();
        for (kind, orbits) in &self.orbits {
            let useful = |orbit: &&Vec<usize>| orbit.iter().any(|k| self.useful.contains(k));
            let orbits: Vec<&Vec<usize>> =
                orbits.iter().filter(useful).filter(|orbit| self.allows(orbit)).collect();
            let mut compared = 0;
            for count in 1..=directions.min(orbits.len()) {
                in_class += choices(orbits.len(), count);
                combinations(orbits.len(), count, &mut chosen, 0, &mut |picked| {
                    let mut members: Vec<usize> =
                        picked.iter().flat_map(|&n| orbits[n]).copied().collect();
                    members.sort_unstable();
                    if compared >= MAX_SYMMETRIC.min(options.limit) {
                        cut_short = true;
                        return false;
                    }
                    if members.len() <= most
                        && self.allows(&members)
                        && known.insert(members.clone())
                    {
                        compared += 1;
                        sets.push(Set { members, kind: *kind });
                    }
                    true
                });
            }
        }
        for size in 1..=directions.min(self.useful.len()).min(most) {
            if options.symmetric_only {
                break;
            }
            in_class += choices(self.useful.len(), size);
            combinations(self.useful.len(), size, &mut chosen, 0, &mut |picked| {
                let members: Vec<usize> = picked.iter().map(|&n| self.useful[n]).collect();
                if sets.len() >= options.limit {
                    cut_short = true;
                    return false;
                }
                if self.allows(&members) && !known.contains(&members) {
                    sets.push(Set { members, kind: Kind::Any });
                }
                true
            });
        }
        Searched { sets, cut_short, in_class }
    }
}

/// Number of subsets with `size` of `count` elements: the binomial coefficient.
#[expect(clippy::cast_precision_loss, reason = "counts of joints")]
fn choices(count: usize, size: usize) -> f64 {
    (0..size).map(|k| (count - k) as f64 / (k + 1) as f64).product::<f64>().round()
}

/// All combinations of `size` of `count`; ends when `visit` returns `false`.
fn combinations(
    count: usize,
    size: usize,
    chosen: &mut Vec<usize>,
    from: usize,
    visit: &mut impl FnMut(&[usize]) -> bool,
) -> bool {
    if chosen.len() == size {
        return visit(chosen);
    }
    for next in from..count {
        chosen.push(next);
        let go_on = combinations(count, size, chosen, next + 1, visit);
        chosen.pop();
        if !go_on {
            return false;
        }
    }
    true
}

/// Largest linear least-norm displacement over the commands, if the set spans what they ask.
pub(super) fn estimate(needs: &[Need], members: &[usize]) -> Result<Option<f64>, Error> {
    let mut size = 0.0_f64;
    for Need { open, relieving } in needs {
        let part = relieving.select_columns(members);
        let decomposition = svd(&part)?;
        let y = decomposition.solve(open, decomposition.rank(1e-6));
        if (&part * &y - open).norm() > LEFT_OPEN * open.norm() {
            return Ok(None);
        }
        size = size.max(y.norm());
    }
    Ok(Some(size))
}
