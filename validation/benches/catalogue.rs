//! How long the finite mobility of each mechanism of the catalogue takes, where its file starts.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay::format::catalogue::entries;
use jointplay::format::mechanism::{kind_of, parse};
use jointplay::mechanism::{MechanismSystem, assemble, guess};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility};

fn mobility(criterion: &mut Criterion) {
    for entry in entries() {
        if kind_of(entry.text).as_deref() != Some("mechanism") {
            continue;
        }
        let mechanism = parse(entry.text).unwrap().mechanism;
        let closed = assemble(&mechanism, &guess(&mechanism), &[], 0).unwrap();
        let system = MechanismSystem::new(&mechanism, closed.coordinates).unwrap();
        criterion.bench_function(entry.name, |bencher| {
            bencher.iter(|| {
                black_box(finite_mobility(&system, &system.at_home(), RANK_THRESHOLD)).unwrap()
            });
        });
    }
}

criterion_group!(benches, mobility);
criterion_main!(benches);
