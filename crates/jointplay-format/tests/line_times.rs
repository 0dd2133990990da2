//! Durations of straight lines: close to optima found by other methods, and continuous in the position of a station.

use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::program::{Path, expand};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::Droop;
use jointplay_cell::workcell::Cell;
use jointplay_format::{cell, program};

/// Durations of the straight lines of a program, strokes excluded (s).
fn line_durations(cell: &Cell, text: &str) -> Vec<f64> {
    let steps = expand(cell, &program::parse(text).unwrap()).unwrap();
    let trajectory = plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap();
    let lines = trajectory.steps.iter().enumerate();
    let lines =
        lines.filter(|(_, step)| matches!(step.path, Path::Line(_)) && step.line_speed.is_none());
    lines.map(|(index, _)| trajectory.intrinsic_step_duration(index)).collect()
}

/// The example cell with LP1 moved outward and sideways (m).
fn example_with_moved_port(outward: f64, sideways: f64) -> Cell {
    let mut cell = cell::read(cell::EXAMPLE, &mut |_| Err(String::new())).unwrap();
    let station = cell.stations.iter_mut().find(|station| station.name == "LP1").unwrap();
    let share = std::f64::consts::FRAC_1_SQRT_2;
    let place = &mut station.base_from_station.translation.vector;
    place.x += share * (-outward - sideways);
    place.y += share * (outward - sideways);
    cell
}

const GET_AND_PUT: &str = "GET LP1 SLOT 3 WITH A\nPUT LP2 SLOT 4 WITH A\n";

/// Largest deviation of a value from the mean of its neighbours, relative to the value.
fn largest_spike(durations: &[f64]) -> f64 {
    let deviation = |three: &[f64]| (three[1] - 0.5 * (three[0] + three[2])).abs() / three[1];
    durations.windows(3).map(deviation).fold(0.0, f64::max)
}

#[test]
fn durations_of_lines_are_continuous_in_the_position_of_a_station() {
    for (outward, sideways) in [(1e-3, 0.0), (0.0, 1e-3)] {
        for is_rigid in [false, true] {
            let durations: Vec<Vec<f64>> = (-20..=20)
                .map(|k| {
                    let k = f64::from(k);
                    let mut cell = example_with_moved_port(k * outward, k * sideways);
                    if is_rigid {
                        cell.robot.arms.iter_mut().for_each(|arm| arm.droop = Droop::Rigid);
                    }
                    line_durations(&cell, GET_AND_PUT)
                })
                .collect();
            for line in 0..durations[0].len() {
                let of_line: Vec<f64> = durations.iter().map(|all| all[line]).collect();
                let spike = largest_spike(&of_line);

                assert!(spike < 0.01, "line {line}: {of_line:?}");
            }
        }
    }
}

/// A search that started at the accuracy at which it was to end made no iteration, or some, by round-off: lines took up to 0.7 % longer by chance.
#[test]
fn durations_of_lines_do_not_depend_on_round_off() {
    for outward in [-20e-3, 0.0] {
        let cell = example_with_moved_port(outward, 0.0);
        let steps = expand(&cell, &program::parse(GET_AND_PUT).unwrap()).unwrap();
        let durations = |noise: f64| {
            let mut steps = steps.clone();
            for k in 0..steps.len() {
                for (axis, to) in steps[k].to.iter_mut().enumerate() {
                    *to += noise * (1.3 * (7 * k + axis) as f64).sin();
                }
                if k + 1 < steps.len() {
                    steps[k + 1].from = steps[k].to.clone();
                }
            }
            let options = TrajectoryOptions::default();
            let trajectory = plan_trajectory(&cell, steps, &options).unwrap();
            let lines = (0..trajectory.steps.len()).filter(|&k| {
                let step = &trajectory.steps[k];
                matches!(step.path, Path::Line(_)) && step.line_speed.is_none()
            });
            lines.map(|k| trajectory.intrinsic_step_duration(k)).collect::<Vec<f64>>()
        };
        let exact = durations(0.0);
        for noise in [1e-14, -3e-13, 1e-12, -2e-11, 1e-10, 1e-9] {
            for (found, exact) in durations(noise).iter().zip(&exact) {
                assert!((found / exact - 1.0).abs() < 1e-5, "{outward} {noise}: {found} {exact}");
            }
        }
    }
}

#[test]
fn a_rigid_arm_is_no_slower_than_a_drooping_one() {
    for outward in [-20e-3, -12e-3, -10e-3, -5e-3, 0.0, 20e-3] {
        let drooping = example_with_moved_port(outward, 0.0);
        let mut rigid = drooping.clone();
        rigid.robot.arms.iter_mut().for_each(|arm| arm.droop = Droop::Rigid);
        let [drooping, rigid] = [drooping, rigid].map(|cell| line_durations(&cell, GET_AND_PUT));
        for (rigid, drooping) in rigid.iter().zip(&drooping) {
            assert!(*rigid < 1.005 * drooping, "{outward}: {rigid} {drooping}");
        }
    }
}

/// Optimal durations of the lines of one robot: at the jerk limits of its file, and without jerk limits (s).
struct Optima {
    robot: &'static str,
    is_rigid: bool,
    with_jerk: [f64; 4],
    without_jerk: [f64; 4],
    /// Of the two loaded lines, between level stations and on a friction of 0.12.
    with_friction: [f64; 2],
}

/// Optima of the lines of `bench/lines/`: GET extend and retract, PUT extend and retract.
///
/// # Source
/// `bench/trajectories.py`, with `IPOPT` of `CasADi` 3.8.2 (direct transcription in 120 intervals) and `toppra` 0.6.10
const OPTIMA: [Optima; 4] = [
    Optima {
        robot: include_str!("../robots/dual-arm.toml"),
        is_rigid: false,
        with_jerk: [0.6841, 1.1375, 0.9654, 0.6051],
        without_jerk: [0.5811, 1.0373, 0.8651, 0.4950],
        with_friction: [1.5929, 1.4137],
    },
    Optima {
        robot: include_str!("../robots/dual-arm.toml"),
        is_rigid: true,
        with_jerk: [0.6840, 1.1374, 0.9652, 0.6050],
        without_jerk: [0.5810, 1.0370, 0.8650, 0.4950],
        with_friction: [1.5928, 1.4137],
    },
    Optima {
        robot: include_str!("../robots/radial-arm.toml"),
        is_rigid: false,
        with_jerk: [0.6843, 1.1378, 0.9652, 0.6051],
        without_jerk: [0.5813, 1.0376, 0.8651, 0.4950],
        with_friction: [1.5929, 1.4137],
    },
    Optima {
        robot: include_str!("../robots/scara-3r.toml"),
        is_rigid: false,
        with_jerk: [0.7487, 1.0876, 0.9166, 0.6387],
        without_jerk: [0.6351, 0.9809, 0.8040, 0.5172],
        with_friction: [1.8564, 1.5509],
    },
];

/// The cell of a text with a robot.
fn cell_of(text: &str, robot: &str) -> Cell {
    cell::read(text, &mut |_| Ok(robot.to_owned().into())).unwrap()
}

#[test]
fn durations_of_lines_exceed_those_of_other_methods_by_at_most_three_percent() {
    let text = include_str!("../../../bench/lines/lines.toml");
    let program = include_str!("../../../bench/lines/lines.program");
    for optima in &OPTIMA {
        let mut cell = cell_of(text, optima.robot);
        for arm in &mut cell.robot.arms {
            arm.effectors.iter_mut().for_each(|effector| effector.friction = 10.0);
            if optima.is_rigid {
                arm.droop = Droop::Rigid;
            }
        }
        let with_jerk = line_durations(&cell, program);
        for axis in &mut cell.robot.axes {
            axis.empty.jerk *= 100.0;
            axis.loaded.jerk *= 100.0;
        }
        let without_jerk = line_durations(&cell, program);
        let comparisons =
            [(with_jerk, optima.with_jerk, 0.03), (without_jerk, optima.without_jerk, 0.01)];
        for (found, optimum, allowed) in comparisons {
            for (found, optimum) in found.iter().zip(optimum) {
                let excess = found / optimum - 1.0;
                assert!(
                    (-5e-3..allowed).contains(&excess),
                    "{}: {found} {optimum}",
                    cell.robot.name
                );
            }
        }
    }
}

#[test]
fn loaded_lines_on_little_friction_exceed_those_of_another_method_by_at_most_three_percent() {
    let text = include_str!("../../../bench/lines/lines.toml");
    let is_level = |line: &&str| !line.starts_with("tilt");
    let level: String = text.lines().filter(is_level).map(|line| format!("{line}\n")).collect();
    let program = include_str!("../../../bench/lines/lines.program");
    for optima in &OPTIMA {
        let mut cell = cell_of(&level, optima.robot);
        for arm in &mut cell.robot.arms {
            arm.effectors.iter_mut().for_each(|effector| effector.friction = 0.12);
            if optima.is_rigid {
                arm.droop = Droop::Rigid;
            }
        }

        let durations = line_durations(&cell, program);

        for (found, optimum) in durations[1..3].iter().zip(optima.with_friction) {
            let excess = found / optimum - 1.0;
            assert!((-5e-3..0.03).contains(&excess), "{}: {found} {optimum}", cell.robot.name);
        }
    }
}

/// Round-off moved the arm's first axis by 10⁻¹⁵ rad along radial lines, which counted as motion.
#[test]
fn an_axis_that_stays_within_the_accuracy_of_a_line_is_at_rest() {
    let mut at_rest = 0;
    for sideways in [0.0, 0.3e-3, 0.7e-3] {
        let cell = example_with_moved_port(0.0, sideways);
        let steps = expand(&cell, &program::parse(GET_AND_PUT).unwrap()).unwrap();
        let trajectory = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
        for (index, step) in trajectory.steps.iter().enumerate() {
            if !matches!(step.path, Path::Line(_)) || step.from == step.to {
                continue;
            }
            let duration = trajectory.intrinsic_step_duration(index);
            let moving = trajectory.moving_axes(index);
            for axis in (0..step.from.len()).filter(|&axis| step.from[axis] == step.to[axis]) {
                let moved = (0..=100)
                    .map(|k| trajectory.sample_in_step(index, duration * f64::from(k) / 100.0))
                    .map(|sample| (sample.positions[axis] - step.from[axis]).abs())
                    .fold(0.0, f64::max);
                assert_eq!(moved > 1e-12, moving.contains(&axis), "{index} {axis}: {moved:e}");
                at_rest += usize::from(moved == 0.0);
            }
        }
    }
    assert!(at_rest > 20, "{at_rest}");
}

/// With blends, an axis counted as moving for the whole of a step in which a blended neighbour moves it for a moment.
#[test]
fn the_time_in_motion_is_that_of_the_samples_with_a_velocity() {
    let cell = example_with_moved_port(0.0, 0.0);
    for blend in ["", "BLEND 8 mm\n", "BLEND 30 mm\n"] {
        let text = format!("{blend}GET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nGET ALIGN WITH B\n");
        let steps = expand(&cell, &program::parse(&text).unwrap()).unwrap();
        let trajectory = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
        let report = check(&cell, &trajectory, &CheckOptions::default());
        let rate = 1000.0;
        let mut seconds = vec![0.0; report.moving_time.len()];
        for sample in trajectory.samples(rate) {
            for (time, velocity) in seconds.iter_mut().zip(&sample.velocities) {
                *time += if *velocity == 0.0 { 0.0 } else { 1.0 / rate };
            }
        }
        for (axis, (reported, sampled)) in report.moving_time.iter().zip(&seconds).enumerate() {
            let difference = (reported - sampled).abs();
            assert!(difference < 0.02 + 0.005 * sampled, "{blend}{axis}: {reported} {sampled}");
        }
    }
}
