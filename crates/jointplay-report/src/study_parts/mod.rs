//! A study in parts: a chunk each, computed anywhere and in any order, and gathered into the table and summary of one machine.
//!
//! A folder of parts has `study.json`, and for each finished part its table, such as `part-000017.parquet`, then its record `part-000017.json` with the totals.
//! A part is finished once it has a record, which is written last.
//!
//! | to… | use |
//! | --- | --- |
//! | describe the folder, and refuse another study | [`Manifest`], [`digest`] |
//! | name the files of a part | [`PartNames`] |
//! | compute a part | [`PartWriter`] → [`PartFiles`] |
//! | list what is finished and what is missing | [`status`] |
//! | put the parts together | [`Gathering`]; only their totals [`TotalsOfParts`] |

mod digest;
mod error;
mod gathering;
mod manifest;
mod names;
mod part;
mod status;
mod totals_of_parts;

pub use digest::digest;
pub use error::PartsError;
pub use gathering::Gathering;
pub use manifest::{MANIFEST, Manifest};
pub use names::PartNames;
pub use part::{PartFiles, PartWriter};
pub use status::{StatusReport, status};
pub use totals_of_parts::TotalsOfParts;
