//! Drawing order, from far to near.

use super::camera::Camera;
use super::item::Item;
use super::plate::Plate;

/// Distance within which an element lies on a plate, in sizes.
const ON: f64 = 1e-3;

/// Depths nearer to each other than this count as equal, in sizes.
const EQUAL: f64 = 1e-6;

/// Elements from far to near.
///
/// Small elements are ordered by depth.
/// A plate can extend from far to near: it is drawn after the overlapping elements behind its plane, and before those in front.
/// A base plate that intersects the mechanism is drawn behind everything.
pub(super) fn far_to_near(mut items: Vec<Item>, plates: Vec<Plate>, camera: &Camera) -> String {
    // Elements of equal depth up to round-off keep their order, so that all machines draw the same picture.
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
        // A plate is drawn once all elements behind it are; of several, the farthest.
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
        // Elements that cover each other cyclically are ordered by depth.
        if let Some(i) = free.or_else(|| done.iter().position(|done| !done)) {
            done[i] = true;
            drawn += &items[i].drawn;
        }
    }
    drawn
}

/// Distance of an element in front of a plate where they overlap; 0 otherwise.
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
