//! Loops opened at a joint, and the unknowns that move either side.

use super::frame::Frame;
use super::walk::Walk;

/// A joint of the spanning tree: from one link to the next.
#[derive(Debug, Clone)]
pub(super) struct TreeEdge {
    pub(super) from: usize,
    pub(super) to: usize,
    /// Index of the frame from which it is walked.
    pub(super) start: usize,
    pub(super) walk: Walk,
}

/// A loop opened at a joint, and the two sides that have to meet.
#[derive(Debug, Clone)]
pub(super) struct Closing {
    pub(super) links: [usize; 2],
    /// Indices of the frames from which the sides are walked.
    pub(super) starts: [usize; 2],
    pub(super) sides: [Walk; 2],
    pub(super) meeting: Meeting,
    pub(super) row: usize,
    /// Unknowns that move one side only.
    pub(super) moved_by: Vec<SideUnknown>,
    /// Current frames of the two sides.
    pub(super) frames: [Frame; 2],
}

/// An unknown that moves one side of a loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct SideUnknown {
    /// Column of the unknown.
    pub(super) column: usize,
    /// Sense in which it changes the mismatch: 1 for the first side, −1 for the second.
    pub(super) sense: f64,
    /// Index of the side.
    pub(super) side: usize,
}

/// Parts of the two sides of a loop that have to coincide.
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

/// Unknowns that move one side of a loop but not the other.
pub(super) fn moved_by(
    tree: &[TreeEdge],
    links: [usize; 2],
    sides: &[Walk; 2],
) -> Vec<SideUnknown> {
    let columns_to = |side: usize| {
        let mut columns: Vec<usize> = sides[side].columns().collect();
        let mut link = links[side];
        while let Some(branch) = tree.iter().find(|branch| branch.to == link) {
            columns.extend(branch.walk.columns());
            link = branch.from;
        }
        columns
    };
    let sides = [columns_to(0), columns_to(1)];
    let only = |side: usize, sense: f64| {
        let other = &sides[1 - side];
        let here = sides[side].iter().filter(|column| !other.contains(column));
        here.map(move |&column| SideUnknown { column, sense, side }).collect::<Vec<_>>()
    };
    [only(0, 1.0), only(1, -1.0)].concat()
}
