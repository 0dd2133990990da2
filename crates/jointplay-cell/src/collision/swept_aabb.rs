//! Axis-aligned boxes that contain a collision object over a step.

use crate::geometry::Interval;

/// Boxes around the path of a collision object, one after the other, with edges along the axes of the base frame.
#[derive(Debug)]
pub(crate) struct SweptAabb {
    /// Box around all parts.
    pub(super) whole: [Interval; 3],
    pub(super) parts: Vec<[Interval; 3]>,
}

impl SweptAabb {
    /// Adds the boxes of a later window.
    pub(crate) fn join(&mut self, next: Self) {
        self.whole = union(self.whole, next.whole);
        self.parts.extend(next.parts);
    }

    /// One box around several paths; `None` for none.
    pub(crate) fn union<'a>(paths: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let whole = paths.map(|path| path.whole).reduce(union)?;
        Some(Self { whole, parts: vec![whole] })
    }

    /// Whether a part is within a distance of a box, axis by axis (m).
    pub(crate) fn is_within(&self, other: &[Interval; 3], distance: f64) -> bool {
        let is_near = |part: &[Interval; 3]| (0..3).all(|k| part[k].gap(other[k]) <= distance);
        is_near(&self.whole) && self.parts.iter().any(is_near)
    }
}

/// The least box that contains both.
pub(super) fn union(one: [Interval; 3], other: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|k| one[k].union(other[k]))
}
