//! Imports and exports: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod asmt;
mod dialect;
mod export;
mod fmu;
mod formats;
mod freecad;
mod host;
mod loop_files;
mod loops;
mod mechanism_export;
#[path = "../../jointplay-format/tests/message_words.rs"]
mod message_words;
mod messages;
mod modelica_text;
mod models;
mod parts;
mod peaks;
mod planned;
mod sample_columns;
#[path = "../src/import/testing.rs"]
mod testing;
mod timeline;

use jointplay_interop::import::{Imported, parse_with_unit};
