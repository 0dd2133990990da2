//! A study as a table: one row a sample, units in the column names.

use jointplay_study::{Samples, SeriesKind};

use jointplay_format::units::{deg, mm};

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name with its unit, such as `q1_mm`.
    pub name: String,
    /// The values.
    pub values: Values,
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers, in the unit of the column's name.
    Real(Vec<f64>),
    /// Counts.
    Count(Vec<u32>),
}

/// The name of a series with its unit.
#[must_use]
pub fn column_name(name: &str, kind: SeriesKind) -> String {
    let unit = if kind == SeriesKind::Angular { "deg" } else { "mm" };
    format!("{name}_{unit}")
}

/// A value of a series in the unit of its column name.
#[must_use]
pub fn column_value(value: f64, kind: SeriesKind) -> f64 {
    if kind == SeriesKind::Angular { deg(value) } else { mm(value) }
}

/// All columns of a study: sample, tilt, rods, sides, virtual joints, origin, twist, iterations, residual.
#[must_use]
pub fn columns(samples: &Samples) -> Vec<Column> {
    let real = |name: String, values: &[f64], convert: fn(f64) -> f64| Column {
        name,
        values: Values::Real(values.iter().map(|&value| convert(value)).collect()),
    };
    let count = |name: &str, values: &mut dyn Iterator<Item = usize>| Column {
        name: name.to_owned(),
        values: Values::Count(
            values.map(|value| u32::try_from(value).unwrap_or(u32::MAX)).collect(),
        ),
    };
    let mut columns = vec![
        count("sample", &mut (0..samples.len())),
        real("yaw_deg".into(), &samples.yaw, deg),
        real("pitch_deg".into(), &samples.pitch, deg),
    ];
    for series in samples.series() {
        let convert = if series.kind == SeriesKind::Angular { deg } else { mm };
        columns.push(real(column_name(&series.name, series.kind), series.values, convert));
    }
    for (axis, values) in ["x", "y", "z"].into_iter().zip(&samples.origin) {
        columns.push(real(format!("{axis}_mm"), values, mm));
    }
    columns.push(real("twist_deg".into(), &samples.twist_about_normal, deg));
    columns.push(count("iterations", &mut samples.iterations.iter().copied()));
    columns.push(real("residual_mm".into(), &samples.residual, mm));
    columns
}

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

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Count(values) => values.len(),
        }
    }
}

/// The same table as a Parquet file, Snappy-compressed, one row group.
///
/// # Errors
/// What the Parquet writer says.
#[cfg(feature = "parquet")]
pub fn parquet(columns: &[Column]) -> Result<Vec<u8>, parquet::errors::ParquetError> {
    let mut table = ParquetTable::new(columns, Vec::new())?;
    table.push(columns)?;
    table.finish()
}

#[cfg(feature = "parquet")]
pub use ::parquet::errors::ParquetError;

/// A Parquet file that takes a table part by part, each a row group.
#[cfg(feature = "parquet")]
pub struct ParquetTable<W: std::io::Write + Send> {
    writer: parquet::file::writer::SerializedFileWriter<W>,
}

#[cfg(feature = "parquet")]
impl<W: std::io::Write + Send> ParquetTable<W> {
    /// An empty file.
    ///
    /// # Arguments
    /// * `columns` – of any part: their names and types
    ///
    /// # Errors
    /// What the Parquet writer says.
    pub fn new(columns: &[Column], writer: W) -> Result<Self, parquet::errors::ParquetError> {
        use std::sync::Arc;

        use parquet::basic::{Compression, Repetition, Type};
        use parquet::file::properties::WriterProperties;
        use parquet::file::writer::SerializedFileWriter;
        use parquet::schema::types;

        let fields = columns
            .iter()
            .map(|column| {
                let physical = match column.values {
                    Values::Real(_) => Type::DOUBLE,
                    Values::Count(_) => Type::INT32,
                };
                let field = types::Type::primitive_type_builder(&column.name, physical)
                    .with_repetition(Repetition::REQUIRED)
                    .build()?;
                Ok(Arc::new(field))
            })
            .collect::<Result<Vec<_>, parquet::errors::ParquetError>>()?;
        let schema = types::Type::group_type_builder("samples").with_fields(fields).build()?;
        let properties =
            Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
        Ok(Self { writer: SerializedFileWriter::new(writer, Arc::new(schema), properties)? })
    }

    /// Adds rows.
    ///
    /// # Errors
    /// What the Parquet writer says.
    pub fn push(&mut self, columns: &[Column]) -> Result<(), parquet::errors::ParquetError> {
        use parquet::data_type::{DoubleType, Int32Type};

        let mut group = self.writer.next_row_group()?;
        for column in columns {
            let Some(mut target) = group.next_column()? else { break };
            match &column.values {
                Values::Real(values) => {
                    target.typed::<DoubleType>().write_batch(values, None, None)?;
                }
                Values::Count(values) => {
                    let signed: Vec<i32> =
                        values.iter().map(|&v| i32::try_from(v).unwrap_or(i32::MAX)).collect();
                    target.typed::<Int32Type>().write_batch(&signed, None, None)?;
                }
            }
            target.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// The writer, the file complete.
    ///
    /// # Errors
    /// What the Parquet writer says.
    pub fn finish(self) -> Result<W, parquet::errors::ParquetError> {
        self.writer.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use jointplay_core::gpr::Gpr;
    use jointplay_core::virtualization::{Polar, SolveOptions};
    use jointplay_study::{Raster, simulate};

    use super::*;

    fn study() -> Vec<Column> {
        let options = SolveOptions::default();
        columns(&simulate(&Gpr::paper(), &Raster::paper(), &Polar, &options, &mut |_| ()).unwrap())
    }

    #[test]
    fn a_table_reads_back_the_same() {
        let columns = study();
        let text = csv(&columns);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        assert_eq!(
            names[..7],
            ["sample", "yaw_deg", "pitch_deg", "q1_mm", "q2_mm", "q3_mm", "L12_mm"]
        );
        assert!(
            names.contains(&"phi2_deg".to_owned()) && names.ends_with(&["residual_mm".to_owned()])
        );
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 777);
        for (i, column) in columns.iter().enumerate() {
            for (row, record) in rows.iter().enumerate() {
                match &column.values {
                    Values::Real(values) => {
                        assert_eq!(record[i].parse::<f64>().unwrap(), values[row])
                    }
                    Values::Count(values) => {
                        assert_eq!(record[i].parse::<u32>().unwrap(), values[row])
                    }
                }
            }
        }
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn a_parquet_file_reads_back_the_same() {
        use parquet::file::reader::{FileReader, SerializedFileReader};

        let columns = study();
        let bytes = super::parquet(&columns).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let mut rows = 0;
        for (row, record) in reader.get_row_iter(None).unwrap().enumerate() {
            let record = record.unwrap();
            for ((name, field), column) in record.get_column_iter().zip(&columns) {
                assert_eq!(name, &column.name);
                match (&column.values, field) {
                    (Values::Real(values), parquet::record::Field::Double(found)) => {
                        assert_eq!(*found, values[row]);
                    }
                    (Values::Count(values), parquet::record::Field::Int(found)) => {
                        assert_eq!(u32::try_from(*found).unwrap(), values[row]);
                    }
                    (_, found) => panic!("{name}: {found:?}"),
                }
            }
            rows += 1;
        }
        assert_eq!(rows, 777);
    }
}
