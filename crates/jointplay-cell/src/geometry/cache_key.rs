//! Cache keys of shapes.

use super::shape::{AxisAlignedBox, Shape};
use crate::incremental::{CacheKey, CacheKeyPart};

impl CacheKeyPart for Shape {
    fn append_to(&self, key: &mut CacheKey) {
        match self {
            Self::Box { half } => key.add(&0_u64).add(half),
            Self::Cylinder { radius, half_height } => key.add(&1_u64).add(radius).add(half_height),
            Self::Capsule { ends, radius } => key.add(&2_u64).add(ends).add(radius),
            Self::Convex { points } => key.add(&3_u64).add(points),
            Self::Boxes { boxes } => key.add(&5_u64).add(boxes),
            Self::Mesh { vertices, triangles } => key.add(&4_u64).add(vertices).add(triangles),
        };
    }
}

impl CacheKeyPart for AxisAlignedBox {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { min, max } = self;
        key.add(min).add(max);
    }
}
