//! How long the example cell takes: a lot of 25 wafers there and back, timed, and checked with collisions at 1 kHz.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::motion::{MotionOptions, timed};
use jointplay_cell::program::expand;
use jointplay_format::{cell, program};

fn lot(criterion: &mut Criterion) {
    let cell = cell::read(cell::EXAMPLE, &mut |path| Err(format!("{path} is not there"))).unwrap();
    let read = program::parse(program::EXAMPLE).unwrap();
    let steps = expand(&cell, &read).unwrap();
    let options = MotionOptions::default();
    let motion = timed(&cell, steps.clone(), &options).unwrap();
    let named = format!("{} steps, {:.0} s", steps.len(), motion.duration());
    let mut group = criterion.benchmark_group(format!("example, {named}"));
    group.sample_size(10);
    group.bench_function("read the cell", |bench| {
        bench.iter(|| cell::read(cell::EXAMPLE, &mut |_| Err(String::new())).unwrap());
    });
    group.bench_function("expand", |bench| {
        bench.iter(|| expand(black_box(&cell), &read).unwrap());
    });
    group.bench_function("time", |bench| {
        bench.iter(|| timed(&cell, black_box(steps.clone()), &options).unwrap());
    });
    group.bench_function("check", |bench| {
        bench.iter(|| check(&cell, black_box(&motion), &CheckOptions::default()));
    });
    group.finish();
}

criterion_group!(benches, lot);
criterion_main!(benches);
