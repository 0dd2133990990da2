//! The local server of the studio: it serves the page and the HTTP API of page and programs.
//!
//! The crate translates requests to calls of the library and results to documents; it computes nothing itself.
//! A file imports only from lines below it.
//!
//! | file | contents |
//! | --- | --- |
//! | `server.rs` | start of the server: port, shutdown by Ctrl-C |
//! | `router.rs` | the routes of the API and their OpenAPI description |
//! | `routes/` | one file for each endpoint |
//! | `study.rs` | studies, computed and streamed in batches |
//! | `state.rs` | the state that all requests share |
//! | `session.rs` | the work cell under edit: its files and the last plans |
//! | `plan.rs` | the plan of a program in a cell |
//! | `wire/` | the documents of requests and responses |
//! | `robot_file.rs` | the robot that the server was started with, and its file |
//! | `text_file.rs` | reading and saving of edited text files |
//! | `cell_files.rs` | cell file and program file |
//! | `controller.rs` | the simulated controller that the page shows |
//! | `mechanism_file.rs` | the mechanism that the server was started with |
//! | `mechanism_source.rs`, `configuration.rs` | mechanisms of requests, and their configurations as documents |
//! | `meshes.rs` | mesh files named in the robot file |
//! | `body.rs` | bodies of requests in JSON |
//! | `length_header.rs` | the header that names the unit of lengths in messages |
//! | `guard.rs` | access control: hosts, origins, security headers, deadline |
//! | `page.rs` | the built page and the description of the API, embedded |
//! | `compression.rs` | compression of responses |
//! | `work.rs` | computations on worker threads |
//! | `ping.rs` | whether a studio answers |
//! | `problem.rs` | errors as problem documents (RFC 9457) |
//! | `display.rs` | units of lengths in the messages of a response |

mod body;
mod cell_files;
mod compression;
mod configuration;
mod controller;
mod display;
mod guard;
mod length_header;
mod mechanism_file;
mod mechanism_source;
mod meshes;
mod page;
mod ping;
mod plan;
mod problem;
mod robot_file;
mod router;
mod routes;
mod server;
mod session;
mod state;
mod study;
#[cfg(test)]
mod tests;
mod text_file;
mod wire;
mod work;

pub use cell_files::{CellFiles, EXAMPLE};
pub use controller::{ControllerMonitor, HostPlace};
pub use mechanism_file::MechanismFileOnDisk;
pub use ping::ping;
pub use robot_file::RobotFileOnDisk;
pub use router::description;
pub use server::{DEFAULT_PORT, Error, Server};
