//! The program of the example cell.

use std::collections::BTreeSet;

use jointplay_cell::program::{Handoff, Path, Phase, Step, expand};
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::{cell, program};

const CELL: &str = include_str!("../cells/example.toml");
const PROGRAM: &str = include_str!("../cells/example.program");

#[test]
fn a_lot_is_processed_and_returned() {
    let cell = cell::read(CELL, &mut |path| Err(format!("{path} is not there"))).unwrap();
    assert_eq!(program::format(PROGRAM).unwrap(), PROGRAM);
    let steps = expand(&cell, &program::parse(PROGRAM).unwrap()).unwrap_or_else(|errors| {
        let shown = |error| {
            program::explain(&cell.robot, PROGRAM, error, DisplayUnits::Metric)
                .with_excerpt("example.program")
        };
        panic!("{}", errors.iter().map(shown).collect::<Vec<_>>().join("\n"))
    });
    let mut full: BTreeSet<_> = cell.occupied.iter().copied().collect();
    let mut carried = BTreeSet::new();
    let mut handed = [0, 0];
    for step in &steps {
        match step.handoff {
            Some(Handoff::Picked(effector, slot)) => {
                assert!(full.remove(&slot) && carried.insert(effector));
                handed[0] += 1;
            }
            Some(Handoff::Placed(effector, slot)) => {
                assert!(full.insert(slot) && carried.remove(&effector));
                handed[1] += 1;
            }
            None => {}
        }
    }
    assert_eq!(full, cell.occupied.iter().copied().collect(), "every wafer is back");
    // From the port, the aligner, the process station and the other port, once each.
    assert_eq!(handed, [25 * 4, 25 * 4]);
    // Each wafer waits once at the aligner and once at the process station.
    let processed = |step: &&Step| matches!(step.path, Path::ProcessDwell { .. });
    assert_eq!(steps.iter().filter(processed).count(), 50);
    assert_eq!(steps.iter().filter(|step| step.phase == Phase::Lift).count(), 200);
    assert_eq!(
        steps.last().unwrap().to,
        cell.robot.axes.iter().map(|it| it.home).collect::<Vec<_>>()
    );
}
