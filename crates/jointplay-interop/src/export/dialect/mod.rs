//! Controller text: lines from the templates of a dialect file.
//!
//! A template is text with fields in braces: a name or an expression of numbers, and a format, as in `{slot:02}` or `{1000 * duration:.0f}`; `{{` and `}}` represent the braces themselves.
//!
//! | key | written | names |
//! | --- | --- | --- |
//! | `begin`, `end` | once | `cell`, `robot`, `axes`, `positions`, `poses`, `time` |
//! | `instruction` | before the first motion of each instruction | `number`, `line`, `text` |
//! | `axes`, `line`, `still` | for each motion: of axes, along a line, none; these three or `point` | `number`, `phase`, `time`, `duration`, `positions`, `poses`, `effector`; for `line` also the pose |
//! | `point` | at equal intervals of time | `number`, `time`, `positions`, `velocities`, `poses` |
//! | `blend` | between two blended motions | `overlap` |
//! | `taken`, `left` | where a wafer is taken or left | `effector`, `station`, `slot`, `effector_code`, `station_code`, and the pose |
//! | `axis` | for each axis within `positions` and `velocities`, with `between` between them | `name`, `value`, `number` |
//! | `pose` | for each effector within `poses` | `effector`, `effector_code`, and the pose |
//! | `comment` | violations of the motion, before everything else | `text` |
//!
//! The pose of a wafer has `x`, `y`, `z`, `heading`, `tilt` and `tilt_azimuth`, in the base frame.
//!
//! The table `[output]` has the form of the lines, with numbers and checksums; `[station_codes]` and `[effector_codes]` have the codes of the controller for the names of the cell.

mod included;
mod language;
mod pose;
mod read;
mod write;

pub use crate::controller_text::Problem;
pub use included::{DIALECTS, IncludedDialect};
pub use language::Dialect;
pub use read::MAX_BYTES;
