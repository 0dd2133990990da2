//! Ctrl-C: a study stops after the current chunk.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Whether Ctrl-C was pressed.
pub(super) fn requested() -> bool {
    STOP.load(Ordering::SeqCst)
}

/// Makes Ctrl-C stop the study after the current chunk, and a second Ctrl-C at once.
pub(super) fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            // What is on the disk covers the finished chunks; the next run continues from it.
            #[expect(clippy::exit, reason = "a second Ctrl-C asks for an immediate end")]
            std::process::exit(130);
        }
    })
    .map_err(|error| Failure::Usage(format!("cannot listen for Ctrl-C: {error}")))
}
