//! Collision objects, and the bodies that they are attached to.

use jointplay_core::spatial::Pose;

use crate::EntityId;
use crate::geometry::{CachedCollider, Collider, ColliderCache, Interval, PlacedCollider};
use crate::incremental::{CacheKey, CacheKeyPart};
use crate::program::WaferLocation;
use crate::robot::EffectorId;
use crate::station::SlotId;

/// Frame that a collision object is attached to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parent {
    World,
    Platform,
    /// A link before the last one of its arm.
    Link {
        arm: usize,
        link: usize,
    },
    /// The last link of an arm, with the deflection at this effector.
    DeflectedLastLink(EffectorId),
    Slot(SlotId),
    Effector(EffectorId),
}

impl Parent {
    pub(crate) fn moves(self) -> bool {
        !matches!(self, Self::World | Self::Slot(_))
    }
}

impl From<WaferLocation> for Parent {
    fn from(location: WaferLocation) -> Self {
        match location {
            WaferLocation::Slot(slot) => Self::Slot(slot),
            WaferLocation::Effector(id) => Self::Effector(id),
        }
    }
}

/// Role of a collision object in clearance rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Body of the cell, by index.
    Body(usize),
    Wafer,
    KeepOut,
}

/// Collider with the entity that it represents and the body that it is attached to.
#[derive(Clone)]
pub(crate) struct CollisionObject {
    pub(crate) entity: EntityId,
    pub(crate) collider: Collider,
    /// Identity of the collider in the cache.
    collider_id: u64,
    /// Identity of the collider at its fixed pose, for objects that do not move.
    fixed_id: u64,
    pub(crate) parent: Parent,
    pub(crate) role: Role,
    /// Pose of the parent, for objects that do not move.
    pub(super) base_from_fixed_parent: Pose,
    /// Axis-aligned box in the base frame, for objects that do not move.
    pub(crate) aabb: [Interval; 3],
}

impl CollisionObject {
    /// An object at the origin of the base frame.
    pub(super) fn new(
        entity: EntityId,
        collider: CachedCollider,
        parent: Parent,
        role: Role,
        cache: &mut ColliderCache,
    ) -> Self {
        let mut object = Self {
            entity,
            collider: collider.collider,
            collider_id: collider.number,
            fixed_id: 0,
            parent,
            role,
            base_from_fixed_parent: Pose::identity(),
            aabb: [Interval { min: 0.0, max: 0.0 }; 3],
        };
        object.set_fixed_pose(Pose::identity(), cache);
        object
    }

    /// Sets the pose of a parent that does not move.
    pub(super) fn set_fixed_pose(&mut self, base_from_parent: Pose, cache: &mut ColliderCache) {
        self.base_from_fixed_parent = base_from_parent;
        self.fixed_id = cache.fixed_id(self.collider_id, &base_from_parent);
        let (collider, base_from_parent) = (&self.collider, &self.base_from_fixed_parent);
        self.aabb = PlacedCollider { collider, base_from_parent }.aabb();
    }
}

impl CacheKeyPart for CollisionObject {
    /// Collider and parent, and the pose of a fixed object; neither entity nor role, which distances do not depend on.
    fn append_to(&self, cache_key: &mut CacheKey) {
        match self.parent {
            Parent::World | Parent::Slot(_) => cache_key.add(&0_u64).add(&self.fixed_id),
            Parent::Platform => cache_key.add(&1_u64).add(&self.collider_id),
            Parent::Link { arm, link } => {
                cache_key.add(&2_u64).add(&self.collider_id).add(&arm).add(&link)
            }
            Parent::Effector(id) => cache_key.add(&3_u64).add(&self.collider_id).add(&id),
            Parent::DeflectedLastLink(id) => cache_key.add(&4_u64).add(&self.collider_id).add(&id),
        };
    }
}
