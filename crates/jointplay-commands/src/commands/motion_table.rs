//! Tables of values of driven coordinates for `jointplay move`.

use std::path::Path;

use jointplay::interop::import::{self, DriveColumn};
use jointplay::mechanism::DrivePath;
use jointplay::report::MotionParameter;

use super::motion_course::Course;
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::source;

/// The path through the rows of a table.
pub(super) fn course(input: &Input, file: &Path) -> Result<Course, Failure> {
    let source = source::Source::read(file, import::MAX_TABLE_BYTES)?;
    let table = import::drive_table(&source.text, &input.coordinates, &input.file.mechanism)
        .map_err(|error| Failure::Usage(format!("{}: {error}", source.label)))?;
    let parameter =
        table.variable.map(|DriveColumn { name, values }| MotionParameter { name, values });
    let steps = table.values[0].len() - 1;
    let point = |row: usize| table.values.iter().map(|column| column[row]).collect();
    let path = DrivePath::through(table.coordinates, (0..=steps).map(point).collect())?;
    Ok(Course { path, steps, parameter })
}
