//! How long the example cell takes: a lot of 25 wafers there and back, timed, and checked with collisions at 1 kHz, from scratch and after a station was moved.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::{cell, program};

fn lot(criterion: &mut Criterion) {
    let cell = cell::read(cell::EXAMPLE, &mut |path| Err(format!("{path} is not there"))).unwrap();
    let read = program::parse(program::EXAMPLE).unwrap();
    let steps = expand(&cell, &read).unwrap();
    let options = TrajectoryOptions::default();
    let motion = plan_trajectory(&cell, steps.clone(), &options).unwrap();
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
        bench.iter(|| plan_trajectory(&cell, black_box(steps.clone()), &options).unwrap());
    });
    group.bench_function("check", |bench| {
        bench.iter(|| check(&cell, black_box(&motion), &CheckOptions::default()));
    });
    // All of these, which share lines and inverse kinematics.
    group.bench_function("plan", |bench| {
        let options = PlanOptions::default();
        bench.iter(|| {
            IncrementalPlanner::default().plan(black_box(&cell), &read, &options).unwrap()
        });
    });
    // A station to and fro, as it is dragged about in the studio.
    for (name, from, to) in [
        ("LP1", "[-495.0, 495.0, 500.0]", "[-495.0, 495.2, 500.0]"),
        ("LP2", "[-495.0, -495.0, 500.0]", "[-495.0, -495.2, 500.0]"),
        ("ALIGN", "[350.0, 606.0, 600.0]", "[350.0, 606.2, 600.0]"),
        ("PM1", "[800.0, 0.0, 620.18]", "[800.0, 0.0, 620.17]"),
    ] {
        let moved = cell::EXAMPLE.replace(from, to);
        assert_ne!(moved, cell::EXAMPLE);
        let cells = [cell::EXAMPLE, &moved]
            .map(|text| cell::read(text, &mut |_| Err(String::new())).unwrap());
        let mut memory = IncrementalPlanner::default();
        let mut plan = |cell: &Cell| memory.plan(cell, &read, &PlanOptions::default()).unwrap();
        plan(&cells[0]);
        let mut round = 0;
        group.bench_function(format!("replan, {name} moved"), |bench| {
            bench.iter(|| {
                round += 1;
                plan(black_box(&cells[round % 2]))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, lot);
criterion_main!(benches);
