//! Parts of a study that were changed never panic: descriptions, records, markers, and Parquet tables with their footers.

#![no_main]

use std::sync::LazyLock;

use jointplay::format::study::{StudyFile, included, parse};
use jointplay::report::study_parts::{Gathering, Manifest, PartFiles, PartWriter};
use jointplay::report::study_table::{Index, Marker, Table, TableKind};
use jointplay::report::totals;
use jointplay::study::plan::compute_chunk;
use libfuzzer_sys::fuzz_target;

/// The study of the seeds.
static STUDY: LazyLock<StudyFile> = LazyLock::new(|| {
    let text = include_str!("../seeds/study/robot.toml");
    parse(text, &mut included).unwrap_or_else(|errors| panic!("{}", errors.with_excerpt("robot")))
});

/// Its only part.
static PART: LazyLock<PartFiles> = LazyLock::new(|| {
    let blocks = compute_chunk(&*STUDY.plan, 0).expect("the study has a chunk");
    let writer = PartWriter::new(&STUDY, TableKind::Parquet).expect("this build writes Parquet");
    writer.files(0, &blocks).expect("the chunk is encoded")
});

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = Manifest::parse(text);
        if let Ok(marker) = Marker::parse(text)
            && let Ok(study) = marker.study_file()
        {
            let no_quantiles = vec![vec![None; 7]; study.plan.columns()];
            drop(totals(&study, &marker.totals, &no_quantiles));
        }
        let manifest = Manifest { study: STUDY.clone(), kind: TableKind::Parquet };
        let mut gathering = Gathering::new(&manifest).expect("this build writes Parquet");
        if gathering.add(text, &PART.table).is_ok()
            && let Ok((_, all)) = gathering.finish()
        {
            drop(totals(&STUDY, &all, &vec![vec![None; 7]; STUDY.plan.columns()]));
        }
        return;
    }
    let table = Table::new(TableKind::Parquet, STUDY.columns.clone());
    let table = table.expect("this build writes Parquet");
    let _ = table.index(bytes);
    if let Ok(encoded) = table.chunk_of(bytes) {
        let mut index = Index::default();
        for at in [4, 1000] {
            if table.note(&mut index, &encoded, at).is_err() {
                return;
            }
        }
        if let Ok(foot) = table.foot(&index) {
            let again = table.index(&foot).expect("an end that was written is read");
            assert!(table.foot(&again).ok() == Some(foot), "an end read back is another");
        }
    }
});
