//! Forward kinematics by a call of C, and by a call of Rust with the same outputs.

use std::hint::black_box;
use std::ptr;

use criterion::{Criterion, criterion_group, criterion_main};
use jointplay::gpr::Gpr;
use jointplay::virtualization::{Planar, Radial, SolveOptions, Virtualization};
use jointplay_c::{JP_PLANAR, JP_RADIAL, jp_robot_forward, jp_robot_free, jp_robot_paper};

const RODS: [f64; 3] = [0.4977, 0.5005, 0.5018];

fn rust(c: &mut Criterion, name: &str, virtualization: &impl Virtualization) {
    let (gpr, options) = (Gpr::paper(), SolveOptions::default());
    c.bench_function(&format!("forward/{name}/rust"), |bencher| {
        bencher.iter(|| gpr.forward(black_box(RODS), virtualization, &options));
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
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

fn benches(c: &mut Criterion) {
    rust(c, "radial", &Radial);
    call(c, "radial", JP_RADIAL);
    rust(c, "planar", &Planar);
    call(c, "planar", JP_PLANAR);
}

criterion_group!(all, benches);
criterion_main!(all);
