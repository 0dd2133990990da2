//! What each step of a motion depends on, and how it is looked at.

use std::sync::{Mutex, PoisonError};

use super::CheckOptions;
use super::alone::Alone;
use super::course::Course;
use super::near::{Look, Near, Pair};
use super::scene::{Rule, Scene};
use super::travel::{Gearing, Levers};
use crate::cell::Cell;
use crate::memory::{Key, Run, each};
use crate::motion::Motion;
use crate::program::{Phase, Step};
use crate::solid::Solids;

/// All steps of a motion, and what they are among.
pub(super) struct Steps<'a> {
    motion: &'a Motion,
    options: &'a CheckOptions,
    gearing: Gearing,
    /// From one handing over of a wafer to the next.
    scenes: Vec<Scene<'a>>,
    /// Room for the samples of steps that are looked at next.
    courses: Mutex<Vec<Course>>,
}

/// What a step by itself depends on.
pub(super) struct Start {
    scene: usize,
    /// Items of the scene that move.
    movers: Vec<usize>,
    /// And those that stand.
    others: Vec<usize>,
    /// Of those that move.
    levers: Vec<Levers>,
    pub(super) key: Key,
}

/// What a step is among.
pub(super) struct Among {
    /// Items of the scene that take part, those that move first.
    pub(super) items: Vec<usize>,
    pairs: Vec<Pair>,
    pub(super) key: Key,
}

impl Start {
    fn new(
        cell: &Cell,
        motion: &Motion,
        index: usize,
        (number, scenes): (usize, &[Scene<'_>]),
    ) -> Self {
        let (step, scene) = (&motion.steps[index], &scenes[number]);
        let (movers, others): (Vec<usize>, Vec<usize>) =
            (0..scene.items.len()).partition(|&item| scene.items[item].holder.moves());
        let mut key = motion.key(index);
        key.push(u64::from(step.phase == Phase::Turn));
        key.push(step.loaded.len() as u64);
        key.extend(step.loaded.iter().flat_map(|id| [id.arm as u64, id.effector as u64]));
        movers.iter().for_each(|&item| scene.items[item].key(&mut key));
        let levers = movers.iter().map(|&item| Levers::new(&cell.robot, &scene.items[item]));
        let levers = levers.collect();
        Self { scene: number, movers, others, levers, key }
    }
}

impl<'a> Steps<'a> {
    /// Of a motion, with what each step by itself depends on.
    pub(super) fn new(
        cell: &'a Cell,
        motion: &'a Motion,
        options: &'a CheckOptions,
        solids: &mut Solids,
        run: Run<'_>,
    ) -> (Self, Vec<Start>) {
        let mut scenes = vec![Scene::new(cell, solids)];
        let mut scene_of = Vec::with_capacity(motion.steps.len());
        for step in &motion.steps {
            let last = scenes.len() - 1;
            scene_of.push(last);
            if let Some(handover) = step.handover {
                let mut next = scenes[last].clone();
                next.hand_over(handover, solids);
                scenes.push(next);
            }
        }
        let start = |index: usize| Start::new(cell, motion, index, (scene_of[index], &scenes));
        let starts = each(motion.steps.len(), run, start);
        let (gearing, courses) = (Gearing::new(&cell.robot), Mutex::default());
        (Self { motion, options, gearing, scenes, courses }, starts)
    }

    pub(super) fn scene(&self, start: &Start) -> &Scene<'a> {
        &self.scenes[start.scene]
    }

    /// After the last step.
    pub(super) fn last(&self) -> &Scene<'a> {
        &self.scenes[self.scenes.len() - 1]
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
        self.take(index, course);
        let scene = self.scene(start);
        let mut alone = Alone::new(scene, &self.motion.steps[index], (course, &self.gearing));
        let around =
            |(&item, levers)| course.around(scene, item, (&self.gearing, levers), &alone.runs);
        alone.around = start.movers.iter().zip(&start.levers).map(around).collect();
        alone
    }

    fn take(&self, index: usize, course: &mut Course) {
        if !course.is_of(index) {
            course.take(self.motion, index, self.options.rate, &self.gearing);
        }
    }

    /// Finds what may come near in a step.
    pub(super) fn among(&self, start: &Start, index: usize, alone: &Alone) -> Among {
        let (scene, options) = (self.scene(start), self.options);
        let reach = options.near.max(scene.cell.clearance).max(scene.cell.slot_clearance);
        let mut items = start.movers.clone();
        let step = &self.motion.steps[index];
        let pairs = pairs(scene, step, alone, &mut items, &start.others, reach);
        let mut key = start.key.clone();
        items[start.movers.len()..].iter().for_each(|&item| scene.items[item].key(&mut key));
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
        self.take(index, course);
        let mut look = Look {
            scene: self.scene(start),
            motion: self.motion,
            step: index,
            course,
            items: &among.items,
            gearing: &self.gearing,
            levers: &start.levers,
            near: self.options.near,
        };
        look.at(&among.pairs, &alone.runs)
    }
}

/// Pairs that something is asked of in a step and that may come near each other; what of the others takes part is added to the items that move.
fn pairs(
    scene: &Scene<'_>,
    step: &Step,
    alone: &Alone,
    items: &mut Vec<usize>,
    others: &[usize],
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
    for &other in others {
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
