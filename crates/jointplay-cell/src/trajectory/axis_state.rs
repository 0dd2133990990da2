//! State of one coordinate, at one time and at many.

use std::ops::Range;

use crate::columns::map_rows;

/// Position, velocity, acceleration and jerk of one coordinate at one time.
pub(crate) type AxisState = [f64; 4];

/// States of one coordinate at many times: a column of positions, and one of each of their first three derivatives.
#[derive(Debug, Clone, Default)]
pub(crate) struct StateColumns {
    /// The memory is kept from one step to the next: there may be more rows than times.
    columns: [Vec<f64>; 4],
    count: usize,
}

impl StateColumns {
    /// A coordinate at rest in one position.
    pub(super) fn at_rest(position: f64, count: usize) -> Self {
        Self { columns: [position, 0.0, 0.0, 0.0].map(|value| vec![value; count]), count }
    }

    /// Changes the number of times; all states are still to be written.
    pub(super) fn resize(&mut self, count: usize) {
        self.count = count;
        for column in &mut self.columns {
            column.resize(column.len().max(count), 0.0);
        }
    }

    /// Columns of position, velocity, acceleration and jerk.
    pub(crate) fn columns(&self) -> [&[f64]; 4] {
        self.columns.each_ref().map(|column| &column[..self.count])
    }

    /// State at one of the times.
    pub(crate) fn at(&self, index: usize) -> AxisState {
        self.columns().map(|column| column[index])
    }

    /// Writes the state at one of the times.
    pub(super) fn set(&mut self, index: usize, state: AxisState) {
        for (column, value) in self.columns.iter_mut().zip(state) {
            column[index] = value;
        }
    }

    /// Writes one state at some of the times.
    pub(super) fn fill(&mut self, times: Range<usize>, state: AxisState) {
        for (column, value) in self.columns.iter_mut().zip(state) {
            column[times.clone()].fill(value);
        }
    }

    /// Writes the states at some of the times, each from its row of other columns.
    pub(super) fn map<const N: usize>(
        &mut self,
        times: Range<usize>,
        inputs: [&[f64]; N],
        state: impl Fn([f64; N]) -> AxisState,
    ) {
        let inputs = inputs.map(|column| &column[times.clone()]);
        let states = self.columns.each_mut().map(|column| &mut column[times.clone()]);
        map_rows(inputs, states, state);
    }
}
