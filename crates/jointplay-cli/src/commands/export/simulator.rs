//! Models of simulators: MJCF, SDF and URDF.

use jointplay::interop::export::mechanism::{self, Error, Written};
use jointplay::mechanism::Mechanism;
use jointplay::nalgebra::DVector;

use super::files::{Files, Format};
use crate::failure::Failure;

/// The files of a mechanism at a configuration in one format.
pub(super) fn files(
    format: Format,
    mechanism: &Mechanism,
    coordinates: &DVector<f64>,
    stem: &str,
) -> Result<Files, Failure> {
    let (name, extension, written) = match format {
        Format::Mjcf => ("MJCF", "xml", mechanism::mjcf(mechanism, coordinates)),
        Format::Sdf => ("SDF", "sdf", mechanism::sdf(mechanism, coordinates)),
        Format::Urdf => ("URDF", "urdf", mechanism::urdf(mechanism, coordinates)),
    };
    let Written { text, loops, lost } = written.map_err(|error| match error {
        Error::Core(error) => Failure::Core(error),
        other => Failure::Usage(other.to_string()),
    })?;
    let mut files = vec![(format!("{stem}.{extension}"), text.into_bytes())];
    files.extend(loops.map(|loops| (format!("{stem}-loops.toml"), loops.into_bytes())));
    Ok(Files { format: name, files, lost })
}
