//! Fingerprints of shapes.

use super::shape::Shape;
use crate::incremental::{Fingerprint, Fingerprinted};

impl Fingerprinted for Shape {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        match self {
            Self::Box { half } => fingerprint.add(&0_u64).add(half),
            Self::Cylinder { radius, half_height } => {
                fingerprint.add(&1_u64).add(radius).add(half_height)
            }
            Self::Capsule { ends, radius } => fingerprint.add(&2_u64).add(ends).add(radius),
            Self::Convex { points } => fingerprint.add(&3_u64).add(points),
            Self::Mesh { vertices, triangles } => {
                fingerprint.add(&4_u64).add(vertices).add(triangles)
            }
        };
    }
}
