//! Some of many poses of the three-rod robot, computed at a time.

use std::array;

use jointplay::Error;
use jointplay::bulk::{Column, PoseSolver, Quantity, Status};

use crate::transform::ENTRIES;
use crate::virtualization::JP_MAX_VIRTUAL_JOINTS;

/// Most sets that are computed at a time: their results take 35 kB of the stack, and columns of this length begin in different sets of the level-1 cache.
pub(crate) const BLOCK: usize = 240;

/// Entries of a transform that differ between poses: its first three rows.
const COMPUTED: [Quantity; 12] = [
    Quantity::Rotation(0, 0),
    Quantity::Rotation(0, 1),
    Quantity::Rotation(0, 2),
    Quantity::Origin(0),
    Quantity::Rotation(1, 0),
    Quantity::Rotation(1, 1),
    Quantity::Rotation(1, 2),
    Quantity::Origin(1),
    Quantity::Rotation(2, 0),
    Quantity::Rotation(2, 1),
    Quantity::Rotation(2, 2),
    Quantity::Origin(2),
];

/// Columns of results.
const COLUMNS: usize = COMPUTED.len() + JP_MAX_VIRTUAL_JOINTS;

/// Results of up to [`BLOCK`] sets of rods.
pub(crate) struct Block {
    /// Entries of the transforms, then displacements of the virtual joints, zero beyond their number.
    columns: [[f64; BLOCK]; COLUMNS],
    status: [Status; BLOCK],
}

impl Block {
    pub(crate) fn new() -> Self {
        Self { columns: [[0.0; BLOCK]; COLUMNS], status: [Status::Solved; BLOCK] }
    }

    /// Computes the poses of at most [`BLOCK`] sets, with so many virtual joints.
    ///
    /// # Errors
    /// Those of [`PoseSolver::forward_many`].
    pub(crate) fn compute(
        &mut self,
        solver: &PoseSolver,
        sets: &[[f64; 3]],
        virtual_joints: usize,
    ) -> Result<(), Error> {
        let rods = sets.as_flattened();
        let rods = [0, 1, 2].map(|k| Column::strided(rods.get(k..).unwrap_or(&[]), 3, sets.len()));
        let [q_1, q_2, q_3] = rods;
        let mut columns = self.columns.iter_mut().enumerate();
        let mut wanted: [(Quantity, &mut [f64]); COLUMNS] = array::from_fn(|_| {
            let (k, column) = columns.next().unwrap_or_else(|| unreachable!("as many as columns"));
            let displacement = || Quantity::VirtualDisplacement(k - COMPUTED.len());
            let quantity = COMPUTED.get(k).copied().unwrap_or_else(displacement);
            (quantity, &mut column[..sets.len()])
        });
        let wanted = &mut wanted[..COMPUTED.len() + virtual_joints];
        solver.forward_many([q_1?, q_2?, q_3?], &mut self.status[..sets.len()], wanted).map(drop)
    }

    /// Whether a set has a pose; its results are NaN otherwise.
    pub(crate) fn is_solved(&self, set: usize) -> bool {
        self.status[set] == Status::Solved
    }

    /// Transform of a set by rows.
    #[inline]
    pub(crate) fn transform(&self, set: usize) -> [f64; ENTRIES] {
        array::from_fn(|k| match self.columns[..COMPUTED.len()].get(k) {
            Some(column) => column[set],
            None if self.is_solved(set) => f64::from(u8::from(k == ENTRIES - 1)),
            None => f64::NAN,
        })
    }

    /// Displacements of the virtual joints of a set.
    #[inline]
    pub(crate) fn virtual_joints(&self, set: usize) -> [f64; JP_MAX_VIRTUAL_JOINTS] {
        array::from_fn(|k| match self.is_solved(set) {
            true => self.columns[COMPUTED.len() + k][set],
            false => f64::NAN,
        })
    }
}
