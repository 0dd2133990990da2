//! Reading a cell file never panics, and an edit changes only what it states.

#![no_main]

use jointplay::format::cell::{Change, read, set_station};
use jointplay::spatial::Tilt;
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
                for change in [Change::Retract(0.0), Change::Tilt(Tilt::LEVEL)] {
                    let is_tilt = matches!(change, Change::Tilt(_));
                    // Copies of a pattern and expressions are refused.
                    let Ok(edited) = set_station(text, &station.name, &[change]) else { continue };
                    let again =
                        read(&edited, &mut files).unwrap_or_else(|found| panic!("{found:?}"));
                    let found = again.stations.iter().find(|one| one.name == station.name);
                    let found = found.expect("it stays there");
                    if is_tilt {
                        assert!(found.base_from_station.rotation[(2, 2)] > 1.0 - 1e-12);
                    } else {
                        assert_eq!(found.retract_reach, 0.0);
                    }
                }
            }
        }
        Err(problems) => {
            assert!(!problems.is_empty());
            problems.iter().for_each(|problem| drop(problem.with_excerpt("file")));
        }
    }
});
