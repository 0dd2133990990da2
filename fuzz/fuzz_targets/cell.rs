//! A cell file never panics, and an edit of one that is read changes what it says it changes.

#![no_main]

use jointplay::format::cell::{Change, read, set_station};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    // Every file is there, and holds what may be a robot or a shape.
    let mut files = |name: &str| match name.len() % 2 {
        0 => Ok(text.as_bytes().to_vec()),
        _ => Err("no such file".to_owned()),
    };
    match read(text, &mut files) {
        Ok(cell) => {
            for station in &cell.stations {
                let change = [Change::Retract(0.0)];
                let Ok(edited) = set_station(text, &station.name, &change) else { continue };
                let again = read(&edited, &mut files).unwrap_or_else(|found| panic!("{found:?}"));
                let found = again.stations.iter().find(|one| one.name == station.name);
                assert_eq!(found.map(|one| one.retract_reach), Some(0.0));
            }
        }
        Err(problems) => {
            assert!(!problems.is_empty());
            problems.iter().for_each(|problem| drop(problem.with_excerpt("file")));
        }
    }
});
