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

/// Its totals become a summary, which has a number for each column of the study.
#[test]
fn markers_with_impossible_progress_are_refused() {
    let file = study(STUDY);
    let whole = Marker::new(&file, TableKind::Csv, Totals::for_study(&*file.plan));
    assert!(whole.study_file().is_ok());
    let refused = |marker: Marker, message: &str| {
        let error = marker.study_file().err().unwrap().to_string();
        assert!(error.contains(message), "{error}");
    };
    refused(Marker { chunks: u64::MAX, ..whole.clone() }, "more chunks than the study has");
    refused(Marker { study: "kind = 1".to_owned(), ..whole.clone() }, "the study in it is invalid");
    let totals = Totals::for_study(&*file.plan);
    for totals in [
        Totals::new(0, totals.outcomes.len()),
        Totals::new(totals.columns.len(), 0),
        Totals { samples: 1, ..totals.clone() },
        Totals { beyond_rods: u64::MAX, ..totals },
    ] {
        refused(Marker { totals, ..whole.clone() }, "its totals are not those of its chunks");
    }
}

/// Sums of such counts would overflow.
#[test]
fn records_with_impossible_counts_are_refused() {
    use jointplay_report::study_parts::{Gathering, Manifest, PartWriter};
    use jointplay_study::plan::compute_chunk;

    let study = study(STUDY);
    let blocks = compute_chunk(&*study.plan, 0).unwrap();
    let files = PartWriter::new(&study, TableKind::Csv).unwrap().files(0, &blocks).unwrap();
    let manifest = Manifest { study, kind: TableKind::Csv };
    let add = |record: &str| Gathering::new(&manifest).unwrap().add(record, &files.table);
    assert!(add(&files.record).is_ok());
    let record: serde_json::Value = serde_json::from_str(&files.record).unwrap();
    let most = serde_json::json!(u64::MAX);
    for place in ["/beyond_rods", "/beyond_joints", "/outcomes/0/0", "/columns/0/0"] {
        let mut record = record.clone();
        *record["totals"].pointer_mut(place).unwrap() = most.clone();
        let error = add(&record.to_string()).unwrap_err().to_string();
        assert!(error.contains("its totals are not those of this part"), "{place}: {error}");
    }
}

/// Before, the message was that of an interrupted run, without the name of the file.
#[test]
fn a_table_that_is_no_part_is_named() {
    use jointplay_report::study_parts::{Gathering, Manifest, PartWriter};
    use jointplay_study::plan::compute_chunk;

    let study = study(STUDY);
    let blocks = compute_chunk(&*study.plan, 0).unwrap();
    let files = PartWriter::new(&study, TableKind::Csv).unwrap().files(0, &blocks).unwrap();
    let table = [b"x", &files.table[1..]].concat();
    let mut record: serde_json::Value = serde_json::from_str(&files.record).unwrap();
    record["sha256"] = jointplay_report::sha256(&table).into();
    let manifest = Manifest { study, kind: TableKind::Csv };
    let error = Gathering::new(&manifest).unwrap().add(&record.to_string(), &table).unwrap_err();
    let expected = "part-000000.csv was not written by jointplay: it is not a table of one chunk";
    assert!(error.to_string().contains(expected), "{error}");
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

#[cfg(feature = "parquet")]
mod footers {
    #![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

    use jointplay_report::study_table::{Index, Table};

    use super::*;

    /// A table of one chunk, its encoder, and where its footer begins.
    fn part() -> (Table, Vec<u8>, usize) {
        let file = study(STUDY);
        let table = Table::new(TableKind::Parquet, file.columns.clone()).unwrap();
        let blocks = [file.plan.compute(&[0, 1, 2, 3]).unwrap()];
        let bytes = table.of_chunk(&blocks).unwrap();
        let tail = bytes.len() - 8;
        let length = u32::from_le_bytes(bytes[tail..tail + 4].try_into().unwrap());
        let start = tail - length as usize;
        (table, bytes, start)
    }

    /// A file that ends with these metadata.
    fn ending(metadata: &[u8]) -> Vec<u8> {
        let length = u32::try_from(metadata.len()).unwrap().to_le_bytes();
        [b"PAR1", metadata, &length, b"PAR1"].concat()
    }

    /// Before, a negative position was a panic of the library, and positions overflowed.
    #[test]
    fn footers_with_a_changed_byte_do_not_panic() {
        let (table, bytes, start) = part();
        let (mut read, mut refused) = (0, 0);
        for place in start..bytes.len() {
            for change in [1, 0x7f, 0x80, 0xff] {
                let mut file = bytes.clone();
                file[place] ^= change;
                let _ = table.index(&file);
                let Ok(encoded) = table.chunk_of(&file) else {
                    refused += 1;
                    continue;
                };
                read += 1;
                let mut index = Index::default();
                for at in [4, u64::MAX / 2] {
                    let _ = table.note(&mut index, &encoded, at);
                }
                if let Ok(foot) = table.foot(&index) {
                    let _ = table.index(&foot);
                }
            }
        }
        assert!(read > 100 && refused > 100, "{read} {refused}");
    }

    /// Before, the library followed a nested schema until the stack overflowed.
    #[test]
    fn schemas_that_are_nested_deeply_are_not_followed() {
        let (table, ..) = part();
        let count = 200_000_u32;
        let mut metadata = vec![0x15, 2, 0x19, 0xfc];
        // The number of elements, in groups of seven bits.
        metadata.extend([count as u8 | 0x80, (count >> 7) as u8 | 0x80, (count >> 14) as u8]);
        // Required groups "s" of one child, then a leaf.
        for _ in 1..count {
            metadata.extend([0x35, 0, 0x18, 1, b's', 0x15, 2, 0]);
        }
        metadata.extend([0x15, 2, 0x25, 0, 0x18, 1, b's', 0]);
        // No rows, no chunks.
        metadata.extend([0x16, 0, 0x19, 0x0c, 0]);
        let file = ending(&metadata);
        assert!(table.chunk_of(&file).is_err());
        assert!(table.index(&file).is_ok());
    }

    /// Before, each of these lists took as long as the number that it states, without a byte in the file.
    #[test]
    fn lists_without_bytes_are_refused() {
        let (table, bytes, start) = part();
        let end = bytes.len() - 9;
        assert_eq!(bytes[end], 0);
        // A field after the known ones: a list of lists of 2³¹ − 1 truth values.
        let values = [0xf1, 0xff, 0xff, 0xff, 0xff, 7];
        let list = [&[0x99, 0xf9, 0x80, 0x08][..], &values.repeat(1024), &[0]].concat();
        let file = ending(&[&bytes[start..end], &list].concat());
        assert!(table.chunk_of(&file).is_err() && table.index(&file).is_err());
    }
}
