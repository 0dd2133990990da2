//! Cache keys of wafers, supports and droop.

use super::{Droop, DroopRow, Material, Support, Wafer};
use crate::incremental::{CacheKey, CacheKeyPart};

impl CacheKeyPart for Wafer {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { diameter, thickness, material } = self;
        let Material { name, young, poisson, density } = material;
        key.add(diameter).add(thickness);
        key.add(name).add(young).add(poisson).add(density);
    }
}

impl CacheKeyPart for Support {
    fn append_to(&self, key: &mut CacheKey) {
        key.add(&match self {
            Self::Edge => (0_u64, 0.0),
            Self::ThreePoints { radius } => (1, *radius),
            Self::TwoRails { distance } => (2, *distance),
        });
    }
}

impl CacheKeyPart for Droop {
    fn append_to(&self, key: &mut CacheKey) {
        match self {
            Self::Rigid => key.add(&0_u64),
            Self::Table { rows } => key.add(&1_u64).add(rows),
            Self::Cantilever { stiffness, mass_per_length } => {
                key.add(&2_u64).add(stiffness).add(mass_per_length)
            }
        };
    }
}

impl CacheKeyPart for DroopRow {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { reach, empty_drop, empty_slope, loaded_drop, loaded_slope, load } = self;
        key.add(reach).add(empty_drop).add(empty_slope);
        key.add(loaded_drop).add(loaded_slope).add(load);
    }
}
