//! Tables read back exactly.

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{Polar, SolveOptions};
use jointplay_study::{Raster, simulate};

use super::column::{Column, Values};
use super::csv::{csv, write_csv};
use super::samples::columns;

fn study() -> Vec<Column> {
    let options = SolveOptions::default();
    columns(&simulate(&Gpr::paper(), &Raster::paper(), &Polar, &options, &mut |_| ()).unwrap())
}

#[test]
fn a_csv_table_reads_back_exactly() {
    let columns = study();
    let text = csv(&columns);
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        names[..7],
        ["sample", "azimuth_deg", "tilt_deg", "q1_mm", "q2_mm", "q3_mm", "L12_mm"]
    );
    assert!(names.contains(&"phi2_deg".to_owned()) && names.ends_with(&["residual_mm".to_owned()]));
    let rows: Vec<::csv::StringRecord> = reader.records().map(Result::unwrap).collect();
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
fn a_parquet_table_reads_back_exactly() {
    use ::parquet::file::reader::{FileReader, SerializedFileReader};

    let columns = study();
    let bytes = super::parquet::parquet(&columns).unwrap();
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
    let mut rows = 0;
    for (row, record) in reader.get_row_iter(None).unwrap().enumerate() {
        let record = record.unwrap();
        for ((name, field), column) in record.get_column_iter().zip(&columns) {
            assert_eq!(name, &column.name);
            match (&column.values, field) {
                (Values::Real(values), ::parquet::record::Field::Double(found)) => {
                    assert_eq!(*found, values[row]);
                }
                (Values::Count(values), ::parquet::record::Field::Int(found)) => {
                    assert_eq!(u32::try_from(*found).unwrap(), values[row]);
                }
                (_, found) => panic!("{name}: {found:?}"),
            }
        }
        rows += 1;
    }
    assert_eq!(rows, 777);
}

#[test]
fn a_full_disk_is_reported_as_one() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    // A row alone stays in the buffer; many are written before the end.
    for rows in [1, 10_000] {
        let column = Column { name: "a".to_owned(), values: Values::Real(vec![0.1; rows]) };
        let error = write_csv(&[column], true, &mut Full).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{rows}: {error}");
    }
}
