//! Linear equations of a step for many configurations side by side, eliminated in one order for all.

use pulp::Simd;

use super::bordered::{EliminationPlan, LoopPlan, RestColumn};
use super::elimination::DEPENDENT;
use crate::kernel::{Lanes, Mask};

/// Columns of which elimination leaves less than this share of the longest are not eliminated in the order of the plan: the configuration needs an order of its own.
const SHORTEST_PIVOT: f64 = 1e-3;

/// The equations, and room for their solution.
pub(super) struct LaneElimination<'a, S: Simd> {
    plan: &'a EliminationPlan,
    simd: S,
    /// For each loop (equations, columns) by columns: own ones in the order of the plan, then all others.
    loops: Vec<Vec<Lanes<S>>>,
    /// For each loop the position in its matrix of each of its columns.
    positions: Vec<Vec<usize>>,
    /// (rows, columns) of what remains, by columns in the order of the plan.
    rest: Vec<Lanes<S>>,
    /// Number of rows that remain.
    rows: usize,
    copied: Vec<Copied>,
    /// Entries of couplings in what remains: where, and column and factor.
    entries: Vec<(usize, usize, f64)>,
    /// (rows) −r.
    pub(super) right: Vec<Lanes<S>>,
    open: Vec<Lanes<S>>,
    /// (passive) the step.
    pub(super) step: Vec<Lanes<S>>,
}

/// Entries of a loop that are among the rest.
struct Copied {
    of: usize,
    from: usize,
    to: usize,
    count: usize,
}

impl<'a, S: Simd> LaneElimination<'a, S> {
    pub(super) fn new(simd: S, plan: &'a EliminationPlan, passive: usize) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let loops: Vec<Vec<Lanes<S>>> =
            plan.loops.iter().map(|one| vec![zero; one.equations * one.columns.len()]).collect();
        let positions = plan.loops.iter().map(|one| {
            let mut positions: Vec<usize> = (0..one.columns.len()).collect();
            one.order.iter().enumerate().for_each(|(at, &column)| positions[column] = at);
            positions
        });
        let rows = plan.loops.iter().map(|one| one.equations - one.rank).sum::<usize>()
            + plan.coupled.len();
        let all = plan.loops.iter().map(|one| one.equations).sum::<usize>() + plan.coupled.len();
        let (mut copied, mut entries) = (Vec::new(), Vec::new());
        for (c, column) in plan.rest.iter().enumerate() {
            let mut first = c * rows;
            for (l, one) in plan.loops.iter().enumerate() {
                let own = one.order.len();
                let position = match *column {
                    RestColumn::Border(column) => {
                        let border = one.columns[own..].iter().position(|&k| k == column);
                        border.map(|k| k + own)
                    }
                    RestColumn::Deferred(of, position) => (of == l).then_some(position),
                };
                let count = one.equations - one.rank;
                if let Some(position) = position {
                    let from = position * one.equations + one.rank;
                    copied.push(Copied { of: l, from, to: first, count });
                }
                first += count;
            }
            for (k, (_, coupled)) in plan.coupled.iter().enumerate() {
                let own = coupled.iter().filter(|(of, _)| *column == RestColumn::Border(*of));
                entries.extend(own.map(|&(of, factor)| (first + k, of, factor)));
            }
        }
        Self {
            plan,
            simd,
            copied,
            entries,
            positions: positions.collect(),
            loops,
            rest: vec![zero; rows * plan.rest.len()],
            rows,
            right: vec![zero; all],
            open: vec![zero; rows],
            step: vec![zero; passive],
        }
    }

    /// The entries of a loop's equations for one of the unknowns that move it.
    #[inline(always)]
    pub(super) fn column_mut(&mut self, closing: usize, column: usize) -> &mut [Lanes<S>] {
        let equations = self.plan.loops[closing].equations;
        let at = self.positions[closing][column] * equations;
        &mut self.loops[closing][at..at + equations]
    }

    /// Solves for the step; where the order of the plan serves.
    ///
    /// # Arguments
    /// * `unit` – of a column of couplings
    #[inline(always)]
    pub(super) fn solve(&mut self, unit: impl Fn(usize) -> f64) -> Mask<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        let mut largest = zero;
        for (matrix, plan) in self.loops.iter().zip(&self.plan.loops) {
            for column in matrix.chunks_exact(plan.equations) {
                largest = largest.max(sum_of_squares(zero, column));
            }
        }
        for &(column, factor) in self.plan.coupled.iter().flat_map(|(_, entries)| entries) {
            largest = largest.max(zero.like((factor * unit(column)).powi(2)));
        }
        let (least, most) = (largest * SHORTEST_PIVOT.powi(2), largest * DEPENDENT.powi(2));
        let mut serves = zero.at_most(largest);
        let mut first = 0;
        for (l, (matrix, plan)) in self.loops.iter_mut().zip(&self.plan.loops).enumerate() {
            let right = &mut self.right[plan.row..plan.row + plan.equations];
            let (rank, own) = (plan.rank, plan.order.len());
            serves = serves & triangulate(matrix, right, plan.equations, rank, least);
            for position in rank..own {
                // What is left of others is among the rest.
                if !self.plan.rest.contains(&RestColumn::Deferred(l, position)) {
                    let left = &matrix[position * plan.equations..][rank..plan.equations];
                    serves = serves & sum_of_squares(zero, left).at_most(most);
                }
            }
            let open = plan.equations - rank;
            self.open[first..first + open].copy_from_slice(&right[rank..]);
            first += open;
        }
        for (k, (row, _)) in self.plan.coupled.iter().enumerate() {
            self.open[first + k] = self.right[*row];
        }
        self.assemble_rest(zero, unit);
        let rank = self.plan.rank;
        serves = serves & triangulate(&mut self.rest, &mut self.open, self.rows, rank, least);
        for column in rank..self.plan.rest.len() {
            let left = &self.rest[column * self.rows..][rank..self.rows];
            serves = serves & sum_of_squares(zero, left).at_most(most);
        }
        self.substitute(zero);
        serves
    }

    #[inline(always)]
    fn assemble_rest(&mut self, zero: Lanes<S>, unit: impl Fn(usize) -> f64) {
        self.rest.fill(zero);
        for &Copied { of, from, to, count } in &self.copied {
            self.rest[to..to + count].copy_from_slice(&self.loops[of][from..from + count]);
        }
        for &(at, column, factor) in &self.entries {
            self.rest[at] = zero.like(factor * unit(column));
        }
    }

    #[inline(always)]
    fn substitute(&mut self, zero: Lanes<S>) {
        self.step.fill(zero);
        let plan = self.plan;
        let column_of = |column: RestColumn| match column {
            RestColumn::Border(column) => column,
            RestColumn::Deferred(l, position) => {
                let plan: &LoopPlan = &plan.loops[l];
                plan.columns[plan.order[position]]
            }
        };
        for k in (0..plan.rank).rev() {
            let column = &self.rest[k * self.rows..(k + 1) * self.rows];
            let value = self.open[k] / column[k];
            self.step[column_of(plan.rest[k])] = value;
            for (entry, a) in self.open[..k].iter_mut().zip(column) {
                *entry = a.times_from(value, *entry);
            }
        }
        for (matrix, one) in self.loops.iter().zip(&plan.loops) {
            let right = &mut self.right[one.row..one.row + one.rank];
            let own = one.order.len();
            let name = |position: usize| {
                one.columns[if position < own { one.order[position] } else { position }]
            };
            for position in one.rank..one.columns.len() {
                let by = self.step[name(position)];
                for (entry, a) in right.iter_mut().zip(&matrix[position * one.equations..]) {
                    *entry = a.times_from(by, *entry);
                }
            }
            for k in (0..one.rank).rev() {
                let column = &matrix[k * one.equations..];
                let value = right[k] / column[k];
                self.step[name(k)] = value;
                for (entry, a) in right[..k].iter_mut().zip(column) {
                    *entry = a.times_from(value, *entry);
                }
            }
        }
    }
}

/// Σ a².
#[inline(always)]
pub(super) fn sum_of_squares<S: Simd>(zero: Lanes<S>, column: &[Lanes<S>]) -> Lanes<S> {
    let mut sum = zero;
    for value in column {
        sum = value.times_plus(*value, sum);
    }
    sum
}

/// Reflects the first columns of a matrix to a triangle, all others and a right-hand side along; where all pivots have at least some squared length.
#[inline(always)]
fn triangulate<S: Simd>(
    matrix: &mut [Lanes<S>],
    right: &mut [Lanes<S>],
    rows: usize,
    rank: usize,
    least: Lanes<S>,
) -> Mask<S> {
    let zero = least.like(0.0);
    let mut serves = zero.at_most(least);
    for k in 0..rank {
        let (left, others) = matrix.split_at_mut((k + 1) * rows);
        let mirror = &mut left[k * rows + k..];
        let square = sum_of_squares(zero, mirror);
        serves = serves & least.at_most(square);
        let (norm, head) = (square.sqrt(), mirror[0]);
        let onto = head.below(zero).select(norm, -norm);
        mirror[0] = head - onto;
        let scale = (norm * (norm + head.abs())).inverse();
        for column in others.chunks_exact_mut(rows) {
            reflect(&mut column[k..], mirror, scale);
        }
        reflect(&mut right[k..rows], mirror, scale);
        mirror[0] = onto;
    }
    serves
}

/// Reflects a vector by a mirror; `scale` is twice the inverse of the mirror's square.
#[inline(always)]
fn reflect<S: Simd>(vector: &mut [Lanes<S>], mirror: &[Lanes<S>], scale: Lanes<S>) {
    let mut dot = scale.like(0.0);
    for (a, b) in mirror.iter().zip(&*vector) {
        dot = a.times_plus(*b, dot);
    }
    let factor = dot * scale;
    for (value, normal) in vector.iter_mut().zip(mirror) {
        *value = normal.times_from(factor, *value);
    }
}
