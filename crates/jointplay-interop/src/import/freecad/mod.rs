//! Assemblies of FreeCAD 1.x: the text of its solver (ASMT), and documents (FCStd).

mod archive;
pub(super) mod asmt;
pub(super) mod assembly;
mod document;
mod joint_limits;
mod part_coupling;
mod placed_joint;

pub use archive::{ArchiveError, MAX_DOCUMENT_BYTES, document_text, is_archive, is_document_name};
