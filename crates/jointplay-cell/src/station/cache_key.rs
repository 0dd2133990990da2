//! Cache keys of stations.

use super::description::{Approach, SlotId, Station, Stroke};
use crate::incremental::{CacheKey, CacheKeyPart};

impl CacheKeyPart for SlotId {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { station, slot } = self;
        key.add(station).add(slot);
    }
}

impl CacheKeyPart for Station {
    /// The origin and the taught points are in `base_from_station` already; the uncertainty has no effect on motions, and its effect on clearances is part of the clearance rules.
    fn append_to(&self, key: &mut CacheKey) {
        let Self {
            name,
            base_from_station,
            origin: _,
            uncertainty: _,
            slots,
            pitch,
            slot_step,
            stroke,
            offset,
            retract_reach,
            via,
            approach,
            effectors,
            process_time,
        } = self;
        let Stroke { below, above, speed } = stroke;
        key.add(name).add(base_from_station).add(slots).add(pitch).add(slot_step);
        key.add(below).add(above).add(speed).add(offset).add(retract_reach).add(via);
        key.add(&match approach {
            Approach::Radial => 0_u64,
            Approach::Line => 1,
        });
        key.add(effectors).add(process_time);
    }
}
