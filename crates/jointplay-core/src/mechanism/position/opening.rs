//! Loops opened at a joint, and what moves either side.

use super::walk::{Frame, Walk};

#[derive(Debug, Clone)]
pub(super) struct TreeEdge {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) walk: Walk,
}

/// A loop opened at a joint, and the two sides that have to meet.
#[derive(Debug, Clone)]
pub(super) struct Closing {
    pub(super) links: [usize; 2],
    pub(super) sides: [Walk; 2],
    pub(super) meeting: Meeting,
    pub(super) row: usize,
    /// Unknowns that move one side only, and the sense in which they change the mismatch.
    pub(super) moved_by: Vec<(usize, f64, usize)>,
    /// The two sides, as they stand.
    pub(super) frames: [Frame; 2],
}

/// What of the two sides of a loop has to meet.
#[derive(Debug, Clone, Copy)]
pub(super) enum Meeting {
    /// The origins, in which of the balls.
    Points(usize),
    /// The origins and the z axes, in the hinge of a coordinate.
    Axes(usize),
    /// All.
    Frames,
}

impl Meeting {
    pub(super) fn equations(self) -> usize {
        match self {
            Self::Points(_) => 3,
            Self::Axes(_) => 5,
            Self::Frames => 6,
        }
    }
}

/// Unknowns on the way to one side of a loop but not the other.
pub(super) fn moved_by(
    tree: &[TreeEdge],
    links: [usize; 2],
    sides: &[Walk; 2],
) -> Vec<(usize, f64, usize)> {
    let way = |side: usize| {
        let mut columns: Vec<usize> = sides[side].columns().collect();
        let mut link = links[side];
        while let Some(branch) = tree.iter().find(|branch| branch.to == link) {
            columns.extend(branch.walk.columns());
            link = branch.from;
        }
        columns
    };
    let ways = [way(0), way(1)];
    let only = |side: usize, sense: f64| {
        let other = &ways[1 - side];
        let here = ways[side].iter().filter(|column| !other.contains(column));
        here.map(move |&column| (column, sense, side)).collect::<Vec<_>>()
    };
    [only(0, 1.0), only(1, -1.0)].concat()
}
