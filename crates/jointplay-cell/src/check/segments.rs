//! What each step of a motion depends on, and how it is looked at.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::options::CheckOptions;
use super::segment_findings::Alone;
use crate::collision::{Among, Cast, Course, Gearing, Look, Near, Pair, Pairs, Samples, Scene};
use crate::geometry::Solids;
use crate::incremental::{Execution, Fingerprint, Interrupted, parallel_map};
use crate::program::Phase;
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

/// What a step by itself depends on.
pub(super) struct Start {
    scene: usize,
    pub(super) key: Fingerprint,
}

impl Start {
    fn new(motion: &Trajectory, index: usize, (scene, cast): (usize, &Cast)) -> Self {
        let step = &motion.steps[index];
        let mut key = motion.step_fingerprint(index);
        key.add(&(step.phase == Phase::Turn)).add(&step.loaded).add(&cast.key);
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
        execution: Execution<'_>,
    ) -> Result<(Self, Vec<Start>), Interrupted> {
        let cell = scene.cell;
        let mut scenes = vec![scene];
        let mut scene_of = Vec::with_capacity(range.len());
        for step in &motion.steps[range.clone()] {
            execution.check_interruption()?;
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
        let casts = parallel_map(scenes.len(), execution, |scene| {
            Cast::new(&scenes[scene], &gearing, near)
        })?;
        let of = |index: usize| (scene_of[index], &casts[scene_of[index]]);
        let start = |place: usize| Start::new(motion, range.start + place, of(place));
        let starts = parallel_map(range.len(), execution, start)?;
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
        let (items, pairs) = cast.pairs(scene, &self.motion.steps[index], &alone.around, reach);
        let mut key = start.key.clone();
        for &item in &items[cast.movers.len()..] {
            key.add(&*scene.items[item]);
        }
        for Pair { items, rule } in &pairs {
            key.add(items).add(rule);
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
