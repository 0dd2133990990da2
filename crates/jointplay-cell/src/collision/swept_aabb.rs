//! Axis-aligned boxes around the path of a collision object.

use crate::geometry::Span;

/// The room around a way: boxes one after the other, axes those of the base.
#[derive(Debug)]
pub(crate) struct Around {
    pub(super) whole: [Span; 3],
    pub(super) parts: Vec<[Span; 3]>,
}

impl Around {
    /// Adds the boxes of a later window.
    pub(crate) fn join(&mut self, next: Self) {
        self.whole = with(self.whole, next.whole);
        self.parts.extend(next.parts);
    }

    /// Around them all, in one box.
    pub(crate) fn all<'a>(of: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let whole = of.map(|around| around.whole).reduce(with)?;
        Some(Self { whole, parts: vec![whole] })
    }

    /// Whether it may come as near to a box as that.
    pub(crate) fn comes_near(&self, other: &[Span; 3], reach: f64) -> bool {
        let near = |part: &[Span; 3]| (0..3).all(|k| part[k].gap(other[k]) <= reach);
        near(&self.whole) && self.parts.iter().any(near)
    }
}

/// The least box that holds both.
pub(super) fn with(one: [Span; 3], other: [Span; 3]) -> [Span; 3] {
    std::array::from_fn(|k| one[k].with(other[k]))
}
