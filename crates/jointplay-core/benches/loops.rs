//! Cost of mobility and of one step of a motion by the number of loops, by sparse algebra and, up to its limit, by dense algebra.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

#[path = "../tests/families/mod.rs"]
mod families;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jointplay_core::mechanism::{
    Drive, Mechanism, MechanismSystem, SparseSystem, assemble, drive, guess,
};
use jointplay_core::mobility::{RANK_THRESHOLD, finite_mobility};

/// A family by its number of loops; the joint that is driven, and where to.
type Family = (&'static str, fn(usize) -> Mechanism, &'static str);

const FAMILIES: [Family; 2] = [
    ("scissor lift", |loops| families::scissor_lift(loops + 1), "middle 0"),
    ("row of Bennett linkages", families::bennett_row, "P1"),
];

fn loops(criterion: &mut Criterion) {
    for (family, make, driver) in FAMILIES {
        for count in [1, 3, 10, 30, 100, 300, 1000] {
            let mechanism = make(count);
            let mut system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
            system.close(&[], 100).unwrap();
            let coordinate =
                system.kinematics().coordinates_of(mechanism.joint(driver).unwrap()).start;
            // A lift also turns about its foot, which is held.
            let still: Vec<usize> =
                mechanism.joint("foot").into_iter().map(|foot| foot.min(coordinate)).collect();
            let drives = [Drive { coordinate, to: system.coordinates()[coordinate] + 0.02 }];
            let mut group = criterion.benchmark_group(family);
            group.sample_size(10).throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::new("mobility, sparse", count), |bencher| {
                bencher.iter(|| black_box(system.mobility(RANK_THRESHOLD)).unwrap());
            });
            group.bench_function(BenchmarkId::new("step, sparse", count), |bencher| {
                bencher.iter(|| black_box(system.clone().drive(&drives, &still, 1)).unwrap());
            });
            if MechanismSystem::fits(&mechanism) {
                let closed = assemble(&mechanism, system.coordinates(), &[], 0).unwrap();
                let dense = MechanismSystem::new(&mechanism, closed.coordinates).unwrap();
                let free: Vec<usize> = (0..mechanism.joint_freedoms())
                    .filter(|k| *k != coordinate && !still.contains(k))
                    .collect();
                group.bench_function(BenchmarkId::new("mobility, dense", count), |bencher| {
                    bencher.iter(|| {
                        black_box(finite_mobility(&dense, &dense.at_home(), RANK_THRESHOLD))
                            .unwrap()
                    });
                });
                group.bench_function(BenchmarkId::new("step, dense", count), |bencher| {
                    bencher.iter(|| black_box(drive(&dense, &drives, &free, 1)).unwrap());
                });
            }
            group.finish();
        }
    }
}

criterion_group!(benches, loops);
criterion_main!(benches);
