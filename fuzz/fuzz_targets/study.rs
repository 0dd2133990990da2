//! A study never panics; the files that were read for one make the same study, and samples with an answer have numbers.

#![no_main]

use jointplay::format::study::{from_files, included, parse};
use jointplay::format::{cell as cell_file, program};
use jointplay::report::study_parts::digest;
use libfuzzer_sys::fuzz_target;

/// Samples of cells take a tenth of a second, and more with the sanitizer.
const CELLS: &str = "program";

fuzz_target!(|text: &str| {
    let mut sources = |name: &str| match name {
        "cell.toml" => Ok(cell_file::EXAMPLE.as_bytes().to_vec()),
        "cell.program" => Ok(program::EXAMPLE.as_bytes().to_vec()),
        _ => included(name.trim_end_matches(".toml")),
    };
    let study = match parse(text, &mut sources) {
        Ok(study) => study,
        Err(errors) => return drop(errors.with_excerpt("study")),
    };
    let again = parse(&study.text, &mut from_files(&study.files)).expect("the same files");
    assert!(study.differences(&again).is_empty() && digest(&study) == digest(&again));
    let samples = study.plan.samples().expect("a study that is read has samples");
    assert!(samples > 0 && study.plan.chunks().expect("so it has chunks") > 0);
    if study.plan.solved_for() == [CELLS] {
        return;
    }
    let block = study.plan.compute(&[0, samples - 1]).expect("samples of the study");
    for row in 0..2 {
        if block.outcomes.iter().all(|outcomes| outcomes[row].is_solved()) {
            let numbers = block.columns.iter().map(|column| column[row]);
            numbers.for_each(|number| assert!(number.is_finite(), "{number} in row {row}"));
        }
    }
});
