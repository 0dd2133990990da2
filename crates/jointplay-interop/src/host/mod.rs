//! A simulated controller that host software talks to: commands in lines of text, and answers from templates.
//!
//! ```text
//!   line ──pattern──▶ program ──plan and check──▶ accepted … completed
//!                        │                │
//!                     refused          refused
//! ```
//!
//! | type | contents |
//! | --- | --- |
//! | [`HostLanguage`] | patterns of commands and templates of answers, from a TOML file |
//! | [`HostSession`] | the robot of one host: lines and times in, answers out; no sockets and no clock |
//! | [`HostSnapshot`] | the robot between two events of a session, for observers |
//!
//! The neutral language is included; languages of other controllers are files of users.

mod command;
mod field;
mod language;
mod pattern;
mod read;
mod refusal;
mod session;
mod snapshot;

pub use crate::controller_text::{CommandProblem, Problem};
pub use language::{HostLanguage, NEUTRAL};
pub use read::MAX_BYTES;
pub use refusal::{REFUSAL_REASONS, RefusalReason};
pub use session::{HostSession, MAX_LINE_BYTES};
pub use snapshot::{HostEvent, HostSnapshot, HostState, Outcome};
