//! Fingerprints of wafers, supports and droop.

use super::{Droop, DroopRow, Material, Support, Wafer};
use crate::incremental::{Fingerprint, Fingerprinted};

impl Fingerprinted for Wafer {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { diameter, thickness, material } = self;
        let Material { name, young, poisson, density } = material;
        fingerprint.add(diameter).add(thickness);
        fingerprint.add(name).add(young).add(poisson).add(density);
    }
}

impl Fingerprinted for Support {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.add(&match self {
            Self::Edge => (0_u64, 0.0),
            Self::ThreePoints { radius } => (1, *radius),
            Self::TwoRails { distance } => (2, *distance),
        });
    }
}

impl Fingerprinted for Droop {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        match self {
            Self::Rigid => fingerprint.add(&0_u64),
            Self::Table { rows } => fingerprint.add(&1_u64).add(rows),
            Self::Cantilever { stiffness, mass_per_length } => {
                fingerprint.add(&2_u64).add(stiffness).add(mass_per_length)
            }
        };
    }
}

impl Fingerprinted for DroopRow {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { reach, empty_drop, empty_slope, loaded_drop, loaded_slope, load } = self;
        fingerprint.add(reach).add(empty_drop).add(empty_slope);
        fingerprint.add(loaded_drop).add(loaded_slope).add(load);
    }
}
