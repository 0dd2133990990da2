//! Files of jointplay: robots, mechanisms, cells, programs and studies, read and written as text.
//!
//! Files use mm and degrees, results are in SI; this crate converts, and opens no file.
//!
//! | to… | use |
//! | --- | --- |
//! | read or write a robot file | [`robot::parse`], [`robot::write`] |
//! | read or write a mechanism file | [`mechanism::parse`], [`mechanism::write`] |
//! | convert a three-rod robot into a mechanism, or back | [`three_rods::mechanism_file`], [`three_rods::robot`] |
//! | find the kind of a file | [`mechanism::kind_of`] |
//! | name the coordinates of a mechanism, in its units | [`coordinates::Coordinates`] |
//! | list the included example files | [`catalogue::entries`] |
//! | read a cell file | [`cell::read`] |
//! | read, format or write a program of a cell | [`program::parse`], [`program::format`](fn@program::format), [`program::write`] |
//! | read a study file | [`study::parse`] |
//! | evaluate an expression of named numbers | [`expression::Formula`] |
//! | read `FROM:TO:STEP` | [`steps::parse`] |
//! | read a request in JSON | [`json::read`] |
//! | convert units without changing decimals | [`units`] |
//! | state an error of the core in mm and degrees | [`explain::explain`] |
//! | format a number or a count for a message | [`number::number`], [`number::counted`] |
//!
//! ```
//! let robot = jointplay_format::robot::paper();
//! assert_eq!(robot.gpr, jointplay_core::gpr::Gpr::paper());
//! ```

pub mod catalogue;
pub mod cell;
pub mod command;
pub mod coordinates;
pub mod display_units;
pub mod explain;
pub mod expression;
pub mod file_problem;
pub mod json;
mod line_ends;
pub mod mechanism;
pub mod number;
pub mod place;
pub mod program;
pub mod robot;
pub mod steps;
pub mod study;
pub mod three_rods;
pub mod toml_reader;
pub mod units;
