//! Tables of values of driven coordinates (CSV).

use csv::{ReaderBuilder, Trim};
use jointplay_core::mechanism::Mechanism;
use jointplay_format::command::Heading;
use jointplay_format::coordinates::{self, Coordinates};

/// Largest accepted table (bytes).
pub const MAX_TABLE_BYTES: usize = 64_000_000;
/// Largest number of rows of a table.
pub const MAX_ROWS: usize = 100_001;
/// Largest number of columns of a table.
pub const MAX_COLUMNS: usize = 10_000;

/// Values of driven coordinates at the points of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTable {
    /// The variable of the path: a first column that names no coordinate.
    pub variable: Option<DriveColumn>,
    /// Indices of the driven coordinates.
    pub coordinates: Vec<usize>,
    /// Values of each driven coordinate at all points (m, rad).
    pub values: Vec<Vec<f64>>,
}

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
    /// A heading that names no coordinate.
    #[error("column {column}: {error}")]
    Unknown {
        /// Number of the column, counted from 1.
        column: usize,
        /// Which names are known.
        error: coordinates::Error,
    },
    /// A coordinate with two columns.
    #[error("column {column}: {name:?} is given twice")]
    Twice {
        /// Number of the second column, counted from 1.
        column: usize,
        /// Its heading.
        name: String,
    },
    /// A value beyond every mechanism.
    #[error(transparent)]
    TooLarge(coordinates::Error),
    /// A variable whose values neither increase nor decrease.
    #[error(
        "the values of the variable {name:?} in the first column must increase or decrease from row to row"
    )]
    Variable {
        /// Name of the variable.
        name: String,
    },
    /// No column of a coordinate.
    #[error("no column names a joint coordinate")]
    NoCoordinate,
    /// Too many columns.
    #[error("the table has {found} columns, at most {MAX_COLUMNS} are allowed")]
    Columns {
        /// Number of columns.
        found: usize,
    },
}

/// Reads a table of driven coordinates: a line of headings, then a line of numbers for each point of the path; lines that start with `#` are comments.
///
/// A heading is that of a [`Heading`]; a first column with another one has the values of the variable of the path.
///
/// # Errors
/// [`DriveTableError`].
pub fn drive_table(
    text: &str,
    coordinates: &Coordinates,
    mechanism: &Mechanism,
) -> Result<DriveTable, DriveTableError> {
    let mut table = DriveTable { variable: None, coordinates: Vec::new(), values: Vec::new() };
    for (k, column) in columns(text)?.into_iter().enumerate() {
        let heading = match Heading::find(coordinates, mechanism, &column.name) {
            Ok(heading) => heading,
            Err(coordinates::Error::Unknown { nearest: None, .. }) if k == 0 => {
                let rising = column.values.windows(2).all(|pair| pair[0] < pair[1]);
                let falling = column.values.windows(2).all(|pair| pair[0] > pair[1]);
                if !rising && !falling {
                    return Err(DriveTableError::Variable { name: column.name });
                }
                table.variable = Some(column);
                continue;
            }
            Err(error) => return Err(DriveTableError::Unknown { column: k + 1, error }),
        };
        let coordinate = heading.coordinate();
        if table.coordinates.contains(&coordinate) {
            return Err(DriveTableError::Twice { column: k + 1, name: column.name });
        }
        table.coordinates.push(coordinate);
        let si = |value| coordinates.checked(coordinate, heading.to_si(value));
        let values = column.values.into_iter().map(si).collect::<Result<_, _>>();
        table.values.push(values.map_err(DriveTableError::TooLarge)?);
    }
    if table.coordinates.is_empty() {
        return Err(DriveTableError::NoCoordinate);
    }
    Ok(table)
}

/// The columns of a table, whatever their headings.
fn columns(text: &str) -> Result<Vec<DriveColumn>, DriveTableError> {
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
        let columns = columns("\u{feff}# a comment\nt, leg 1_mm\n0, 1.5\n\n1,-2e-3\n").unwrap();
        assert_eq!(columns[0], DriveColumn { name: "t".to_owned(), values: vec![0.0, 1.0] });
        assert_eq!(columns[1].name, "leg 1_mm");
        assert_eq!(columns[1].values, [1.5, -2e-3]);
    }

    #[test]
    fn columns_of_coordinates_are_in_si_units_and_a_first_one_of_another_name_is_the_variable() {
        let four_bar = jointplay_format::catalogue::find("four-bar").unwrap().text;
        let file = jointplay_format::mechanism::parse(four_bar).unwrap();
        let coordinates = Coordinates::of(&file);
        let read = |text: &str| drive_table(text, &coordinates, &file.mechanism);
        let table = read("time,B_rad,A\n0,1,180\n1,2,-90\n").unwrap();
        let variable = DriveColumn { name: "time".to_owned(), values: vec![0.0, 1.0] };
        assert_eq!(table.variable, Some(variable));
        let find = |name: &str| coordinates.find(&file.mechanism, name).unwrap();
        assert_eq!(table.coordinates, [find("B"), find("A")]);
        assert_eq!(table.values[0], [1.0, 2.0]);
        assert!((table.values[1][0] - std::f64::consts::PI).abs() < 1e-15);
        let refused = |text: &str| read(text).unwrap_err().to_string();
        assert!(refused("A,time\n1,0\n2,1\n").starts_with("column 2: joint `time`"));
        assert!(refused("time\n1\n2\n").contains("no column names"));
    }

    #[track_caller]
    fn refuse(text: &str, message: &str) {
        let error = columns(text).unwrap_err().to_string();
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
