//! Inverse kinematics of the last program, so that a change of one station costs only what it changes.

use std::convert::Infallible;
use std::sync::Arc;

use crate::incremental::{CacheKey, CacheStats, GenerationalCache};
use crate::robot::{EffectorId, Redundancy, WaferTarget};
use crate::station::{BlockedLine, SlotId, Station, StationPostures, Waypoints};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Postures along the line into a station, or why there are none.
type FoundPostures = Result<Option<StationPostures>, BlockedLine>;

/// Inverse kinematics of the last program, by what it depends on.
#[derive(Default)]
pub(crate) struct IkCache {
    /// Numbers of the stations of the last program, by their descriptions.
    stations: GenerationalCache<u64>,
    /// How many numbers have been used.
    count: u64,
    /// Numbers of the stations of this program.
    numbers: Vec<u64>,
    waypoints: GenerationalCache<Waypoints>,
    postures: GenerationalCache<FoundPostures>,
    reachable: GenerationalCache<Vec<f64>>,
}

impl IkCache {
    pub(super) fn begin(&mut self, cell: &Cell) {
        let mut shared = CacheKey::default();
        shared.add(&cell.robot).add(&cell.wafer).add(&cell.gravity).add(&cell.plane_threshold);
        self.stations.begin(&CacheKey::default());
        self.waypoints.begin(&shared);
        self.postures.begin(&shared);
        self.reachable.begin(&shared);
        let number = |station: &Station| {
            let inputs = CacheKey::default().with(station);
            let Ok(number) = self.stations.get_or_compute::<Infallible>(inputs, || {
                self.count += 1;
                Ok(self.count)
            });
            *number
        };
        self.numbers = cell.stations.iter().map(number).collect();
    }

    pub(super) fn end(&mut self) {
        self.stations.end();
        self.waypoints.end();
        self.postures.end();
        self.reachable.end();
    }

    /// As [`Cell::waypoints`].
    pub(super) fn waypoints(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        slot: SlotId,
        near: &[f64],
    ) -> Result<Arc<Waypoints>, Unreachable> {
        let mut inputs = CacheKey::default().with(&effector);
        inputs.add(&self.numbers[slot.station]).add(&slot.slot).add(near);
        self.waypoints.get_or_compute(inputs, || cell.waypoints(effector, slot, near))
    }

    /// As [`Cell::station_postures`].
    pub(super) fn postures(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        station: usize,
    ) -> Result<Arc<FoundPostures>, Unreachable> {
        let inputs = CacheKey::default().with(&effector).with(&self.numbers[station]);
        self.postures.get_or_compute(inputs, || cell.station_postures(effector, station))
    }

    /// As [`Cell::reach_by`], the positions alone.
    pub(super) fn reach(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        near: &[f64],
        redundancy: Redundancy,
    ) -> Result<Vec<f64>, Unreachable> {
        let mut inputs = CacheKey::default().with(&effector).with(&loaded);
        inputs.add(&(redundancy == Redundancy::AsNear));
        inputs.add(&target.center).add(&target.normal).add(&target.heading).add(near);
        let reach = || {
            let found = cell.reach_by(effector, target, loaded, near, redundancy);
            found.map(|found| found.positions)
        };
        self.reachable.get_or_compute(inputs, reach).map(|positions| positions.to_vec())
    }

    pub(crate) fn stats(&self) -> CacheStats {
        self.reachable.stats()
    }
}
