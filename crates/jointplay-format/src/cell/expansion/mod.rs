//! Expansion of a cell file: templates, patterns and parts become tables without them.
//!
//! The readers of stations, bodies and zones then know nothing of templates, patterns and parts.
//! Errors in the expanded document have their places in the file, see [`Reader::copy`](crate::toml_reader::Reader) and [`Inclusion`](crate::toml_reader::Inclusion).
//!
//! | file | contents |
//! | --- | --- |
//! | `document` | lists of tables, copied with other positions |
//! | `groups` | names of bodies that patterns and parts generate |
//! | `inheritance` | tables with `like` |
//! | `pattern` | tables with `repeat` |
//! | `lists` | tables of stations, bodies, zones and frames, with their templates and patterns |
//! | `library` | texts of parts |
//! | `part` | tables with `part` |
//! | `contacts` | allowed contacts of groups of bodies |
//! | `expand` | all of it, in this order |
//! | `print` | the expanded document as text |

mod contacts;
mod document;
mod expand;
mod groups;
mod inheritance;
mod library;
mod lists;
mod part;
mod pattern;
mod print;

pub(super) use expand::expand;
pub(super) use inheritance::is_replaced;
pub(super) use library::{Library, is_station};
pub use library::{Part, PartParameter, parts};
pub(super) use print::print;
