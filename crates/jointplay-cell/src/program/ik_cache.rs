//! Inverse kinematics of the last program, so that a change of one station costs only what it changes.

use std::convert::Infallible;
use std::sync::Arc;

use super::posture_choice::Visit;
use crate::incremental::{CacheKey, CacheStats, GenerationalCache};
use crate::robot::{EffectorId, HybridRobot, PostureChange, Redundancy, WaferTarget};
use crate::station::{InfeasibleLine, PostureOptions, SlotId, Station, StationPostures, Waypoints};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Postures along the line into a station to choose from, or the line that is blocked.
type FoundOptions = Result<Option<PostureOptions>, InfeasibleLine>;

/// Inverse kinematics of the last program, by cache key.
#[derive(Default)]
pub(crate) struct IkCache {
    /// Identities of the stations of the last program, by their descriptions.
    stations: GenerationalCache<u64>,
    /// Number of identities used so far.
    count: u64,
    /// Identities of the stations of this program.
    station_ids: Vec<u64>,
    waypoints: GenerationalCache<Waypoints>,
    posture_options: GenerationalCache<FoundOptions>,
    postures: GenerationalCache<StationPostures>,
    /// Positions between the moves of a change of posture.
    posture_changes: GenerationalCache<Vec<Vec<f64>>>,
    ik_solutions: GenerationalCache<Vec<f64>>,
}

impl IkCache {
    pub(super) fn begin(&mut self, cell: &Cell) {
        let mut shared = CacheKey::default();
        shared.add(&cell.robot).add(&cell.wafer).add(&cell.gravity).add(&cell.plane_threshold);
        self.stations.begin(&CacheKey::default());
        self.waypoints.begin(&shared);
        self.posture_options.begin(&shared);
        self.postures.begin(&shared);
        self.posture_changes.begin(&shared);
        self.ik_solutions.begin(&shared);
        let id = |station: &Station| {
            let inputs = CacheKey::default().with(station);
            let Ok(id) = self.stations.get_or_compute::<Infallible>(inputs, || {
                self.count += 1;
                Ok(self.count)
            });
            *id
        };
        self.station_ids = cell.stations.iter().map(id).collect();
    }

    pub(super) fn end(&mut self) {
        self.stations.end();
        self.waypoints.end();
        self.posture_options.end();
        self.postures.end();
        self.posture_changes.end();
        self.ik_solutions.end();
    }

    /// As [`Cell::waypoints`].
    pub(super) fn waypoints(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        slot: SlotId,
        seed: &[f64],
    ) -> Result<Arc<Waypoints>, Unreachable> {
        let mut inputs = CacheKey::default().with(&effector);
        inputs.add(&self.station_ids[slot.station]).add(&slot.slot).add(seed);
        self.waypoints.get_or_compute(inputs, || cell.waypoints(effector, slot, seed))
    }

    /// As [`Cell::posture_options`].
    pub(super) fn posture_options(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        station: usize,
    ) -> Result<Arc<FoundOptions>, Unreachable> {
        let inputs = CacheKey::default().with(&effector).with(&self.station_ids[station]);
        self.posture_options.get_or_compute(inputs, || cell.posture_options(effector, station))
    }

    /// As [`PostureOptions::postures`], for the options of a station.
    pub(super) fn postures(
        &mut self,
        cell: &Cell,
        Visit { effector, station }: Visit,
        options: &PostureOptions,
        candidate: usize,
    ) -> Arc<StationPostures> {
        let mut inputs = CacheKey::default().with(&effector);
        inputs.add(&self.station_ids[station]).add(&candidate);
        let Ok(postures) = self.postures.get_or_compute::<Infallible>(inputs, || {
            Ok(options.postures(&cell.robot, effector, candidate))
        });
        postures
    }

    /// As [`PostureChange::waypoints`].
    pub(super) fn posture_change(
        &mut self,
        robot: &HybridRobot,
        change: &PostureChange,
    ) -> Arc<Vec<Vec<f64>>> {
        let inputs = CacheKey::default().with(change);
        let Ok(waypoints) = self
            .posture_changes
            .get_or_compute::<Infallible>(inputs, || Ok(change.waypoints(robot)));
        waypoints
    }

    /// As [`Cell::compensated_inverse_by`], the positions alone, rounded to the resolution.
    pub(super) fn positions(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        seed: &[f64],
        redundancy: Redundancy,
    ) -> Result<Vec<f64>, Unreachable> {
        let mut inputs = CacheKey::default().with(&effector).with(&loaded);
        inputs.add(&(redundancy as u64));
        inputs.add(&target.center).add(&target.normal).add(&target.heading).add(seed);
        let reach = || {
            let found = cell.compensated_inverse_by(effector, target, loaded, seed, redundancy);
            found.map(|found| cell.robot.rounded(found.positions, seed))
        };
        self.ik_solutions.get_or_compute(inputs, reach).map(|positions| positions.to_vec())
    }

    pub(crate) fn stats(&self) -> CacheStats {
        self.ik_solutions.stats()
    }
}
