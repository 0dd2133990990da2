//! A column of numbers in memory of the caller.

use std::ops::Range;

use pulp::Simd;

use crate::Error;
use crate::kernel::{Lanes, MOST};

/// Numbers to be read, one for each pose: contiguous, every n-th of a slice, or one for all.
#[derive(Debug, Clone, Copy)]
pub struct Column<'a> {
    values: &'a [f64],
    stride: usize,
    len: usize,
}

impl<'a> Column<'a> {
    /// `len` numbers, each `stride` after the last; a stride of 0 takes the first for all.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if the slice ends before the last of them.
    pub fn strided(values: &'a [f64], stride: usize, len: usize) -> Result<Self, Error> {
        let needed =
            len.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(1));
        match needed {
            Some(needed) if needed <= values.len() => Ok(Self { values, stride, len }),
            _ => Err(Error::LengthMismatch {
                what: "a column",
                found: values.len(),
                expected: needed.unwrap_or(usize::MAX),
            }),
        }
    }

    /// The same number `len` times.
    #[must_use]
    pub fn constant(value: &'a f64, len: usize) -> Self {
        Self { values: std::slice::from_ref(value), stride: 0, len }
    }

    /// How many numbers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number `index`, in the unit of what the column holds.
    ///
    /// # Panics
    /// If there is no such number.
    #[must_use]
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        assert!(index < self.len, "a column of {} has no entry {index}", self.len);
        self.values[index * self.stride]
    }

    /// The column in blocks of as many entries as a register holds.
    #[inline(always)]
    pub(super) fn blocks<S: Simd>(self, simd: S) -> ColumnBlocks<'a, S> {
        let contiguous = if self.stride == 1 { &self.values[..self.len] } else { &[] };
        let (registers, _) = S::as_simd_f64s(contiguous);
        let same = match self.values {
            [first, ..] if self.stride == 0 => Some(Lanes::splat(simd, *first)),
            _ => None,
        };
        ColumnBlocks { registers, same, column: self }
    }

    /// The entries from `first` on, side by side; beyond the end the last one again.
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, first: usize) -> Lanes<S> {
        let mut numbers = [0.0; MOST];
        self.gather(first, &mut numbers[..Lanes::<S>::COUNT]);
        Lanes::of(simd, &numbers[..Lanes::<S>::COUNT])
    }

    /// The entries from `first` on; beyond the end the last one again.
    // Apart from the loops over blocks, whose registers its indices would take.
    #[inline(never)]
    fn gather(&self, first: usize, numbers: &mut [f64]) {
        for (lane, number) in numbers.iter_mut().enumerate() {
            *number = self.at((first + lane).min(self.len - 1));
        }
    }

    /// Some of the numbers.
    ///
    /// # Panics
    /// If the range exceeds the column.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        assert!(
            range.start <= range.end && range.end <= self.len,
            "a column of {} has no part {range:?}",
            self.len
        );
        let first = (range.start * self.stride).min(self.values.len());
        Self { values: &self.values[first..], stride: self.stride, len: range.len() }
    }
}

/// A column in blocks.
pub(super) struct ColumnBlocks<'a, S: Simd> {
    /// The whole blocks of a contiguous column; none of another.
    registers: &'a [S::f64s],
    /// The entries of every block, where all of them are the same.
    same: Option<Lanes<S>>,
    column: Column<'a>,
}

impl<S: Simd> ColumnBlocks<'_, S> {
    /// The entries of a block; beyond the end the last one again.
    #[inline(always)]
    pub(super) fn block(&self, simd: S, block: usize) -> Lanes<S> {
        match (self.registers.get(block), self.same) {
            (Some(register), _) => Lanes::from_register(simd, *register),
            (None, Some(same)) => same,
            (None, None) => self.column.lanes(simd, block * Lanes::<S>::COUNT),
        }
    }

    /// Whether whole blocks are read from the column itself.
    #[inline(always)]
    pub(super) fn contiguous(&self) -> bool {
        self.column.stride == 1
    }

    /// Consecutive blocks: of the column itself, or copied to a buffer.
    #[inline(always)]
    pub(super) fn some<'b>(
        &'b self,
        simd: S,
        blocks: Range<usize>,
        buffer: &'b mut [S::f64s],
    ) -> &'b [S::f64s] {
        if let Some(registers) = self.registers.get(blocks.clone()) {
            return registers;
        }
        let copies = &mut buffer[..blocks.len()];
        for (copy, block) in copies.iter_mut().zip(blocks) {
            *copy = self.block(simd, block).register();
        }
        copies
    }
}

impl<'a> From<&'a [f64]> for Column<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self { values, stride: 1, len: values.len() }
    }
}

/// Whether every column is as long as the column of statuses.
pub(super) fn same_lengths(
    expected: usize,
    found: impl IntoIterator<Item = (&'static str, usize)>,
) -> Result<(), Error> {
    for (what, found) in found {
        if found != expected {
            return Err(Error::LengthMismatch { what, found, expected });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(column: Column<'_>, expected: &[f64]) {
        assert_eq!((column.len(), column.is_empty()), (expected.len(), expected.is_empty()));
        let found: Vec<f64> = (0..column.len()).map(|i| column.at(i)).collect();
        assert_eq!(found, expected);
        for start in 0..=expected.len() {
            for end in start..=expected.len() {
                let part = column.part(start..end);
                let found: Vec<f64> = (0..part.len()).map(|i| part.at(i)).collect();
                assert_eq!(found, expected[start..end]);
            }
        }
    }

    #[test]
    fn contiguous_strided_and_constant() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        check(Column::from(&values[..]), &values);
        check(Column::strided(&values[1..], 3, 2).unwrap(), &[2.0, 5.0]);
        check(Column::strided(&values, 0, 3).unwrap(), &[1.0, 1.0, 1.0]);
        check(Column::constant(&values[3], 2), &[4.0, 4.0]);
        check(Column::strided(&[], 7, 0).unwrap(), &[]);
    }

    #[test]
    fn slices_that_end_too_early() {
        for (stride, len) in [(3, 3), (0, 1), (usize::MAX, 3)] {
            let values: &[f64] = if stride == 0 { &[] } else { &[1.0; 5] };
            assert!(matches!(
                Column::strided(values, stride, len),
                Err(Error::LengthMismatch { .. })
            ));
        }
    }
}
