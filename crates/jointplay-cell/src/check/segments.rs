//! Checks of single segments: their inputs, and the calls of limits, broad phase and distance queries.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::options::CheckOptions;
use super::segment_findings::SegmentFindings;
use crate::collision::{
    BroadPhase, CandidatePair, CandidatePairs, MotionBoundModel, PairAccumulator, PairResults,
    SampleWindows, SampledSegment, Scene, SegmentDistanceQuery,
};
use crate::geometry::ColliderCache;
use crate::incremental::{Execution, Fingerprint, Interrupted, parallel_map};
use crate::program::{Phase, WaferTransfer};
use crate::trajectory::Trajectory;

/// Successive segments of a trajectory, with their scenes.
pub(super) struct SegmentChecks<'a> {
    trajectory: &'a Trajectory,
    options: &'a CheckOptions,
    bounds: MotionBoundModel,
    /// Scenes from one hand-off to the next.
    scenes: Vec<Scene<'a>>,
    /// Broad phase of each scene.
    broad_phases: Vec<BroadPhase>,
    /// Buffers for the samples of the next segments.
    buffers: Mutex<Vec<SampledSegment>>,
}

/// Inputs of the check of one segment by itself.
pub(super) struct SegmentKey {
    scene: usize,
    pub(super) fingerprint: Fingerprint,
}

impl<'a> SegmentChecks<'a> {
    /// # Arguments
    /// * `transfers` – of wafers at the ends of these steps
    /// * `scene` – before the first of the steps
    pub(super) fn new(
        trajectory: &'a Trajectory,
        steps: Range<usize>,
        transfers: &[WaferTransfer],
        options: &'a CheckOptions,
        scene: Scene<'a>,
        cache: &mut ColliderCache,
        execution: Execution<'_>,
    ) -> Result<(Self, Vec<SegmentKey>), Interrupted> {
        let cell = scene.cell;
        let mut scenes = vec![scene];
        let mut scene_of = Vec::with_capacity(steps.len());
        let mut transfers = transfers.iter().peekable();
        for step in steps.clone() {
            execution.check_interruption()?;
            let last = scenes.len() - 1;
            scene_of.push(last);
            if let Some(transfer) = transfers.next_if(|transfer| transfer.step == step) {
                let mut next = scenes[last].clone();
                next.move_wafer(transfer, cache);
                scenes.push(next);
            }
        }
        let bounds = MotionBoundModel::new(&cell.robot);
        let max_distance = options.near.max(cell.clearance).max(cell.slot_clearance);
        let broad_phases = parallel_map(scenes.len(), execution, |scene| {
            BroadPhase::new(&scenes[scene], &bounds, max_distance)
        })?;
        let key = |index: usize| {
            let (step, scene) = (steps.start + index, scene_of[index]);
            let mut fingerprint = trajectory.step_fingerprint(step);
            let step = &trajectory.steps[step];
            fingerprint.add(&(step.phase == Phase::Turn)).add(&step.loaded);
            fingerprint.add(&broad_phases[scene].fingerprint);
            SegmentKey { scene, fingerprint }
        };
        let keys = parallel_map(steps.len(), execution, key)?;
        let buffers = Mutex::default();
        Ok((Self { trajectory, options, bounds, scenes, broad_phases, buffers }, keys))
    }

    pub(super) fn scene(&self, key: &SegmentKey) -> &Scene<'a> {
        &self.scenes[key.scene]
    }

    /// Scene after the last step.
    pub(super) fn into_last_scene(mut self) -> Scene<'a> {
        self.scenes.swap_remove(self.scenes.len() - 1)
    }

    /// Calls a function with a buffer for samples.
    pub(super) fn with_buffer<T>(&self, call: impl FnOnce(&mut SampledSegment) -> T) -> T {
        let buffers = || self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        let mut segment = buffers().pop().unwrap_or_default();
        let result = call(&mut segment);
        segment.release();
        buffers().push(segment);
        result
    }

    /// Checks a segment by itself, and computes its swept boxes.
    pub(super) fn findings(
        &self,
        key: &SegmentKey,
        step: usize,
        segment: &mut SampledSegment,
    ) -> SegmentFindings {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let mut check_window = |window: usize| {
            self.sample(step, window, segment);
            let mut findings =
                SegmentFindings::new(scene, &self.trajectory.steps[step], segment, &self.bounds);
            let mut paths = Vec::with_capacity(broad_phase.moving.len());
            for (&object, coefficients) in broad_phase.moving.iter().zip(&broad_phase.coefficients)
            {
                let runs = &findings.runs;
                match segment.swept_aabb(scene, object, &self.bounds, coefficients, runs) {
                    Ok(path) => paths.push(path),
                    Err(unknown) => {
                        // No distance of this window is known, which is reported as a violation.
                        findings.add_unknown_pose(unknown);
                        paths = broad_phase.moving.iter().map(|_| None).collect();
                        break;
                    }
                }
            }
            findings.paths = paths;
            (findings, segment.first())
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

    fn sample(&self, step: usize, window: usize, segment: &mut SampledSegment) {
        if !segment.is_at(step, window) {
            segment.begin(self.trajectory, step, window, &self.windows(step), &self.bounds);
        }
    }

    /// Broad phase of a segment.
    pub(super) fn candidates(
        &self,
        key: &SegmentKey,
        step: usize,
        findings: &SegmentFindings,
    ) -> CandidatePairs {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let clearance = scene.cell.clearance.max(scene.cell.slot_clearance);
        let distance = self.options.near.max(clearance);
        let step = &self.trajectory.steps[step];
        let (objects, pairs) = broad_phase.candidates(scene, step, &findings.paths, distance);
        let mut fingerprint = key.fingerprint.clone();
        for &object in &objects[broad_phase.moving.len()..] {
            fingerprint.add(&*scene.objects[object]);
        }
        for CandidatePair { objects, rule } in &pairs {
            fingerprint.add(objects).add(rule);
        }
        CandidatePairs { objects, pairs, fingerprint }
    }

    /// Narrow phase of a segment: distances of its candidate pairs.
    pub(super) fn distances(
        &self,
        key: &SegmentKey,
        step: usize,
        findings: &SegmentFindings,
        candidates: &CandidatePairs,
        segment: &mut SampledSegment,
    ) -> PairResults {
        let (scene, broad_phase) = (self.scene(key), &self.broad_phases[key.scene]);
        let mut pairs = PairAccumulator::new(&candidates.pairs);
        for window in 0..self.windows(step).windows() {
            self.sample(step, window, segment);
            let mut query = SegmentDistanceQuery {
                scene,
                trajectory: self.trajectory,
                step,
                segment: &mut *segment,
                objects: &candidates.objects,
                bounds: &self.bounds,
                coefficients: &broad_phase.coefficients,
                relative: broad_phase.relative_motion(scene),
                max_distance: self.options.near,
            };
            query.check(&mut pairs, &findings.runs);
        }
        pairs.into_results()
    }
}
