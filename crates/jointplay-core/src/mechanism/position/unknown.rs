//! Unknowns of a position solver, and the couplings among its equations.

use crate::mechanism::coupling_rows::CouplingRow;

/// A coupling as one of the equations.
#[derive(Debug, Clone)]
pub(super) struct CoupledRow {
    pub(super) equation: CouplingRow,
    /// Columns of its coordinates, with their factors.
    pub(super) columns: Vec<(usize, f64)>,
    pub(super) row: usize,
}

/// A ball joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub(super) coordinate: usize,
    /// Its first column, if it is in the tree and moves.
    pub(super) column: Option<usize>,
    /// Whether a loop is opened there.
    pub(super) opened: bool,
}

impl Ball {
    /// Whether it keeps its coordinates.
    pub(super) fn is_commanded(&self) -> bool {
        self.column.is_none() && !self.opened
    }
}

/// A coordinate that is solved for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unknown {
    pub(super) coordinate: usize,
    /// One unit of it: a radian or a characteristic length, or for a virtual joint a unit of the metric that is no longer than these.
    pub(super) unit: f64,
}
