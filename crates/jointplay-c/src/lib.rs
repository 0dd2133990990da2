//! C interface of jointplay: `include/jointplay.h`, generated from this source by cbindgen.
//!
//! Entries check pointers and numbers, call the library, and copy results; they compute nothing.
//! Each entry catches panics, so that none unwinds into foreign code.

mod block;
mod catch;
pub mod fmi;
mod mechanism;
mod motion_request;
mod pointer;
mod request;
mod robot;
mod status;
mod text;
mod transform;
mod virtualization;

pub use mechanism::*;
pub use robot::*;
pub use status::*;
pub use text::*;
pub use virtualization::*;

/// Handles are shared between threads.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<JpRobot>();
    shared::<JpMechanism>();
};
