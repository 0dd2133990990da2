//! The blends of all steps, and the slowdown of segments that minimizes the total duration.

use std::convert::Infallible;
use std::ops::Range;

use super::blend::Blend;
use super::blend_candidate::{BlendCandidate, BlendConditions};
use super::segment::Segment;
use super::segment_motion::SegmentMotion;
use crate::geometry::{Collider, ColliderCache};
use crate::incremental::{
    CacheKey, GenerationalCache, Interrupted, JobContext, WithId, compute_missing,
};
use crate::program::Step;
use crate::workcell::{Cell, Zone, ZoneRule};

/// Blends of the last trajectory, by cache key.
#[derive(Default)]
pub(super) struct BlendPlanner {
    /// Time scales of both segments at a corner.
    slowdowns: GenerationalCache<f64>,
    slowed: GenerationalCache<WithId<SegmentMotion>>,
    blends: GenerationalCache<Option<Blend>>,
    solids: ColliderCache,
    /// Zones in which the centres of wafers have to stay while the robot turns.
    safe_zones: Vec<Collider>,
}

/// Steps with their segments.
#[derive(Clone, Copy)]
pub(super) struct StepSegments<'a> {
    pub(super) steps: &'a [Step],
    pub(super) segments: &'a [Segment],
}

impl<'a> StepSegments<'a> {
    fn range(self, range: Range<usize>) -> Self {
        Self { steps: &self.steps[range.clone()], segments: &self.segments[range] }
    }

    /// The candidate of a step and the next.
    fn candidate(
        self,
        conditions: BlendConditions<'a>,
        first: usize,
    ) -> Option<BlendCandidate<'a>> {
        BlendCandidate::new(
            conditions,
            [&self.steps[first], &self.steps[first + 1]],
            [&self.segments[first], &self.segments[first + 1]],
        )
    }

    /// Cache key of the blend of a step with the next.
    fn key(self, first: usize) -> CacheKey {
        let mut key = CacheKey::default();
        for (step, segment) in self.steps.iter().zip(self.segments).skip(first).take(2) {
            key.add(segment).add(&step.blend_radius).add(&step.phase.is_in_safe_zones());
        }
        key
    }
}

impl BlendPlanner {
    /// Starts a round of planning.
    ///
    /// # Arguments
    /// * `shared` – cache key of the inputs that all segments share
    pub(super) fn begin(&mut self, cell: &Cell, shared: &CacheKey) {
        self.slowed.begin(shared);
        let zones = || cell.zones.iter().filter(|zone| zone.rule == ZoneRule::Safe);
        let shared = shared.clone().with(&zones().collect::<Vec<_>>());
        self.slowdowns.begin(&shared);
        self.blends.begin(&shared);
        self.solids.begin();
        let solid = |zone: &Zone| self.solids.get(&zone.shape, &zone.base_from_shape);
        self.safe_zones = zones().filter_map(solid).map(|solid| solid.collider).collect();
    }

    /// Ends a round of planning: results that it did not use are dropped.
    pub(super) fn end(&mut self) {
        self.slowdowns.end();
        self.slowed.end();
        self.blends.end();
        self.solids.end();
    }

    /// Slows segments where longer blends save more time than the slowdown costs.
    pub(super) fn slow(
        &mut self,
        cell: &Cell,
        steps: &[Step],
        segments: &mut [Segment],
        context: JobContext<'_>,
    ) -> Result<(), Interrupted> {
        let conditions = BlendConditions { cell, safe_zones: &self.safe_zones };
        let original = StepSegments { steps, segments };
        let corners: Vec<usize> = (0..steps.len().saturating_sub(1))
            .filter(|&first| original.candidate(conditions, first).is_some())
            .collect();
        let keys = |of: StepSegments<'_>| -> Vec<(usize, CacheKey)> {
            corners.iter().map(|&first| (first, of.key(first))).collect()
        };
        let original_keys = keys(original);
        compute_missing_corners(&mut self.slowdowns, &original_keys, context, |first| {
            original.candidate(conditions, first).map_or(1.0, |one| one.best_slowdown())
        })?;
        let mut factors = vec![1.0_f64; steps.len()];
        for (first, key) in &original_keys {
            let Ok(factor) = self.slowdowns.get_or_compute::<Infallible>(key.clone(), || Ok(1.0));
            // A segment has two corners: the larger factor serves both.
            for factor_of in &mut factors[*first..first + 2] {
                *factor_of = factor_of.max(*factor);
            }
        }
        let slowed: Vec<Segment> = (segments.iter().zip(&factors))
            .map(|(segment, factor)| slow_segment(&mut self.slowed, segment, *factor))
            .collect();
        let slow = StepSegments { steps, segments: &slowed };
        for (of, keys) in [(original, original_keys), (slow, keys(slow))] {
            let blend = |first| of.candidate(conditions, first).and_then(|one| one.blend());
            compute_missing_corners(&mut self.blends, &keys, context, blend)?;
        }
        // Each corner proposes a factor by itself; the factors of a run of blended steps are applied only if they shorten the whole run, from rest to rest.
        let mut start = 0;
        for end in 0..steps.len() {
            if corners.binary_search(&end).is_ok() {
                continue;
            }
            let blended = start..end + 1;
            start = blended.end;
            if factors[blended.clone()].iter().all(|&factor| factor == 1.0) {
                continue;
            }
            let original = StepSegments { steps, segments };
            let fast = self.duration(cell, original.range(blended.clone()));
            let slow = StepSegments { steps, segments: &slowed };
            if self.duration(cell, slow.range(blended.clone())) < fast {
                segments[blended.clone()].clone_from_slice(&slowed[blended]);
            }
        }
        Ok(())
    }

    /// Duration of blended steps from rest to rest (s).
    fn duration(&mut self, cell: &Cell, blended: StepSegments<'_>) -> f64 {
        let corners = 0..blended.steps.len() - 1;
        let blends: Vec<Option<Blend>> =
            corners.map(|first| self.blend(cell, blended, first)).collect();
        let overlaps: f64 = blends.iter().flatten().map(|blend| blend.overlap).sum();
        blended.segments.iter().map(|segment| segment.duration()).sum::<f64>() - overlaps
    }

    /// Blend of a step with the next.
    pub(super) fn blend(
        &mut self,
        cell: &Cell,
        all: StepSegments<'_>,
        first: usize,
    ) -> Option<Blend> {
        let conditions = BlendConditions { cell, safe_zones: &self.safe_zones };
        let candidate = all.candidate(conditions, first)?;
        let Ok(blend) =
            self.blends.get_or_compute::<Infallible>(all.key(first), || Ok(candidate.blend()));
        *blend
    }
}

/// A segment slowed by a time scale.
fn slow_segment(
    cache: &mut GenerationalCache<WithId<SegmentMotion>>,
    segment: &Segment,
    factor: f64,
) -> Segment {
    if factor == 1.0 {
        return segment.clone();
    }
    let key = CacheKey::default().with(&*segment.motion).with(&factor);
    let slow = || Ok(WithId::new(segment.motion.slowed(factor)));
    let Ok(slowed) = cache.get_or_compute::<Infallible>(key, slow);
    segment.with(slowed)
}

/// Computes the results of corners that are not in the cache.
fn compute_missing_corners<T: Send + Sync>(
    cache: &mut GenerationalCache<T>,
    corners: &[(usize, CacheKey)],
    context: JobContext<'_>,
    compute: impl Fn(usize) -> T + Sync,
) -> Result<(), Interrupted> {
    let missing = corners.iter().filter(|(_, key)| !cache.contains(key));
    for (key, computed) in
        compute_missing(missing.map(|(first, key)| (*first, key)), context, compute)?
    {
        let Ok(_) = cache.get_or_compute::<Infallible>(key, || Ok(computed));
    }
    Ok(())
}
