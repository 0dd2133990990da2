//! Files and text of jointplay: robot and mechanism files in; JSON, CSV and Parquet out.
//!
//! The one place that knows serde, millimetres and degrees; takes and gives text or bytes, and opens no file.
//!
//! | to… | use |
//! | --- | --- |
//! | read a robot file | [`robot::parse`] |
//! | read or write a mechanism file | [`mechanism::parse`], [`mechanism::write`] |
//! | take over a model of MuJoCo, Gazebo or ROS | [`import::parse`] |
//! | tell which of them a file is | [`mechanism::kind_of`] |
//! | name its coordinates, in its units | [`coordinates::Coordinates`] |
//! | list the files that come with the program | [`catalogue::entries`] |
//! | read `FROM:TO:STEP` | [`steps::parse`] |
//! | change units without changing decimals | [`units`] |
//! | read, lay out or write a program of a cell | [`program::parse`], [`program::format`](fn@program::format), [`program::write`] |
//! | say an error of the core in mm and degrees | [`explain::explain`] |
//! | format a number or a count for a message | [`number::number`], [`number::counted`] |
//! | give results to a program | [`report`] |
//! | give a cell's motion to other programs | [`export`] |
//! | read a study file, and write its table of any length | [`study::parse`], [`study::Table`] |
//! | give a study to a spreadsheet or a data frame | [`table`] |
//!
//! ```
//! let robot = jointplay_format::robot::paper();
//! assert_eq!(robot.gpr, jointplay_core::gpr::Gpr::paper());
//! ```

pub mod catalogue;
pub mod cell;
pub mod coordinates;
pub mod explain;
pub mod export;
pub mod import;
pub mod mechanism;
pub mod number;
pub mod place;
pub mod program;
pub mod report;
pub mod robot;
pub mod steps;
pub mod study;
pub mod table;
pub mod units;
