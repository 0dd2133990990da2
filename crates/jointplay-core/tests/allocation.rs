//! The kernels that run once for each pose do not allocate.
#![expect(
    unsafe_code,
    reason = "counting allocations takes a global allocator, whose trait is unsafe"
)]

mod robot;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use jointplay_core::bulk::{Column, Quantity, Status};
use jointplay_core::gpr::{AxisHeight, CenterHeight, Gpr, PlatformPose};
use jointplay_core::mechanism::{
    DifferentialKinematics, FrameId, MechanismSystem, PositionSolver, ReliefSolver,
};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{SolveOptions, Solver, Virtualization, built_in};

/// The system's allocator, counting the calls of each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is handed on to the system's allocator; counting in a constant-initialised cell allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` above, that is from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(kernel: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    kernel();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn kernels_do_not_allocate() {
    assert_eq!(
        allocations(|| drop(std::hint::black_box(Box::new(1)))),
        1,
        "allocations are counted"
    );
    let gpr = Gpr::paper().without_limit_checks();
    let tilt = Tilt { azimuth: 0.4, angle: 0.03 };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    let inverse = allocations(|| {
        gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    });
    assert_eq!(inverse, 0);
    for model in built_in() {
        for solver in [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm] {
            let options = SolveOptions { solver, ..SolveOptions::default() };
            let forward = allocations(|| {
                gpr.forward(rods, model, &options).unwrap();
            });
            let center = allocations(|| {
                gpr.inverse_for_center(tilt, CenterHeight(0.5), model, &options).unwrap();
            });
            assert_eq!((forward, center), (0, 0), "{} {solver}", model.name());
        }
        let pose = gpr.forward(rods, model, &SolveOptions::default()).unwrap();
        let derivatives = allocations(|| {
            gpr.rod_derivatives(tilt, AxisHeight(0.5)).unwrap();
            gpr.platform_derivatives(&pose, model).unwrap();
            std::hint::black_box(gpr.needed_clearance(&pose, model));
            gpr.platform_jacobian(&by_newton(&gpr, rods, model), model).ok();
        });
        assert_eq!(derivatives, 0, "{}", model.name());
    }
}

/// A pose whose derivatives are refused where there are more than three virtual joints.
fn by_newton(gpr: &Gpr, rods: [f64; 3], model: &dyn Virtualization) -> PlatformPose {
    let options = SolveOptions { solver: Solver::Newton, ..SolveOptions::default() };
    gpr.forward(rods, model, &options).expect("the pose is within reach")
}

#[test]
fn poses_beyond_the_limits_do_not_allocate() {
    let (gpr, options) = (Gpr::paper(), SolveOptions::default());
    let count = allocations(|| {
        let tilt = Tilt { azimuth: 30.0, angle: 1.5 };
        gpr.inverse(tilt, AxisHeight(0.5)).unwrap_err();
        for model in built_in() {
            gpr.forward([120.0, 121.0, 122.0], model, &options).unwrap_err();
            gpr.forward([f64::NAN; 3], model, &options).unwrap_err();
            gpr.inverse_for_center(tilt, CenterHeight(0.5), model, &options).unwrap_err();
        }
        let broken = gpr.limits().broken(&[0.1, 0.5, 0.9], tilt);
        assert_eq!(broken.iter().count(), 3);
    });
    assert_eq!(count, 0);
}

#[test]
fn many_poses_do_not_allocate() {
    const POSES: usize = 13;
    let gpr = Gpr::paper().without_limit_checks();
    let tilt_angle: [f64; POSES] = std::array::from_fn(|i| 0.01 * i as f64);
    let mut rods = [[0.0; POSES]; 3];
    let mut status = [Status::Solved; POSES];
    let inverse = allocations(|| {
        let [azimuth, height] = [0.4, 0.5].each_ref().map(|value| Column::constant(value, POSES));
        let rods = rods.each_mut().map(|column| &mut column[..]);
        gpr.inverse_many(azimuth, tilt_angle[..].into(), height, &mut status, rods).unwrap();
    });
    assert_eq!(inverse, 0);
    let rods = rods.each_ref().map(|column| Column::from(&column[..]));
    let mut columns = [[0.0; POSES]; 3];
    for model in built_in() {
        for solver in [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm] {
            let options = SolveOptions { solver, ..SolveOptions::default() };
            let forward = allocations(|| {
                let [x, azimuth, sensitivity] = columns.each_mut().map(|column| &mut column[..]);
                let wanted = &mut [
                    (Quantity::VirtualJoint(2), x),
                    (Quantity::Azimuth, azimuth),
                    (Quantity::Sensitivity(1), sensitivity),
                ];
                let tally = gpr.forward_many(rods, model, &options, &mut status, wanted).unwrap();
                assert_eq!(tally.failed(), 0);
            });
            assert_eq!(forward, 0, "{} {solver}", model.name());
        }
    }
}

#[test]
fn positions_of_a_mechanism_do_not_allocate() {
    let mechanism = robot::gpr(robot::polar);
    let gpr = Gpr::paper().without_limit_checks();
    let rods = gpr.inverse(Tilt { azimuth: 0.4, angle: 0.03 }, AxisHeight(0.5)).unwrap();
    let mut start = robot::home(&mechanism);
    (0..3).for_each(|k| start[4 * k] = rods[k]);
    let system = MechanismSystem::new(&mechanism, start.clone()).unwrap();
    let mut solver = PositionSolver::new(&system, &[0, 4, 8]).unwrap();
    for relief in [ReliefSolver::Newton, ReliefSolver::LeastNorm] {
        let mut position = start.clone();
        let count = allocations(|| {
            let found = solver.solve(position.as_mut_slice(), relief).unwrap();
            assert!(found.iterations > 1);
        });
        assert_eq!(count, 0, "{relief:?}");
    }
    let rigid = robot::gpr(|_, _| Vec::new());
    let system = MechanismSystem::new(&rigid, robot::home(&rigid)).unwrap();
    let mut solver = PositionSolver::new(&system, &[0, 4, 8]).unwrap();
    let mut position = start.rows(0, 12).into_owned();
    let count = allocations(|| {
        solver.solve(position.as_mut_slice(), ReliefSolver::Newton).unwrap_err();
    });
    assert_eq!(count, 0, "what cannot be reached");
}

#[test]
fn velocities_and_accelerations_do_not_allocate() {
    let mechanism = robot::gpr(robot::planar);
    let mut at = robot::home(&mechanism);
    (at[0], at[4], at[8]) = (0.502, 0.499, 0.5);
    let system = MechanismSystem::new(&mechanism, at.clone()).unwrap();
    let rods = [0, 4, 8];
    PositionSolver::new(&system, &rods)
        .unwrap()
        .solve(at.as_mut_slice(), ReliefSolver::LeastNorm)
        .unwrap();
    let mut rates = DifferentialKinematics::new(&system, &rods).unwrap();
    let (mut velocities, mut accelerations) = (at.clone(), at.clone());
    let count = allocations(|| {
        rates.linearize(at.as_slice()).unwrap();
        rates.velocities(&[0.1, 0.0, -0.1], velocities.as_mut_slice()).unwrap();
        rates.accelerations(&[1.0, 0.0, 0.0], accelerations.as_mut_slice()).unwrap();
        rates.frame_acceleration(FrameId::Link(4)).unwrap();
    });
    assert_eq!(count, 0);
}
