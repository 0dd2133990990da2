//! Colliders of the last check.

use std::convert::Infallible;

use jointplay_core::spatial::Pose;

use super::collider::Solid;
use super::shape::Shape;
use crate::incremental::{Kept, Key, extend};

/// The solids of the last check, each with a number of its own, and so where they stand.
#[derive(Default)]
pub(crate) struct Solids {
    kept: Kept<(u64, Option<Solid>)>,
    standing: Kept<u64>,
    count: u64,
}

impl Solids {
    pub(crate) fn begin(&mut self) {
        self.kept.begin("");
        self.standing.begin("");
    }

    /// As [`Solid::new`].
    pub(crate) fn get(&mut self, shape: &Shape, carrier_from_shape: &Pose) -> Option<(u64, Solid)> {
        let make = || {
            self.count += 1;
            Ok::<_, Infallible>((self.count, Solid::new(shape, carrier_from_shape)))
        };
        let Ok(found) = self.kept.get(inputs(shape, carrier_from_shape), make);
        Some((found.0, found.1.clone()?))
    }

    /// The number of a solid that stands somewhere.
    pub(crate) fn standing(&mut self, number: u64, base_from_carrier: &Pose) -> u64 {
        let mut key = vec![number];
        extend(&mut key, base_from_carrier.rotation.matrix().as_slice());
        extend(&mut key, base_from_carrier.translation.vector.as_slice());
        let Ok(found) = self.standing.get::<Infallible>(key, || {
            self.count += 1;
            Ok(self.count)
        });
        *found
    }

    pub(crate) fn end(&mut self) {
        self.kept.end();
        self.standing.end();
    }
}

fn inputs(shape: &Shape, carrier_from_shape: &Pose) -> Key {
    let mut key = Key::new();
    extend(&mut key, carrier_from_shape.rotation.matrix().as_slice());
    extend(&mut key, carrier_from_shape.translation.vector.as_slice());
    match shape {
        Shape::Box { half } => {
            key.push(0);
            extend(&mut key, half);
        }
        Shape::Cylinder { radius, half_height } => {
            key.push(1);
            extend(&mut key, &[*radius, *half_height]);
        }
        Shape::Capsule { ends, radius } => {
            key.push(2);
            extend(&mut key, ends.as_flattened());
            extend(&mut key, &[*radius]);
        }
        Shape::Convex { points } => {
            key.push(3);
            extend(&mut key, points.as_flattened());
        }
        Shape::Mesh { vertices, triangles } => {
            key.extend([4, vertices.len() as u64]);
            extend(&mut key, vertices.as_flattened());
            key.extend(triangles.as_flattened().iter().map(|&corner| u64::from(corner)));
        }
    }
    key
}
