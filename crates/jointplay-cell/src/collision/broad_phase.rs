//! Broad phase: pairs of collision objects that may come near each other in a segment.

use std::sync::OnceLock;

use super::allowed_collisions::Rule;
use super::conservative_advancement::Pair;
use super::motion_bound::Gearing;
use super::motion_bound_coefficients::{Levers, common};
use super::object::Holder;
use super::scene::Scene;
use super::swept_aabb::Around;
use crate::incremental::Fingerprint;
use crate::program::Step;

/// Who moves in a scene, and who stands.
pub(crate) struct Cast {
    /// Items that move.
    pub(crate) movers: Vec<usize>,
    /// And those that stand.
    others: Vec<usize>,
    /// Of those that move: up to which distance from what holds them their points count [m].
    reaches: Vec<f64>,
    /// Of those that move.
    pub(crate) levers: Vec<Levers>,
    /// Pairs of them that something is asked of, by their places among them.
    pairs: Vec<Pair>,
    /// Of each of these, against what carries both; found when first asked for.
    between: OnceLock<Vec<(Levers, Holder)>>,
    /// All that is known of them.
    pub(crate) key: Fingerprint,
}

/// What a step is among.
pub(crate) struct Among {
    /// Items of the scene that take part, those that move first.
    pub(crate) items: Vec<usize>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) key: Fingerprint,
}

impl Cast {
    /// # Arguments
    /// * `near` – distance from which on none is followed [m]
    pub(crate) fn new(scene: &Scene<'_>, gearing: &Gearing, near: f64) -> Self {
        let (movers, others): (Vec<usize>, Vec<usize>) =
            (0..scene.items.len()).partition(|&item| scene.items[item].holder.moves());
        let mut key = Fingerprint::default();
        movers.iter().for_each(|&item| {
            key.add(&*scene.items[item]);
        });
        let reaches = reaches(scene, (&movers, &others), gearing, near);
        for (&item, &reach) in movers.iter().zip(&reaches) {
            // What it is clipped to depends on the others.
            if reach < scene.items[item].solid.reach() {
                key.add(&reach);
            }
        }
        let lever =
            |(&item, &reach): (&usize, &f64)| Levers::new(scene.cell, &scene.items[item], reach);
        let levers = movers.iter().zip(&reaches).map(lever).collect();
        let mut pairs = Vec::new();
        for a in 0..movers.len() {
            for b in a + 1..movers.len() {
                let rule = scene.general_rule(movers[a], movers[b]);
                if rule != Rule::Free {
                    pairs.push(Pair { items: [a, b], rule });
                }
            }
        }
        Self { movers, others, reaches, levers, pairs, between: OnceLock::new(), key }
    }

    pub(crate) fn between(&self, scene: &Scene<'_>) -> &[(Levers, Holder)] {
        let of = |pair: &Pair| {
            let both =
                pair.items.map(|place| (&*scene.items[self.movers[place]], self.reaches[place]));
            let common = common(&scene.cell.robot, both[0].0, both[1].0);
            (Levers::between(scene.cell, both, common), common)
        };
        self.between.get_or_init(|| self.pairs.iter().map(of).collect())
    }

    /// Who may come near in a step, those that move first, and the pairs of them that something is asked of.
    pub(crate) fn pairs(
        &self,
        scene: &Scene<'_>,
        step: &Step,
        paths: &[Option<Around>],
        reach: f64,
    ) -> (Vec<usize>, Vec<Pair>) {
        let (mut items, mut pairs) = (self.movers.clone(), self.pairs.clone());
        let whole = Around::all(paths.iter().flatten());
        for &other in &self.others {
            let standing = &scene.items[other].around;
            if !whole.as_ref().is_some_and(|whole| whole.comes_near(standing, reach)) {
                continue;
            }
            let mut place = None;
            for (mover, around) in paths.iter().enumerate() {
                if !around.as_ref().is_some_and(|around| around.comes_near(standing, reach)) {
                    continue;
                }
                let rule = scene.rule(self.movers[mover], other, step);
                if rule == Rule::Free {
                    continue;
                }
                let place = *place.get_or_insert_with(|| {
                    items.push(other);
                    items.len() - 1
                });
                pairs.push(Pair { items: [mover, place], rule });
            }
        }
        (items, pairs)
    }
}

/// Up to which distance from the origin of what holds them points of items that move count [m].
///
/// A point farther out than every other item is from there is not near to any of them, so that bounds of how far a long item moves need not count its far end:
///
/// ```text
///    |a − o|  ≤  |a − b| + |b − O| + |O − o|        a, b: points of both that are nearest, o: origin of what holds a, O: that of the platform
/// ```
fn reaches(
    scene: &Scene<'_>,
    (movers, others): (&[usize], &[usize]),
    gearing: &Gearing,
    near: f64,
) -> Vec<f64> {
    let highest = gearing.highest(&scene.cell.robot);
    let farthest = |&item: &usize| {
        let corner = scene.items[item].around.map(|span| span.least.abs().max(span.most.abs()));
        corner[0].hypot(corner[1]).hypot(corner[2]) + highest
    };
    let standing = others.iter().map(farthest).fold(0.0, f64::max);
    let far =
        |&item: &usize, reach: f64| Levers::new(scene.cell, &scene.items[item], reach).farthest();
    let radii: Vec<f64> =
        movers.iter().map(|item| far(item, scene.items[*item].solid.reach())).collect();
    let reach = |(place, item): (usize, &usize)| {
        let moving = radii.iter().enumerate().filter(|(other, _)| *other != place);
        let moving = moving.map(|(_, radius)| *radius).fold(0.0, f64::max);
        let counts = far(item, 0.0) + standing.max(moving) + near;
        counts.min(scene.items[*item].solid.reach())
    };
    movers.iter().enumerate().map(reach).collect()
}
