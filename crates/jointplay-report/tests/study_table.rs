//! Tables of studies and the markers of interrupted runs read back to the bit.

#[path = "../../jointplay-format/tests/example_study.rs"]
mod example_study;

use example_study::{STUDY, study};
use jointplay_report::study_table::{Marker, MarkerError, TableKind};
use jointplay_study::plan::{Moments, Totals};

#[test]
fn markers_read_back_exactly() {
    let file = study(STUDY);
    let mut totals = Totals::new(3, 2);
    totals.columns[0] = Moments::of(&[0.1, 0.2, f64::NAN, 1e-300]);
    totals.outcomes[1].counts[3] = 7;
    let mut marker = Marker::new(&file, TableKind::Csv, totals);
    (marker.chunks, marker.bytes, marker.foot) = (3, u64::MAX, vec![0, 255, 16]);
    let text = marker.to_json(9);
    assert_eq!(Marker::parse(&text), Ok(marker));
    let malformed = |text: &str| matches!(Marker::parse(text), Err(MarkerError::Malformed(_)));
    assert!(malformed(&text[1..]));
    for (from, to) in [
        ("00ff10", "00ff1"),
        ("00ff10", "00fg10"),
        ("\"csv\"", "\"doc\""),
        ("\"chunks\": 3", "\"chunks\": -3"),
    ] {
        assert!(text.contains(from) && malformed(&text.replace(from, to)), "{to}");
    }
}

/// Last digits of mechanisms differ between instruction sets: a run is continued on the kind that began it.
#[test]
fn a_study_of_a_mechanism_is_continued_on_its_kind_of_processor() {
    let file = study(
        "kind = \"study\"\nmechanism = \"four-bar\"\nquantities = [\"joints\"]\n[drives]\nA = [0, 10]\n",
    );
    let marker = Marker::new(&file, TableKind::Csv, Totals::for_study(&*file.plan));
    let text = marker.to_json(0);
    assert_eq!(Marker::parse(&text).as_ref(), Ok(&marker));
    let here = marker.instructions.unwrap();
    let other =
        text.replace(&format!("\"instructions\": \"{here}\""), "\"instructions\": \"other\"");
    assert_ne!(other, text);
    let refused = MarkerError::Processor { found: "other".to_owned(), here };
    assert_eq!(Marker::parse(&other), Err(refused));
    assert_eq!(Marker::new(&study(STUDY), TableKind::Csv, Totals::new(3, 2)).instructions, None);
}

proptest::proptest! {
    #[test]
    fn malformed_markers_do_not_panic(noise in "\\PC{0,12}") {
        let _ = Marker::parse(&noise);
    }
}

#[cfg(feature = "parquet")]
#[test]
fn a_parquet_table_reads_back_exactly() {
    use jointplay_report::study_table::{Index, Table};
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    let file = study(&STUDY.replace("[0, 0.01]", "[0, 60]"));
    let tables = [TableKind::Csv, TableKind::Parquet]
        .map(|kind| Table::new(kind, file.columns.clone()).unwrap());
    // Three chunks of two blocks, with the end read back after the second, as by a run that is taken up again.
    let [csv, parquet] = tables.map(|table| {
        let (mut bytes, mut index) = (table.head(), Index::default());
        for chunk in 0..3 {
            let blocks = [0, 1].map(|block| {
                let first = 100 * chunk + 50 * block;
                file.plan.compute(&(first..first + 50).collect::<Vec<u64>>()).unwrap()
            });
            let encoded = table.encode(&blocks).unwrap();
            table.note(&mut index, &encoded, bytes.len() as u64).unwrap();
            bytes.extend(encoded.parts.concat());
            if chunk == 1 {
                let foot = table.foot(&index).unwrap();
                index = table.index(&foot).unwrap();
                assert!(table.foot(&index).unwrap() == foot, "an end read back is another");
            }
        }
        bytes.extend(table.foot(&index).unwrap());
        bytes
    });
    let reader = SerializedFileReader::new(bytes::Bytes::from(parquet)).unwrap();
    assert_eq!(reader.num_row_groups(), 3);
    let text = String::from_utf8(csv).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let (mut rows, mut missing) = (0, 0);
    for (row, line) in reader.get_row_iter(None).unwrap().zip(lines) {
        let row = row.unwrap();
        assert_eq!(row.get_column_iter().count(), names.len());
        let cells = row.get_column_iter().zip(line.split(',')).zip(&names);
        for (((name, field), expected), known) in cells {
            assert_eq!(name, known);
            match field {
                Field::Long(found) => assert_eq!(found.to_string(), expected),
                Field::Str(found) => assert_eq!(found, expected),
                Field::Double(found) if expected.is_empty() => {
                    assert!(found.is_nan());
                    missing += 1;
                }
                Field::Double(found) => assert_eq!(*found, expected.parse::<f64>().unwrap()),
                other => panic!("{name}: {other:?}"),
            }
        }
        rows += 1;
    }
    assert_eq!(rows, 300);
    assert!(missing > 0);
}
