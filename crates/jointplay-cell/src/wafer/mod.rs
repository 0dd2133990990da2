//! Wafers on effectors: plates that sag and may slip, arms that droop, and the compensation of droop and sag by the platform.
//!
//! | file | contents |
//! | --- | --- |
//! | `model` | descriptions of wafers, supports, and the droop of arms |
//! | `plate`, `sag` | deflection of a wafer on its supports |
//! | `droop` | deflection of an arm by reach and load |
//! | `deflection` | poses of wafers on drooping arms |
//! | `acceleration` | motions of wafers on drooping arms |
//! | `compensation` | inverse kinematics of drooping arms |
//! | `friction` | friction that a wafer needs to stay on its effector |

mod acceleration;
mod cache_key;
mod compensation;
mod deflection;
mod droop;
mod friction;
mod model;
mod monotone_cubic;
mod plate;
mod sag;
mod unreachable;
mod validate;

pub use compensation::CompensatedPose;
pub use deflection::apply_deflection;
pub use droop::{Deflection, DroopError};
pub(crate) use droop::{DroopBounds, MIN_REACH};
pub use friction::FrictionDemand;
pub use model::{Droop, DroopRow, Material, Support, Wafer};
pub use sag::{Sag, SagError, sag};
pub use unreachable::{RejectedBranch, Unreachable};
pub use validate::check_thin_plate;
