//! The run of a check over all segments of a motion, with results reused from the last one.

use std::collections::BTreeMap;
use std::convert::Infallible;

use super::aggregate::Summary;
use super::options::CheckOptions;
use super::report::Report;
use super::segment_findings::Alone;
use super::segments::{Start, Steps};
use crate::collision::{Among, Near, Scene};
use crate::geometry::Solids;
use crate::incremental::{
    CacheStats, Execution, Fingerprint, GenerationalCache, Interrupted, compute_missing,
    parallel_map, uninterrupted,
};
use crate::trajectory::Trajectory;
use crate::workcell::{Cell, Zone, ZoneRule};

/// Everything that is wrong with a motion, none hidden by the first.
///
/// Each step is looked at from its start on, so many times a second, and at its end: axes, tilt, play, slip and zones at each of these samples.
/// Distances of bodies are judged between the samples too:
///
/// ```text
///    min d  ≥  (d_0 + d_1 − way) / 2
/// ```
/// over an interval with the distances d_0 and d_1 at its ends, in which no point of either goes farther than the way, or
///
/// ```text
///    min d  ≥  min(g_0, g_1) - bend dt / 4
/// ```
/// with the gaps g_0 and g_1 along one direction, the same side ahead: of what slides along something, whose points change their speed by no more than the bend in all.
/// An interval in which either keeps a pair apart is passed over, any other is halved, also below the samples: so a wall that is thinner than a sample's way is not jumped, nor a place that is too narrow.
///
/// # Numerics
/// Least distances are exact at the samples looked at; those passed over may be nearer by `within` of each row.
///
/// # Assumptions
/// Bodies and wafers are rigid where distances are concerned; wafers are flat discs.
/// The last link of an arm and the wafer on it are lowered and turned by the droop of the arm, as in pictures and exports; links before it are not.
///
/// A distance is compared with the one asked for to a resolution of 10⁻⁸ m, which is how exactly distances are tested to be found.
#[must_use]
pub fn check(cell: &Cell, motion: &Trajectory, options: &CheckOptions) -> Report {
    uninterrupted(Checks::default().check(cell, motion, options, Execution::unobserved()))
}

/// Steps that are checked at a time: memory for what they are among does not grow with the motion.
const AT_A_TIME: usize = 1024;

/// What was found of the steps of the last motion, by what it depends on.
#[derive(Default)]
pub(crate) struct Checks {
    solids: Solids,
    moves: GenerationalCache<Alone>,
    distances: GenerationalCache<Near>,
}

impl Checks {
    /// See [`check`].
    pub(crate) fn check(
        &mut self,
        cell: &Cell,
        motion: &Trajectory,
        options: &CheckOptions,
        execution: Execution<'_>,
    ) -> Result<Report, Interrupted> {
        let shared = shared_inputs(cell, options);
        self.solids.begin();
        self.moves.begin(&shared);
        self.distances.begin(&shared);
        let mut summary = Summary::new(cell, motion);
        let mut scene = Scene::new(cell, &mut self.solids);
        for first in (0..motion.steps.len()).step_by(AT_A_TIME) {
            let range = first..(first + AT_A_TIME).min(motion.steps.len());
            let (steps, starts) =
                Steps::new((motion, range), options, scene, &mut self.solids, execution)?;
            self.some((&steps, &starts), first, execution, &mut summary)?;
            scene = steps.into_last();
        }
        self.solids.end();
        self.moves.end();
        self.distances.end();
        Ok(summary.finished(&scene))
    }

    /// Checks some steps, from the first one on.
    fn some(
        &mut self,
        (steps, starts): (&Steps<'_>, &[Start]),
        first: usize,
        execution: Execution<'_>,
        summary: &mut Summary<'_>,
    ) -> Result<(), Interrupted> {
        // By themselves, and among what is near them while their samples are at hand.
        let unknown = starts.iter().map(|start| &start.key).enumerate();
        let unknown = unknown.filter(|(_, key)| !self.moves.contains(key));
        let mut by_themselves = compute_missing(unknown, execution, |place| {
            steps.with_course(|course| {
                let alone = steps.alone(&starts[place], first + place, course);
                let among = steps.among(&starts[place], first + place, &alone);
                let near = (!self.distances.contains(&among.key))
                    .then(|| steps.near(&starts[place], first + place, (&alone, &among), course));
                (alone, among, near)
            })
        })?;
        let mut nears: BTreeMap<Fingerprint, Near> = BTreeMap::new();
        let (mut alone, mut near_it) = (Vec::with_capacity(starts.len()), BTreeMap::new());
        for (place, start) in starts.iter().enumerate() {
            let Ok(found) = self.moves.get_or_compute::<Infallible>(start.key.clone(), || {
                let (found, among, near) =
                    by_themselves.remove(&start.key).expect("what is not known was looked at");
                nears.extend(near.map(|near| (among.key.clone(), near)));
                near_it.insert(place, among);
                Ok(found)
            });
            alone.push(found);
        }
        let among = parallel_map(starts.len(), execution, |place| match near_it.get(&place) {
            Some(_) => None,
            None => Some(steps.among(&starts[place], first + place, &alone[place])),
        })?;
        let among = among.into_iter().enumerate();
        let among: Vec<Among> =
            among.filter_map(|(place, among)| among.or_else(|| near_it.remove(&place))).collect();
        // Moves that are known, among other things than before.
        let unknown = among.iter().map(|among| &among.key).enumerate();
        let unknown =
            unknown.filter(|(_, key)| !(self.distances.contains(key) || nears.contains_key(*key)));
        let others = compute_missing(unknown, execution, |place| {
            let things = (&*alone[place], &among[place]);
            steps.with_course(|course| steps.near(&starts[place], first + place, things, course))
        })?;
        nears.extend(others);
        for (place, (alone, among)) in alone.iter().zip(&among).enumerate() {
            let Ok(near) = self.distances.get_or_compute::<Infallible>(among.key.clone(), || {
                Ok(nears.remove(&among.key).expect("what is not known was looked at"))
            });
            let scene = steps.scene(&starts[place]);
            summary.add(scene, first + place, alone, &near, &among.items);
        }
        Ok(())
    }

    pub(crate) fn limit_stats(&self) -> CacheStats {
        self.moves.stats()
    }

    pub(crate) fn distance_stats(&self) -> CacheStats {
        self.distances.stats()
    }
}

/// Checks all steps once, nothing being remembered.
pub(super) fn examine(
    cell: &Cell,
    motion: &Trajectory,
    steps: Steps<'_>,
    starts: &[Start],
) -> Report {
    let mut summary = Summary::new(cell, motion);
    for (index, start) in starts.iter().enumerate() {
        let (alone, among, near) = steps.with_course(|course| {
            let alone = steps.alone(start, index, course);
            let among = steps.among(start, index, &alone);
            let near = steps.near(start, index, (&alone, &among), course);
            (alone, among, near)
        });
        summary.add(steps.scene(start), index, &alone, &near, &among.items);
    }
    summary.finished(&steps.into_last())
}

/// Inputs that all segments share.
fn shared_inputs(cell: &Cell, options: &CheckOptions) -> Fingerprint {
    let safe: Vec<&Zone> = cell.zones.iter().filter(|zone| zone.rule == ZoneRule::Safe).collect();
    let CheckOptions { rate, near } = options;
    let mut inputs = Fingerprint::default();
    inputs.add(&cell.robot).add(&cell.wafer).add(&cell.gravity).add(&cell.play_budget);
    inputs.add(&safe).add(rate).add(near);
    inputs
}
