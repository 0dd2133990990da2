//! Checks of steps: cache keys, limits, broad phase and distance queries.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::options::CheckOptions;
use super::step_findings::StepFindings;
use crate::collision::{
    BroadPhase, CandidatePair, CandidatePairs, MotionBoundModel, PairAccumulator, PairResults,
    SampleWindows, SampledStep, Scene, StepDistanceQuery,
};
use crate::geometry::ColliderCache;
use crate::incremental::{CacheKey, Interrupted, JobContext, parallel_map};
use crate::program::LocationChange;
use crate::trajectory::Trajectory;

/// Successive steps of a trajectory, with their scenes.
pub(super) struct StepChecks<'a> {
    trajectory: &'a Trajectory,
    options: &'a CheckOptions,
    bounds: MotionBoundModel,
    /// Scenes from one hand-off to the next.
    scenes: Vec<Scene<'a>>,
    /// Broad phase of each scene.
    broad_phases: Vec<BroadPhase>,
    /// Buffers for the samples of the next steps.
    buffers: Mutex<Vec<SampledStep>>,
}

/// Scene and cache key of one step.
pub(super) struct StepKey {
    scene: usize,
    pub(super) cache_key: CacheKey,
}

impl<'a> StepChecks<'a> {
    /// # Arguments
    /// * `changes` – of the locations of wafers at the ends of these steps
    /// * `scene` – before the first of the steps
    pub(super) fn new(
        trajectory: &'a Trajectory,
        steps: Range<usize>,
        changes: &[LocationChange],
        options: &'a CheckOptions,
        scene: Scene<'a>,
        cache: &mut ColliderCache,
        context: JobContext<'_>,
    ) -> Result<(Self, Vec<StepKey>), Interrupted> {
        let cell = scene.cell;
        let mut scenes = vec![scene];
        let mut scene_of = Vec::with_capacity(steps.len());
        let mut changes = changes.iter().peekable();
        for step in steps.clone() {
            context.check_interruption()?;
            let last = scenes.len() - 1;
            scene_of.push(last);
            if let Some(change) = changes.next_if(|change| change.step == step) {
                let mut next = scenes[last].clone();
                next.move_wafer(change, cache);
                scenes.push(next);
            }
        }
        let bounds = MotionBoundModel::new(&cell.robot);
        let in_slots = cell.slot_clearance.max(cell.clearance) + scenes[0].largest_slot_margin();
        let max_distance = options.report_distance.max(in_slots);
        let broad_phases = parallel_map(scenes.len(), context, |scene| {
            BroadPhase::new(&scenes[scene], &bounds, max_distance)
        })?;
        let key = |index: usize| {
            let (step, scene) = (steps.start + index, scene_of[index]);
            let mut cache_key = trajectory.step_motion_key(step);
            let step = &trajectory.steps[step];
            cache_key.add(&step.phase.is_in_safe_zones()).add(&step.loaded);
            cache_key.add(&broad_phases[scene].cache_key);
            StepKey { scene, cache_key }
        };
        let keys = parallel_map(steps.len(), context, key)?;
        let buffers = Mutex::default();
        Ok((Self { trajectory, options, bounds, scenes, broad_phases, buffers }, keys))
    }

    pub(super) fn scene(&self, key: &StepKey) -> &Scene<'a> {
        &self.scenes[key.scene]
    }

    /// Scene after the last step.
    pub(super) fn into_last_scene(mut self) -> Scene<'a> {
        self.scenes.swap_remove(self.scenes.len() - 1)
    }

    /// Calls a function with a buffer for samples.
    pub(super) fn with_buffer<T>(&self, call: impl FnOnce(&mut SampledStep) -> T) -> T {
        let buffers = || self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        let mut sampled = buffers().pop().unwrap_or_default();
        let result = call(&mut sampled);
        sampled.release();
        buffers().push(sampled);
        result
    }

    /// Checks limits, slip and safe zones in a step, and computes its swept boxes.
    pub(super) fn findings(
        &self,
        key: &StepKey,
        step: usize,
        sampled: &mut SampledStep,
    ) -> StepFindings {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let mut check_window = |window: usize| {
            self.sample(step, window, sampled);
            let mut findings =
                StepFindings::new(scene, &self.trajectory.steps[step], sampled, &self.bounds);
            let mut swept_boxes = Vec::with_capacity(broad_phase.moving.len());
            for (&object, coefficients) in broad_phase.moving.iter().zip(&broad_phase.coefficients)
            {
                let runs = &findings.runs;
                match sampled.swept_aabb(scene, object, &self.bounds, coefficients, runs) {
                    Ok(boxes) => swept_boxes.push(boxes),
                    Err(unknown) => {
                        // No distance of this window is known, which is reported as a violation.
                        findings.add_unknown_pose(unknown);
                        swept_boxes = broad_phase.moving.iter().map(|_| None).collect();
                        break;
                    }
                }
            }
            findings.swept_boxes = swept_boxes;
            (findings, sampled.first())
        };
        let (mut findings, _) = check_window(0);
        for window in 1..self.windows(step).windows() {
            let (next, first) = check_window(window);
            findings.join(next, first);
        }
        findings
    }

    fn windows(&self, step: usize) -> SampleWindows {
        SampleWindows::new(self.trajectory, step, self.options.rate)
    }

    fn sample(&self, step: usize, window: usize, sampled: &mut SampledStep) {
        if !sampled.is_at(step, window) {
            sampled.begin(self.trajectory, step, window, &self.windows(step), &self.bounds);
        }
    }

    /// Broad phase of a step.
    pub(super) fn candidates(
        &self,
        key: &StepKey,
        step: usize,
        findings: &StepFindings,
    ) -> CandidatePairs {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let clearance =
            scene.cell.clearance.max(scene.cell.slot_clearance) + scene.largest_slot_margin();
        let distance = self.options.report_distance.max(clearance);
        let step = &self.trajectory.steps[step];
        let (objects, pairs) = broad_phase.candidates(scene, step, &findings.swept_boxes, distance);
        let mut cache_key = key.cache_key.clone();
        for &object in &objects[broad_phase.moving.len()..] {
            cache_key.add(&*scene.objects[object]);
        }
        for CandidatePair { objects, rule } in &pairs {
            cache_key.add(objects).add(rule);
        }
        CandidatePairs { objects, pairs, cache_key }
    }

    /// Narrow phase of a step: distances of its candidate pairs.
    pub(super) fn distances(
        &self,
        key: &StepKey,
        step: usize,
        findings: &StepFindings,
        candidates: &CandidatePairs,
        sampled: &mut SampledStep,
    ) -> PairResults {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let mut pairs = PairAccumulator::new(&candidates.pairs);
        for window in 0..self.windows(step).windows() {
            self.sample(step, window, sampled);
            let mut query = StepDistanceQuery {
                scene,
                trajectory: self.trajectory,
                step,
                sampled: &mut *sampled,
                objects: &candidates.objects,
                bounds: &self.bounds,
                coefficients: &broad_phase.coefficients,
                relative: broad_phase.relative_motion(scene),
                max_distance: self.options.report_distance,
            };
            query.check(&mut pairs, &findings.runs);
        }
        pairs.into_results()
    }
}
