//! Colliders of the last check.

use std::convert::Infallible;

use jointplay_core::spatial::Pose;
use nalgebra::Translation3;

use super::collider::Collider;
use super::shape::{AxisAlignedBox, Shape};
use crate::incremental::{CacheKey, GenerationalCache};

/// Colliders of the last check, each with its own number; so have the poses of fixed colliders.
#[derive(Default)]
pub(crate) struct ColliderCache {
    colliders: GenerationalCache<(u64, Option<Collider>)>,
    fixed: GenerationalCache<u64>,
    count: u64,
}

/// A collider with its number.
#[derive(Clone)]
pub(crate) struct CachedCollider {
    /// Number in the cache; equal colliders have equal numbers.
    pub(crate) number: u64,
    pub(crate) collider: Collider,
}

impl ColliderCache {
    pub(crate) fn begin(&mut self) {
        self.colliders.begin(&CacheKey::default());
        self.fixed.begin(&CacheKey::default());
    }

    /// Number and collider of a shape, as [`Collider::new`].
    pub(crate) fn get(
        &mut self,
        shape: &Shape,
        parent_from_shape: &Pose,
    ) -> Option<CachedCollider> {
        let compute = || {
            self.count += 1;
            Ok::<_, Infallible>((self.count, Collider::new(shape, parent_from_shape)))
        };
        let Ok(found) = self
            .colliders
            .get_or_compute(CacheKey::default().with(parent_from_shape).with(shape), compute);
        Some(CachedCollider { number: found.0, collider: found.1.clone()? })
    }

    /// Numbers and colliders of the convex parts of a shape: of each box of a union; other shapes are one part.
    pub(crate) fn get_convex(
        &mut self,
        shape: &Shape,
        parent_from_shape: &Pose,
    ) -> Vec<CachedCollider> {
        let Shape::Boxes { boxes } = shape else {
            return self.get(shape, parent_from_shape).into_iter().collect();
        };
        let part = |one: &AxisAlignedBox| {
            let placed = parent_from_shape * Translation3::from(one.center());
            self.get(&Shape::Box { half: one.half() }, &placed)
        };
        boxes.iter().filter_map(part).collect()
    }

    /// Number of a collider at a fixed pose.
    pub(crate) fn fixed_id(&mut self, number: u64, base_from_parent: &Pose) -> u64 {
        let cache_key = CacheKey::default().with(&number).with(base_from_parent);
        let Ok(found) = self.fixed.get_or_compute::<Infallible>(cache_key, || {
            self.count += 1;
            Ok(self.count)
        });
        *found
    }

    pub(crate) fn end(&mut self) {
        self.colliders.end();
        self.fixed.end();
    }
}
