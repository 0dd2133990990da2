//! What each step of a motion depends on, and how it is looked at.

use std::ops::Range;
use std::sync::{Mutex, OnceLock, PoisonError};

use super::CheckOptions;
use super::alone::Alone;
use super::course::{Around, Course, Samples};
use super::levers::{Levers, common};
use super::near::{Look, Near, Pair, Pairs};
use super::scene::{Holder, Rule, Scene};
use super::travel::Gearing;
use crate::memory::{Interrupted, Key, Run, each};
use crate::program::{Phase, Step};
use crate::solid::Solids;
use crate::trajectory::Trajectory;

/// Some steps of a motion, and what they are among.
pub(super) struct Steps<'a> {
    motion: &'a Trajectory,
    options: &'a CheckOptions,
    gearing: Gearing,
    /// From one handing over of a wafer to the next.
    scenes: Vec<Scene<'a>>,
    /// Of each scene.
    casts: Vec<Cast>,
    /// Room for the samples of steps that are looked at next.
    courses: Mutex<Vec<Course>>,
}

/// Who moves in a scene, and who stands.
struct Cast {
    /// Items that move.
    movers: Vec<usize>,
    /// And those that stand.
    others: Vec<usize>,
    /// Of those that move: up to which distance from what holds them their points count [m].
    reaches: Vec<f64>,
    /// Of those that move.
    levers: Vec<Levers>,
    /// Pairs of them that something is asked of, by their places among them.
    pairs: Vec<Pair>,
    /// Of each of these, against what carries both; found when first asked for.
    between: OnceLock<Vec<(Levers, Holder)>>,
    /// All that is known of them.
    key: Key,
}

/// What a step by itself depends on.
pub(super) struct Start {
    scene: usize,
    pub(super) key: Key,
}

/// What a step is among.
pub(super) struct Among {
    /// Items of the scene that take part, those that move first.
    pub(super) items: Vec<usize>,
    pairs: Vec<Pair>,
    pub(super) key: Key,
}

impl Cast {
    /// # Arguments
    /// * `near` – distance from which on none is followed [m]
    fn new(scene: &Scene<'_>, gearing: &Gearing, near: f64) -> Self {
        let (movers, others): (Vec<usize>, Vec<usize>) =
            (0..scene.items.len()).partition(|&item| scene.items[item].holder.moves());
        let mut key = Key::new();
        movers.iter().for_each(|&item| scene.items[item].key(&mut key));
        let reaches = reaches(scene, (&movers, &others), gearing, near);
        for (&item, &reach) in movers.iter().zip(&reaches) {
            // What it is clipped to depends on the others.
            if reach < scene.items[item].solid.reach() {
                key.push(reach.to_bits());
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

    fn between(&self, scene: &Scene<'_>) -> &[(Levers, Holder)] {
        let of = |pair: &Pair| {
            let both =
                pair.items.map(|place| (&*scene.items[self.movers[place]], self.reaches[place]));
            let common = common(&scene.cell.robot, both[0].0, both[1].0);
            (Levers::between(scene.cell, both, common), common)
        };
        self.between.get_or_init(|| self.pairs.iter().map(of).collect())
    }

    /// Who may come near in a step, those that move first, and the pairs of them that something is asked of.
    fn pairs(
        &self,
        scene: &Scene<'_>,
        step: &Step,
        alone: &Alone,
        reach: f64,
    ) -> (Vec<usize>, Vec<Pair>) {
        let (mut items, mut pairs) = (self.movers.clone(), self.pairs.clone());
        let whole = Around::all(alone.around.iter().flatten());
        for &other in &self.others {
            let standing = &scene.items[other].around;
            if !whole.as_ref().is_some_and(|whole| whole.comes_near(standing, reach)) {
                continue;
            }
            let mut place = None;
            for (mover, around) in alone.around.iter().enumerate() {
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

impl Start {
    fn new(motion: &Trajectory, index: usize, (scene, cast): (usize, &Cast)) -> Self {
        let step = &motion.steps[index];
        let mut key = motion.key(index);
        key.push(u64::from(step.phase == Phase::Turn));
        key.push(step.loaded.len() as u64);
        key.extend(step.loaded.iter().flat_map(|id| [id.arm as u64, id.effector as u64]));
        key.extend(&cast.key);
        Self { scene, key }
    }
}

impl<'a> Steps<'a> {
    /// Some steps of a motion, with what each by itself depends on.
    ///
    /// # Arguments
    /// * `scene` – before the first of them
    pub(super) fn new(
        (motion, range): (&'a Trajectory, Range<usize>),
        options: &'a CheckOptions,
        scene: Scene<'a>,
        solids: &mut Solids,
        run: Run<'_>,
    ) -> Result<(Self, Vec<Start>), Interrupted> {
        let cell = scene.cell;
        let mut scenes = vec![scene];
        let mut scene_of = Vec::with_capacity(range.len());
        for step in &motion.steps[range.clone()] {
            run.poll()?;
            let last = scenes.len() - 1;
            scene_of.push(last);
            if let Some(handover) = step.handover {
                let mut next = scenes[last].clone();
                next.hand_over(handover, solids);
                scenes.push(next);
            }
        }
        let gearing = Gearing::new(&cell.robot);
        let near = options.near.max(cell.clearance).max(cell.slot_clearance);
        let casts = each(scenes.len(), run, |scene| Cast::new(&scenes[scene], &gearing, near))?;
        let of = |index: usize| (scene_of[index], &casts[scene_of[index]]);
        let start = |place: usize| Start::new(motion, range.start + place, of(place));
        let starts = each(range.len(), run, start)?;
        let courses = Mutex::default();
        Ok((Self { motion, options, gearing, scenes, casts, courses }, starts))
    }

    pub(super) fn scene(&self, start: &Start) -> &Scene<'a> {
        &self.scenes[start.scene]
    }

    /// After the last step.
    pub(super) fn into_last(mut self) -> Scene<'a> {
        self.scenes.swap_remove(self.scenes.len() - 1)
    }

    /// Does something in the room that was used before.
    pub(super) fn with_course<T>(&self, make: impl FnOnce(&mut Course) -> T) -> T {
        let courses = || self.courses.lock().unwrap_or_else(PoisonError::into_inner);
        let mut course = courses().pop().unwrap_or_default();
        let made = make(&mut course);
        course.leave();
        courses().push(course);
        made
    }

    /// Looks at a step by itself.
    pub(super) fn alone(&self, start: &Start, index: usize, course: &mut Course) -> Alone {
        let (scene, cast) = (self.scene(start), &self.casts[start.scene]);
        let mut window = |window: usize| {
            self.take(index, window, course);
            let step = &self.motion.steps[index];
            let mut alone = Alone::new(scene, step, (&*course, &self.gearing));
            let mut around = Vec::with_capacity(cast.movers.len());
            for (&item, levers) in cast.movers.iter().zip(&cast.levers) {
                match course.around(scene, item, (&self.gearing, levers), &alone.runs) {
                    Ok(found) => around.push(found),
                    Err(lost) => {
                        // Nothing is known of the distances in this window, which is a violation.
                        alone.lost(lost);
                        around = cast.movers.iter().map(|_| None).collect();
                        break;
                    }
                }
            }
            alone.around = around;
            (alone, course.first())
        };
        let (mut alone, _) = window(0);
        for later in 1..self.samples(index).windows() {
            let (next, first) = window(later);
            alone.join(next, first);
        }
        alone
    }

    fn samples(&self, index: usize) -> Samples {
        Samples::of(self.motion, index, self.options.rate)
    }

    fn take(&self, index: usize, window: usize, course: &mut Course) {
        if !course.is_of(index, window) {
            course.take(self.motion, (index, window), &self.samples(index), &self.gearing);
        }
    }

    /// Finds what may come near in a step.
    pub(super) fn among(&self, start: &Start, index: usize, alone: &Alone) -> Among {
        let (scene, cast) = (self.scene(start), &self.casts[start.scene]);
        let clearance = scene.cell.clearance.max(scene.cell.slot_clearance);
        let reach = self.options.near.max(clearance);
        let (items, pairs) = cast.pairs(scene, &self.motion.steps[index], alone, reach);
        let mut key = start.key.clone();
        items[cast.movers.len()..].iter().for_each(|&item| scene.items[item].key(&mut key));
        for Pair { items: [a, b], rule } in &pairs {
            key.extend([*a as u64, *b as u64]);
            rule.key(&mut key);
        }
        Among { items, pairs, key }
    }

    /// Looks at the distances in a step.
    pub(super) fn near(
        &self,
        start: &Start,
        index: usize,
        (alone, among): (&Alone, &Among),
        course: &mut Course,
    ) -> Near {
        let (scene, cast) = (self.scene(start), &self.casts[start.scene]);
        let mut pairs = Pairs::new(&among.pairs);
        for window in 0..self.samples(index).windows() {
            self.take(index, window, course);
            let mut look = Look {
                scene,
                motion: self.motion,
                step: index,
                course: &mut *course,
                items: &among.items,
                gearing: &self.gearing,
                levers: &cast.levers,
                between: cast.between(scene),
                near: self.options.near,
            };
            look.at(&mut pairs, &alone.runs);
        }
        pairs.finished()
    }
}
