//! Postures of redundant arms between the stations of a program.

use std::f64::consts::TAU;

use jointplay_cell::program::{Phase, Step, expand};
use jointplay_cell::robot::{EffectorId, RODS};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::program;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngSeed, TestRunner};

use crate::small_cell::{StationPlace, small_cell};

const A: EffectorId = EffectorId { arm: 0, effector: 0 };

/// Largest radius beyond that of both ends of a move; see the page on arms (m).
const ALLOWANCE: f64 = 0.025;

/// Transfers of one wafer through all stations and back to the first.
fn round(count: usize) -> String {
    let transfers =
        (0..count).map(|k| format!("TRANSFER S{k} SLOT 1 TO S{} SLOT 1 WITH A\n", (k + 1) % count));
    transfers.collect::<String>() + "HOME\n"
}

fn steps(cell: &Cell, text: &str) -> Option<Vec<Step>> {
    expand(cell, &program::parse(text).unwrap()).ok()
}

/// Distance of the wafer's centre from the robot's axis (m).
fn radius(cell: &Cell, positions: &[f64]) -> f64 {
    cell.robot.effector_pose(positions, A).unwrap().translation.vector.xy().norm()
}

/// Random cells of two to four stations.
fn for_random_cells(cases: usize, oblique: bool, mut each: impl FnMut(&[StationPlace])) {
    let mut runner = TestRunner::new(Config { rng_seed: RngSeed::Fixed(1), ..Config::default() });
    let obliquity = if oblique {
        (-25.0..25.0_f64).prop_map(Some).boxed()
    } else {
        proptest::strategy::Just(None).boxed()
    };
    let station = (-180.0..180.0_f64, 450.0..720.0_f64, 5.0..300.0_f64, obliquity).prop_map(
        |(azimuth_deg, distance_mm, retract_mm, oblique_deg)| StationPlace {
            azimuth_deg,
            distance_mm,
            retract_mm,
            oblique_deg,
        },
    );
    let stations = proptest::collection::vec(station, 2..=4);
    for _ in 0..cases {
        each(&stations.new_tree(&mut runner).unwrap().current());
    }
}

#[test]
fn wafers_between_stations_stay_within_the_larger_radius_of_both_ends() {
    // A change of posture in which the wrist unwinds takes the hand outward: the links folded as far as their limits admit, and the hand.
    // 3R: |225 + 225 e^{i 155°}| + 300; 4R: |160 (1 + e^{i 150°})| is shorter than the third link, which points back: 160 − 82.8 + 290.
    for (robot, folded) in [("scara-3r", 0.3974), ("scara-4r", 0.3672)] {
        for oblique in [false, true] {
            let (mut planned, mut moves, mut changes) = (0, 0, 0);
            for_random_cells(if oblique { 30 } else { 8 }, oblique, |stations| {
                let cell = small_cell(robot, stations, 1);
                let Some(steps) = steps(&cell, &round(stations.len())) else { return };
                planned += 1;
                let trajectory =
                    plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
                let numbered: Vec<_> = trajectory.steps.iter().enumerate().collect();
                for same in numbered.chunk_by(|(_, one), (_, other)| one.phase == other.phase) {
                    let [(_, first), .., (_, last)] = &[same, same].concat()[..] else { continue };
                    let mut bound = radius(&cell, &first.from).max(radius(&cell, &last.to));
                    match first.phase {
                        Phase::PostureChange => {
                            changes += 1;
                            bound = bound.max(folded);
                        }
                        Phase::Turn | Phase::Move => moves += 1,
                        _ => continue,
                    }
                    for &(index, _) in same {
                        let duration = trajectory.step_duration(index);
                        for k in 1..60 {
                            let time = duration * f64::from(k) / 60.0;
                            let sample = trajectory.sample_in_step(index, time);
                            let excess = radius(&cell, &sample.positions) - bound;
                            assert!(excess < ALLOWANCE, "{robot}, {stations:?}: {excess} {same:?}");
                        }
                    }
                }
            });
            assert!(planned >= 5 && moves >= 20, "{robot}: {planned} cells, {moves} moves");
            // Radial lines of free heading can be driven from the elbow side at home; prescribed headings force changes.
            assert_eq!(changes > 0, oblique, "{robot}: {changes}");
        }
    }
}

/// Positions of the arm in front of each station, by elbow side: where the line can be driven from that side, with the first joint in all revolutions within limits.
fn starts_by_elbow(stations: &[StationPlace]) -> Vec<[Vec<Vec<f64>>; 2]> {
    let cell = small_cell("scara-3r", stations, stations.len());
    let sided = [1.0, -1.0].map(|side| {
        let mut cell = cell.clone();
        // The robot, or its mirrored posture, at home, and no elbow beyond the stretched arm.
        for axis in &mut cell.robot.axes[RODS..] {
            axis.home *= side;
        }
        let elbow = &mut cell.robot.axes[RODS + 1];
        if side > 0.0 {
            elbow.max = 0.0
        } else {
            elbow.min = 0.0
        }
        cell
    });
    let starts = |station: usize| {
        sided.each_ref().map(|cell| {
            let program = format!("GET S{station} SLOT 1 WITH A\n");
            let Some(steps) = steps(cell, &program) else { return Vec::new() };
            let shoulder = |step: &Step| step.to[RODS];
            let in_station = || steps.iter().filter(|step| step.slot.is_some()).map(shoulder);
            let limits = &cell.robot.axes[RODS];
            let is_possible = |turn: &f64| {
                in_station().all(|at| (limits.min..=limits.max).contains(&(at + turn)))
            };
            let entering = steps.iter().find(|step| step.slot.is_some()).unwrap();
            let turned = |turn| {
                let mut start = entering.from[RODS..].to_vec();
                start[0] += turn;
                start
            };
            [-TAU, 0.0, TAU].into_iter().filter(is_possible).map(turned).collect()
        })
    };
    (0..stations.len()).map(starts).collect()
}

/// Least time of turns through one of several positions for each visit.
fn least_time<'s>(
    home: &[f64],
    visits: impl Iterator<Item = Vec<&'s Vec<f64>>>,
    time: impl Fn(&[f64], &[f64]) -> f64,
) -> f64 {
    let mut front = vec![(home.to_vec(), 0.0)];
    for starts in visits {
        let times = |to: &Vec<f64>| {
            front.iter().map(|(from, sum)| sum + time(from, to)).fold(f64::INFINITY, f64::min)
        };
        front = starts.into_iter().map(|to| (to.clone(), times(to))).collect();
    }
    front.iter().map(|(_, sum)| *sum).fold(f64::INFINITY, f64::min)
}

#[test]
fn turns_take_little_longer_than_those_of_the_best_sequence_of_postures() {
    let (mut same_elbow, mut any_elbow) = (Vec::new(), Vec::new());
    for_random_cells(40, false, |stations| {
        let cell = small_cell("scara-3r", stations, 1);
        let axes = &cell.robot.axes[RODS..];
        let time = |from: &[f64], to: &[f64]| {
            let each = axes.iter().zip(from.iter().zip(to));
            each.map(|(axis, (from, to))| (to - from).abs() / axis.loaded.velocity)
                .fold(0.0, f64::max)
        };
        let count = stations.len();
        let Some(steps) = steps(&cell, &round(count).replace("HOME", "")) else { return };
        let turns =
            steps.iter().filter(|step| matches!(step.phase, Phase::Turn | Phase::PostureChange));
        let taken: f64 = turns.map(|step| time(&step.from[RODS..], &step.to[RODS..])).sum();
        let home: Vec<f64> = axes.iter().map(|axis| axis.home).collect();
        let starts = starts_by_elbow(stations);
        let visits = || (0..count).flat_map(|k| [k, (k + 1) % count]);
        let same = visits().map(|station| starts[station][0].iter().collect());
        same_elbow.push(taken / least_time(&home, same, time));
        // A change of elbow without regard to the radius of the wafer.
        let any = visits().map(|station| starts[station].iter().flatten().collect());
        any_elbow.push(taken / least_time(&home, any, time));
    });
    // The first posture is a compromise with the line: turns are shorter, or longer, by as much.
    assert!(same_elbow.iter().all(|ratio| (0.9..1.03).contains(ratio)), "{same_elbow:?}");
    let mean = any_elbow.iter().sum::<f64>() / any_elbow.len() as f64;
    assert!(any_elbow.len() > 30 && mean < 1.2, "{mean}: {any_elbow:?}");
}

#[test]
fn incremental_plans_with_changes_of_posture_equal_new_plans() {
    // Two ports next to each other, entered straight on: each can be driven from one elbow side only.
    let port = |azimuth_deg: f64, oblique_deg| StationPlace {
        azimuth_deg,
        distance_mm: 643.0,
        retract_mm: 240.0,
        oblique_deg: Some(oblique_deg),
    };
    let stations = |azimuth_deg| [port(azimuth_deg, 15.0), port(-165.0, -15.0)];
    let text = "REPEAT 3 AS n\nTRANSFER S0 SLOT n TO S1 SLOT n WITH A\nEND\n";
    let program = program::parse(text).unwrap();
    let plan = |planner: &mut IncrementalPlanner, azimuth_deg: f64| {
        let cell = small_cell("scara-3r", &stations(azimuth_deg), 1);
        planner.plan(&cell, &program, &PlanOptions::default()).unwrap().0
    };
    let mut planner = IncrementalPlanner::default();
    for azimuth_deg in [165.0, 164.0, 165.0] {
        let found = plan(&mut planner, azimuth_deg);
        assert!(found.steps.iter().any(|step| step.phase == Phase::PostureChange));
        let expected = plan(&mut IncrementalPlanner::default(), azimuth_deg);
        assert_eq!(found.steps, expected.steps);
        assert!(found.duration().to_bits() == expected.duration().to_bits());
    }
}

#[test]
fn relative_lines_end_near_their_start() {
    let place = StationPlace {
        azimuth_deg: 90.0,
        distance_mm: 600.0,
        retract_mm: 100.0,
        oblique_deg: None,
    };
    let cell = small_cell("scara-4r", &[place], 1);
    let start = "MOVE J1 60 deg J2 -30 deg J3 -30 deg J4 120 deg\n";
    for (line, most) in [("Z 1 mm", 1e-3), ("X 1 mm", 0.02), ("Y -1 mm", 0.02)] {
        let steps = steps(&cell, &format!("{start}MOVE LINE BY {line}\n")).unwrap();
        let step = steps.last().unwrap();
        for (from, to) in step.from.iter().zip(&step.to).skip(RODS) {
            assert!((to - from).abs() < most, "{line}: {:?} {:?}", step.from, step.to);
        }
        let displacement = cell.robot.effector_pose(&step.to, A).unwrap().translation.vector
            - cell.robot.effector_pose(&step.from, A).unwrap().translation.vector;
        assert!((displacement.norm() - 1e-3).abs() < 1e-6, "{line}: {displacement:?}");
    }
}
