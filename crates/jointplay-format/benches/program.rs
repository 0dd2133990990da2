//! From the text of a program to the steps of a lot, in the example cell.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use jointplay_cell::program::expand;
use jointplay_format::{cell, program};

const CELL: &str = include_str!("../cells/example.toml");
const PROGRAM: &str = include_str!("../cells/example.program");

fn lot(criterion: &mut Criterion) {
    let cell = cell::read(CELL, &mut |path| Err(format!("{path} is not there"))).unwrap();
    let read = program::parse(PROGRAM).unwrap();
    let steps = expand(&cell, &read).unwrap().len();
    let mut group = criterion.benchmark_group("a lot there and back");
    group.bench_function("read its program", |bencher| {
        bencher.iter(|| program::parse(black_box(PROGRAM)).unwrap());
    });
    group.sample_size(20).throughput(Throughput::Elements(steps as u64));
    group.bench_function("expand it to steps", |bencher| {
        bencher.iter(|| expand(black_box(&cell), &read).unwrap());
    });
    group.finish();

    // A text of the maximum length, which formatting changes.
    let long = "  get  LP1 slot 3  with A # a wafer\n".repeat(25_000);
    let mut group = criterion.benchmark_group("a text of 25 000 lines");
    group.sample_size(10).throughput(Throughput::Bytes(long.len() as u64));
    group.bench_function("read", |bencher| {
        bencher.iter(|| program::parse(black_box(&long)).unwrap());
    });
    group.bench_function("lay out", |bencher| {
        bencher.iter(|| program::format(black_box(&long)).unwrap());
    });
    group.finish();
}

criterion_group!(benches, lot);
criterion_main!(benches);
