//! Duration of the inverse kinematics of the whole chain, per call and per branch.
//!
//! Targets vary from call to call over a thousand positions and tilts within limits, so that neither branch prediction nor caches know the answer.
//! The least time of each quarter of the targets counts, over the passes of a sample: other work on the machine only adds to it.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::{Duration, Instant};

use common::kind;
use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use jointplay_cell::robot::{EffectorId, HybridRobot, WaferTarget};
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Tilt, tilt_rotation};
use nalgebra::Vector3;

const POSES: u32 = 1000;
const QUARTER: usize = POSES as usize / 4;
const A: EffectorId = EffectorId { arm: 0, effector: 0 };

/// The same targets, from near the positions that the arm would have taken to reach them: as one instruction follows another.
fn settled(robot: &HybridRobot, cases: &[(Vec<f64>, WaferTarget)]) -> Vec<(Vec<f64>, WaferTarget)> {
    let settle = |(near, target): &(Vec<f64>, WaferTarget)| {
        let found = robot.inverse(A, target, near).unwrap();
        let taken = found.chosen.map_or(near.clone(), |k| found.branches[k].positions.to_vec());
        let moved = |(axis, position): (usize, f64)| position + if axis < 3 { 0.0 } else { 0.05 };
        (taken.into_iter().enumerate().map(moved).collect(), *target)
    };
    cases.iter().map(settle).collect()
}

/// Positions spread evenly over the axes and tilts up to 1.5°, by irrational strides, and the targets that they reach.
fn cases(robot: &HybridRobot, with_heading: bool) -> Vec<(Vec<f64>, WaferTarget)> {
    let strides = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3, 0.819_172_513_396_164_5];
    (1..=POSES)
        .map(|i| {
            let fraction = |stride: f64| (f64::from(i) * stride).fract();
            let tilt =
                Tilt { azimuth: TAU * fraction(0.618), angle: 0.026 * fraction(0.414_213_562) };
            let mut positions = robot.gpr.inverse(tilt, AxisHeight(0.5)).unwrap().to_vec();
            for (k, axis) in robot.axes[3..].iter().enumerate() {
                let fraction = 0.1 + 0.8 * fraction(strides[k % 3] + 0.1 * k as f64);
                positions.push(axis.min + fraction * (axis.max - axis.min));
            }
            let pose = robot.effector_pose(&positions, A).unwrap();
            let normal = pose.rotation * Vector3::z();
            let x = tilt_rotation(&normal).inverse() * (pose.rotation * Vector3::x());
            let heading = with_heading.then(|| x.y.atan2(x.x));
            let target = WaferTarget { center: pose.translation.vector, normal, heading };
            // Near positions that reach the target.
            for position in &mut positions[3..] {
                *position += 0.05;
            }
            (positions, target)
        })
        .collect()
}

fn benches(criterion: &mut Criterion) {
    let robots = [
        ("radial, belt", 0, true),
        ("radial, slide", 3, true),
        ("2R", 4, true),
        ("3R", 5, true),
        ("radial with wrist", 7, true),
        ("slide with wrist", 8, true),
        ("3R, heading free", 5, false),
        ("radial with wrist, heading free", 7, false),
        ("slide with wrist, heading free", 8, false),
        ("4R", 9, true),
        ("4R, heading free", 9, false),
    ];
    let mut group = criterion.benchmark_group("forward");
    let robot = kind(0, [0.23, 0.23, 0.3]);
    let of_belt = cases(&robot, true);
    group.throughput(Throughput::Elements(u64::from(POSES)));
    group.bench_function("effector_pose", |bencher| {
        bencher.iter(|| {
            for (positions, _) in &of_belt {
                black_box(robot.effector_pose(black_box(positions), A).unwrap());
            }
        });
    });
    group.bench_function("effector_jacobian", |bencher| {
        bencher.iter(|| {
            for (positions, _) in &of_belt {
                black_box(robot.effector_jacobian(black_box(positions), A).unwrap());
            }
        });
    });
    group.finish();
    // An element is a branch.
    let mut group = criterion.benchmark_group("inverse");
    // As many passes in each sample.
    group.sampling_mode(SamplingMode::Flat);
    for (name, number, with_heading) in robots {
        let robot = kind(number, [0.22, 0.2, 0.3]);
        let cases = cases(&robot, with_heading);
        let count = |(near, target): &(Vec<f64>, WaferTarget)| {
            robot.inverse(A, target, near).unwrap().branches.len() as u64
        };
        let mut measure = |name: &str, cases: &[(Vec<f64>, WaferTarget)]| {
            group.throughput(Throughput::Elements(cases.iter().map(count).sum()));
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|passes| {
                    let mut least = [Duration::MAX; 4];
                    for _ in 0..passes {
                        for (least, quarter) in least.iter_mut().zip(cases.chunks(QUARTER)) {
                            let start = Instant::now();
                            for (near, target) in quarter {
                                black_box(robot.inverse(A, black_box(target), near).unwrap());
                            }
                            *least = start.elapsed().min(*least);
                        }
                    }
                    least.iter().sum::<Duration>().mul_f64(passes as f64)
                });
            });
        };
        measure(name, &cases);
        if !with_heading {
            measure(&format!("{name}, settled"), &settled(&robot, &cases));
        }
    }
    group.finish();
}

criterion_group!(groups, benches);
criterion_main!(groups);
