//! The GPR: three parallel rods of adjustable length under a platform on three ball joints.
//!
//! | quantity | is |
//! | --- | --- |
//! | B_k | where rod k's axis crosses the base plane |
//! | q_k | length of rod k, the actuated coordinate |
//! | P_k = B_k + q_k e_b3 | centre of ball k |
//! | L_12, L_23, L_31 | sides of the triangle of the ball centres |

mod approximate;
mod ball_clearance;
mod forward;
mod geometry;
mod height;
mod in_plane;
mod inverse;
mod limb_state;
mod limit_clamp;
mod limits;
mod nearest_rods;
mod placement;
mod platform_derivatives;
#[cfg(feature = "std")]
mod recognition;
mod rod_derivatives;
#[cfg(feature = "std")]
mod system;
#[cfg(feature = "std")]
mod tilt_play;
#[cfg(feature = "std")]
mod to_mechanism;

pub use approximate::ApproximatePose;
pub use ball_clearance::BallClearance;
pub use forward::PlatformPose;
#[cfg(feature = "std")]
pub(crate) use forward::solution;
pub use geometry::{Gpr, Limb, ball_sides};
pub use height::{AxisHeight, CenterHeight};
pub use limits::{BrokenLimit, BrokenLimits, Limits};
pub use nearest_rods::NearestRods;
pub use platform_derivatives::{PlatformDerivatives, PlatformJacobian};
#[cfg(feature = "std")]
pub use recognition::{NotThreeRods, RodCoordinate, ThreeRodMechanism};
pub use rod_derivatives::RodDerivatives;
#[cfg(feature = "std")]
pub use system::GprSystem;
#[cfg(feature = "std")]
pub use tilt_play::{EvaluatedBounds, TiltPlay};
