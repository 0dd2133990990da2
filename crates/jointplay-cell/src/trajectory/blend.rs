//! Successive moves run into each other, so that the axes do not come to rest between them.

use std::convert::Infallible;
use std::sync::Arc;

use super::Segment;
use super::corner::Corner;
use super::segment_planner::key;
use crate::geometry::{Solid, Solids};
use crate::incremental::{Interrupted, Kept, Key, Run, anew, extend};
use crate::program::Step;
use crate::workcell::{Cell, Zone, ZoneRule};

/// How a step runs into the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// How long both run at the same time [s].
    pub overlap: f64,
    /// Largest distance of a wafer's centre from the way without blending, at most [m].
    pub deviation: f64,
}

/// How the steps of the last motion run into each other, by what that depends on.
#[derive(Default)]
pub(super) struct Blends {
    /// By how much the steps at a corner are slowed.
    slower: Kept<f64>,
    slowed: Kept<Segment>,
    blends: Kept<Option<Blend>>,
    solids: Solids,
    /// Zones that wafers' centres have to stay in while the robot turns.
    safe: Vec<Solid>,
}

impl Blends {
    pub(super) fn begin(&mut self, cell: &Cell, shared: &str) {
        self.slowed.begin(shared);
        let zones = || cell.zones.iter().filter(|zone| zone.rule == ZoneRule::Safe);
        let shared = format!("{shared} {:?}", zones().collect::<Vec<_>>());
        self.slower.begin(&shared);
        self.blends.begin(&shared);
        self.solids.begin();
        let solid = |zone: &Zone| self.solids.get(&zone.shape, &zone.base_from_shape);
        self.safe = zones().filter_map(solid).map(|(_, solid)| solid).collect();
    }

    pub(super) fn end(&mut self) {
        self.slower.end();
        self.slowed.end();
        self.blends.end();
        self.solids.end();
    }

    /// Slows the steps that then gain more by running into each other; by how much each.
    pub(super) fn slow(
        &mut self,
        cell: &Cell,
        steps: &[Step],
        ways: &mut [Arc<Segment>],
        run: Run<'_>,
    ) -> Result<Vec<f64>, Interrupted> {
        let corners: Vec<usize> = (0..steps.len().saturating_sub(1))
            .filter(|&before| at((cell, &self.safe), steps, ways, before).is_some())
            .collect();
        let keys = |factors: &[f64]| -> Vec<(usize, Key)> {
            let key = |&before: &usize| (before, corner_key(steps, factors, before));
            corners.iter().map(key).collect()
        };
        let mut factors = vec![1.0_f64; steps.len()];
        let plain = keys(&factors);
        fill(&mut self.slower, &plain, run, |before| {
            at((cell, &self.safe), steps, ways, before).map_or(1.0, |corner| corner.slower())
        })?;
        for (before, key) in &plain {
            let Ok(factor) = self.slower.get::<Infallible>(key.clone(), || Ok(1.0));
            for factor_of in &mut factors[*before..before + 2] {
                *factor_of = factor_of.max(*factor);
            }
        }
        let slowed: Vec<Arc<Segment>> =
            (0..steps.len()).map(|k| self.slowed(&steps[k], &ways[k], factors[k])).collect();
        let blend = |ways: &[Arc<Segment>], before: usize| {
            at((cell, &self.safe), steps, ways, before)?.blend()
        };
        fill(&mut self.blends, &plain, run, |before| blend(ways, before))?;
        fill(&mut self.blends, &keys(&factors), run, |before| blend(&slowed, before))?;
        // Each corner gains by its own factor; whether all do together is seen from rest to rest.
        let mut start = 0;
        for end in 0..steps.len() {
            if corners.binary_search(&end).is_ok() {
                continue;
            }
            let run = start..end + 1;
            start = run.end;
            if factors[run.clone()].iter().all(|&factor| factor == 1.0) {
                continue;
            }
            let (steps, plain) = (&steps[run.clone()], vec![1.0; run.len()]);
            let fast = self.duration(cell, steps, &ways[run.clone()], &plain);
            let slow = &slowed[run.clone()];
            if self.duration(cell, steps, slow, &factors[run.clone()]) < fast {
                ways[run].clone_from_slice(slow);
            } else {
                factors[run].fill(1.0);
            }
        }
        Ok(factors)
    }

    fn slowed(&mut self, step: &Step, way: &Arc<Segment>, factor: f64) -> Arc<Segment> {
        if factor == 1.0 {
            return Arc::clone(way);
        }
        let mut key = key(step);
        extend(&mut key, &[factor]);
        let Ok(slowed) = self.slowed.get::<Infallible>(key, || Ok(way.slowed(factor)));
        slowed
    }

    /// How long steps take that run into each other [s].
    fn duration(
        &mut self,
        cell: &Cell,
        steps: &[Step],
        ways: &[Arc<Segment>],
        factors: &[f64],
    ) -> f64 {
        let corners = 0..steps.len() - 1;
        let blends: Vec<Option<Blend>> =
            corners.map(|before| self.at(cell, steps, ways, factors, before)).collect();
        let overlaps: f64 = blends.iter().flatten().map(|blend| blend.overlap).sum();
        ways.iter().map(|way| way.duration()).sum::<f64>() - overlaps
    }

    /// How a step runs into the next.
    pub(super) fn at(
        &mut self,
        cell: &Cell,
        steps: &[Step],
        ways: &[Arc<Segment>],
        factors: &[f64],
        before: usize,
    ) -> Option<Blend> {
        let corner = at((cell, &self.safe), steps, ways, before)?;
        let key = corner_key(steps, factors, before);
        let Ok(blend) = self.blends.get::<Infallible>(key, || Ok(corner.blend()));
        *blend
    }
}

/// Makes for some corners what is not known of them.
fn fill<T: Send + Sync>(
    kept: &mut Kept<T>,
    corners: &[(usize, Key)],
    run: Run<'_>,
    make: impl Fn(usize) -> T + Sync,
) -> Result<(), Interrupted> {
    let unknown = corners.iter().filter(|(_, key)| !kept.knows(key));
    for (key, made) in anew(unknown.map(|(before, key)| (*before, key)), run, make)? {
        let Ok(_) = kept.get::<Infallible>(key, || Ok(made));
    }
    Ok(())
}

/// Where a step and the next meet.
fn at<'a>(
    (cell, safe): (&'a Cell, &'a [Solid]),
    steps: &'a [Step],
    ways: &'a [Arc<Segment>],
    before: usize,
) -> Option<Corner<'a>> {
    Corner::new(
        (cell, safe),
        [&steps[before], &steps[before + 1]],
        [&ways[before], &ways[before + 1]],
    )
}

/// What a step and the next, slowed by so much, come to where they meet.
fn corner_key(steps: &[Step], factors: &[f64], before: usize) -> Key {
    let mut corner = Key::new();
    for at in [before, before + 1] {
        corner.extend(key(&steps[at]));
        extend(&mut corner, &[factors[at], steps[at].blend]);
    }
    corner
}
