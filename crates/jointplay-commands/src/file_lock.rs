//! Locks on files that one run at a time may write.

use std::fs::{File, TryLockError};
use std::path::Path;

use crate::failure::Failure;

/// Locks a file against other runs until it is closed.
///
/// # Errors
/// [`Failure::Usage`] while another run has it locked.
pub(crate) fn lock(file: &File, path: &Path) -> Result<(), Failure> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(Failure::Usage(format!(
            "another run is writing {}: wait for it to end, or choose another --out",
            path.display()
        ))),
        Err(TryLockError::Error(source)) => Err(Failure::Write { path: path.to_owned(), source }),
    }
}
