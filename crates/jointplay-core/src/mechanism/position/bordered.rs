//! Equations of all loops, of which most unknowns move one loop only.
//!
//! ```text
//!    ⎛ A_1            B_1 ⎞        A_i: (equations of loop i, unknowns that move loop i only)
//!    ⎜      A_2       B_2 ⎟        B_i: unknowns that move several loops, and virtual joints
//!    ⎝           …    …   ⎠
//! ```
//! Each A_i is reflected to a triangle by itself; the equations that are then left involve the border alone.
//! A parallel robot of six legs with fifteen equations leaves five.

use super::elimination::{DEPENDENT, Elimination, LONG_ENOUGH, reflect};
use super::opening::Closing;
use super::unknown::CoupledRow;
use crate::mechanism::ReliefSolver;

/// Linear equations of a step, and room for their solution.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`
#[derive(Debug, Clone)]
pub(super) struct Bordered {
    /// (rows) −r, with the equations of each loop next to each other; used up by a solution.
    pub(super) right: Vec<f64>,
    /// (passive + virtuals) the step.
    pub(super) step: Vec<f64>,
    passive: usize,
    loops: Vec<LoopBlock>,
    /// Rows and columns of couplings, with their entries.
    coupled: Vec<(usize, Vec<(usize, f64)>)>,
    /// Passive columns that are never eliminated loop by loop.
    border: Vec<usize>,
    /// Place of each column within the border: passive ones, then virtual ones.
    place: Vec<usize>,
    /// Loop and position of those own columns that a loop by itself does not determine, which follow the border in the rest.
    deferred: Vec<(usize, usize)>,
    rest: Elimination,
}

/// The equations of one loop.
#[derive(Debug, Clone)]
struct LoopBlock {
    row: usize,
    equations: usize,
    /// Passive columns that move this loop only, then all others that move it.
    columns: Vec<usize>,
    /// Number of own columns.
    own: usize,
    /// (equations, columns) by columns; once reflected the triangle with its mirrors below.
    matrix: Vec<f64>,
    /// Own column at each position.
    order: Vec<usize>,
    /// First entry of each mirror, which the triangle leaves no room for, and twice the inverse of its square.
    mirrors: Vec<[f64; 2]>,
    /// How many own columns are reflected.
    rank: usize,
}

impl Bordered {
    /// Lays out the equations, and sorts the unknowns of each loop as its columns are.
    ///
    /// # Arguments
    /// * `passive`, `virtuals` – numbers of columns
    pub(super) fn new(
        closings: &mut [Closing],
        couplings: &[CoupledRow],
        passive: usize,
        virtuals: usize,
    ) -> Self {
        let unknowns = passive + virtuals;
        let mut uses = vec![0; unknowns];
        for moved in closings.iter().flat_map(|closing| &closing.moved_by) {
            if let Some(uses) = uses.get_mut(moved.column) {
                *uses += 1;
            }
        }
        let entries = |row: &CoupledRow| -> Vec<(usize, f64)> {
            row.columns.iter().copied().filter(|(column, _)| *column < unknowns).collect()
        };
        let coupled: Vec<_> = couplings.iter().map(|row| (row.row, entries(row))).collect();
        let mut is_own: Vec<bool> =
            (0..unknowns).map(|column| column < passive && uses[column] == 1).collect();
        for (column, _) in coupled.iter().flat_map(|(_, entries)| entries) {
            is_own[*column] = false;
        }
        let loops: Vec<LoopBlock> = closings
            .iter_mut()
            .map(|closing| {
                // Own unknowns first, and what is recorded only last.
                closing.moved_by.sort_by_key(|moved| {
                    (moved.column >= unknowns, is_own.get(moved.column) != Some(&true))
                });
                let columns = closing.moved_by.iter().map(|moved| moved.column);
                let columns: Vec<usize> = columns.filter(|&column| column < unknowns).collect();
                let own = columns.iter().filter(|&&column| is_own[column]).count();
                let equations = closing.meeting.equations();
                LoopBlock {
                    row: closing.row,
                    equations,
                    matrix: vec![0.0; equations * columns.len()],
                    order: vec![0; own],
                    mirrors: vec![[0.0; 2]; own],
                    own,
                    columns,
                    rank: 0,
                }
            })
            .collect();
        let border: Vec<usize> = (0..passive).filter(|&column| !is_own[column]).collect();
        let mut place = vec![usize::MAX; unknowns];
        border.iter().enumerate().for_each(|(k, &column)| place[column] = k);
        (passive..unknowns).enumerate().for_each(|(v, column)| place[column] = v);
        let rows = loops.iter().map(|block| block.equations).sum::<usize>() + coupled.len();
        Self {
            right: vec![0.0; rows],
            step: vec![0.0; unknowns],
            passive,
            loops,
            coupled,
            deferred: Vec::with_capacity(passive - border.len()),
            rest: Elimination::new(rows, passive, virtuals),
            border,
            place,
        }
    }

    /// Number of equations.
    pub(super) fn rows(&self) -> usize {
        self.right.len()
    }

    /// The entries of a loop's equations for each of the unknowns that move it.
    #[inline]
    pub(super) fn columns_mut(&mut self, closing: usize) -> impl Iterator<Item = &mut [f64]> {
        let block = &mut self.loops[closing];
        block.matrix.chunks_exact_mut(block.equations)
    }

    /// Factors the equations; `units` are those of the columns of couplings.
    pub(super) fn factor(&mut self, unit: impl Fn(usize) -> f64) {
        let square = |column: &[f64]| column.iter().map(|value| value * value).sum::<f64>();
        let mut largest = 0.0_f64;
        for block in &self.loops {
            largest = match block.equations {
                3 => block.longest::<3>(largest),
                5 => block.longest::<5>(largest),
                _ => block.longest::<6>(largest),
            };
        }
        for &(column, factor) in self.coupled.iter().flat_map(|(_, entries)| entries) {
            largest = largest.max((factor * unit(column)).powi(2));
        }
        let largest = largest.sqrt();
        self.deferred.clear();
        let mut rows = self.coupled.len();
        for (l, block) in self.loops.iter_mut().enumerate() {
            match block.equations {
                3 => block.reflect::<3>(LONG_ENOUGH * largest),
                5 => block.reflect::<5>(LONG_ENOUGH * largest),
                _ => block.reflect::<6>(LONG_ENOUGH * largest),
            }
            rows += block.equations - block.rank;
            for position in block.rank..block.own {
                let column = &block.matrix[position * block.equations..][..block.equations];
                if square(&column[block.rank..]).sqrt() > DEPENDENT * largest {
                    self.deferred.push((l, position));
                }
            }
        }
        let (border, deferred) = (self.border.len(), self.deferred.len());
        let passive = border + deferred;
        self.rest.resize(rows, passive);
        if passive + self.rest.virtuals() == 0 {
            return;
        }
        let matrix = &mut self.rest.matrix[..rows * (passive + self.step.len() - self.passive)];
        matrix.fill(0.0);
        let in_rest = |column: usize| {
            let virtuals = if column < self.passive { 0 } else { passive };
            virtuals + self.place[column]
        };
        let (mut first, mut next) = (0, 0);
        for (l, block) in self.loops.iter().enumerate() {
            let open = block.equations - block.rank;
            let mut copy = |position: usize, to: usize| {
                let entries = &block.matrix[position * block.equations + block.rank..][..open];
                matrix[to * rows + first..][..open].copy_from_slice(entries);
            };
            for (position, &column) in block.columns.iter().enumerate().skip(block.own) {
                copy(position, in_rest(column));
            }
            while let Some(&(_, position)) = self.deferred.get(next).filter(|(of, _)| *of == l) {
                copy(position, border + next);
                next += 1;
            }
            first += open;
        }
        for (k, (_, entries)) in self.coupled.iter().enumerate() {
            for &(column, factor) in entries {
                matrix[in_rest(column) * rows + first + k] = factor * unit(column);
            }
        }
        self.rest.factor(largest);
    }

    /// Solves for the step with the equations as factored; `y` are the virtual joints in their metric.
    pub(super) fn solve(&mut self, y: &[f64], solver: ReliefSolver) {
        let mut first = 0;
        for block in &mut self.loops {
            let right = &mut self.right[block.row..block.row + block.equations];
            match block.equations {
                3 => block.reflect_right::<3>(right),
                5 => block.reflect_right::<5>(right),
                _ => block.reflect_right::<6>(right),
            }
            let open = &right[block.rank..];
            self.rest.right[first..first + open.len()].copy_from_slice(open);
            first += open.len();
        }
        for (k, (row, _)) in self.coupled.iter().enumerate() {
            self.rest.right[first + k] = self.right[*row];
        }
        self.step.fill(0.0);
        let passive = self.border.len() + self.deferred.len();
        if passive + self.rest.virtuals() > 0 {
            self.rest.solve(y, solver);
            let (of_passive, of_virtuals) = self.rest.step().split_at(passive);
            for (&column, step) in self.border.iter().zip(of_passive) {
                self.step[column] = *step;
            }
            for (&(l, position), step) in self.deferred.iter().zip(&of_passive[self.border.len()..])
            {
                self.step[self.loops[l].own_column(position)] = *step;
            }
            self.step[self.passive..].copy_from_slice(of_virtuals);
        }
        for block in &self.loops {
            block.substitute(&mut self.right[block.row..], &mut self.step);
        }
    }
}

/// How the equations of one configuration were eliminated: an order for those of others nearby.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EliminationPlan {
    pub(super) loops: Vec<LoopPlan>,
    /// Passive columns of what remains: those of several loops, then loop and position of own columns left over; the first `rank` are eliminated.
    pub(super) rest: Vec<RestColumn>,
    pub(super) rank: usize,
    /// Rows of couplings with their entries.
    pub(super) coupled: Vec<(usize, Vec<(usize, f64)>)>,
}

/// A column of the equations that remain when each loop is eliminated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RestColumn {
    /// A column of several loops, or of couplings.
    Border(usize),
    /// Of a loop the own column at a position in its order.
    Deferred(usize, usize),
}

/// How the equations of one loop were eliminated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LoopPlan {
    pub(super) row: usize,
    pub(super) equations: usize,
    /// All columns that move the loop; own ones first.
    pub(super) columns: Vec<usize>,
    /// Own columns, as positions in `columns`; the first `rank` are eliminated.
    pub(super) order: Vec<usize>,
    pub(super) rank: usize,
}

impl Bordered {
    /// The order of the last elimination.
    pub(super) fn plan(&self) -> EliminationPlan {
        let loops = self.loops.iter().map(|block| LoopPlan {
            row: block.row,
            equations: block.equations,
            columns: block.columns.clone(),
            order: block.order.clone(),
            rank: block.rank,
        });
        let border = self.border.iter().map(|&column| RestColumn::Border(column));
        let deferred = self.deferred.iter().map(|&(l, position)| RestColumn::Deferred(l, position));
        let columns: Vec<RestColumn> = border.chain(deferred).collect();
        let (order, rank) = self.rest.elimination_order();
        let rest = order.iter().map(|&column| columns[column]).collect();
        EliminationPlan { loops: loops.collect(), rest, rank, coupled: self.coupled.clone() }
    }
}

impl LoopBlock {
    /// The column of the own unknown at a position.
    fn own_column(&self, position: usize) -> usize {
        self.columns[self.order[position]]
    }

    /// The square of the longest column, or of a longer one.
    #[inline(always)]
    fn longest<const E: usize>(&self, longer: f64) -> f64 {
        let (columns, _) = self.matrix.as_chunks::<E>();
        columns.iter().fold(longer, |largest, column| {
            let square = column.iter().map(|value| value * value).sum::<f64>();
            if square > largest { square } else { largest }
        })
    }

    /// Reflects own columns of at least some length to a triangle, and all others along.
    #[inline(always)]
    fn reflect<const E: usize>(&mut self, least: f64) {
        let (columns, _) = self.matrix.as_chunks_mut::<E>();
        for (k, place) in self.order.iter_mut().enumerate() {
            *place = k;
        }
        self.rank = 0;
        let least = least * least;
        for k in 0..E.min(self.own) {
            let below =
                |column: &[f64; E]| column[k..].iter().map(|value| value * value).sum::<f64>();
            let (mut best, mut square) = (k, below(&columns[k]));
            if square.partial_cmp(&least) != Some(std::cmp::Ordering::Greater) {
                for (position, column) in columns[..self.own].iter().enumerate().skip(k + 1) {
                    let other = below(column);
                    if other > square {
                        (best, square) = (position, other);
                    }
                }
                // Also where it is NaN.
                if square.partial_cmp(&least) != Some(std::cmp::Ordering::Greater) {
                    return;
                }
            }
            if best != k {
                columns.swap(k, best);
                self.order.swap(k, best);
            }
            let (left, right) = columns.split_at_mut(k + 1);
            let mirror = &mut left[k];
            let (norm, head) = (square.sqrt(), mirror[k]);
            let onto = -norm.copysign(head);
            mirror[k] = head - onto;
            let scale = 1.0 / (norm * (norm + head.abs()));
            for column in right {
                reflect(&mut column[k..], &mirror[k..], scale);
            }
            self.mirrors[k] = [mirror[k], scale];
            mirror[k] = onto;
            self.rank = k + 1;
        }
    }

    #[inline(always)]
    fn reflect_right<const E: usize>(&self, right: &mut [f64]) {
        let (columns, _) = self.matrix.as_chunks::<E>();
        for (k, column) in columns.iter().enumerate().take(self.rank) {
            let [head, scale] = self.mirrors[k];
            let mut mirror = *column;
            mirror[k] = head;
            reflect(&mut right[k..E], &mirror[k..], scale);
        }
    }

    /// The own columns, for the steps of all others.
    #[inline(always)]
    fn substitute(&self, right: &mut [f64], step: &mut [f64]) {
        let e = self.equations;
        let right = &mut right[..self.rank];
        let others =
            (self.own..self.columns.len()).map(|position| (position, self.columns[position]));
        let deferred = (self.rank..self.own).map(|position| (position, self.own_column(position)));
        for (position, column) in others.chain(deferred) {
            let by = step[column];
            if by != 0.0 {
                let entries = &self.matrix[position * e..];
                right.iter_mut().zip(entries).for_each(|(entry, a)| *entry -= a * by);
            }
        }
        for k in (0..self.rank).rev() {
            let column = &self.matrix[k * e..];
            let value = right[k] / column[k];
            step[self.own_column(k)] = value;
            right[..k].iter_mut().zip(column).for_each(|(entry, a)| *entry -= a * value);
        }
    }
}
