//! Many poses at a time: columns of numbers in, columns of numbers out, in memory of the caller.
//!
//! | to… | use |
//! | --- | --- |
//! | find the rods of many tilts | [`Gpr::inverse_many`](crate::gpr::Gpr::inverse_many) |
//! | find the poses of many rods | [`Gpr::forward_many`](crate::gpr::Gpr::forward_many) |
//! | prepare forward kinematics for many calls | [`PoseSolver`] |
//! | pass numbers: contiguous, every n-th, or one for all | [`Column`] |
//! | choose the quantities to compute | [`Quantity`] |
//! | find the limits that many poses exceed | [`Gpr::broken_limits_many`](crate::gpr::Gpr::broken_limits_many) |
//! | find the sines and cosines of many angles | [`sin_cos`] |
//! | find the poses without a solution, and the reasons | [`Status`], [`StatusCounts`] |
//! | split the work | [`parts`] |
//! | know the instructions of the processor | [`instruction_set`] |
//!
//! Each pose equals that of [`Gpr::forward`](crate::gpr::Gpr::forward) to 10⁻¹² of the platform's size, and is independent of the other poses.
//! A pose without a solution, or beyond the limits of a robot that checks them, is NaN in every column of numbers, and the column of statuses holds its reason; the other poses are computed.
//!
//! ```
//! use jointplay_core::bulk::{Column, Quantity, Status};
//! use jointplay_core::gpr::Gpr;
//! use jointplay_core::virtualization::{Planar, SolveOptions};
//!
//! let (gpr, q_1, rest) = (Gpr::paper(), [0.499, 0.5, f64::NAN], 0.5);
//! let rods = [Column::from(&q_1[..]), Column::constant(&rest, 3), Column::constant(&rest, 3)];
//! let (mut tilt_angle, mut status) = ([0.0; 3], [Status::Solved; 3]);
//! let wanted = &mut [(Quantity::TiltAngle, &mut tilt_angle[..])];
//! let tally = gpr.forward_many(rods, &Planar, &SolveOptions::default(), &mut status, wanted)?;
//! assert_eq!((tally.failed(), status[2]), (1, Status::NotFinite));
//! assert!(tilt_angle[0] > 0.0 && tilt_angle[1] == 0.0 && tilt_angle[2].is_nan());
//! # Ok::<(), jointplay_core::Error>(())
//! ```

mod blocks;
mod column;
mod forward;
mod instruction_set;
mod inverse;
mod limits;
mod parts;
mod pose_solver;
mod quantity;
mod results;
mod sin_cos;
mod singular_values;
mod status;

pub use column::Column;
pub use instruction_set::instruction_set;
pub use parts::{Part, parts};
pub use pose_solver::PoseSolver;
pub use quantity::Quantity;
pub use sin_cos::sin_cos;
pub use status::{Status, StatusCounts};
