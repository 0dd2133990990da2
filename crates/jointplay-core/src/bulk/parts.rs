//! Many poses in parts, for several cores or between looks at something else.

use super::{Column, Status};

/// Some of the poses: what is read, their statuses, the columns that are written.
pub type Part<'a> = ([Column<'a>; 3], &'a mut [Status], Vec<&'a mut [f64]>);

/// The poses in parts of at most `most`, one after another.
///
/// Poses are independent of each other, so that the parts together equal the whole to the bit.
/// Columns of different lengths stay one part, whose computation reports the error.
///
/// # Arguments
/// * `given` – (3) columns of n numbers that are read
/// * `columns` – columns of n numbers that are written
/// * `most` – poses in a part; 0 counts as 1
#[must_use]
pub fn parts<'a>(
    given: [Column<'a>; 3],
    mut status: &'a mut [Status],
    mut columns: Vec<&'a mut [f64]>,
    most: usize,
) -> Vec<Part<'a>> {
    let (poses, most) = (status.len(), most.max(1));
    let uneven = given.iter().any(|column| column.len() != poses)
        || columns.iter().any(|column| column.len() != poses);
    if uneven || poses <= most {
        return vec![(given, status, columns)];
    }
    let mut parts = Vec::with_capacity(poses.div_ceil(most));
    let mut first = 0;
    while first < poses {
        let end = (first + most).min(poses);
        let (here, rest) = std::mem::take(&mut status).split_at_mut(end - first);
        let mut taken = Vec::with_capacity(columns.len());
        for column in &mut columns {
            let (here, rest) = std::mem::take(column).split_at_mut(end - first);
            taken.push(here);
            *column = rest;
        }
        parts.push((given.map(|column| column.part(first..end)), here, taken));
        (status, first) = (rest, end);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(poses: usize, written: usize, most: usize, expected: &[usize]) {
        let numbers: Vec<f64> = (0..poses).map(|k| k as f64).collect();
        let given = Column::from(&numbers[..]);
        let mut status = vec![Status::Solved; poses];
        let mut column = vec![0.0; written];
        let mut sizes = Vec::new();
        for (given, status, mut columns) in
            parts([given; 3], &mut status, vec![&mut column[..]], most)
        {
            sizes.push(status.len());
            for k in 0..status.len().min(columns[0].len()) {
                columns[0][k] = given[2].at(k);
            }
        }
        assert_eq!(sizes, expected);
        assert_eq!(column[..], numbers[..written]);
    }

    #[test]
    fn the_parts_are_the_whole() {
        check(10, 10, 4, &[4, 4, 2]);
        check(8, 8, 4, &[4, 4]);
        check(4, 4, 4, &[4]);
        check(3, 3, 0, &[1, 1, 1]);
        check(0, 0, 4, &[0]);
        // Lengths that do not agree.
        check(10, 9, 4, &[10]);
    }
}
