//! Tables of values of driven coordinates (CSV).

use csv::{ReaderBuilder, Trim};

/// Largest number of rows of a table.
pub const MAX_ROWS: usize = 100_001;
/// Largest number of columns of a table.
pub const MAX_COLUMNS: usize = 10_000;

/// A column of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveColumn {
    /// Heading.
    pub name: String,
    /// Numbers, all finite, one for each row.
    pub values: Vec<f64>,
}

/// Error in a table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveTableError {
    /// A text that is no table, or a row with another number of cells.
    #[error("the table is not valid CSV: {message}")]
    Csv {
        /// Message of the CSV reader, with the line.
        message: String,
    },
    /// A cell that is not a finite number.
    #[error("line {line}, column {column:?}: expected a finite number, found {found:?}")]
    Cell {
        /// Line in the file, counted from 1.
        line: u64,
        /// Heading of the column.
        column: String,
        /// Text of the cell.
        found: String,
    },
    /// Two columns of one name, or one without a name.
    #[error("the heading {name:?} of column {column} is empty or used twice")]
    Heading {
        /// Number of the column, counted from 1.
        column: usize,
        /// The heading.
        name: String,
    },
    /// Too few or too many rows.
    #[error("the table has {found} rows of numbers, expected 2 to {MAX_ROWS}")]
    Rows {
        /// Number of rows found; counted only up to the first that is too many.
        found: usize,
    },
    /// Too many columns.
    #[error("the table has {found} columns, at most {MAX_COLUMNS} are allowed")]
    Columns {
        /// Number of columns.
        found: usize,
    },
}

/// Reads a table: a line of headings, then a line of numbers for each point of the path; lines that start with `#` are comments.
///
/// # Errors
/// [`DriveTableError`].
pub fn drive_table(text: &str) -> Result<Vec<DriveColumn>, DriveTableError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let csv = |error: csv::Error| DriveTableError::Csv { message: error.to_string() };
    let headings = reader.headers().map_err(csv)?.clone();
    if headings.len() > MAX_COLUMNS {
        return Err(DriveTableError::Columns { found: headings.len() });
    }
    let mut columns: Vec<DriveColumn> = Vec::with_capacity(headings.len());
    for (k, name) in headings.iter().enumerate() {
        if name.is_empty() || columns.iter().any(|one| one.name == name) {
            return Err(DriveTableError::Heading { column: k + 1, name: name.to_owned() });
        }
        columns.push(DriveColumn { name: name.to_owned(), values: Vec::new() });
    }
    let mut rows = 0;
    for record in reader.records() {
        let record = record.map_err(csv)?;
        rows += 1;
        if rows > MAX_ROWS {
            return Err(DriveTableError::Rows { found: rows });
        }
        for (cell, column) in record.iter().zip(&mut columns) {
            let value = cell.parse().ok().filter(|value: &f64| value.is_finite());
            column.values.push(value.ok_or_else(|| DriveTableError::Cell {
                line: record.position().map_or(0, csv::Position::line),
                column: column.name.clone(),
                found: cell.to_owned(),
            })?);
        }
    }
    if rows < 2 {
        return Err(DriveTableError::Rows { found: rows });
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_headings_and_finite_numbers() {
        let columns = drive_table("\u{feff}# a comment\nt, leg 1_mm\n0, 1.5\n\n1,-2e-3\n").unwrap();
        assert_eq!(columns[0], DriveColumn { name: "t".to_owned(), values: vec![0.0, 1.0] });
        assert_eq!(columns[1].name, "leg 1_mm");
        assert_eq!(columns[1].values, [1.5, -2e-3]);
    }

    #[track_caller]
    fn refuse(text: &str, message: &str) {
        let error = drive_table(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text:?}: {error}");
    }

    #[test]
    fn tables_with_missing_cells_and_without_numbers_are_refused_with_their_line() {
        refuse(
            "t,a\n0,1\n1,NaN\n",
            "line 3, column \"a\": expected a finite number, found \"NaN\"",
        );
        refuse("t,a\n0,\n1,2\n", "line 2, column \"a\"");
        refuse("t,a\n0,1\n1\n", "line");
        refuse("t;a\n0;1\n1;2\n", "line 2, column \"t;a\"");
        refuse("t,a\n0,1\n", "1 rows of numbers, expected 2");
        refuse("", "0 rows");
        refuse("a,a\n0,1\n", "column 2");
        let long = format!("a\n{}", "0\n".repeat(MAX_ROWS + 1));
        refuse(&long, "100002 rows");
    }
}
