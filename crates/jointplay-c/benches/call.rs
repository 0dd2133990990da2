//! Forward kinematics by a call of C, by a call of Rust with the same outputs, and of many sets by one call of C.

use std::hint::black_box;
use std::ptr;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay::bulk::PoseSolver;
use jointplay::gpr::Gpr;
use jointplay::virtualization::{BuiltIn, SolveOptions};
use jointplay_c::{
    JP_PLANAR, JP_POLAR, JP_RADIAL, jp_robot_forward, jp_robot_forward_many, jp_robot_free,
    jp_robot_paper,
};

const RODS: [f64; 3] = [0.4977, 0.5005, 0.5018];

/// Sets of one call; the time of a set is this part of the time of the call.
const SETS: usize = 1000;

fn rust(c: &mut Criterion, name: &str, virtualization: BuiltIn) {
    let options = SolveOptions::default();
    let solver =
        PoseSolver::new(&Gpr::paper(), virtualization, &options).expect("the metric is valid");
    c.bench_function(&format!("forward/{name}/rust"), |bencher| {
        bencher.iter(|| solver.forward(black_box(RODS)));
    });
}

fn call(c: &mut Criterion, name: &str, virtualization: i32) {
    let mut robot = ptr::null_mut();
    // SAFETY: room for a handle.
    assert_eq!(unsafe { jp_robot_paper(&raw mut robot) }, 0);
    let mut pose = [0.0; 16];
    c.bench_function(&format!("forward/{name}/c"), |bencher| {
        bencher.iter(|| {
            let (rods, pose) = (black_box(RODS), black_box(&mut pose));
            // SAFETY: a robot, 3 numbers, room for 16.
            unsafe {
                jp_robot_forward(
                    robot,
                    virtualization,
                    rods.as_ptr(),
                    pose.as_mut_ptr(),
                    ptr::null_mut(),
                    ptr::null_mut(),
                )
            }
        });
    });
    let (sets, mut poses, mut codes) = ([RODS; SETS], vec![0.0; 16 * SETS], [0; SETS]);
    c.bench_function(&format!("forward/{name}/c, many"), |bencher| {
        bencher.iter(|| {
            let (sets, poses) = (black_box(&sets), black_box(&mut poses));
            // SAFETY: a robot, 3 numbers of each set, room for all.
            unsafe {
                jp_robot_forward_many(
                    robot,
                    virtualization,
                    SETS,
                    sets.as_flattened().as_ptr(),
                    poses.as_mut_ptr(),
                    ptr::null_mut(),
                    codes.as_mut_ptr(),
                )
            }
        });
    });
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

fn benches(c: &mut Criterion) {
    rust(c, "radial", BuiltIn::Radial);
    call(c, "radial", JP_RADIAL);
    rust(c, "planar", BuiltIn::Planar);
    call(c, "planar", JP_PLANAR);
    rust(c, "polar", BuiltIn::Polar);
    call(c, "polar", JP_POLAR);
}

criterion_group!(all, benches);
criterion_main!(all);
