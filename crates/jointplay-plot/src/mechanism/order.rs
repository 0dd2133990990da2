//! What is drawn first.

use super::glyph::Item;
use super::paint::{Camera, Plate};

/// What is nearer to a plate than this lies on it, in sizes.
const ON: f64 = 1e-3;

/// Depths nearer to each other than this count as equal, in sizes.
const EQUAL: f64 = 1e-6;

/// Elements from far to near.
///
/// Small things go by their depth.
/// A plate may reach from far to near: it is drawn after all that is behind its plane where they overlap, and before all that is in front of it.
/// A base that cuts through the mechanism is a mere sign of what is fixed, and goes behind everything.
pub(super) fn far_to_near(mut items: Vec<Item>, plates: Vec<Plate>, camera: &Camera) -> String {
    // What is equally near but for round-off keeps its order, so that every machine draws the same.
    items.sort_by_key(|item| (item.depth / EQUAL).round() as i64);
    let behind: Vec<Vec<bool>> = plates
        .iter()
        .map(|plate| {
            let sides: Vec<f64> = items.iter().map(|item| side(item, plate, camera)).collect();
            let cuts = plate.base && sides.iter().any(|&side| side > ON);
            sides.into_iter().map(|side| side < -ON && !cuts).collect()
        })
        .collect();
    let front: Vec<Vec<bool>> = plates
        .iter()
        .zip(&behind)
        .map(|(plate, behind)| {
            let over = items.iter().zip(behind).map(|(item, behind)| {
                !behind && item.points.iter().any(|point| covers(plate, camera.spot(point)))
            });
            over.collect()
        })
        .collect();
    let (mut done, mut laid) = (vec![false; items.len()], vec![false; plates.len()]);
    let mut drawn = String::new();
    for _ in 0..items.len() + plates.len() {
        // A plate as soon as all that is behind it is there; the farthest of several.
        let ready = (0..plates.len())
            .filter(|&p| {
                !laid[p] && behind[p].iter().zip(&done).all(|(behind, done)| !behind || *done)
            })
            .min_by(|&a, &b| {
                camera.depth(&plates[a].middle).total_cmp(&camera.depth(&plates[b].middle))
            });
        if let Some(p) = ready {
            laid[p] = true;
            drawn += &plates[p].drawn;
            continue;
        }
        let waits = |i: usize| (0..plates.len()).any(|p| front[p][i] && !laid[p]);
        let free = (0..items.len()).find(|&i| !done[i] && !waits(i));
        // Things that are in front of each other in a circle go by their depth.
        if let Some(i) = free.or_else(|| done.iter().position(|done| !done)) {
            done[i] = true;
            drawn += &items[i].drawn;
        }
    }
    drawn
}

/// How far a thing is in front of a plate where they overlap; 0 where they do not.
fn side(item: &Item, plate: &Plate, camera: &Camera) -> f64 {
    let covered = item.points.iter().filter(|point| covers(plate, camera.spot(point)));
    covered.map(|point| (point - plate.middle).dot(&plate.normal)).sum()
}

/// Whether a spot is inside the outline of a plate, or a little beyond.
fn covers(plate: &Plate, spot: (f64, f64)) -> bool {
    const BEYOND: f64 = 6.0;
    let around = plate.outline.iter().zip(plate.outline.iter().cycle().skip(1));
    around.into_iter().all(|(a, b)| {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let left = dx * (spot.1 - a.1) - dy * (spot.0 - a.0);
        left >= -BEYOND * dx.hypot(dy)
    })
}
