//! Tables as comma-separated values.

use super::column::{Column, Values};

/// Comma-separated values, every number with enough digits to read back exactly.
///
/// # Panics
/// If the columns differ in length.
#[must_use]
pub fn csv(columns: &[Column]) -> String {
    let mut bytes = Vec::new();
    write_csv(columns, true, &mut bytes).expect("writing into memory does not fail");
    String::from_utf8(bytes).expect("names and numbers are UTF-8")
}

/// Writes rows of comma-separated values as by [`csv`](fn@csv).
///
/// # Arguments
/// * `header` – whether to write the names of the columns first
///
/// # Errors
/// Those of the writer.
///
/// # Panics
/// If the columns differ in length.
pub fn write_csv(
    columns: &[Column],
    header: bool,
    writer: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(writer);
    if header {
        writer.write_record(columns.iter().map(|column| &column.name)).map_err(of_writer)?;
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    for row in 0..rows {
        let cell = |column: &Column| match &column.values {
            Values::Real(values) => format!("{:?}", values[row]),
            Values::Count(values) => values[row].to_string(),
        };
        writer.write_record(columns.iter().map(cell)).map_err(of_writer)?;
    }
    writer.flush()
}

/// The error of the writer itself: the conversion of the library hides its kind.
fn of_writer(error: csv::Error) -> std::io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        // Records of one table have the same length, and nothing is read.
        _ => std::io::ErrorKind::InvalidData.into(),
    }
}
