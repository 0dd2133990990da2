//! Placement of labels at points: inside the frame, clear of curves and of each other.

use crate::path::{Rectangle, Spot};
use crate::svg::Anchor;
use crate::text::{TICK, width};

/// Distance between a point and its label (px).
const AWAY: f64 = 7.0;

/// A label with its position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlacedLabel {
    /// Anchor on its base line (px).
    pub(crate) at: Spot,
    /// Alignment at the anchor.
    pub(crate) anchor: Anchor,
    /// The text.
    pub(crate) text: String,
}

/// Positions for labels at spots, clear of the curves drawn already.
pub(crate) fn place(
    texts: &[(Spot, &str)],
    strokes: &[Vec<Spot>],
    frame: &Rectangle,
) -> Vec<PlacedLabel> {
    let mut taken: Vec<Rectangle> = texts
        .iter()
        .map(|((x, y), _)| Rectangle { x: x - 4.0, y: y - 4.0, w: 8.0, h: 8.0 })
        .collect();
    let mut placed = Vec::new();
    for (spot, text) in texts {
        let size = (width(text, TICK), TICK);
        let cost = |side: &(f64, f64)| {
            let room = label_room(*spot, *side, size);
            let outside = !(frame.contains((room.x, room.y))
                && frame.contains((room.right(), room.bottom())));
            let covered = taken.iter().filter(|other| room.overlaps(other)).count();
            let crossed = strokes
                .iter()
                .flat_map(|stroke| stroke.windows(2))
                .filter(|pair| room.cut(pair[0], pair[1]).is_some())
                .count();
            (outside, covered, crossed)
        };
        let side = SIDES.iter().min_by_key(|side| cost(side)).expect("there are eight sides");
        let room = label_room(*spot, *side, size);
        taken.push(room);
        let (x, anchor) = match side.0 {
            s if s > 0.0 => (room.x, Anchor::Start),
            s if s < 0.0 => (room.right(), Anchor::End),
            _ => (spot.0, Anchor::Middle),
        };
        // Capitals extend 0.73 of the size above the base line, descenders 0.2 below it.
        placed.push(PlacedLabel {
            at: (x, room.y + 0.85 * TICK),
            anchor,
            text: (*text).to_string(),
        });
    }
    placed
}

/// Directions from a point to its text, right and down, in order of preference.
const SIDES: [(f64, f64); 8] = [
    (0.8, -0.8),
    (-0.8, -0.8),
    (0.8, 0.8),
    (-0.8, 0.8),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
];

/// The rectangle of a label of size (`w`, `h`) on one side of a spot (px).
fn label_room((x, y): Spot, side: (f64, f64), (w, h): (f64, f64)) -> Rectangle {
    let start = |at: f64, side: f64, length: f64| match side {
        s if s > 0.0 => at + AWAY * s,
        s if s < 0.0 => at + AWAY * s - length,
        _ => at - 0.5 * length,
    };
    Rectangle { x: start(x, side.0, w), y: start(y, side.1, h), w, h }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rectangle = Rectangle { x: 0.0, y: 0.0, w: 200.0, h: 100.0 };

    fn check(spot: Spot, strokes: &[Vec<Spot>], anchor: Anchor, above: bool) {
        let placed = place(&[(spot, "centre")], strokes, &FRAME);
        assert_eq!(placed[0].anchor, anchor, "{placed:?}");
        assert_eq!(placed[0].at.1 < spot.1, above, "{placed:?}");
    }

    #[test]
    fn keeps_inside_and_clear() {
        check((100.0, 50.0), &[], Anchor::Start, true);
        check((195.0, 50.0), &[], Anchor::End, true);
        check((100.0, 3.0), &[], Anchor::Start, false);
        check((100.0, 50.0), &[vec![(100.0, 50.0), (200.0, 0.0)]], Anchor::End, true);
    }
}
