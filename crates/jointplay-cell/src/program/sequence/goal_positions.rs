//! Positions of all axes at the goals of a sequence: branch and postures of the arm.

use std::sync::Arc;

use super::{Goal, MotionSequencer};
use crate::program::ProgramProblem;
use crate::program::effector_choice::effector_name;
use crate::program::posture_choice::{Visit, best_candidate};
use crate::robot::{ArmChain, EffectorId, RODS, Redundancy, WaferTarget};
use crate::station::LinePoint::Retracted;
use crate::station::{SlotId, StationPostures};
use crate::wafer::Unreachable;

/// Largest difference of motor positions on one branch for the same pose of a wafer (m or rad).
const SAME_BRANCH: f64 = 1e-6;

impl MotionSequencer<'_> {
    /// The target at which the sagging wafer's mean plane coincides with that of a given target.
    pub(super) fn compensated_sag(
        &mut self,
        effector: EffectorId,
        target: &WaferTarget,
    ) -> Result<WaferTarget, ProgramProblem> {
        let height = match self.sag.get(&effector) {
            Some(&height) => height,
            None => {
                let name = || effector_name(&self.cell.robot, effector).to_owned();
                let sag = self.cell.sag(effector);
                let sag = sag.map_err(|source| ProgramProblem::Sag {
                    effector: name(),
                    source: Box::new(source),
                })?;
                self.sag.insert(effector, sag.plane_height);
                sag.plane_height
            }
        };
        let center = target.center - target.normal.normalize() * height;
        Ok(WaferTarget { center, ..*target })
    }

    pub(super) fn positions_at(&mut self, goal: Goal<'_>) -> Result<Vec<f64>, ProgramProblem> {
        let Goal { what, effector, target, slot, point } = goal;
        let loaded = self.loaded.contains(&effector);
        let target = if loaded { self.compensated_sag(effector, target)? } else { *target };
        let reached = match self.postures(effector, slot.station)? {
            Some(postures) => {
                let chain = ArmChain::new(&self.cell.robot, effector);
                let seed = postures.near(&chain, point, &self.positions);
                let redundancy = Redundancy::KeepRedundantAngles;
                self.ik_cache.positions(self.cell, effector, &target, loaded, &seed, redundancy)
            }
            None if point == Retracted => self.solve_retracted(effector, &target, slot, loaded),
            None => self.solve(effector, &target, loaded),
        };
        reached.map_err(|source| self.unreachable(what, effector, slot, loaded, source))
    }

    /// Positions at the retracted pose of a slot, for an arm without a choice of postures: on the branch that the line into the slot follows.
    ///
    /// An arm that folds beyond its first axis can hold the wafer on either side of it; from the side that is away from the slot, the line would lead through the axis.
    fn solve_retracted(
        &mut self,
        effector: EffectorId,
        target: &WaferTarget,
        slot: SlotId,
        loaded: bool,
    ) -> Result<Vec<f64>, Unreachable> {
        let nearest = self.solve(effector, target, loaded)?;
        let waypoints = self.ik_cache.waypoints(self.cell, effector, slot, &self.positions)?;
        let vias = if loaded { &waypoints.via_above } else { &waypoints.via_below };
        let pose = if loaded { &waypoints.above } else { &waypoints.below };
        let mut solve = |target: &WaferTarget, seed: &[f64]| {
            let redundancy = Redundancy::AwayFromLimits;
            self.ik_cache.positions(self.cell, effector, target, loaded, seed, redundancy)
        };
        let along = solve(vias.first().unwrap_or(pose), &nearest);
        let Ok(on_line) = along.and_then(|along| solve(target, &along)) else {
            // The line itself is refused, with its place.
            return Ok(nearest);
        };
        let motors = nearest.iter().zip(&on_line).skip(RODS);
        let is_same = motors.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) <= SAME_BRANCH;
        Ok(if is_same { nearest } else { on_line })
    }

    /// Positions that bring the wafer of an effector to a target, from the present ones.
    pub(super) fn solve(
        &mut self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
    ) -> Result<Vec<f64>, Unreachable> {
        let redundancy = Redundancy::AwayFromLimits;
        self.ik_cache.positions(self.cell, effector, target, loaded, &self.positions, redundancy)
    }

    /// As [`Self::solve`], for the end of a line that starts at the present positions: those nearest to them where the arm is redundant.
    pub(super) fn solve_line_end(
        &mut self,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
    ) -> Result<Vec<f64>, Unreachable> {
        let redundancy = Redundancy::NearestToPresent;
        self.ik_cache.positions(self.cell, effector, target, loaded, &self.positions, redundancy)
    }

    /// Postures of an arm along the line into a station, chosen at the start of the visit; `None` where the arm has no choice.
    pub(super) fn postures(
        &mut self,
        effector: EffectorId,
        station: usize,
    ) -> Result<Option<Arc<StationPostures>>, ProgramProblem> {
        let visit = Visit { effector, station };
        if let Some(postures) = self.posture_choice.of_visit(visit) {
            return Ok(Some(postures));
        }
        let found = self.ik_cache.posture_options(self.cell, effector, station);
        let found = found.map_err(|source| {
            let slot = SlotId { station, slot: 1 };
            self.unreachable("the line into", effector, slot, false, source)
        })?;
        match found.as_ref() {
            Ok(None) => Ok(None),
            Ok(Some(options)) => {
                let (robot, positions) = (&self.cell.robot, &self.positions);
                let best = best_candidate(robot, effector, &options.candidates, positions);
                let postures = self.ik_cache.postures(self.cell, visit, options, best);
                self.posture_choice.start_visit(visit, &postures);
                Ok(Some(postures))
            }
            Err(blocked) => Err(self.infeasible_line(effector, station, blocked)),
        }
    }
}
