//! From data to strokes: broken at gaps, cut at the frame, thinned to what shows.

use std::collections::BTreeSet;

/// A position on the page, right and down (px).
pub(crate) type Spot = (f64, f64);

/// Width of the columns and cells within which further points do not show (px).
const GRAIN: f64 = 0.5;

/// A rectangle on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    /// Left edge (px).
    pub(crate) x: f64,
    /// Upper edge (px).
    pub(crate) y: f64,
    /// Width (px).
    pub(crate) w: f64,
    /// Height (px).
    pub(crate) h: f64,
}

impl Rectangle {
    /// Right edge (px).
    pub(crate) fn right(&self) -> f64 {
        self.x + self.w
    }

    /// Lower edge (px).
    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.h
    }

    /// Whether the spot is inside or on the edge.
    pub(crate) fn contains(&self, (x, y): Spot) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Whether the two rectangles have points in common.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right()
            && other.x < self.right()
            && self.y < other.bottom()
            && other.y < self.bottom()
    }

    /// Whether the circle about `center` passes through the rectangle.
    pub(crate) fn meets_circle(&self, center: Spot, radius: f64) -> bool {
        let (left, right) = (self.x - center.0, self.right() - center.0);
        let (top, bottom) = (self.y - center.1, self.bottom() - center.1);
        let nearest = left.max(-right).max(0.0).hypot(top.max(-bottom).max(0.0));
        let farthest = left.abs().max(right.abs()).hypot(top.abs().max(bottom.abs()));
        (nearest..=farthest).contains(&radius)
    }

    /// The part of the stroke from `a` to `b` that is inside (clipping after Liang and Barsky).
    pub(crate) fn cut(&self, a: Spot, b: Spot) -> Option<(Spot, Spot)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        let edges = [
            (-dx, a.0 - self.x),
            (dx, self.right() - a.0),
            (-dy, a.1 - self.y),
            (dy, self.bottom() - a.1),
        ];
        for (outward, distance) in edges {
            if outward == 0.0 {
                if distance < 0.0 {
                    return None;
                }
            } else if outward < 0.0 {
                enter = enter.max(distance / outward);
            } else {
                leave = leave.min(distance / outward);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        // The ends themselves are kept exactly, so that strokes join up.
        (enter <= leave).then(|| {
            (if enter > 0.0 { at(enter) } else { a }, if leave < 1.0 { at(leave) } else { b })
        })
    }
}

/// Parameter in [0, 1] along the segment from `p` to `q` at which the segment from `r` to `s` crosses it; `None` without a crossing.
pub(crate) fn crossing(p: Spot, q: Spot, r: Spot, s: Spot) -> Option<f64> {
    let (d, e) = ((q.0 - p.0, q.1 - p.1), (s.0 - r.0, s.1 - r.1));
    let determinant = d.0 * e.1 - d.1 * e.0;
    let size = d.0.hypot(d.1) * e.0.hypot(e.1);
    if determinant.abs() <= 1e-9 * size {
        return None;
    }
    let f = (r.0 - p.0, r.1 - p.1);
    let t = (f.0 * e.1 - f.1 * e.0) / determinant;
    let u = (f.0 * d.1 - f.1 * d.0) / determinant;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some(t)
}

/// The strokes of a curve through `spots`, where `None` is a gap; a stroke of one spot is a point between gaps.
pub(crate) fn strokes(
    spots: impl IntoIterator<Item = Option<Spot>>,
    frame: &Rectangle,
) -> Vec<Vec<Spot>> {
    let mut strokes: Vec<Vec<Spot>> = Vec::new();
    let mut before: Option<Spot> = None;
    // Whether the spot before has been drawn as the end of the last stroke.
    let mut joined = false;
    for spot in spots {
        match (before, spot) {
            (_, None) => joined = false,
            (None, Some(here)) => {
                joined = frame.contains(here);
                if joined {
                    strokes.push(vec![here]);
                }
            }
            (Some(there), Some(here)) => match frame.cut(there, here) {
                None => joined = false,
                Some((from, to)) => {
                    match strokes.last_mut() {
                        Some(stroke) if joined => stroke.push(to),
                        _ => strokes.push(vec![from, to]),
                    }
                    joined = to == here;
                }
            },
        }
        before = spot;
    }
    strokes.iter().map(|stroke| thin(stroke)).collect()
}

/// The same stroke to the eye: of neighbours within one column, the first, lowest, highest and last.
fn thin(stroke: &[Spot]) -> Vec<Spot> {
    let mut thinned = Vec::new();
    for column in stroke.chunk_by(|a, b| (a.0 / GRAIN).floor() == (b.0 / GRAIN).floor()) {
        let last = column.len() - 1;
        let by_height = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
        let lowest = (0..=last).min_by(by_height).expect("a chunk has at least one spot");
        let highest = (0..=last).max_by(by_height).expect("a chunk has at least one spot");
        // In the order of the stroke, each once.
        let kept: BTreeSet<usize> = [0, lowest, highest, last].into();
        thinned.extend(kept.into_iter().map(|index| column[index]));
    }
    thinned
}

/// The spots inside `frame`, one per cell.
pub(crate) fn points(
    spots: impl IntoIterator<Item = Option<Spot>>,
    frame: &Rectangle,
) -> Vec<Spot> {
    let mut taken = BTreeSet::new();
    let mut new = |(x, y): Spot| taken.insert(((x / GRAIN) as i64, (y / GRAIN) as i64));
    spots.into_iter().flatten().filter(|spot| frame.contains(*spot) && new(*spot)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rectangle = Rectangle { x: 0.0, y: 0.0, w: 100.0, h: 50.0 };

    fn check(spots: &[Option<Spot>], expected: &[&[Spot]]) {
        assert_eq!(strokes(spots.iter().copied(), &FRAME), expected);
    }

    #[test]
    fn gaps_break_and_lone_points_stay() {
        check(
            &[Some((1.0, 1.0)), Some((2.0, 2.0)), None, Some((3.0, 3.0)), None, Some((4.0, 99.0))],
            &[&[(1.0, 1.0), (2.0, 2.0)], &[(3.0, 3.0)]],
        );
    }

    #[test]
    fn cut_at_the_frame() {
        check(
            &[Some((-10.0, 10.0)), Some((10.0, 10.0)), Some((10.0, 90.0)), Some((20.0, 10.0))],
            &[&[(0.0, 10.0), (10.0, 10.0), (10.0, 50.0)], &[(15.0, 50.0), (20.0, 10.0)]],
        );
        check(&[Some((-2.0, -1.0)), Some((102.0, 51.0))], &[&[(0.0, 0.0), (100.0, 50.0)]]);
        check(&[Some((-9.0, 5.0)), Some((5.0, -9.0))], &[]);
    }

    #[test]
    fn thinning_keeps_extremes_and_order() {
        let spots = (0..100_000).map(|i| {
            let x = f64::from(i) * 1e-3;
            Some((x, if i == 54_321 { 50.0 } else { 25.0 + (x * 40.0).sin() }))
        });
        let strokes = strokes(spots, &FRAME);
        assert_eq!(strokes.len(), 1);
        assert!(strokes[0].len() <= 4 * 200, "{}", strokes[0].len());
        assert!(strokes[0].contains(&(54.321, 50.0)));
        assert!(strokes[0].windows(2).all(|pair| pair[0].0 < pair[1].0));
    }

    #[test]
    fn coinciding_points_are_drawn_once() {
        let spots =
            [Some((1.0, 1.0)), Some((1.1, 1.1)), None, Some((3.0, 3.0)), Some((300.0, 3.0))];
        assert_eq!(points(spots, &FRAME), [(1.0, 1.0), (3.0, 3.0)]);
    }
}
