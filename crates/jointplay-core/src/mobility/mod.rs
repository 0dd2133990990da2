//! What can move: by counting, to first order, and for real.
//!
//! | question | function |
//! | --- | --- |
//! | what does a count of links and joints give? | [`kutzbach_mobility`] |
//! | which motions do the constraints allow to first order? | [`instantaneous_mobility`] |
//! | …with the virtual joints free as well? | [`augmented_mobility`] |
//! | in how many directions can it really go? | [`finite_mobility`] |
//! | …and do branches of other dimensions meet there? | [`branch_dimensions`] |
//! | …if its dimensions are true only to a tolerance? | [`near_mobility`] |
//! | …and would a small tolerance make a difference? | [`near_miss`] |
//!
//! The answers differ at a singular configuration, and that difference is the subject of this library: none is ever reported as another.

mod branches;
mod finite;
mod instantaneous;
mod kutzbach;
mod near;
mod nearby;
mod search;
mod second_order;

pub use branches::branch_dimensions;
pub use finite::{FiniteMobility, finite_mobility};
pub use instantaneous::{
    InstantaneousMobility, RANK_THRESHOLD, augmented_mobility, instantaneous_mobility,
};
pub use kutzbach::kutzbach_mobility;
pub use near::{
    ForcedClosure, NearMiss, NearMobility, TOLERANCES, near_miss, near_mobility, near_tolerances,
};
pub use nearby::NearbyConfigurations;
pub use second_order::SecondOrder;
pub(crate) use second_order::quadrics;
