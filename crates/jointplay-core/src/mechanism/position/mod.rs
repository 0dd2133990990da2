//! Positions, velocities and accelerations, fast: what passive and virtual joints do for commanded ones, without allocation.

mod bordered;
mod closing_geometry;
mod differential;
mod dimension;
mod elimination;
mod field;
mod frame;
mod frame_jacobian;
mod frame_motion;
mod lane_elimination;
mod lane_frame;
mod least_displacement;
mod many;
mod newton_step;
mod opening;
mod solver;
mod unknown;
mod walk;

pub use differential::DifferentialKinematics;
pub use dimension::{ChangedDimension, DimensionDerivatives};
pub use frame_jacobian::{Dexterity, dexterity};
pub use solver::{Position, PositionSolver};
