//! Suggestions over the catalogue: what a written file gives.

use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    CommandedJoints, Mechanism, MechanismSystem, ReliefSolver, SuggestOptions, Suggestion,
    assemble, guess, relieve, suggest,
};
use jointplay_format::catalogue;
use jointplay_format::mechanism::{parse, with_virtual_joints};
use nalgebra::DVector;

/// A command that needs play: motors, and other joints with one freedom, at home except for the first.
struct Command {
    coordinates: Vec<usize>,
    values: DVector<f64>,
}

/// Share of the characteristic length, or angle (rad), of the first coordinate.
const STEP: f64 = 0.02;

/// The first suggestions for a command that needs play, with as few commanded coordinates as it takes.
fn first_suggestions(
    mechanism: &Mechanism,
    home: &DVector<f64>,
) -> Option<(Command, Vec<Suggestion>)> {
    let system = MechanismSystem::new(mechanism, home.clone()).expect("the mechanism is small");
    let mut order = mechanism.actuated_coordinates();
    let motors = order.len().max(1);
    for (j, joint) in mechanism.joints().iter().enumerate() {
        if joint.kind.freedoms() == 1 && !joint.actuated {
            order.extend(system.kinematics().coordinates_of(j));
        }
    }
    let length = system.characteristic_length();
    for count in motors..=order.len() {
        let coordinates = order[..count].to_vec();
        let mut values = DVector::from_iterator(count, coordinates.iter().map(|&k| home[k]));
        values[0] += STEP * system.kinematics().dimensions()[coordinates[0]].unit(length);
        let options = SuggestOptions { limit: 200, joints: Some(4), ..SuggestOptions::default() };
        let commands = [values.clone()];
        let found = suggest(mechanism, home, &coordinates, &commands, &options).ok()?;
        if found.needed {
            let sets = found.sets.into_iter().take(2).collect();
            return Some((Command { coordinates, values }, sets));
        }
    }
    None
}

#[test]
fn a_written_suggestion_has_the_displacement_that_was_stated() {
    let mut written_sets = 0;
    for entry in catalogue::entries().iter().filter(|e| e.kind().as_deref() == Some("mechanism")) {
        let file = parse(entry.text).unwrap();
        let bare = file.mechanism.clone().with_virtual_joints(Vec::new()).unwrap();
        let home = assemble(&bare, &guess(&bare), &[], 30).unwrap().coordinates;
        let Some((command, sets)) = first_suggestions(&bare, &home) else { continue };
        for set in sets {
            let text = with_virtual_joints(
                entry.text,
                &file.mechanism,
                file.units,
                &set.virtual_joints,
                &[],
            );
            let read = parse(&text.unwrap()).unwrap().mechanism;
            let at_home = assemble(&read, &guess(&read), &[], 30).unwrap().coordinates;
            let at_home = MechanismSystem::new(&read, at_home).unwrap();
            let commanded = CommandedJoints::new(&at_home, &command.coordinates).unwrap();
            let start = commanded.start(command.values.iter().copied(), set.virtual_joints.len());
            let system = MechanismSystem::new(&read, start).unwrap();
            let found = relieve(&system, &commanded, ReliefSolver::LeastNorm).unwrap();
            let off = (found.size - set.size).abs() / set.size;
            assert!(off < 1e-7, "{}: {} {} {off:e}", entry.name, found.size, set.size);
            for (x, largest) in found.virtual_joints.iter().zip(&set.largest) {
                assert!(
                    (x.abs() - largest).abs() < 1e-7 * set.size.max(*largest),
                    "{}",
                    entry.name
                );
            }
            written_sets += 1;
        }
    }
    assert!(written_sets >= 30, "{written_sets}");
}
