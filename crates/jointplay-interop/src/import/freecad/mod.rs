//! Assemblies of FreeCAD 1.x: the text of its solver (ASMT), and documents (FCStd).

mod archive;
pub(super) mod asmt;
pub(super) mod assembly;
mod document;
mod joint_limits;
mod joint_series;
mod part_coupling;
mod path_end;
mod placed_joint;
mod solver_kind;

pub use archive::{ArchiveError, MAX_DOCUMENT_BYTES, document_text, is_archive, is_document_name};
