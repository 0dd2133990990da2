//! Time of velocities, accelerations and Jacobians of mechanisms.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

#[path = "../tests/robot/mod.rs"]
mod robot;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay_core::mechanism::{
    DifferentialKinematics, FrameId, JointKind, Mechanism, MechanismSystem, PositionSolver,
    ReliefSolver,
};
use jointplay_core::nalgebra::DVector;
use robot::{gpr, joint, names, planar, radial};

/// A name, a mechanism, and values of its commanded coordinates.
type Case<'a> = (&'static str, Mechanism, &'a [(usize, f64)]);

/// A planar four-bar linkage.
fn four_bar() -> Mechanism {
    let points = [[0.0, 0.0], [0.1, 0.0], [0.262, 0.119], [0.25, 0.0]];
    let joints = (0..4).map(|k| {
        let [x, y] = points[k];
        let (kind, z) = (JointKind::Revolute, [0.0, 0.0, 1.0]);
        joint(["A", "B", "C", "D"][k], kind, [k, (k + 1) % 4], [x, y, 0.0], z)
    });
    Mechanism::new("four-bar", names(4), joints.collect()).unwrap()
}

fn differential(criterion: &mut Criterion) {
    let rods = [(0, 0.502), (4, 0.499), (8, 0.5)];
    let cases: [Case<'_>; 3] = [
        ("four-bar", four_bar(), &[(0, 0.2)]),
        ("three rods, radial", gpr(radial), &rods),
        ("three rods, planar by least norm", gpr(planar), &rods),
    ];
    for (name, mechanism, commanded) in cases {
        let mut at = DVector::zeros(mechanism.joint_freedoms() + mechanism.virtual_joints().len());
        commanded.iter().for_each(|&(k, value)| at[k] = value);
        let system = MechanismSystem::new(&mechanism, at.clone()).unwrap();
        let indices: Vec<usize> = commanded.iter().map(|&(k, _)| k).collect();
        let mut solver = PositionSolver::new(&system, &indices).unwrap();
        solver.solve(at.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        let mut rates = DifferentialKinematics::new(&system, &indices).unwrap();
        let velocity: Vec<f64> = (0..indices.len()).map(|j| 0.1 + j as f64).collect();
        let (mut velocities, mut accelerations) = (at.clone(), at.clone());
        let mut group = criterion.benchmark_group("differential kinematics");
        group.bench_function(format!("velocities and accelerations, {name}"), |bencher| {
            bencher.iter(|| {
                rates.linearize(at.as_slice()).unwrap();
                rates.velocities(&velocity, velocities.as_mut_slice()).unwrap();
                rates.accelerations(&velocity, accelerations.as_mut_slice()).unwrap();
                black_box(&accelerations);
            });
        });
        let link = FrameId::Link(mechanism.links().len() - 1);
        group.bench_function(format!("Jacobian of a link, {name}"), |bencher| {
            bencher.iter(|| {
                rates.linearize(at.as_slice()).unwrap();
                black_box(rates.jacobian(link)).unwrap();
            });
        });
        group.finish();
    }
}

criterion_group!(benches, differential);
criterion_main!(benches);
