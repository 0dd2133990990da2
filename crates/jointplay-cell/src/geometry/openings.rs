//! Boxes with openings, as unions of boxes.

use super::shape::AxisAlignedBox;
use crate::CellError;
use crate::conditions::{count, lengths};

/// Distance of two faces below which they are one (m).
const MIN_THICKNESS: f64 = 1e-9;

/// Largest number of openings of a box.
pub const MAX_OPENINGS: usize = 16;

/// The part of a box outside of its openings, as boxes that share faces and have no common interior.
///
/// ```text
///    box \ ∪ openings  =  ∪ boxes      up to faces
/// ```
/// The coordinates of the faces are those of the arguments; faces closer than 1 nm are one, so that no box is thinner.
///
/// # Arguments
/// * `openings` – boxes that are removed; they may extend beyond the box
///
/// # Errors
/// [`CellError::OutOfRange`]: more than [`MAX_OPENINGS`]. [`CellError::OpeningOutside`]: an opening without common interior with the box. [`CellError::NothingLeft`]: the openings remove the whole box.
///
/// # Numerics
/// The planes of all faces cut the box into cells, each of which is solid or removed; solid cells are merged along x, then y, then z.
pub fn box_with_openings(
    outer: &AxisAlignedBox,
    openings: &[AxisAlignedBox],
) -> Result<Vec<AxisAlignedBox>, CellError> {
    count("the openings of a box", openings.len(), 0, MAX_OPENINGS)?;
    for AxisAlignedBox { min, max } in openings.iter().chain([outer]) {
        lengths("a corner of a box or of its opening", min)?;
        lengths("a corner of a box or of its opening", max)?;
    }
    for (index, opening) in openings.iter().enumerate() {
        let common = |k: usize| outer.max[k].min(opening.max[k]) - outer.min[k].max(opening.min[k]);
        if (0..3).any(|k| common(k) < MIN_THICKNESS) {
            return Err(CellError::OpeningOutside { index });
        }
    }
    let mut openings = openings.to_vec();
    let cuts: [Vec<f64>; 3] = std::array::from_fn(|k| {
        let mut cuts = vec![outer.min[k], outer.max[k]];
        for opening in &mut openings {
            for end in [&mut opening.min[k], &mut opening.max[k]] {
                match cuts.iter().find(|cut| (*end - **cut).abs() < MIN_THICKNESS) {
                    Some(cut) => *end = *cut,
                    None => cuts.push(*end),
                }
            }
        }
        cuts.retain(|cut| (outer.min[k]..=outer.max[k]).contains(cut));
        cuts.sort_by(f64::total_cmp);
        cuts
    });
    let mut cells = Cells::new(&cuts, &openings);
    let mut boxes = Vec::new();
    while let Some(first) = cells.first_solid() {
        let last = cells.take_block(first);
        boxes.push(AxisAlignedBox {
            min: std::array::from_fn(|k| cuts[k][first[k]]),
            max: std::array::from_fn(|k| cuts[k][last[k] + 1]),
        });
    }
    if boxes.is_empty() { Err(CellError::NothingLeft) } else { Ok(boxes) }
}

/// Cells between cutting planes; a cell is identified by its indices along the axes.
struct Cells {
    counts: [usize; 3],
    is_solid: Vec<bool>,
}

impl Cells {
    fn new(cuts: &[Vec<f64>; 3], openings: &[AxisAlignedBox]) -> Self {
        let counts = [0, 1, 2].map(|k| cuts[k].len() - 1);
        let mut cells = Self { counts, is_solid: vec![true; counts.iter().product()] };
        for index in 0..cells.is_solid.len() {
            let at = cells.position(index);
            let contains = |opening: &AxisAlignedBox| {
                (0..3).all(|k| {
                    opening.min[k] <= cuts[k][at[k]] && cuts[k][at[k] + 1] <= opening.max[k]
                })
            };
            cells.is_solid[index] = !openings.iter().any(contains);
        }
        cells
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn position(&self, index: usize) -> [usize; 3] {
        let [x, y, _] = self.counts;
        [index % x, index / x % y, index / (x * y)]
    }

    fn first_solid(&self) -> Option<[usize; 3]> {
        self.is_solid.iter().position(|&solid| solid).map(|index| self.position(index))
    }

    /// Removes a block of solid cells that begins at a cell; returns its last cell.
    fn take_block(&mut self, first: [usize; 3]) -> [usize; 3] {
        let mut last = first;
        for k in 0..3 {
            while last[k] + 1 < self.counts[k] {
                let (mut from, mut to) = (first, last);
                (from[k], to[k]) = (last[k] + 1, last[k] + 1);
                if !block(from, to).all(|cell| self.is_solid[self.index(cell)]) {
                    break;
                }
                last[k] += 1;
            }
        }
        for cell in block(first, last) {
            let index = self.index(cell);
            self.is_solid[index] = false;
        }
        last
    }
}

/// All cells between two, both included.
fn block(first: [usize; 3], last: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (first[2]..=last[2]).flat_map(move |z| {
        (first[1]..=last[1]).flat_map(move |y| (first[0]..=last[0]).map(move |x| [x, y, z]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn about(center: [f64; 3], size: [f64; 3]) -> AxisAlignedBox {
        AxisAlignedBox {
            min: std::array::from_fn(|k| center[k] - size[k] / 2.0),
            max: std::array::from_fn(|k| center[k] + size[k] / 2.0),
        }
    }

    #[test]
    fn a_wall_with_a_slit_is_four_boxes() {
        let wall = about([0.0; 3], [0.5, 0.02, 0.4]);
        let slit = about([0.0, 0.0, 0.05], [0.36, 0.1, 0.05]);
        let boxes = box_with_openings(&wall, &[slit]).unwrap();
        assert_eq!(boxes.len(), 4, "{boxes:?}");
        let volume: f64 = boxes.iter().map(AxisAlignedBox::volume).sum();
        assert!((volume - 0.02 * (0.5 * 0.4 - 0.36 * 0.05)).abs() < 1e-15);
    }

    #[test]
    fn round_off_leaves_no_sheets() {
        let wall = about([0.0; 3], [0.5, 0.02, 0.3]);
        // As wide as the wall, but for the last digits.
        let gap = about([1e-17, 0.0, 0.0], [0.1 + 0.4 - 1e-16, 0.1, 0.1]);
        assert_eq!(box_with_openings(&wall, &[gap]).unwrap().len(), 2);
    }

    #[test]
    fn a_box_without_openings_remains() {
        let solid = about([1.0, 2.0, 3.0], [1.0; 3]);
        assert_eq!(box_with_openings(&solid, &[]).unwrap(), [solid]);
    }

    #[test]
    fn openings_outside_and_openings_that_remove_everything_are_rejected() {
        let solid = about([0.0; 3], [1.0; 3]);
        let inside = about([0.0; 3], [0.5; 3]);
        // It touches a face of the box from outside.
        let outside = about([1.0, 0.0, 0.0], [1.0; 3]);
        let found = box_with_openings(&solid, &[inside, outside]);
        assert_eq!(found, Err(CellError::OpeningOutside { index: 1 }));
        let found = box_with_openings(&solid, &[about([0.0; 3], [1.0, 2.0, 3.0])]);
        assert_eq!(found, Err(CellError::NothingLeft));
        assert!(box_with_openings(&solid, &[inside; MAX_OPENINGS + 1]).is_err());
    }

    prop_compose! {
        fn any_box()(ends in prop::array::uniform3(prop::array::uniform2(-9_i8..=9))) -> AxisAlignedBox {
            AxisAlignedBox {
                min: ends.map(|[a, b]| f64::from(a.min(b))),
                max: ends.map(|[a, b]| f64::from(a.max(b)) + 1.0),
            }
        }
    }

    proptest! {
        /// Points between the planes are in exactly one of the boxes, or in an opening.
        #[test]
        fn boxes_are_disjoint_and_cover_exactly_what_the_openings_leave(
            outer in any_box(),
            openings in prop::collection::vec(any_box(), 0..6),
            points in prop::collection::vec(prop::array::uniform3(-10_i8..=10), 200),
        ) {
            let overlaps = |opening: &AxisAlignedBox| {
                (0..3).all(|k| opening.min[k] < outer.max[k] && outer.min[k] < opening.max[k])
            };
            let openings: Vec<_> = openings.into_iter().filter(overlaps).collect();
            let boxes = match box_with_openings(&outer, &openings) {
                Ok(boxes) => boxes,
                Err(CellError::NothingLeft) => Vec::new(),
                Err(error) => panic!("{error}"),
            };
            for point in points {
                let point = point.map(|value| f64::from(value) + 0.5);
                let holds = |one: &AxisAlignedBox| {
                    (0..3).all(|k| (one.min[k]..one.max[k]).contains(&point[k]))
                };
                let solid = holds(&outer) && !openings.iter().any(holds);
                let count = boxes.iter().filter(|one| holds(one)).count();
                prop_assert_eq!(count, usize::from(solid));
            }
        }
    }
}
