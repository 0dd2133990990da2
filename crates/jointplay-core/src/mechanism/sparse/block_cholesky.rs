//! Cholesky factorization of a symmetric matrix of 6×6 blocks: one row of blocks for each link, one pair of blocks for each joint.
//!
//! The factors of mechanisms have a few blocks in a column, too few for the dense kernels of a general sparse library; of scalar entries they have as many indices as numbers.
#![allow(clippy::needless_range_loop, reason = "indices are those of the equations")]

use std::collections::BTreeSet;

use crate::Error;

/// Rows of a block.
const SIDE: usize = 6;

/// Most blocks of a factor below its diagonal: 288 MB.
const MAX_BLOCKS: usize = 1_000_000;

/// A 6×6 block by columns.
pub(super) type Block = [[f64; SIDE]; SIDE];

/// The numbers of a row of blocks in several columns.
pub(super) type Row<const COLUMNS: usize> = [[f64; COLUMNS]; SIDE];

/// No entries.
pub(super) const EMPTY: Block = [[0.0; SIDE]; SIDE];

/// The matrix has a direction in which it is not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NotPositive;

/// Where a block of the lower triangle is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    index: usize,
    /// Whether the block is stored transposed.
    transposed: bool,
}

/// Order of elimination, and the blocks of the factor below its diagonal; they depend on the graph only.
#[derive(Debug, Clone)]
pub(super) struct BlockPattern {
    /// Position of each row of blocks in the order of elimination.
    position: Vec<usize>,
    /// Row of blocks at each position.
    order: Vec<usize>,
    /// First stored block of each column, by positions, and their number behind the last.
    starts: Vec<usize>,
    /// Row of each stored block, ascending within a column.
    rows: Vec<usize>,
}

impl BlockPattern {
    /// The pattern for a number of rows of blocks, and pairs of rows that have a block off the diagonal.
    ///
    /// # Numerics
    /// Minimum degree: next is the row with the fewest blocks, the first of several; when it is eliminated, each two of its neighbours have a block in common.
    ///
    /// # Source
    /// \[Davis\], section 7.1
    ///
    /// # Errors
    /// [`Error::TooConnected`] beyond [`MAX_BLOCKS`].
    pub(super) fn new(size: usize, pairs: impl Iterator<Item = [usize; 2]>) -> Result<Self, Error> {
        let mut neighbours = vec![BTreeSet::new(); size];
        // Blocks of the factor, of eliminated rows and of those that are left.
        let mut blocks = 0;
        for [a, b] in pairs.filter(|[a, b]| a != b) {
            blocks += usize::from(neighbours[a].insert(b));
            neighbours[b].insert(a);
            check_number(blocks)?;
        }
        let mut next: BTreeSet<(usize, usize)> =
            neighbours.iter().enumerate().map(|(row, others)| (others.len(), row)).collect();
        let (mut order, mut columns) = (Vec::with_capacity(size), Vec::with_capacity(size));
        while let Some((_, row)) = next.pop_first() {
            let column = std::mem::take(&mut neighbours[row]);
            let mut added = 0;
            for &other in &column {
                let others = &mut neighbours[other];
                next.remove(&(others.len(), other));
                others.remove(&row);
                let before = others.len();
                others.extend(column.iter().filter(|&&third| third != other));
                added += others.len() - before;
                next.insert((others.len(), other));
            }
            blocks += added / 2;
            check_number(blocks)?;
            order.push(row);
            columns.push(column);
        }
        let mut position = vec![0; size];
        order.iter().enumerate().for_each(|(place, &row)| position[row] = place);
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(blocks));
        for column in columns {
            let first = rows.len();
            rows.extend(column.into_iter().map(|row| position[row]));
            rows[first..].sort_unstable();
            starts.push(rows.len());
        }
        Ok(Self { position, order, starts, rows })
    }

    /// Number of rows of blocks.
    pub(super) fn size(&self) -> usize {
        self.order.len()
    }

    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        SIDE * self.size()
    }

    /// Where the block in a row and a column off the diagonal is stored; it must be one of the pairs.
    pub(super) fn place(&self, [row, column]: [usize; 2]) -> Place {
        let [row, column] = [self.position[row], self.position[column]];
        let transposed = row < column;
        let (row, column) = (row.max(column), row.min(column));
        let stored = &self.rows[self.starts[column]..self.starts[column + 1]];
        let index = stored.binary_search(&row).expect("the pattern has all pairs");
        Place { index: self.starts[column] + index, transposed }
    }
}

fn check_number(found: usize) -> Result<(), Error> {
    if found > MAX_BLOCKS {
        let what = "blocks of a sparse matrix";
        return Err(Error::TooConnected { what, found, allowed: MAX_BLOCKS });
    }
    Ok(())
}

/// A symmetric matrix, and once factored its Cholesky factor L.
///
/// ```text
///    A  =  L Lᵀ        the diagonal blocks of L are lower triangles, with the inverses of their diagonals
/// ```
#[derive(Debug, Clone)]
pub(super) struct BlockMatrix {
    diagonal: Vec<Block>,
    below: Vec<Block>,
}

impl BlockMatrix {
    /// The matrix without entries.
    pub(super) fn zeros(pattern: &BlockPattern) -> Self {
        Self { diagonal: vec![EMPTY; pattern.size()], below: vec![EMPTY; pattern.rows.len()] }
    }

    /// Removes all entries.
    pub(super) fn clear(&mut self) {
        self.diagonal.fill(EMPTY);
        self.below.fill(EMPTY);
    }

    /// Adds a block on the diagonal, of which the lower triangle is used.
    pub(super) fn add_diagonal(&mut self, pattern: &BlockPattern, row: usize, block: &Block) {
        let own = &mut self.diagonal[pattern.position[row]];
        for (own, added) in own.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
            *own += added;
        }
    }

    /// Adds a block off the diagonal.
    pub(super) fn add(&mut self, place: Place, block: &Block) {
        let own = &mut self.below[place.index];
        for column in 0..SIDE {
            for row in 0..SIDE {
                own[column][row] +=
                    if place.transposed { block[row][column] } else { block[column][row] };
            }
        }
    }

    /// Adds a number to all entries of the diagonal.
    pub(super) fn add_to_diagonal(&mut self, value: f64) {
        for block in &mut self.diagonal {
            (0..SIDE).for_each(|k| block[k][k] += value);
        }
    }

    /// Largest entry of the blocks that were added, without sign; NaN if one is.
    pub(super) fn largest(&self) -> f64 {
        let entries = self.diagonal.iter().chain(&self.below).flatten().flatten();
        entries.fold(0.0, |largest, &entry| {
            let size = entry.abs();
            if size > largest || size.is_nan() { size } else { largest }
        })
    }

    /// Factors in place.
    pub(super) fn factor(&mut self, pattern: &BlockPattern) -> Result<(), NotPositive> {
        for column in 0..pattern.size() {
            let (first, last) = (pattern.starts[column], pattern.starts[column + 1]);
            factor_triangle(&mut self.diagonal[column])?;
            let triangle = &self.diagonal[column];
            let (own, later) = self.below.split_at_mut(last);
            let own = &mut own[first..];
            own.iter_mut().for_each(|block| divide_by_transposed(block, triangle));
            let rows = &pattern.rows[first..last];
            for (k, (&row, block)) in rows.iter().zip(&*own).enumerate() {
                subtract_product(&mut self.diagonal[row], block, block);
                // All rows that follow are also in the column of this one.
                let mut at = pattern.starts[row];
                for (&next, other) in rows.iter().zip(&*own).skip(k + 1) {
                    while pattern.rows[at] != next {
                        at += 1;
                    }
                    subtract_product(&mut later[at - last], other, block);
                }
            }
        }
        Ok(())
    }

    /// A⁻¹ b by the factor, in place, for several b at a time: each block is read once for all.
    ///
    /// # Arguments
    /// * `b` – columns of 6·rows numbers, one after the other
    /// * `room` – one entry a row, overwritten
    pub(super) fn solve<const COLUMNS: usize>(
        &self,
        pattern: &BlockPattern,
        b: &mut [f64],
        room: &mut [Row<COLUMNS>],
    ) {
        let (b, _) = b.as_chunks_mut::<SIDE>();
        let rows = pattern.size();
        for (x, &row) in room.iter_mut().zip(&pattern.order) {
            *x = std::array::from_fn(|k| std::array::from_fn(|c| b[c * rows + row][k]));
        }
        for column in 0..rows {
            let (before, after) = room.split_at_mut(column + 1);
            let own = &mut before[column];
            let triangle = &self.diagonal[column];
            for k in 0..SIDE {
                own[k] = own[k].map(|value| value * triangle[k][k]);
                for row in k + 1..SIDE {
                    own[row] = less(own[row], triangle[k][row], own[k]);
                }
            }
            let stored = pattern.starts[column]..pattern.starts[column + 1];
            for (&row, block) in pattern.rows[stored.clone()].iter().zip(&self.below[stored]) {
                let entries = &mut after[row - column - 1];
                for (value, entries_of) in own.iter().zip(block) {
                    for (entry, &a) in entries.iter_mut().zip(entries_of) {
                        *entry = less(*entry, a, *value);
                    }
                }
            }
        }
        for column in (0..rows).rev() {
            let (before, after) = room.split_at_mut(column + 1);
            let own = &mut before[column];
            let stored = pattern.starts[column]..pattern.starts[column + 1];
            for (&row, block) in pattern.rows[stored.clone()].iter().zip(&self.below[stored]) {
                let entries = &after[row - column - 1];
                for (value, entries_of) in own.iter_mut().zip(block) {
                    for (x, &a) in entries.iter().zip(entries_of) {
                        *value = less(*value, a, *x);
                    }
                }
            }
            let triangle = &self.diagonal[column];
            for k in (0..SIDE).rev() {
                for row in k + 1..SIDE {
                    own[k] = less(own[k], triangle[k][row], own[row]);
                }
                own[k] = own[k].map(|value| value * triangle[k][k]);
            }
        }
        for (x, &row) in room.iter().zip(&pattern.order) {
            for (k, values) in x.iter().enumerate() {
                values.iter().enumerate().for_each(|(c, &value)| b[c * rows + row][k] = value);
            }
        }
    }
}

/// a − f b, for each column.
#[inline(always)]
fn less<const COLUMNS: usize>(
    mut a: [f64; COLUMNS],
    factor: f64,
    b: [f64; COLUMNS],
) -> [f64; COLUMNS] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= factor * b);
    a
}

/// Factors the lower triangle of a block, and inverts its diagonal.
fn factor_triangle(block: &mut Block) -> Result<(), NotPositive> {
    for k in 0..SIDE {
        let pivot = block[k][k];
        // Also where it is NaN.
        if pivot.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) || pivot.is_infinite() {
            return Err(NotPositive);
        }
        let inverse = 1.0 / pivot.sqrt();
        block[k][k] = inverse;
        for row in k + 1..SIDE {
            block[k][row] *= inverse;
        }
        for column in k + 1..SIDE {
            let factor = block[k][column];
            for row in column..SIDE {
                block[column][row] -= block[k][row] * factor;
            }
        }
    }
    Ok(())
}

/// B L⁻ᵀ in place, for a lower triangle with inverted diagonal.
fn divide_by_transposed(block: &mut Block, triangle: &Block) {
    for k in 0..SIDE {
        let (done, rest) = block.split_at_mut(k + 1);
        let own = &mut done[k];
        own.iter_mut().for_each(|value| *value *= triangle[k][k]);
        for (column, entries) in rest.iter_mut().enumerate() {
            let factor = triangle[k][k + 1 + column];
            for (entry, value) in entries.iter_mut().zip(&*own) {
                *entry -= value * factor;
            }
        }
    }
}

/// C − A Bᵀ in place.
#[inline(always)]
fn subtract_product(c: &mut Block, a: &Block, b: &Block) {
    for (column, entries) in c.iter_mut().enumerate() {
        let mut sum = *entries;
        for k in 0..SIDE {
            let factor = b[k][column];
            for (entry, value) in sum.iter_mut().zip(&a[k]) {
                *entry -= value * factor;
            }
        }
        *entries = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use nalgebra::DMatrix;

    /// Graphs whose factors have no new blocks, some, and all; links without joints.
    fn graphs() -> Vec<(usize, Vec<[usize; 2]>)> {
        let ring = |n: usize| (0..n).map(|k| [k, (k + 1) % n]).collect::<Vec<_>>();
        let grid = (0..5).flat_map(|x| {
            (0..5).flat_map(move |y| {
                [[5 * x + y, 5 * ((x + 1) % 5) + y], [5 * x + y, 5 * x + (y + 1) % 5]]
            })
        });
        let all = (0..7).flat_map(|a| (0..a).map(move |b| [a, b]));
        let star = (1..9).map(|k| [k, 0]);
        // The same pair more than once, in both orders; a joint of a link with itself.
        let twice = vec![[0, 1], [1, 0], [0, 1], [2, 2]];
        vec![
            (1, Vec::new()),
            (4, Vec::new()),
            (9, ring(9)),
            (25, grid.collect()),
            (7, all.collect()),
            (9, star.collect()),
            (4, twice),
        ]
    }

    #[test]
    fn solutions_are_those_of_the_dense_matrix() {
        for (size, pairs) in graphs() {
            let pattern = BlockPattern::new(size, pairs.iter().copied()).unwrap();
            let mut random = Random(7);
            let mut matrix = BlockMatrix::zeros(&pattern);
            let mut dense = DMatrix::<f64>::identity(6 * size, 6 * size) * 30.0;
            matrix.add_to_diagonal(30.0);
            for &[a, b] in &pairs {
                if a == b {
                    continue;
                }
                let mut block = EMPTY;
                block.as_flattened_mut().iter_mut().for_each(|entry| *entry = random.next());
                matrix.add(pattern.place([a, b]), &block);
                for (column, entries) in block.iter().enumerate() {
                    for (row, entry) in entries.iter().enumerate() {
                        dense[(6 * a + row, 6 * b + column)] += entry;
                        dense[(6 * b + column, 6 * a + row)] += entry;
                    }
                }
            }
            let mut symmetric = EMPTY;
            (0..SIDE).for_each(|k| (0..SIDE).for_each(|l| symmetric[k][l] = 0.1 * (k + l) as f64));
            matrix.add_diagonal(&pattern, size - 1, &symmetric);
            let mut corner = dense.fixed_view_mut::<6, 6>(6 * (size - 1), 6 * (size - 1));
            corner += nalgebra::Matrix6::from_fn(|k, l| symmetric[k][l]);
            assert_eq!(matrix.largest(), dense.amax(), "{pairs:?}");

            let expected = DMatrix::from_fn(6 * size, 3, |_, _| random.next());
            let given = &dense * &expected;
            matrix.factor(&pattern).unwrap();
            let mut found = given.clone();
            let mut room = vec![[[f64::NAN; 3]; SIDE]; size];
            matrix.solve(&pattern, found.as_mut_slice(), &mut room);
            assert!((&found - expected).amax() < 1e-13, "{pairs:?}");
            // One column alone is the same to the last bit.
            let mut alone = given.column(1).into_owned();
            let mut room = vec![[[f64::NAN; 1]; SIDE]; size];
            matrix.solve(&pattern, alone.as_mut_slice(), &mut room);
            assert_eq!(alone, found.column(1), "{pairs:?}");
        }
    }

    #[test]
    fn matrices_that_are_not_positive_are_refused() {
        let pattern = BlockPattern::new(2, std::iter::once([0, 1])).unwrap();
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut matrix = BlockMatrix::zeros(&pattern);
            matrix.add_to_diagonal(value);
            assert_eq!(matrix.factor(&pattern), Err(NotPositive), "{value}");
        }
        // Positive on its diagonal only.
        let mut matrix = BlockMatrix::zeros(&pattern);
        matrix.add_to_diagonal(1.0);
        matrix.add(pattern.place([1, 0]), &[[2.0; SIDE]; SIDE]);
        assert_eq!(matrix.factor(&pattern), Err(NotPositive));
    }

    #[test]
    fn a_long_ring_needs_few_new_blocks() {
        let ring = (0..1000).map(|k| [k, (k + 1) % 1000]);
        let pattern = BlockPattern::new(1000, ring).unwrap();
        assert!(pattern.rows.len() < 2000, "{}", pattern.rows.len());
    }

    #[test]
    fn blocks_beyond_the_memory_are_refused() {
        // 2,000 rows with a block in each pair are too many; so are 6,000 rows with three blocks each, whose factor is nearly full.
        let all = (0..2000).flat_map(|a| (0..a).map(move |b| [a, b]));
        let error = BlockPattern::new(2000, all).unwrap_err();
        let what = "blocks of a sparse matrix";
        assert_eq!(error, Error::TooConnected { what, found: MAX_BLOCKS + 1, allowed: MAX_BLOCKS });
        let mut random = Random(3);
        let mut row = || ((random.next() * 0.5 + 0.5) * 5999.0) as usize;
        let pairs: Vec<_> = (0..18_000).map(|_| [row(), row()]).collect();
        assert!(matches!(
            BlockPattern::new(6000, pairs.into_iter()),
            Err(Error::TooConnected { .. })
        ));
    }
}
