//! Cell files: the example, what is wrong with others and where, and editing.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use jointplay_cell::cell::Cell;
use jointplay_cell::robot::RODS;
use jointplay_format::cell::{EXAMPLE, Problem, read};

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("nobody has {name}"))
}

fn problems(text: &str) -> Vec<Problem> {
    read(text, &mut no_files).unwrap_err()
}

fn example() -> Cell {
    match read(EXAMPLE, &mut no_files) {
        Ok(cell) => cell,
        Err(problems) => {
            let told = problems.iter().map(|problem| problem.with_excerpt("example.toml"));
            panic!("{}", told.collect::<Vec<_>>().join("\n"))
        }
    }
}

#[test]
fn every_slot_of_the_example_is_within_reach_of_both_arms() {
    let cell = example();
    let home: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    for station in &cell.stations {
        for slot in 1..=station.slots {
            for &id in &station.effectors {
                let [x, y, _] = cell.robot.arms[id.arm].mount;
                let way = station.waypoints(slot, [x, y]);
                let mut near = home.clone();
                let places = [
                    &way.retracted_below,
                    &way.below,
                    &way.resting,
                    &way.above,
                    &way.retracted_above,
                ];
                for (k, place) in places.into_iter().enumerate() {
                    let reached = cell.reach(id, place, k > 2, &near).unwrap_or_else(|error| {
                        panic!("{} slot {slot} place {k} {id:?}: {error}", station.name)
                    });
                    near = reached.positions;
                }
                if slot == 1 {
                    eprintln!("{} {id:?} {:?}", station.name, &near[RODS..]);
                }
            }
        }
    }
}
