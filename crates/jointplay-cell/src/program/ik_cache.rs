//! Inverse kinematics of the last program, so that a change of one station costs only what it changes.

use std::convert::Infallible;
use std::sync::Arc;

use crate::incremental::{CacheStats, Kept, Key, extend};
use crate::robot::{EffectorId, WaferTarget};
use crate::station::{SlotId, Waypoints};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Inverse kinematics of the last program, by what it depends on.
#[derive(Default)]
pub(crate) struct IkCache {
    /// Numbers of the stations of the last program, by their descriptions.
    stations: Kept<u64>,
    /// How many numbers have been used.
    count: u64,
    /// Numbers of the stations of this program.
    numbers: Vec<u64>,
    ways: Kept<Waypoints>,
    reached: Kept<Vec<f64>>,
}

impl IkCache {
    pub(super) fn begin(&mut self, cell: &Cell) {
        // Numbers are printed in full, so that different inputs have different texts.
        let shared = format!(
            "{:?} {:?} {:?} {:?}",
            cell.robot, cell.wafer, cell.gravity, cell.plane_threshold
        );
        self.stations.begin("");
        self.ways.begin(&shared);
        self.reached.begin(&shared);
        let number = |station| {
            let key = format!("{station:?}").bytes().map(u64::from).collect();
            let Ok(number) = self.stations.get::<Infallible>(key, || {
                self.count += 1;
                Ok(self.count)
            });
            *number
        };
        self.numbers = cell.stations.iter().map(number).collect();
    }

    pub(super) fn end(&mut self) {
        self.stations.end();
        self.ways.end();
        self.reached.end();
    }

    /// As [`Cell::waypoints`].
    pub(super) fn waypoints(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        slot: SlotId,
        near: &[f64],
    ) -> Result<Arc<Waypoints>, Unreachable> {
        let mut key = of(effector);
        key.extend([self.numbers[slot.station], slot.slot as u64]);
        extend(&mut key, near);
        self.ways.get(key, || cell.waypoints(effector, slot, near))
    }

    /// As [`Cell::reach`], the positions alone.
    pub(super) fn reach(
        &mut self,
        cell: &Cell,
        effector: EffectorId,
        target: &WaferTarget,
        loaded: bool,
        near: &[f64],
    ) -> Result<Vec<f64>, Unreachable> {
        let mut key = of(effector);
        key.extend([u64::from(loaded), u64::from(target.heading.is_some())]);
        extend(&mut key, target.center.as_slice());
        extend(&mut key, target.normal.as_slice());
        extend(&mut key, target.heading.as_slice());
        extend(&mut key, near);
        let reach = || cell.reach(effector, target, loaded, near).map(|found| found.positions);
        self.reached.get(key, reach).map(|positions| positions.to_vec())
    }

    pub(crate) fn reuse(&self) -> CacheStats {
        self.reached.reuse()
    }
}

fn of(effector: EffectorId) -> Key {
    vec![effector.arm as u64, effector.effector as u64]
}
