//! Reading a cell file never panics, its expansion is the same cell, and an edit changes only what it states.

#![no_main]

use jointplay::format::cell::{Change, expand, read, set_station};
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
            let expanded = expand(text, &[], &mut files).expect("a cell that is read is expanded");
            let again = read(&expanded, &mut files)
                .unwrap_or_else(|found| panic!("{found:?} in the expansion\n{expanded}"));
            assert!(cell.stations == again.stations && cell.bodies.len() == again.bodies.len());
            assert!(cell.zones.len() == again.zones.len() && cell.occupied == again.occupied);
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
