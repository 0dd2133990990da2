//! Import of models of other programs, and export of motions.
//!
//! | to… | use |
//! | --- | --- |
//! | import a model of MuJoCo, Gazebo, ROS or FreeCAD | [`import::parse`] |
//! | export a cell's motion | [`export`] |
//! | export a mechanism or a robot to simulators as a functional mock-up unit | [`fmu`] |
//! | answer host software as a simulated controller | [`host`] |
//! | recognise the kind of a file | [`FileKind`] |

mod controller_text;
pub mod export;
mod file_kind;
pub mod fmu;
pub mod host;
pub mod import;

pub use file_kind::FileKind;
