//! Study files: what is varied, over which values or at random, and what is written of each sample.
//!
//! | to… | use |
//! | --- | --- |
//! | read a study file | [`parse`] → [`StudyFile`] |
//! | list those that come with the program | [`examples`] |
//! | know the columns of its table | [`StudyFile::columns`] |

mod cell_sample;
mod cell_study;
mod examples;
mod fact;
mod file;
mod mechanism_study;
mod names;
mod platform;
mod problem;
mod quantity;
mod read;
mod sources;
mod spread;
mod tree;

pub use examples::{Example, example, examples};
pub use file::StudyFile;
pub use names::{Column, Source};
pub use problem::{Error, Errors, Problem};
pub use read::{MAX_BYTES, parse};
pub use sources::{Sources, from_files, included};
