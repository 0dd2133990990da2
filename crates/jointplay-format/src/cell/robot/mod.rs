//! Files of robots with arms.
//!
//! ```
//! use jointplay_format::{catalogue, cell::robot};
//!
//! let robot = robot::parse(catalogue::find("dual-arm").unwrap().text).unwrap();
//! let axes: Vec<&str> = robot.axes.iter().map(|axis| axis.name.as_str()).collect();
//! assert_eq!(axes, ["q1", "q2", "q3", "T", "RA", "RB"]);
//! ```

mod arm;
mod axes;
mod base;
mod included;
mod read;
mod words;

pub use base::virtualization_name;
pub use included::names;
pub(super) use read::from_table;
pub use read::parse;
pub use words::KIND;
pub(super) use words::ROD_NAMES;
