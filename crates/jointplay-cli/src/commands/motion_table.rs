//! Tables of values of driven coordinates for `jointplay move`.

use std::path::Path;

use jointplay::format::command::Heading;
use jointplay::format::coordinates;
use jointplay::interop::import::{self, DriveColumn};
use jointplay::mechanism::DrivePath;
use jointplay::report::MotionParameter;

use super::motion_course::Course;
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::source;

/// Largest accepted table (bytes).
const MAX_TABLE: usize = 64_000_000;

/// The path through the rows of a table.
pub(super) fn course(input: &Input, file: &Path) -> Result<Course, Failure> {
    let table = source::Source::read(file, MAX_TABLE)?;
    let label = &table.label;
    let refused = |text: String| Failure::Usage(format!("{label}: {text}"));
    let columns = import::drive_table(&table.text).map_err(|error| refused(error.to_string()))?;
    let mut parameter = None;
    let (mut coordinates, mut driven) = (Vec::new(), Vec::new());
    for (k, DriveColumn { name, values }) in columns.into_iter().enumerate() {
        let heading = match Heading::find(&input.coordinates, &input.file.mechanism, &name) {
            Ok(heading) => heading,
            Err(coordinates::Error::Unknown { nearest: None, .. }) if k == 0 => {
                let rising = values.windows(2).all(|pair| pair[0] < pair[1]);
                let falling = values.windows(2).all(|pair| pair[0] > pair[1]);
                if !rising && !falling {
                    return Err(refused(format!(
                        "the values of the variable {name:?} in the first column must increase or decrease from row to row"
                    )));
                }
                parameter = Some(MotionParameter { name, values });
                continue;
            }
            Err(error) => return Err(refused(format!("column {}: {error}", k + 1))),
        };
        if coordinates.contains(&heading.coordinate()) {
            let text = format!("column {}: {name:?} is given twice", k + 1);
            return Err(refused(text));
        }
        coordinates.push(heading.coordinate());
        let si = values
            .into_iter()
            .map(|value| input.reachable(heading.coordinate(), heading.to_si(value)))
            .collect::<Result<Vec<f64>, Failure>>()?;
        driven.push(si);
    }
    let Some(first) = driven.first() else {
        return Err(refused("no column names a joint coordinate".to_owned()));
    };
    let steps = first.len() - 1;
    let points = (0..=steps).map(|row| driven.iter().map(|column| column[row]).collect()).collect();
    Ok(Course { path: DrivePath::through(coordinates, points)?, steps, parameter })
}
