//! Tables as comma-separated values.

use super::column::{Column, Values};

/// Comma-separated values, every number with the digits that read back the same.
///
/// # Panics
/// If the columns differ in length: an error of ours.
#[must_use]
pub fn csv(columns: &[Column]) -> String {
    let mut bytes = Vec::new();
    write_csv(columns, true, &mut bytes).expect("writing into memory does not fail");
    String::from_utf8(bytes).expect("names and numbers are UTF-8")
}

/// Rows of comma-separated values as by [`csv`](fn@csv), to where they are kept.
///
/// # Arguments
/// * `header` – whether the names of the columns come first
///
/// # Errors
/// Those of the writer.
///
/// # Panics
/// If the columns differ in length: an error of ours.
pub fn write_csv(
    columns: &[Column],
    header: bool,
    writer: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(writer);
    if header {
        writer.write_record(columns.iter().map(|column| &column.name))?;
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    for row in 0..rows {
        let cell = |column: &Column| match &column.values {
            Values::Real(values) => format!("{:?}", values[row]),
            Values::Count(values) => values[row].to_string(),
        };
        writer.write_record(columns.iter().map(cell))?;
    }
    writer.flush()
}
