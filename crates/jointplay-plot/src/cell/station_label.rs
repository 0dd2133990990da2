//! Positions of station labels in the top view: next to the station, clear of circles, paths and other labels.

use crate::path::{Rectangle, Spot};
use crate::text::{HALF_CAPITAL, TICK, width};

/// Distance between a station and its label (px).
const GAP: f64 = 8.0;
/// Height of a label with its margin (px).
const HEIGHT: f64 = 1.4 * TICK;

/// A circle on the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    /// Centre on the page (px).
    pub(super) center: Spot,
    /// Radius (px).
    pub(super) radius: f64,
}

/// Everything that a label should not cover.
#[derive(Debug, Default)]
pub(super) struct Obstacles {
    /// Outlines of stations, and reaches of effectors.
    pub(super) circles: Vec<Circle>,
    /// Paths of wafer centres (px).
    pub(super) paths: Vec<Vec<Spot>>,
    /// Labels placed already.
    pub(super) labels: Vec<Rectangle>,
}

/// The middle of a label's base line: of the positions around the station, the first of those with the fewest crossings.
///
/// # Arguments
/// * `below` – whether the label is preferred below (true) or above the station
/// * `frame` – the part of the page that labels may use
pub(super) fn place(
    text: &str,
    station: Circle,
    below: bool,
    obstacles: &mut Obstacles,
    frame: &Rectangle,
) -> Spot {
    let half = 0.5 * width(text, TICK) + 2.0;
    let (x, y) = station.center;
    let vertical = station.radius + GAP + 0.5 * HEIGHT;
    let sideways = station.radius + GAP + half;
    let outward = if below { 1.0 } else { -1.0 };
    let candidates = [
        (x, y + outward * vertical),
        (x - half - GAP, y + outward * vertical),
        (x + half + GAP, y + outward * vertical),
        (x - sideways, y),
        (x + sideways, y),
        (x, y - outward * vertical),
    ];
    let room = |(x, y): Spot| {
        let fits = |at: f64, low: f64, high: f64| at.clamp(low, high.max(low));
        let x = fits(x, frame.x + half, frame.right() - half);
        let y = fits(y, frame.y + 0.5 * HEIGHT, frame.bottom() - 0.5 * HEIGHT);
        Rectangle { x: x - half, y: y - 0.5 * HEIGHT, w: 2.0 * half, h: HEIGHT }
    };
    let crossings = |at: &Spot| {
        let room = room(*at);
        let circles = &obstacles.circles;
        let circles = circles.iter().filter(|one| room.meets_circle(one.center, one.radius));
        let labels = obstacles.labels.iter().filter(|other| room.overlaps(other));
        let paths = obstacles
            .paths
            .iter()
            .filter(|path| path.windows(2).any(|pair| room.cut(pair[0], pair[1]).is_some()));
        circles.count() + 2 * labels.count() + paths.count()
    };
    let best = candidates.iter().min_by_key(|at| crossings(at)).expect("there are six candidates");
    let room = room(*best);
    obstacles.labels.push(room);
    (room.x + half, room.y + 0.5 * HEIGHT + HALF_CAPITAL * TICK)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rectangle = Rectangle { x: 0.0, y: 0.0, w: 400.0, h: 400.0 };
    const STATION: Circle = Circle { center: (200.0, 300.0), radius: 40.0 };

    #[test]
    fn a_label_without_obstacles_is_below_its_station() {
        let at = place("PM1", STATION, true, &mut Obstacles::default(), &FRAME);
        assert!((at.0 - 200.0).abs() < 1e-9 && at.1 > 340.0, "{at:?}");
    }

    #[test]
    fn a_label_avoids_a_reach_circle() {
        let reach = Circle { center: (200.0, 0.0), radius: 355.0 };
        let mut obstacles = Obstacles { circles: vec![reach], ..Obstacles::default() };
        let at = place("PM1, 0.1°", STATION, true, &mut obstacles, &FRAME);
        let room = obstacles.labels[0];
        assert!(!room.meets_circle(reach.center, reach.radius), "{at:?} {room:?}");
    }
}
