//! Programs on all robots with arms of the catalogue.

use std::f64::consts::{PI, TAU};

use jointplay_cell::check::{CheckOptions, ViolationKind, check};
use jointplay_cell::program::{Path, ProgramProblem, expand};
use jointplay_cell::robot::{KinematicLimits, RODS};
use jointplay_cell::station::LineRemedy;
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_format::cell::robot::names;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::program;
use proptest::test_runner::{Config, RngSeed, TestRunner};

use crate::small_cell::{StationPlace, small_cell};

/// Why a program has no trajectory: the first problem of its lines, if it is one of them, and its text.
#[derive(Debug)]
struct Refusal {
    problem: Option<Box<ProgramProblem>>,
    message: String,
}

fn planned(cell: &Cell, text: &str) -> Result<Trajectory, Refusal> {
    let parsed = program::parse(text).unwrap();
    let steps = expand(cell, &parsed).map_err(|errors| Refusal {
        message: program::explain(&cell.robot, text, &errors[0], DisplayUnits::Metric)
            .problem
            .message,
        problem: Some(Box::new(errors[0].problem.clone())),
    })?;
    plan_trajectory(cell, steps, &TrajectoryOptions::default())
        .map_err(|error| Refusal { problem: None, message: error.to_string() })
}

/// A station that is entered along radial lines of any heading.
fn radial(azimuth_deg: f64, distance_mm: f64, retract_mm: f64) -> StationPlace {
    StationPlace { azimuth_deg, distance_mm, retract_mm, oblique_deg: None }
}

fn stations(distance_mm: f64, retract_mm: f64) -> [StationPlace; 3] {
    [135.0, -135.0, 0.0].map(|azimuth_deg| radial(azimuth_deg, distance_mm, retract_mm))
}

const LOT: &str = "
REPEAT 2 AS n
  TRANSFER S0 SLOT n TO S1 SLOT n + 1 WITH A
  TRANSFER S1 SLOT n + 1 TO S2 SLOT n + 20 WITH A
  TRANSFER S2 SLOT n + 20 TO S0 SLOT n WITH A
END
HOME
";

#[test]
fn every_robot_of_the_catalogue_runs_a_lot_without_violating_a_limit() {
    for robot in names() {
        for retract_mm in [10.0, 250.0] {
            let cell = small_cell(robot, &stations(700.0, retract_mm), 1);
            let trajectory =
                planned(&cell, LOT).unwrap_or_else(|error| panic!("{robot}: {error:?}"));
            let report =
                check(&cell, &trajectory, &CheckOptions { rate: 200.0, report_distance: 0.0 });
            assert!(report.violations.is_empty(), "{robot} {retract_mm}: {:?}", report.violations);
        }
    }
}

/// What the collision check assumes of the motion between two samples.
#[test]
fn velocities_and_accelerations_keep_their_limits_at_any_time() {
    for robot in names() {
        for retract_mm in [10.0, 250.0] {
            let cell = small_cell(robot, &stations(700.0, retract_mm), 1);
            let trajectory = planned(&cell, &format!("BLEND 50 mm{LOT}")).unwrap();
            let mut steps = 0..trajectory.steps.len();
            assert!(steps.any(|step| trajectory.blend(step).is_some()), "{robot}");
            let mut largest = [0.0_f64; 2];
            // Multiples of the golden ratio are spread evenly, and are no times of a grid.
            for k in 0..20_000 {
                let share = (f64::from(k) * 0.618_033_988_749_895).fract();
                let at = trajectory.sample_at(share * trajectory.duration());
                for (axis, limits) in cell.robot.axes.iter().enumerate() {
                    let most =
                        |of: fn(&KinematicLimits) -> f64| of(&limits.empty).max(of(&limits.loaded));
                    let velocity = at.velocities[axis].abs() / most(|one| one.velocity);
                    let acceleration = at.accelerations[axis].abs() / most(|one| one.acceleration);
                    largest = [largest[0].max(velocity), largest[1].max(acceleration)];
                }
            }
            assert!(largest.iter().all(|ratio| *ratio < 1.001), "{robot}: {largest:?}");
        }
    }
}

#[test]
fn wafers_of_redundant_arms_move_along_straight_lines_without_jumps() {
    for robot in ["scara-3r", "scara-4r"] {
        let cell = small_cell(robot, &stations(650.0, 10.0), 1);
        let trajectory = planned(&cell, LOT).unwrap();
        let mut lines = 0;
        for (index, step) in trajectory.steps.iter().enumerate() {
            let Path::Line(effector) = step.path else { continue };
            lines += 1;
            let center = |positions: &[f64]| {
                let loaded = step.loaded.contains(&effector);
                cell.wafer_pose(effector, positions, loaded).unwrap().translation.vector
            };
            let (from, to) = (center(&step.from), center(&step.to));
            let along = to - from;
            let duration = trajectory.step_duration(index);
            let mut before = step.from.clone();
            for k in 1..=40 {
                let sample = trajectory.sample_in_step(index, duration * f64::from(k) / 40.0);
                let off = center(&sample.positions) - from;
                let across = off - along * (off.dot(&along) / along.norm_squared());
                assert!(across.norm() < 1e-6, "{robot}, step {index}: {} m", across.norm());
                for (axis, (now, old)) in sample.positions.iter().zip(&before).enumerate() {
                    let most = cell.robot.axes[axis].empty.velocity * duration / 40.0;
                    assert!((now - old).abs() <= most * 1.001 + 1e-12, "{robot}, axis {axis}");
                }
                before.clone_from(&sample.positions);
            }
        }
        assert!(lines > 40, "{lines}");
    }
}

#[test]
fn each_change_that_the_message_of_a_blocked_line_names_makes_the_line_possible() {
    let get = "GET S0 SLOT 1 WITH A";
    for (robot, azimuth_deg) in [("scara-3r", 135.0), ("scara-4r", 0.0)] {
        let free = radial(azimuth_deg, 600.0, 150.0);
        let line = StationPlace { oblique_deg: Some(0.0), ..free };
        let cell = small_cell(robot, &[line], 1);
        let refusal = planned(&cell, get).expect_err(robot);
        let message = &refusal.message;
        let Some(ProgramProblem::InfeasibleLine { blocked, .. }) = refusal.problem.as_deref()
        else {
            panic!("{robot}: {message}")
        };
        assert!(
            (0.0..1.0).contains(&blocked.fraction) && blocked.remedies.len() >= 2,
            "{blocked:?}"
        );
        assert!(message.contains("set approach = \"radial\" of S0"), "{message}");
        for remedy in &blocked.remedies {
            let changed = match *remedy {
                LineRemedy::Retract(reach) => {
                    let retract_mm = (reach * 1e3).round();
                    small_cell(robot, &[StationPlace { retract_mm, ..line }], 1)
                }
                LineRemedy::Radius(reach) => {
                    small_cell(robot, &[StationPlace { distance_mm: reach * 1e3, ..line }], 1)
                }
                LineRemedy::FreeHeading => small_cell(robot, &[free], 1),
                LineRemedy::Limits { axis, min, max } => {
                    let mut changed = cell.clone();
                    let limits = &mut changed.robot.axes[axis];
                    // A station at its own height and droop needs slightly more than the level plane.
                    limits.min = limits.min.min(min - 0.02);
                    limits.max = limits.max.max(max + 0.02);
                    changed
                }
            };
            let done = planned(&changed, get);
            assert!(done.is_ok(), "{robot} {remedy:?}: {:?}", done.map(|_| ()));
        }
    }
}

/// An arm of two links and an effector, as a stranger would search it: directions of the effector on a grid, both elbows, the nearest revolutions.
struct ThreeLinks {
    lengths: [f64; 3],
    limits: [[f64; 2]; 3],
}

impl ThreeLinks {
    fn of(cell: &Cell) -> Self {
        let arm = &cell.robot.arms[0];
        let limits = |axis: usize| [cell.robot.axes[axis].min, cell.robot.axes[axis].max];
        let reach = arm.effectors[0].wafer_center[0];
        Self {
            lengths: [arm.joints[0].length, arm.joints[1].length, reach],
            limits: [limits(RODS), limits(RODS + 1), limits(RODS + 2)],
        }
    }

    /// Positions with the wafer at a point, its effector in a direction, by an elbow.
    fn positions(&self, point: [f64; 2], direction: f64, elbow: f64) -> Vec<[f64; 3]> {
        let [first, second, effector] = self.lengths;
        let (x, y) = (point[0] - effector * direction.cos(), point[1] - effector * direction.sin());
        let cosine = (x * x + y * y - first * first - second * second) / (2.0 * first * second);
        // Two degrees from the stretched and from the folded arm.
        if cosine.abs() > 0.9994 {
            return Vec::new();
        }
        let bend = elbow * cosine.acos();
        let shoulder = y.atan2(x) - (second * bend.sin()).atan2(first + second * bend.cos());
        let wrist = direction - shoulder - bend;
        let within = |axis: usize, angle: f64| {
            let margin = 0.01;
            let [min, max] = self.limits[axis];
            (-2..=2)
                .map(move |k| angle + TAU * f64::from(k))
                .filter(move |q| (min + margin..=max - margin).contains(q))
        };
        let mut found = Vec::new();
        for a in within(0, shoulder) {
            for b in within(1, bend) {
                found.extend(within(2, wrist).map(|c| [a, b, c]));
            }
        }
        found
    }

    /// Whether steps of at most 10 mm and 3° of the effector lead from one radius to another.
    fn reaches(&self, azimuth: f64, from: f64, to: f64) -> bool {
        let samples = ((to - from).abs() / 0.01).ceil() as usize + 1;
        let grid = 240_i64;
        let layer = |k: usize| {
            let radius = from + (to - from) * k as f64 / (samples - 1) as f64;
            let point = [radius * azimuth.cos(), radius * azimuth.sin()];
            let mut found = Vec::new();
            for cell in 0..grid {
                for elbow in [-1.0, 1.0] {
                    let direction = TAU * cell as f64 / grid as f64;
                    for positions in self.positions(point, direction, elbow) {
                        found.push((cell, elbow, positions));
                    }
                }
            }
            found
        };
        let mut front = layer(0);
        for k in 1..samples {
            let mut next = layer(k);
            next.retain(|(cell, elbow, to)| {
                front.iter().any(|(old, other, from)| {
                    let apart = (cell - old).rem_euclid(grid);
                    apart.min(grid - apart) <= 2
                        && elbow == other
                        && (0..3).all(|a| (to[a] - from[a]).abs() < 0.3)
                })
            });
            front = next;
        }
        !front.is_empty()
    }
}

#[test]
fn lines_that_a_grid_search_follows_are_planned_in_random_cells() {
    let mut runner = TestRunner::new(Config { rng_seed: RngSeed::Fixed(1), ..Config::default() });
    let cases = (-PI..PI, 0.35..0.74_f64, 0.01..0.45_f64, 0.6..1.0_f64, 0.5..1.0_f64);
    let (mut possible, mut refused) = (0, Vec::new());
    for _ in 0..120 {
        let tree = proptest::strategy::Strategy::new_tree(&cases, &mut runner).unwrap();
        let (azimuth, distance, retract, shoulder, elbow) =
            proptest::strategy::ValueTree::current(&tree);
        let retract = retract.min(distance - 0.05);
        let place = radial(azimuth.to_degrees(), distance * 1e3, retract * 1e3);
        let mut cell = small_cell("scara-3r", &[place], 1);
        for (axis, share) in [(RODS, shoulder), (RODS + 1, elbow)] {
            let limits = &mut cell.robot.axes[axis];
            (limits.min, limits.max) = (limits.min * share, limits.max * share);
            limits.home = limits.home.clamp(limits.min, limits.max);
        }
        if !ThreeLinks::of(&cell).reaches(azimuth, retract, distance) {
            continue;
        }
        possible += 1;
        if let Err(refusal) = planned(&cell, "GET S0 SLOT 1 WITH A") {
            refused.push((azimuth, distance, retract, refusal.message));
        }
    }
    assert!(possible > 60, "{possible}");
    assert!(100 * refused.len() <= possible, "of {possible}: {refused:?}");
}

#[test]
fn arms_that_fold_beyond_their_axis_extend_on_the_side_of_the_station() {
    for robot in ["dual-arm", "radial-arm"] {
        for length in [0.235, 0.245, 0.25] {
            let mut cell = small_cell(robot, &stations(700.0, 10.0), 1);
            let joints = cell.robot.arms.iter_mut().flat_map(|arm| &mut arm.joints);
            joints.filter(|joint| joint.length > 0.2).for_each(|joint| joint.length = length);
            // At home, the wafer is beyond the axis.
            let trajectory =
                planned(&cell, LOT).unwrap_or_else(|error| panic!("{robot} {length}: {error:?}"));
            let report =
                check(&cell, &trajectory, &CheckOptions { rate: 200.0, report_distance: 0.0 });
            assert!(report.violations.is_empty(), "{robot} {length}: {:?}", report.violations);
        }
    }
}

#[test]
fn segments_are_slowed_until_the_wafer_stays() {
    let mut cell = small_cell("dual-arm", &stations(650.0, 10.0), 1);
    let fast = planned(&cell, LOT).unwrap().duration();
    for friction in [0.2, 0.05, 0.01] {
        for arm in &mut cell.robot.arms {
            arm.effectors.iter_mut().for_each(|effector| effector.friction = friction);
        }
        let trajectory = planned(&cell, LOT).unwrap();
        let report = check(&cell, &trajectory, &CheckOptions::default());
        assert!(report.violations.is_empty(), "{friction}: {:?}", report.violations.first());
        let shares = report.by_instruction.iter().filter_map(|row| row.slip).map(|it| it.ratio);
        let most = shares.fold(0.0, f64::max);
        // No slower than needed.
        assert!((0.97..=1.0).contains(&most), "{friction}: {most}");
        assert!(trajectory.duration() > fast, "{friction}");
    }
    // No speed keeps a wafer on a slope beyond its angle of friction.
    for arm in &mut cell.robot.arms {
        arm.effectors.iter_mut().for_each(|effector| effector.friction = 1e-5);
    }
    let trajectory = planned(&cell, LOT).unwrap();
    let report = check(&cell, &trajectory, &CheckOptions::default());
    assert!(report.violations.iter().any(|one| one.kind == ViolationKind::Slip));
}
