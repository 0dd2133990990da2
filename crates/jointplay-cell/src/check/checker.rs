//! The check of all steps of a trajectory, with results of the last check reused.

use std::collections::{BTreeMap, HashMap};
use std::convert::Infallible;

use super::aggregate::Aggregator;
use super::options::CheckOptions;
use super::report::Report;
use super::step_checks::{StepChecks, StepKey};
use super::step_findings::StepFindings;
use crate::collision::{CandidatePairs, PairResults, Scene};
use crate::geometry::ColliderCache;
use crate::incremental::{
    CacheKey, CacheStats, GenerationalCache, Interrupted, JobContext, compute_missing,
    parallel_map, uninterrupted,
};
use crate::program::WaferLocations;
use crate::schedule::rule_violations;
use crate::trajectory::Trajectory;
use crate::workcell::{Cell, Zone, ZoneRule};

/// Checks a trajectory against the limits of its axes, tilt, play, slip, safe zones, required clearances and the rules for wafers; all violations are reported.
///
/// Axes, tilt, play, slip and safe zones are checked at samples: from the start of each step at the given rate, and at its end.
/// Clearances are checked continuously, between the samples too, by adaptive bisection \[Schwarzer\]; the module `collision` states the guarantee and its assumptions.
///
/// # Numerics
/// Minimum distances are exact at the evaluated samples; a sample that was not evaluated may have a distance smaller by [`MinimumDistance::tolerance`](super::MinimumDistance::tolerance).
///
/// # Assumptions
/// Bodies and wafers are rigid, and wafers are flat discs.
/// The last link of an arm and its wafer are displaced and rotated by the deflection of the arm, as in pictures and exports; the links before it are not.
///
/// A distance is compared with the required clearance to a resolution of 10⁻⁸ m, the accuracy to which distances are tested.
#[must_use]
pub fn check(cell: &Cell, trajectory: &Trajectory, options: &CheckOptions) -> Report {
    uninterrupted(CheckCache::default().check(cell, trajectory, options, JobContext::unmonitored()))
}

/// Segments that are checked at a time: memory for their scenes does not grow with the trajectory.
const BATCH: usize = 1024;

/// Results of the steps of the last check, by their inputs.
#[derive(Default)]
pub(crate) struct CheckCache {
    colliders: ColliderCache,
    findings: GenerationalCache<StepFindings>,
    distances: GenerationalCache<PairResults>,
}

impl CheckCache {
    /// See [`check`].
    pub(crate) fn check(
        &mut self,
        cell: &Cell,
        trajectory: &Trajectory,
        options: &CheckOptions,
        context: JobContext<'_>,
    ) -> Result<Report, Interrupted> {
        let shared = shared_inputs(cell, options);
        self.colliders.begin();
        self.findings.begin(&shared);
        self.distances.begin(&shared);
        let mut aggregator = Aggregator::new(cell, trajectory);
        let mut scene = Scene::new(cell, &mut self.colliders);
        let locations = WaferLocations::of_steps(cell, &trajectory.steps);
        for first in (0..trajectory.steps.len()).step_by(BATCH) {
            let steps = first..(first + BATCH).min(trajectory.steps.len());
            let colliders = &mut self.colliders;
            let changes = locations.location_changes_in(&steps);
            let (checks, keys) =
                StepChecks::new(trajectory, steps, changes, options, scene, colliders, context)?;
            self.check_batch(&checks, &keys, first, context, &mut aggregator)?;
            scene = checks.into_last_scene();
        }
        self.colliders.end();
        self.findings.end();
        self.distances.end();
        let rules = rule_violations(cell, trajectory, &locations);
        Ok(aggregator.into_report(&scene, locations.placed_wafers(), rules))
    }

    /// Checks successive steps, from the step `first` on.
    fn check_batch(
        &mut self,
        checks: &StepChecks<'_>,
        keys: &[StepKey],
        first: usize,
        context: JobContext<'_>,
        aggregator: &mut Aggregator<'_>,
    ) -> Result<(), Interrupted> {
        // Steps without cached findings: limits, broad phase and distances at once, while their samples are in the buffer.
        let missing = keys.iter().map(|key| &key.cache_key).enumerate();
        let missing = missing.filter(|(_, cache_key)| !self.findings.contains(cache_key));
        let mut computed = compute_missing(missing, context, |index| {
            let (key, step) = (&keys[index], first + index);
            checks.with_buffer(|sampled| {
                let findings = checks.findings(key, step, sampled);
                let candidates = checks.candidates(key, step, &findings);
                let is_missing = !self.distances.contains(&candidates.cache_key);
                let distances = is_missing
                    .then(|| checks.distances(key, step, &findings, &candidates, sampled));
                (findings, candidates, distances)
            })
        })?;
        let mut new_distances: HashMap<CacheKey, PairResults> = HashMap::new();
        let (mut findings, mut new_candidates) = (Vec::with_capacity(keys.len()), BTreeMap::new());
        for (index, key) in keys.iter().enumerate() {
            let compute = || {
                let (found, candidates, distances) =
                    computed.remove(&key.cache_key).expect("missing findings were computed");
                let cache_key = &candidates.cache_key;
                new_distances.extend(distances.map(|found| (cache_key.clone(), found)));
                new_candidates.insert(index, candidates);
                Ok(found)
            };
            let Ok(found) =
                self.findings.get_or_compute::<Infallible>(key.cache_key.clone(), compute);
            findings.push(found);
        }
        let candidates =
            parallel_map(keys.len(), context, |index| match new_candidates.get(&index) {
                Some(_) => None,
                None => Some(checks.candidates(&keys[index], first + index, &findings[index])),
            })?;
        let candidates = candidates.into_iter().enumerate();
        let candidates: Vec<CandidatePairs> = candidates
            .filter_map(|(index, known)| known.or_else(|| new_candidates.remove(&index)))
            .collect();
        // Steps with cached findings whose candidates have changed: distances alone.
        let missing = candidates.iter().map(|candidates| &candidates.cache_key).enumerate();
        let missing = missing.filter(|(_, cache_key)| {
            !(self.distances.contains(cache_key) || new_distances.contains_key(*cache_key))
        });
        let others = compute_missing(missing, context, |index| {
            let (findings, candidates) = (&findings[index], &candidates[index]);
            checks.with_buffer(|sampled| {
                checks.distances(&keys[index], first + index, findings, candidates, sampled)
            })
        })?;
        new_distances.extend(others);
        for (index, (findings, candidates)) in findings.iter().zip(&candidates).enumerate() {
            let cache_key = &candidates.cache_key;
            let compute =
                || Ok(new_distances.remove(cache_key).expect("missing distances were computed"));
            let Ok(distances) =
                self.distances.get_or_compute::<Infallible>(cache_key.clone(), compute);
            let scene = checks.scene(&keys[index]);
            aggregator.add(scene, first + index, findings, &distances, &candidates.objects);
        }
        Ok(())
    }

    pub(crate) fn findings_stats(&self) -> CacheStats {
        self.findings.stats()
    }

    pub(crate) fn distance_stats(&self) -> CacheStats {
        self.distances.stats()
    }
}

/// Checks all steps once, without a cache.
///
/// # Arguments
/// * `placed_wafers` – number of different wafers that were placed before
pub(super) fn check_uncached(
    cell: &Cell,
    trajectory: &Trajectory,
    checks: StepChecks<'_>,
    keys: &[StepKey],
    placed_wafers: usize,
) -> Report {
    let mut aggregator = Aggregator::new(cell, trajectory);
    for (step, key) in keys.iter().enumerate() {
        let (findings, candidates, distances) = checks.with_buffer(|sampled| {
            let findings = checks.findings(key, step, sampled);
            let candidates = checks.candidates(key, step, &findings);
            let distances = checks.distances(key, step, &findings, &candidates, sampled);
            (findings, candidates, distances)
        });
        let scene = checks.scene(key);
        aggregator.add(scene, step, &findings, &distances, &candidates.objects);
    }
    aggregator.into_report(&checks.into_last_scene(), placed_wafers, Vec::new())
}

/// Inputs that all steps share.
fn shared_inputs(cell: &Cell, options: &CheckOptions) -> CacheKey {
    let safe: Vec<&Zone> = cell.zones.iter().filter(|zone| zone.rule == ZoneRule::Safe).collect();
    let CheckOptions { rate, report_distance } = options;
    let mut inputs = CacheKey::default();
    inputs.add(&cell.robot).add(&cell.wafer).add(&cell.gravity).add(&cell.play_budget);
    inputs.add(&safe).add(rate).add(report_distance);
    inputs
}
