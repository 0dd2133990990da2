//! How long the kernels for many poses take, per pose.
//!
//! 4,096 tilts within ±2°, whose columns stay in the core's own cache.
//! Times of different machines compare only as ratios, see `cargo bench -p jointplay-core --bench kernels`.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use jointplay_core::bulk::{Column, Quantity, Status};
use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{
    Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};

const POSES: usize = 4096;

struct Poses {
    gpr: Gpr,
    azimuth: Vec<f64>,
    tilt_angle: Vec<f64>,
    rods: [Vec<f64>; 3],
}

impl Poses {
    /// Tilts spread evenly over all azimuths and up to ±2°, by two irrational strides.
    fn new() -> Self {
        let numbers = 1..=POSES as u32;
        let azimuth: Vec<f64> = numbers
            .clone()
            .map(|i| (f64::from(i) * 2.399_963_229_728_653).rem_euclid(std::f64::consts::TAU))
            .collect();
        let tilt_angle: Vec<f64> = numbers
            .map(|i| (4.0 * (f64::from(i) * 0.754_877_666_246_692_8).fract() - 2.0).to_radians())
            .collect();
        let rods = [0, 1, 2].map(|_| vec![0.0; POSES]);
        let mut poses =
            Self { gpr: Gpr::paper().without_limit_checks(), azimuth, tilt_angle, rods };
        poses.inverse();
        poses
    }

    fn inverse(&mut self) {
        let [q_1, q_2, q_3] = &mut self.rods;
        let status = &mut [Status::Solved; POSES];
        let (azimuth, tilt_angle) = (self.azimuth[..].into(), self.tilt_angle[..].into());
        let height = Column::constant(&0.5, POSES);
        self.gpr.inverse_many(azimuth, tilt_angle, height, status, [q_1, q_2, q_3]).unwrap();
    }
}

fn forward(
    criterion: &mut Criterion,
    name: &str,
    model: &dyn Virtualization,
    solver: Solver,
    quantities: &[Quantity],
) {
    let poses = Poses::new();
    let mut columns = vec![vec![0.0; POSES]; quantities.len()];
    let mut status = vec![Status::Solved; POSES];
    let options = SolveOptions { solver, ..SolveOptions::default() };
    let mut group = criterion.benchmark_group("bulk");
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let rods = poses.rods.each_ref().map(|column| Column::from(&column[..]));
            let mut wanted: Vec<_> = quantities
                .iter()
                .zip(&mut columns)
                .map(|(quantity, column)| (*quantity, &mut column[..]))
                .collect();
            let rods = black_box(rods);
            poses.gpr.forward_many(rods, model, &options, &mut status, &mut wanted).unwrap()
        });
    });
    group.finish();
}

fn kernels(criterion: &mut Criterion) {
    let mut poses = Poses::new();
    let mut group = criterion.benchmark_group("bulk");
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function("inverse", |bencher| bencher.iter(|| black_box(&mut poses).inverse()));
    group.finish();

    let three = [0, 1, 2].map(Quantity::VirtualJoint);
    let six = [0, 1, 2, 3, 4, 5].map(Quantity::VirtualJoint);
    let shift = [Quantity::Origin(0), Quantity::Origin(1)];
    let pose: Vec<_> = (0..3)
        .map(Quantity::Origin)
        .chain([Quantity::Azimuth, Quantity::TiltAngle, Quantity::Torsion])
        .collect();
    forward(criterion, "radial closed-form, X", &Radial, Solver::ClosedForm, &three);
    forward(criterion, "planar closed-form, X", &Planar, Solver::ClosedForm, &six);
    forward(criterion, "polar newton, X", &Polar, Solver::Newton, &six);
    let with_residual = [&six[..], &[Quantity::Residual]].concat();
    forward(criterion, "polar newton, X, residual", &Polar, Solver::Newton, &with_residual);
    forward(criterion, "offset newton, X", &Offset, Solver::Newton, &six);
    forward(criterion, "polar least-norm, X", &Polar, Solver::LeastNorm, &six);
    forward(criterion, "planar closed-form, centre shift", &Planar, Solver::ClosedForm, &shift);
    forward(criterion, "polar newton, centre shift", &Polar, Solver::Newton, &shift);
    forward(criterion, "polar newton, pose", &Polar, Solver::Newton, &pose);
    let displacement = [Quantity::Displacement];
    forward(criterion, "polar newton, displacement", &Polar, Solver::Newton, &displacement);
    let sensitivity = [0, 1, 2].map(Quantity::Sensitivity);
    forward(criterion, "polar newton, sensitivity", &Polar, Solver::Newton, &sensitivity);
}

criterion_group!(benches, kernels);
criterion_main!(benches);
