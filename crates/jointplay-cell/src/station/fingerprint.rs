//! Fingerprints of stations.

use super::description::{Approach, SlotId, Station, Stroke};
use crate::incremental::{Fingerprint, Fingerprinted};

impl Fingerprinted for SlotId {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { station, slot } = self;
        fingerprint.add(station).add(slot);
    }
}

impl Fingerprinted for Station {
    /// The origin and the taught points are in `base_from_station` already.
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self {
            name,
            base_from_station,
            origin: _,
            slots,
            pitch,
            stroke,
            offset,
            retract_reach,
            via,
            approach,
            effectors,
            process_time,
        } = self;
        let Stroke { below, above, speed } = stroke;
        fingerprint.add(name).add(base_from_station).add(slots).add(pitch);
        fingerprint.add(below).add(above).add(speed).add(offset).add(retract_reach).add(via);
        fingerprint.add(&match approach {
            Approach::Radial => 0_u64,
            Approach::Line => 1,
        });
        fingerprint.add(effectors).add(process_time);
    }
}
