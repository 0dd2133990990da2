//! What is wrong with a motion.
//!
//! | file | role |
//! | --- | --- |
//! | `report` | what a check finds |
//! | `scene` | bodies, wafers and zones, and where they are |
//! | `solid` | shapes, and distances between them |
//! | `course`, `travel` | a step sample by sample, and how far things can have gone between samples |
//! | `alone`, `slip` | a step by itself: axes, tilt, play and slip against their limits |
//! | `near` | a step among all bodies: distances, looked at only as often as they can matter |
//! | `found` | what is broken in a step, merged from sample to sample |
//! | `summary` | all steps together |

mod alone;
mod course;
mod found;
mod near;
mod report;
mod scene;
mod slip;
mod solid;
mod summary;
mod travel;

pub use report::{InstructionRow, Kind, PairDistance, Report, Share, Unit, Verdict, Violation};

use std::convert::Infallible;
use std::sync::Arc;

use crate::cell::{Cell, ZoneRule};
use crate::memory::{Kept, Reuse};
use crate::motion::{Motion, Way};
use crate::program::{Phase, Step};
use alone::Alone;
use course::Course;
use near::{Look, Near, Pair};
use scene::{Rule, Scene};
use solid::Solids;
use summary::Summary;
use travel::{Gearing, Levers};

/// How closely a motion is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckOptions {
    /// Samples a second [Hz].
    pub rate: f64,
    /// Distances of bodies are followed below this; farther ones count as far [m].
    pub near: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { rate: 1000.0, near: 0.05 }
    }
}

/// Everything that is wrong with a motion, none hidden by the first.
///
/// Each step is looked at from its start on, so many times a second, and at its end: axes, tilt, play, slip and zones at each of these samples.
/// Distances of bodies are judged between the samples too:
///
/// ```text
///    min d  ≥  (d_0 + d_1 − way) / 2
/// ```
/// over an interval with the distances d_0 and d_1 at its ends, in which no point of either goes farther than the way.
/// An interval in which this keeps a pair apart is passed over, any other is halved, also below the samples: so a wall that is thinner than a sample's way is not jumped, nor a place that is too narrow.
///
/// # Numerics
/// Least distances are exact at the samples looked at; those passed over may be nearer by `within` of each row.
///
/// # Assumptions
/// Links and wafers are rigid where distances are concerned; wafers lie as flat discs, lowered and turned by the droop of their arm.
#[must_use]
pub fn check(cell: &Cell, motion: &Motion, options: &CheckOptions) -> Report {
    Checks::default().check(cell, motion, options)
}

/// What was found of the steps of the last motion, by what it depends on.
#[derive(Default)]
pub(crate) struct Checks {
    solids: Solids,
    /// With the ways that the keys of both tell apart by where they are kept.
    moves: Kept<(Alone, [Option<Arc<Way>>; 3])>,
    distances: Kept<Near>,
}

impl Checks {
    /// See [`check`].
    pub(crate) fn check(&mut self, cell: &Cell, motion: &Motion, options: &CheckOptions) -> Report {
        let shared = shared(cell, options);
        self.solids.begin();
        self.moves.begin(&shared);
        self.distances.begin(&shared);
        let mut scene = Scene::new(cell, &mut self.solids);
        let gearing = Gearing::new(&cell.robot);
        let mut course = Course::default();
        let mut summary = Summary::new(cell, motion);
        for (index, step) in motion.steps.iter().enumerate() {
            let (mut items, others): (Vec<usize>, Vec<usize>) =
                (0..scene.items.len()).partition(|&item| scene.items[item].holder.moves());
            let movers = items.len();
            let mut key = motion.key(index);
            key.push(u64::from(step.phase == Phase::Turn));
            key.push(step.loaded.len() as u64);
            key.extend(step.loaded.iter().flat_map(|id| [id.arm as u64, id.effector as u64]));
            items.iter().for_each(|&item| scene.items[item].key(&mut key));
            let levers = |&item: &usize| Levers::new(&cell.robot, &scene.items[item]);
            let levers: Vec<Levers> = items.iter().map(levers).collect();
            let mut is_taken = false;
            let mut take = |course: &mut Course| {
                if !std::mem::replace(&mut is_taken, true) {
                    course.take(motion, index, options.rate, &gearing);
                }
            };
            let Ok(alone) = self.moves.get::<Infallible>(key.clone(), || {
                take(&mut course);
                let mut alone = Alone::new(&scene, step, &mut course);
                let around =
                    |(&item, levers)| course.around(&scene, item, (&gearing, levers), &alone.runs);
                alone.around = items.iter().zip(&levers).map(around).collect();
                Ok((alone, motion.way_of(index)))
            });
            let reach = options.near.max(cell.clearance).max(cell.slot_clearance);
            let pairs = pairs(&scene, step, &alone.0, &mut items, others, reach);
            items[movers..].iter().for_each(|&item| scene.items[item].key(&mut key));
            for Pair { items: [a, b], rule } in &pairs {
                key.extend([*a as u64, *b as u64]);
                rule.key(&mut key);
            }
            let near = self.distances.get::<Infallible>(key, || {
                take(&mut course);
                let mut look = Look {
                    scene: &scene,
                    motion,
                    step: index,
                    course: &mut course,
                    items: &items,
                    gearing: &gearing,
                    levers: &levers,
                    near: options.near,
                };
                Ok(look.at(&pairs, &alone.0.runs))
            });
            let Ok(near) = near;
            summary.add(&scene, index, &alone.0, &near, &items);
            if let Some(handover) = step.handover {
                scene.hand_over(handover);
            }
        }
        self.solids.end();
        self.moves.end();
        self.distances.end();
        summary.finished(&scene)
    }

    pub(crate) fn reuse_of_moves(&self) -> Reuse {
        self.moves.reuse()
    }

    pub(crate) fn reuse_of_distances(&self) -> Reuse {
        self.distances.reuse()
    }
}

/// What every step depends on: numbers are printed so that no two of them look alike.
fn shared(cell: &Cell, options: &CheckOptions) -> String {
    let safe: Vec<_> = cell.zones.iter().filter(|zone| zone.rule == ZoneRule::Safe).collect();
    format!(
        "{:?} {:?} {:?} {:?} {safe:?} {options:?}",
        cell.robot, cell.wafer, cell.gravity, cell.play_budget
    )
}

/// Pairs that something is asked of in a step and that may come near each other; what of the others takes part is added to the items that move.
fn pairs(
    scene: &Scene<'_>,
    step: &Step,
    alone: &Alone,
    items: &mut Vec<usize>,
    others: Vec<usize>,
    reach: f64,
) -> Vec<Pair> {
    let movers = items.len();
    let mut pairs = Vec::new();
    for a in 0..movers {
        for b in a + 1..movers {
            let rule = scene.rule(items[a], items[b], step);
            if rule != Rule::Free {
                pairs.push(Pair { items: [a, b], rule });
            }
        }
    }
    for other in others {
        let standing = &scene.items[other].around;
        let mut place = None;
        for mover in 0..movers {
            let Some(around) = &alone.around[mover] else { continue };
            if !around.comes_near(standing, reach) {
                continue;
            }
            let rule = scene.rule(items[mover], other, step);
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
    pairs
}
