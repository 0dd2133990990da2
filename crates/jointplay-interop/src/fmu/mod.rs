//! Functional mock-up units (FMI 2.0 and 3.0 for co-simulation) of mechanisms and three-rod robots.
//!
//! ```text
//!   mechanism or robot file ──Resources──▶ Fmu ──variables──▶ modelDescription.xml ─┐
//!                                │                                                  ├─▶ NAME.fmu
//!                                └──────────────── texts ────────── shared library ─┘
//! ```
//!
//! | type | role |
//! | --- | --- |
//! | [`Resources`] | the files of a unit that describe its model |
//! | [`Fmu`] | one instance: drives in; poses, displacements of virtual joints and their rates out |
//! | [`Variable`] | a scalar variable of the unit |
//! | [`Binary`] | a shared library and its platform |
//! | [`archive`](fn@archive) | the unit as one file |
//!
//! An instance calls the library of mechanisms and robots, and has no equations of its own.

mod archive;
mod binary;
mod description;
mod error;
mod instance;
mod library_place;
mod mechanism_model;
mod model;
mod resources;
mod robot_model;
mod solved;
mod state;
mod variable;

pub(crate) use archive::MODEL_DESCRIPTION;
pub use archive::{ArchiveError, archive, model_identifier};
pub use binary::{Binary, BinaryError, library_mark};
pub use description::{FmiVersion, model_description};
pub use error::Error;
pub use instance::Fmu;
pub use library_place::library_places;
pub use resources::{RESOURCE_FILES, Resources};
pub use state::State;
pub use variable::{Causality, Quantity, Variable};
