//! Files that a cell names.

use crate::robot::stays_within;

/// Returns the bytes of a file that a cell names, or the reason why it cannot be read.
pub type Files<'f> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'f;

/// The bytes of a file within the cell's folder.
pub(super) fn read_named_file(name: &str, files: &mut Files) -> Result<Vec<u8>, String> {
    if !stays_within(name) {
        return Err(
            "it has to be a path within the cell file's folder, with / between names and without `..`"
                .to_owned(),
        );
    }
    files(name)
}
