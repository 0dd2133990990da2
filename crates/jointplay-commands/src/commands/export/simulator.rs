//! Models of simulators: MJCF, SDF, URDF and Modelica.

use jointplay::interop::export::mechanism::{Error, Written};

use super::files::Files;
use crate::failure::Failure;

/// The files of a model in one format.
///
/// # Arguments
/// * `format` – its name, and the extension of its file
pub(super) fn files(
    (name, extension): (&'static str, &str),
    written: Result<Written, Error>,
    stem: &str,
) -> Result<Files, Failure> {
    let Written { text, loops, lost } = written.map_err(|error| match error {
        Error::Core(error) => Failure::Core(error),
        other => Failure::Usage(other.to_string()),
    })?;
    let mut files = vec![(format!("{stem}.{extension}"), text.into_bytes())];
    files.extend(loops.map(|loops| (format!("{stem}-loops.toml"), loops.into_bytes())));
    Ok(Files { format: name, files, lost })
}
