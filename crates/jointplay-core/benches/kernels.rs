//! How long the kernels take, per pose.
//!
//! Poses vary from call to call, over a thousand tilts within ±2°, so that neither branches nor caches know the answer beforehand.
//! Times of different machines compare only as ratios to `inverse`.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

#[path = "../tests/robot/mod.rs"]
mod robot;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use jointplay_core::gpr::{AxisHeight, CenterHeight, Gpr};
use jointplay_core::mechanism::{MechanismSystem, PositionSolver, ReliefSolver};
use jointplay_core::mobility::{RANK_THRESHOLD, finite_mobility, instantaneous_mobility};
use jointplay_core::sensitivity::sensitivity;
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{
    Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization, solve,
};

const POSES: u64 = 1000;

/// Tilts spread evenly over all azimuths and up to ±2°, by two irrational strides.
fn tilts() -> Vec<Tilt> {
    (1..=POSES as u32)
        .map(|i| Tilt {
            azimuth: (f64::from(i) * 2.399_963_229_728_653).rem_euclid(std::f64::consts::TAU),
            angle: (4.0 * (f64::from(i) * 0.754_877_666_246_692_8).fract() - 2.0).to_radians(),
        })
        .collect()
}

fn rods(gpr: &Gpr) -> Vec<[f64; 3]> {
    tilts().into_iter().map(|tilt| gpr.inverse(tilt, AxisHeight(0.5)).unwrap()).collect()
}

fn with(solver: Solver) -> SolveOptions {
    SolveOptions { solver, ..SolveOptions::default() }
}

/// Measures one function over all items of a list; criterion reports the rate, of which the inverse is the time of one.
fn over<T>(criterion: &mut Criterion, name: &str, items: &[T], kernel: impl Fn(&T)) {
    let mut group = criterion.benchmark_group("kernels");
    group.throughput(Throughput::Elements(items.len() as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            for item in items {
                kernel(black_box(item));
            }
        });
    });
    group.finish();
}

fn forward<V: Virtualization>(criterion: &mut Criterion, name: &str, model: &V, solver: Solver) {
    let gpr = Gpr::paper().without_limit_checks();
    let options = with(solver);
    over(criterion, name, &rods(&gpr), |&rods| {
        black_box(&gpr.forward(rods, model, &options)).as_ref().unwrap();
    });
}

/// First and second derivatives of poses that are known.
fn platform_derivatives<V: Virtualization>(criterion: &mut Criterion, model: &V) {
    let gpr = Gpr::paper().without_limit_checks();
    let options = SolveOptions::default();
    let poses: Vec<_> =
        rods(&gpr).into_iter().map(|rods| gpr.forward(rods, model, &options).unwrap()).collect();
    let name = model.name();
    over(criterion, &format!("platform Jacobian {name}"), &poses, |pose| {
        black_box(&gpr.platform_jacobian(pose, model)).as_ref().unwrap();
    });
    over(criterion, &format!("platform derivatives {name}"), &poses, |pose| {
        black_box(&gpr.platform_derivatives(pose, model)).as_ref().unwrap();
    });
}

fn derivatives(criterion: &mut Criterion) {
    let gpr = Gpr::paper().without_limit_checks();
    over(criterion, "rod derivatives", &tilts(), |&tilt| {
        black_box(&gpr.rod_derivatives(tilt, AxisHeight(0.5))).as_ref().unwrap();
    });
    platform_derivatives(criterion, &Radial);
    platform_derivatives(criterion, &Planar);
    platform_derivatives(criterion, &Polar);
    platform_derivatives(criterion, &Offset);
}

fn kinematics(criterion: &mut Criterion) {
    let gpr = Gpr::paper().without_limit_checks();
    over(criterion, "inverse", &tilts(), |&tilt| {
        black_box(gpr.inverse(tilt, AxisHeight(0.5))).unwrap();
    });
    forward(criterion, "forward radial closed-form", &Radial, Solver::ClosedForm);
    forward(criterion, "forward planar closed-form", &Planar, Solver::ClosedForm);
    forward(criterion, "forward radial newton", &Radial, Solver::Newton);
    forward(criterion, "forward polar newton", &Polar, Solver::Newton);
    forward(criterion, "forward offset newton", &Offset, Solver::Newton);
    forward(criterion, "forward planar newton", &Planar, Solver::Newton);
    forward(criterion, "forward polar least-norm", &Polar, Solver::LeastNorm);
    over(criterion, "inverse for centre, radial closed-form", &tilts(), |&tilt| {
        let options = SolveOptions::default();
        black_box(gpr.inverse_for_center(tilt, CenterHeight(0.5), &Radial, &options)).unwrap();
    });

    let options = SolveOptions::default();
    let sides: Vec<_> = rods(&gpr)
        .into_iter()
        .map(|rods| gpr.forward(rods, &Radial, &options).unwrap().sides)
        .collect();
    for solver in [Solver::ClosedForm, Solver::Newton] {
        let options = with(solver);
        over(criterion, &format!("solve radial {solver}"), &sides, |sides| {
            black_box(solve(&Radial, gpr.platform(), sides, &options)).unwrap();
        });
        over(criterion, &format!("solve planar {solver}"), &sides, |sides| {
            black_box(solve(&Planar, gpr.platform(), sides, &options)).unwrap();
        });
    }
    for solver in [Solver::Newton, Solver::LeastNorm] {
        let options = with(solver);
        over(criterion, &format!("solve polar {solver}"), &sides, |sides| {
            black_box(solve(&Polar, gpr.platform(), sides, &options)).unwrap();
        });
    }
}

fn analyses(criterion: &mut Criterion) {
    let gpr = Gpr::paper().without_limit_checks();
    let system = gpr.system(&Polar);
    let poses: Vec<_> = rods(&gpr)
        .into_iter()
        .take(20)
        .map(|rods| gpr.forward(rods, &Polar, &with(Solver::Newton)).unwrap())
        .collect();
    let configurations: Vec<_> = poses.iter().map(|pose| system.configuration(pose)).collect();
    over(criterion, "instantaneous mobility", &configurations, |at| {
        black_box(instantaneous_mobility(&system, at, RANK_THRESHOLD)).unwrap();
    });
    over(criterion, "sensitivity", &configurations, |at| {
        black_box(sensitivity(&system, at, 1e-3, RANK_THRESHOLD)).unwrap();
    });
    over(criterion, "finite mobility", &configurations[..5], |at| {
        black_box(finite_mobility(&system, at, RANK_THRESHOLD)).unwrap();
    });
    let tilts = tilts();
    over(criterion, "tilt play", &tilts[..10], |&tilt| {
        black_box(gpr.tilt_play(tilt, AxisHeight(0.5), &Polar, &with(Solver::Newton))).unwrap();
    });
}

/// The robot with six virtual joints as a mechanism: positions from nominal, and mobility.
fn mechanisms(criterion: &mut Criterion) {
    let mechanism = robot::gpr(robot::polar).with_characteristic_length(1e-3).unwrap();
    let mut nominal = robot::home(&mechanism);
    (0..3).for_each(|k| nominal[4 * k] = 0.5);
    let system = MechanismSystem::new(&mechanism, nominal.clone()).unwrap();
    let solver = PositionSolver::new(&system, &[0, 4, 8]).unwrap();
    let rods = rods(&Gpr::paper().without_limit_checks());
    for relief in [ReliefSolver::Newton, ReliefSolver::LeastNorm] {
        let room = std::cell::RefCell::new((solver.clone(), nominal.clone()));
        over(criterion, &format!("position of a mechanism, {relief:?}"), &rods, |rods| {
            let (solver, position) = &mut *room.borrow_mut();
            position.copy_from(&nominal);
            (0..3).for_each(|k| position[4 * k] = rods[k]);
            black_box(solver.solve(position.as_mut_slice(), relief)).unwrap();
        });
    }
    let rigid = robot::gpr(|_, _| Vec::new());
    let system = MechanismSystem::new(&rigid, nominal.rows(0, 12).into_owned()).unwrap();
    over(
        criterion,
        "finite mobility of an infinitesimally mobile mechanism",
        &[system.at_home()],
        |at| {
            black_box(finite_mobility(&system, at, RANK_THRESHOLD)).unwrap();
        },
    );
}

criterion_group!(benches, kinematics, derivatives, analyses, mechanisms);
criterion_main!(benches);
