//! Time of a step of a functional mock-up unit: all inputs set, loops closed, all outputs read.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay_format::catalogue;
use jointplay_interop::fmu::{Causality, Fmu, Resources};

/// Subjects of the catalogue, and amplitudes of their drives (m, rad).
const SUBJECTS: [(&str, f64); 4] =
    [("gpr", 5e-4), ("gpr-mechanism", 1e-3), ("four-bar", 0.8), ("hexapod", 0.01)];
/// Change of the phase of the drives in a step (rad).
const PHASE: f64 = 0.01;

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for (name, amplitude) in SUBJECTS {
        let model = catalogue::entries().iter().find(|entry| entry.name == name).unwrap().text;
        let mut fmu = Fmu::new(&Resources::for_model(model)).unwrap();
        let of = |causality| {
            let all = fmu.variables().iter();
            let those = all.filter(move |one| one.causality == causality);
            those.map(|one| one.reference).collect::<Vec<u32>>()
        };
        let (inputs, outputs) = (of(Causality::Input), of(Causality::Output));
        let start: Vec<f64> = inputs.iter().map(|&one| fmu.value(one).unwrap()).collect();
        let mut phase = 0.0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                phase += PHASE;
                let mut values = Vec::with_capacity(inputs.len());
                for (k, (&one, start)) in (0_u32..).zip(inputs.iter().zip(&start)) {
                    let shift = f64::from(k);
                    values.push((one, start + amplitude * ((phase + shift).sin() - shift.sin())));
                }
                fmu.set(&values).unwrap();
                fmu.update().unwrap();
                outputs.iter().for_each(|&one| {
                    black_box(fmu.value(one).unwrap());
                });
            });
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
