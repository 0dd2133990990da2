//! Study files: what is varied, over which values or at random, and what is written of each sample.
//!
//! | to… | use |
//! | --- | --- |
//! | read a study file | [`parse`] → [`StudyFile`] |
//! | list those that come with the program | [`examples`] |
//! | know the columns of its table | [`StudyFile::columns`] |

mod examples;
mod names;
mod problem;
mod read;
mod spread;
mod tree;

pub use examples::{Example, example, examples};
pub use names::{Column, Source};
pub use problem::{Error, Errors, Problem};
pub use read::{MAX_BYTES, StudyFile, parse, robot_of};
