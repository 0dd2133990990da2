//! The local server of the studio: serves the page, and the HTTP API that the page and programs speak to.
//!
//! A door: it translates requests for the library and answers for the wire, and computes nothing.
//!
//! | file | role |
//! | --- | --- |
//! | `server.rs` | from a robot to a running server: port, Ctrl-C |
//! | `app.rs` | which path is answered by what, and the OpenAPI description |
//! | `guard.rs` | who may ask: hosts, origins, security headers, time |
//! | `body.rs` | JSON bodies read strictly, each error with its field |
//! | `strict.rs` | objects of JSON read as objects only |
//! | `problem.rs` | what went wrong, as RFC 9457 says it |
//! | `study.rs` | studies, computed and sent batch by batch |
//! | `work.rs` | computations kept off the thread that serves |
//! | `cell.rs` | the cell's files, and what a program comes to in it |
//! | `meshes.rs` | shapes from the robot file's folder |
//! | `page.rs` | the built page, embedded |
//! | `wire/` | what requests and answers look like |
//! | `routes/` | one file an endpoint |

mod app;
mod body;
mod cell;
mod cell_plan;
mod guard;
mod meshes;
mod page;
mod problem;
mod routes;
mod server;
mod strict;
mod study;
#[cfg(test)]
mod tests;
mod wire;
mod work;

pub use app::description;
pub use cell::{CellFiles, EXAMPLE};
pub use server::{DEFAULT_PORT, Error, Server};
