//! Exports of a cell's motion as text or bytes.
//!
//! | to… | use | units |
//! | --- | --- | --- |
//! | a spreadsheet or a data frame | [`samples`](fn@samples) or [`samples_with`] chosen columns, then [`jointplay_report::table::csv`] or [`jointplay_report::table::parquet`] | mm, degrees, in the names of the columns |
//! | a viewer that shows a part of a long motion | [`Timeline`]: independent windows of steps | m, rad |
//! | a 3D viewer | [`gltf`](fn@gltf): one binary file with an animation | m, y up |
//! | Foxglove, PlotJuggler or ROS 2 | `mcap::write`: JointState, JointTrajectory and transforms | m, rad |
//! | SolidWorks | [`solidworks`](fn@solidworks): a file for each motor, and a macro that loads them | mm, degrees |
//! | a controller | [`dialect::Dialect`]: lines from templates | those of the dialect |
//! | a reader | [`report_page`](fn@report_page): one page of HTML; [`top_view`], [`timing_diagram`]: pictures | mm, degrees |
//!
//! Each export begins at 0 and ends at the exact duration of the motion.
//! Each export reports the violations of the motion.

mod channel;
mod curve_reduction;
pub mod dialect;
mod error;
mod gltf;
mod joint_points;
#[cfg(feature = "mcap")]
pub mod mcap;
pub mod mechanism;
mod mechanism_shapes;
mod motion_export;
mod pictures;
mod report_page;
mod sample_columns;
mod samples;
mod scene;
mod segment;
mod solidworks;
mod timeline;
mod violation_note;
mod wafer_frames;

pub use error::Error;
pub use gltf::{
    AnimatedParts, KEY_TOLERANCE, MechanismMotion, PartTable, PartsError, PartsFile, UpAxis, gltf,
    gltf_within, proportional_times,
};
pub use mechanism_shapes::MechanismShapes;
pub use motion_export::{MOST_SAMPLES, MotionExport};
pub use pictures::{PictureError, postures_view, taught_planes, timing_diagram, top_view};
pub use report_page::report_page;
pub use sample_columns::{
    COLUMN_GROUPS, DEFAULT_COLUMNS, POSE_COLUMNS, SampleColumn, sample_columns, select_columns,
};
pub use samples::{SampleOptions, frame_poses, samples, samples_in_parts, samples_with, tracks};
pub use scene::{Frame, frames};
pub use solidworks::{MACRO, loader, motor, motors, solidworks, solidworks_names};
pub use timeline::{Envelope, HeldAt, Timeline, Window, wafers_at_start};
pub use violation_note::{ViolationNote, violation_notes};
