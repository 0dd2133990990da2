//! Shapes, colliders and distances between them.
//!
//! | file | contents |
//! | --- | --- |
//! | `shape` | shapes of collision objects |
//! | `openings` | boxes with openings, as unions of boxes |
//! | `triangulate` | shapes as triangles, for display and export |
//! | `interval` | intervals of coordinates, of which axis-aligned boxes are made |
//! | `collider` | shapes as the collision library takes them, with bounding spheres |
//! | `collider_cache` | colliders of the last check |
//! | `cache_key` | cache keys of shapes |
//! | `distance` | minimum distance, nearest points, separation along a direction, penetration depth |
//!
//! Nothing in this folder depends on robots or cells, except that invalid shapes are a [`CellError`](crate::CellError).

mod cache_key;
mod collider;
mod collider_cache;
mod distance;
mod interval;
mod openings;
mod shape;
mod triangulate;
mod validate;

pub(crate) use collider::{Collider, PlacedCollider};
pub(crate) use collider_cache::{CachedCollider, ColliderCache};
pub(crate) use distance::{
    bounding_sphere_gap, distance, nearest_points, penetration_depth, separation, separation_along,
    signed_distance,
};
pub(crate) use interval::Interval;
pub use openings::{MAX_OPENINGS, box_with_openings};
pub use shape::{AxisAlignedBox, Shape};
pub use triangulate::Surface;
