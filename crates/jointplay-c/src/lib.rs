//! C interface of jointplay: `jointplay.h`, from this source by cbindgen.
//!
//! It checks pointers and numbers, calls the library, and copies the results; it computes nothing.
//! Each entry catches panics, so that none unwinds into foreign code.

mod catch;
mod mechanism;
mod pointer;
mod request;
mod robot;
mod status;

pub use mechanism::*;
pub use robot::*;
pub use status::*;

/// Handles are shared between threads.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<JpRobot>();
    shared::<JpMechanism>();
};
