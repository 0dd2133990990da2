//! Mechanisms from model files of other programs: MJCF, SDF, URDF and documents of FreeCAD, distinguished by their root element, and ASMT of FreeCAD.
//!
//! Parts that do not affect the mechanism, such as shapes and masses, are listed as ignored.
//! An unsupported part that would affect the mechanism is an error with its place.
//!
//! ```
//! let model = jointplay_interop::import::parse(r#"
//!     <robot name="door">
//!       <link name="wall"/>
//!       <link name="door"><visual/></link>
//!       <joint name="hinge" type="continuous">
//!         <parent link="wall"/>
//!         <child link="door"/>
//!         <axis xyz="0 0 1"/>
//!       </joint>
//!     </robot>"#)?;
//! assert_eq!(model.mechanism.links(), ["wall", "door"]);
//! assert_eq!(model.ignored, ["1 × visual"]);
//! # Ok::<(), jointplay_interop::import::Error>(())
//! ```

mod draft;
mod drive_table;
mod freecad;
mod loops;
mod mjcf;
mod model;
mod problem;
mod read;
mod repair;
mod sdf;
mod starts;
#[cfg(test)]
mod testing;
mod urdf;
mod urdf_constraint;
mod urdf_place;
mod xml;
mod xml_limits;

pub use drive_table::{
    DriveColumn, DriveTable, DriveTableError, MAX_COLUMNS, MAX_ROWS, MAX_TABLE_BYTES, drive_table,
};
pub use freecad::{ArchiveError, MAX_DOCUMENT_BYTES, document_text, is_archive, is_document_name};
pub use loops::{LoopsError, is_loops_of_another_program};
pub use mjcf::{Expanded, IncludeError, expand_includes};
pub use model::{Dialect, Imported};
pub use problem::{Error, Problem};
pub use read::{
    ClosedError, is_assembly, is_model, is_picture, parse, parse_closed, parse_with_unit,
};
