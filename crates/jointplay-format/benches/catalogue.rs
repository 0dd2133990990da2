//! Time of velocities and accelerations, and of a suggestion, for each mechanism of the catalogue.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]
#![expect(clippy::print_stdout, reason = "results that are not times")]

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    DifferentialKinematics, Mechanism, MechanismSystem, SuggestOptions, assemble, guess, suggest,
};
use jointplay_format::{catalogue, mechanism};
use nalgebra::DVector;

/// Displacement of a motor from home: in radians, or as a share of the characteristic length.
const STEP: f64 = 0.05;

/// The mechanisms of the catalogue by name.
fn mechanisms() -> impl Iterator<Item = (&'static str, Mechanism)> {
    let of_kind = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some("mechanism");
    catalogue::entries()
        .iter()
        .filter(of_kind)
        .map(|entry| (entry.name, mechanism::parse(entry.text).unwrap().mechanism))
}

/// Closed coordinates, virtual joints at rest.
fn home(mechanism: &Mechanism) -> DVector<f64> {
    assemble(mechanism, &guess(mechanism), &[], 30).unwrap().coordinates
}

fn rates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("velocities and accelerations");
    for (name, mechanism) in mechanisms() {
        let home = home(&mechanism);
        let system = MechanismSystem::new(&mechanism, home.clone()).unwrap();
        let commanded = mechanism.actuated_coordinates();
        let mut rates = DifferentialKinematics::new(&system, &commanded).unwrap();
        let velocity: Vec<f64> = commanded.iter().map(|&k| 0.1 + 0.01 * k as f64).collect();
        let (mut velocities, mut accelerations) = (home.clone(), home.clone());
        rates.linearize(home.as_slice()).unwrap();
        if let Err(error) = rates.velocities(&velocity, velocities.as_mut_slice()) {
            println!("{name}: {error}");
            continue;
        }
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                rates.linearize(black_box(home.as_slice())).unwrap();
                rates.velocities(&velocity, velocities.as_mut_slice()).unwrap();
                rates.accelerations(&velocity, accelerations.as_mut_slice()).unwrap();
                black_box(&accelerations);
            });
        });
    }
    group.finish();
}

fn suggestions(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("suggestion");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (name, mechanism) in mechanisms() {
        let mechanism = mechanism.with_virtual_joints(Vec::new()).unwrap();
        let home = home(&mechanism);
        let system = MechanismSystem::new(&mechanism, home.clone()).unwrap();
        let commanded = mechanism.actuated_coordinates();
        let (length, dimensions) =
            (system.characteristic_length(), system.kinematics().dimensions());
        let commands: Vec<DVector<f64>> = (0..commanded.len())
            .map(|n| {
                let mut command = home.select_rows(&commanded);
                command[n] += STEP * dimensions[commanded[n]].unit(length);
                command
            })
            .collect();
        let options = SuggestOptions::default();
        let found = suggest(&mechanism, &home, &commanded, &commands, &options);
        match &found {
            Ok(found) => println!(
                "{name}: play needed {}, {} sets, complete {}, {} compared of {}, {} untried",
                found.needed,
                found.sets.len(),
                found.complete(),
                found.compared,
                found.in_class,
                found.untried
            ),
            Err(error) => println!("{name}: {error}"),
        }
        group.bench_function(name, |bencher| {
            bencher.iter(|| suggest(&mechanism, &home, &commanded, black_box(&commands), &options));
        });
    }
    group.finish();
}

criterion_group!(benches, rates, suggestions);
criterion_main!(benches);
