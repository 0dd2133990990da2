//! Mobility: Kutzbach, instantaneous and finite.
//!
//! | quantity | function |
//! | --- | --- |
//! | Kutzbach mobility, from the number of links and joints | [`kutzbach_mobility`] |
//! | instantaneous mobility, from the constraint Jacobian | [`instantaneous_mobility`] |
//! | instantaneous mobility with the virtual joints free | [`augmented_mobility`] |
//! | finite mobility | [`finite_mobility`] |
//! | dimensions of the branches that meet | [`branch_dimensions`] |
//! | near mobility, if dimensions are true only to a tolerance | [`near_mobility`] |
//! | near misses: whether a small tolerance makes a difference | [`near_miss`] |
//!
//! They differ at a singular configuration, and that difference is the subject of this library: none is ever reported as another.

mod branches;
mod common_zeros;
mod finite;
mod instantaneous;
mod kutzbach;
mod near;
mod nearby;
mod second_order;
mod tracking;

pub use branches::branch_dimensions;
pub use finite::{BoundOrigin, FiniteMobility, finite_mobility};
pub use instantaneous::{
    InstantaneousMobility, RANK_THRESHOLD, augmented_mobility, instantaneous_mobility,
};
pub use kutzbach::kutzbach_mobility;
pub(crate) use near::check_tolerance;
pub use near::{
    ForcedClosure, NearMiss, NearMobility, TOLERANCES, near_miss, near_mobility, near_tolerances,
};
pub use nearby::{FreeMotions, NearbyConfigurations};
pub use second_order::SecondOrder;
pub(crate) use second_order::quadrics;
