//! Mechanism files: TOML with links, joints, virtual joints and frames, parameters and formulas.
//!
//! ```
//! let file = jointplay_format::mechanism::parse(r#"
//!     kind = "mechanism"
//!     name = "door"
//!     units = { length = "mm", angle = "deg" }
//!     base = "wall"
//!     [parameters]
//!     width = 900
//!     [[joint]]
//!     name = "hinge"
//!     kind = "revolute"
//!     links = ["wall", "door"]
//!     point = ["width / 2", 0, 0]
//!     axis = [0, 0, 1]
//!     limits = [0, 90]
//! "#)?;
//! let hinge = &file.mechanism.joints()[0];
//! assert_eq!(hinge.frames[0].translation.x, 0.45);
//! assert_eq!(hinge.limits, [[0.0, f64::to_radians(90.0)]]);
//! # Ok::<(), jointplay_format::mechanism::Errors>(())
//! ```

mod attached_frame;
mod changed_dimension;
mod coupling;
mod edit;
pub mod frame;
mod header;
mod joint;
mod kind;
mod loops;
mod names;
mod problem;
mod read;
mod tree;
mod values;
mod virtual_joint;
mod write;

pub use changed_dimension::{ParameterError, changed_dimension};
pub use edit::with_virtual_joints;
pub use header::MAX_BYTES;
pub use kind::kind_of;
pub use loops::with_loops;
pub use names::allowed_joint_name;
pub use problem::{Error, Errors, Problem};
pub use read::{Expected, MechanismFile, parse, parse_with};
pub use values::{LARGEST_COORDINATE, LengthUnit, Units};
pub use write::{write, write_loops};

pub use crate::expression::{AngleUnit, ExpressionProblem};
