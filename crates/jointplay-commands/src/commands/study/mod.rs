//! `jointplay study`: studies of any length, on all cores, interruptible and resumable.
//!
//! | file | role |
//! | --- | --- |
//! | `command.rs` | the flags, and the run from file to table |
//! | `source.rs` | the study file and the robot or mechanism that it names |
//! | `destination.rs` | the destination of the table: a file, or standard output |
//! | `part_file.rs` | an incomplete table on the disk, and the marker for resuming it |
//! | `parts.rs` | studies in parts: the flags, and computing, listing and gathering |
//! | `parts_folder.rs` | a folder of parts on the disk |
//! | `interrupt.rs` | Ctrl-C |
//! | `estimate.rs` | expected size and duration |
//! | `text.rs` | the summary as text |

mod command;
mod destination;
mod estimate;
mod interrupt;
mod part_file;
mod parts;
mod parts_folder;
mod source;
mod text;

pub(crate) use command::StudyCommand;
