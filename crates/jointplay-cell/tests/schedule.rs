//! Schedules of small tools, compared with their closed forms, and rules for wafers.

use crate::common;

use jointplay_cell::CellError;
use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, Violation, ViolationKind, check};
use jointplay_cell::optimise::{
    Candidate, Evaluation, Objectives, OptimiseOptions, Search, TimingModel, WaferFlow,
};
use jointplay_cell::program::{Handoff, Path, Program, SourceLocation, Step};
use jointplay_cell::robot::{Effector, EffectorId};
use jointplay_cell::schedule::{Resource, Schedule, schedule};
use jointplay_cell::station::{DwellLimits, SlotId, Station, Stroke, VisitRule, WaferRules};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;
use nalgebra::Translation3;
use proptest::prelude::*;

const A: EffectorId = EffectorId { arm: 0, effector: 0 };
/// A second effector, which only schedules know.
const B: EffectorId = EffectorId { arm: 0, effector: 1 };
/// Turns of the axis T whose times represent unloading, loading and moving (rad).
const UNLOAD: f64 = 0.2;
const LOAD: f64 = 0.35;
const MOVE: f64 = 0.5;
const LOAD_LOCK: usize = 0;

/// A load lock with many slots, and chambers with one slot.
fn tool(processes: &[f64], wafers: usize) -> Cell {
    let mut cell = common::cell(common::kind(0, [0.25, 0.22, 0.2]));
    let station = |index: usize, slots: usize, process_time: f64| {
        let place = Translation3::new(2.0 + index as f64, 0.0, 0.3);
        let base_from_station = Pose::from_parts(place, nalgebra::Rotation3::identity());
        Station {
            slots,
            pitch: 0.01,
            stroke: Stroke { below: 0.002, above: 0.002, speed: 0.01 },
            retract_reach: 0.2,
            process_time,
            ..common::station(&format!("S{index}"), base_from_station)
        }
    };
    cell.stations.push(station(LOAD_LOCK, wafers, 0.0));
    for (index, &process) in processes.iter().enumerate() {
        cell.stations.push(station(index + 1, 1, process));
    }
    cell.loaded_effectors.clear();
    cell.occupied = (1..=wafers).map(|slot| SlotId { station: LOAD_LOCK, slot }).collect();
    cell
}

/// Steps of a program, one after the other.
struct Steps<'c> {
    cell: &'c Cell,
    steps: Vec<Step>,
    /// Step at whose end each station got its wafer.
    placed: Vec<Option<usize>>,
    line: usize,
}

impl<'c> Steps<'c> {
    fn new(cell: &'c Cell) -> Self {
        Self { cell, steps: Vec::new(), placed: vec![None; cell.stations.len()], line: 1 }
    }

    fn push(&mut self, path: Path, to: Vec<f64>, handoff: Option<Handoff>) {
        let from = self.steps.last().map_or_else(home, |step| step.to.clone());
        self.steps.push(Step {
            place: SourceLocation { line: self.line, column: 1 },
            path,
            loaded: Vec::new(),
            handoff,
            ..common::step(self.line - 1, &from, &to)
        });
    }

    /// Turns T by an angle, there or back.
    fn turn(&mut self, angle: f64, handoff: Option<Handoff>) {
        let mut to = self.steps.last().map_or_else(home, |step| step.to.clone());
        to[3] += if to[3] > 0.0 { -angle } else { angle };
        self.push(Path::PointToPoint, to, handoff);
    }

    fn go(&mut self) {
        self.turn(MOVE, None);
    }

    fn wait(&mut self, seconds: f64) {
        let to = self.steps.last().map_or_else(home, |step| step.to.clone());
        self.push(Path::Dwell(seconds), to, None);
    }

    fn pick(&mut self, effector: EffectorId, station: usize, slot: usize) {
        if let Some(placed_at_step) = self.placed[station].take() {
            let seconds = self.cell.stations[station].process_time;
            let to = self.steps.last().map_or_else(home, |step| step.to.clone());
            if seconds > 0.0 {
                self.push(Path::ProcessDwell { placed_at_step, seconds }, to, None);
            }
        }
        self.turn(UNLOAD, Some(Handoff::Picked(effector, SlotId { station, slot })));
        self.mark_in_station(station, slot);
    }

    fn place(&mut self, effector: EffectorId, station: usize, slot: usize) {
        self.turn(LOAD, Some(Handoff::Placed(effector, SlotId { station, slot })));
        self.mark_in_station(station, slot);
        if station != LOAD_LOCK {
            self.placed[station] = Some(self.steps.len() - 1);
        }
    }

    fn mark_in_station(&mut self, station: usize, slot: usize) {
        if let Some(last) = self.steps.last_mut() {
            last.slot = Some(SlotId { station, slot });
        }
    }

    fn trajectory(&self) -> Trajectory {
        plan_trajectory(self.cell, self.steps.clone(), &TrajectoryOptions::default()).unwrap()
    }
}

fn home() -> Vec<f64> {
    vec![0.5, 0.5, 0.5, 0.0, 0.9]
}

/// Times of unloading, loading and moving (s).
fn durations(cell: &Cell) -> [f64; 3] {
    [UNLOAD, LOAD, MOVE].map(|angle| {
        let mut steps = Steps::new(cell);
        steps.turn(angle, None);
        steps.trajectory().duration()
    })
}

/// A single arm in backward sequence: it empties the last chamber first, then moves each wafer to the next chamber.
fn single_arm(cell: &Cell, wafers: usize) -> Trajectory {
    let chambers = cell.stations.len() - 1;
    let mut steps = Steps::new(cell);
    for cycle in 1..=wafers + chambers {
        for chamber in (0..=chambers).rev() {
            // Wafer of this cycle that leaves the chamber; chamber 0 is the load lock.
            let Some(wafer) = (cycle).checked_sub(chamber).filter(|n| (1..=wafers).contains(n))
            else {
                continue;
            };
            let next = if chamber == chambers { LOAD_LOCK } else { chamber + 1 };
            let slot = |station| if station == LOAD_LOCK { wafer } else { 1 };
            steps.go();
            steps.pick(A, chamber, slot(chamber));
            steps.go();
            steps.place(A, next, slot(next));
        }
    }
    steps.trajectory()
}

/// A dual arm that swaps at each chamber and at the load lock, from the first wafer to the last.
fn dual_arm(cell: &Cell, wafers: usize) -> Trajectory {
    let chambers = cell.stations.len() - 1;
    let mut steps = Steps::new(cell);
    let is_wafer = |wafer: &usize| (1..=wafers).contains(wafer);
    steps.go();
    for cycle in 1..=wafers + chambers {
        let (mut full, mut empty) = (A, B);
        if is_wafer(&cycle) {
            steps.pick(full, LOAD_LOCK, cycle);
        }
        for chamber in 1..=chambers {
            let before = cycle.checked_sub(chamber).filter(is_wafer);
            let enters = (cycle + 1).checked_sub(chamber).filter(is_wafer);
            if before.is_none() && enters.is_none() {
                continue;
            }
            steps.go();
            if before.is_some() {
                steps.pick(empty, chamber, 1);
            }
            if enters.is_some() {
                steps.place(full, chamber, 1);
            }
            (full, empty) = (empty, full);
        }
        steps.go();
        if let Some(wafer) = cycle.checked_sub(chambers).filter(is_wafer) {
            steps.place(full, LOAD_LOCK, wafer);
        }
    }
    steps.trajectory()
}

fn steady_period(cell: &Cell, trajectory: &Trajectory) -> (Schedule, f64) {
    let found = schedule(cell, trajectory);
    let part = found.steady_state().unwrap();
    assert_eq!(part.wafers, 1);
    let period = part.period;
    (found, period)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Fundamental period of a single arm, [Perkinson] with separate times of unloading u, loading l and moving v, as in [Lee]:
    ///
    /// max { (n + 1) (u + l + 2 v),  max p + 2 u + 2 l + 3 v }
    #[test]
    fn the_period_of_a_single_arm_is_that_of_perkinson(processes in prop::collection::vec(0.0..30.0, 1..3)) {
        let cell = tool(&processes, 16);
        let [unload, load, move_] = durations(&cell);
        let chambers = processes.len() as f64;
        let robot = (chambers + 1.0) * (unload + load + 2.0 * move_);
        let longest = processes.iter().copied().fold(0.0, f64::max);
        let process = longest + 2.0 * (unload + load) + 3.0 * move_;
        let trajectory = single_arm(&cell, 16);
        let (found, period) = steady_period(&cell, &trajectory);
        prop_assert!((period - robot.max(process)).abs() < 1e-9, "{period} {robot} {process}");
        // In the steady state the robot waits in the process-bound region only; for the first and the last wafer, each alone, also where a process takes longer than a move.
        let waits = found.robot.waiting() > 1e-9;
        prop_assert_eq!(waits, longest > move_);
    }

    /// Fundamental period of a dual arm that swaps, [Venkatesh], with the swap s = u + l:
    ///
    /// max { (n + 1) (s + v),  max p + s }
    #[test]
    fn the_period_of_a_dual_arm_is_that_of_venkatesh(processes in prop::collection::vec(0.0..20.0, 1..3)) {
        let cell = tool(&processes, 16);
        let [unload, load, move_] = durations(&cell);
        let swap = unload + load;
        let chambers = processes.len() as f64;
        let robot = (chambers + 1.0) * (swap + move_);
        let process = processes.iter().copied().fold(0.0, f64::max) + swap;
        let trajectory = dual_arm(&cell, 16);
        let (_, period) = steady_period(&cell, &trajectory);
        prop_assert!((period - robot.max(process)).abs() < 1e-9, "{period} {robot} {process}");
    }
}

#[test]
fn the_critical_path_adds_up_and_names_the_bottleneck() {
    for (process, bottleneck) in [(0.5, Resource::Robot), (60.0, Resource::Station(1))] {
        let cell = tool(&[process], 12);
        let trajectory = single_arm(&cell, 12);
        let found = schedule(&cell, &trajectory);
        let path = &found.critical_path;
        assert!((path.duration() - trajectory.duration()).abs() < 1e-9);
        assert_eq!(path.bottleneck(), Some(bottleneck));
        let part = found.steady_state().unwrap();
        assert!((part.critical_path.duration() - (part.end - part.start)).abs() < 1e-9);
        assert_eq!(part.critical_path.bottleneck(), Some(bottleneck));
        // A process on the path is there for its whole time, once for each wafer.
        let on_path = path.times.iter().find(|(one, _)| *one == Resource::Station(1));
        let expected = if process > 1.0 { Some(12.0 * process) } else { None };
        assert_eq!(on_path.map(|(_, time)| (time * 1e6).round() * 1e-6), expected);
        let station = &found.stations[1];
        assert_eq!(station.visits, 12);
        assert!(
            (station.processing - 12.0 * process.min(station.longest_dwell.unwrap())).abs() < 1e-6
        );
        let all = found.robot.moving + found.robot.waiting();
        assert!((all - trajectory.duration()).abs() < 1e-9);
    }
}

#[test]
fn stays_of_a_wafer_follow_each_other_without_gaps() {
    let cell = tool(&[3.0, 5.0], 5);
    let trajectory = single_arm(&cell, 5);
    let found = schedule(&cell, &trajectory);
    for stays in found.stays.chunk_by(|one, next| one.wafer == next.wafer) {
        assert_eq!(stays.len(), 7, "load lock, arm, chamber, arm, chamber, arm, load lock");
        assert_eq!((stays[0].start, stays[6].end), (0.0, trajectory.duration()));
        for pair in stays.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
        }
    }
}

#[test]
fn a_program_without_repetition_has_no_steady_state() {
    let cell = tool(&[3.0], 2);
    assert_eq!(schedule(&cell, &single_arm(&cell, 2)).steady_state(), None);
}

/// Each wafer through all chambers before the next.
fn one_by_one(cell: &Cell, wafers: usize) -> Trajectory {
    let mut order = Vec::new();
    for wafer in 1..=wafers {
        for station in 0..cell.stations.len() {
            let slot = |station| {
                let slot = if station == LOAD_LOCK { wafer } else { 1 };
                SlotId { station, slot }
            };
            order.push(Handoff::Picked(A, slot(station)));
            order.push(Handoff::Placed(A, slot((station + 1) % cell.stations.len())));
        }
    }
    executed(cell, &order)
}

/// Hand-offs in an order, with a move where the station changes.
fn executed(cell: &Cell, order: &[Handoff]) -> Trajectory {
    let mut steps = Steps::new(cell);
    let mut at = None;
    for &handoff in order {
        let (Handoff::Picked(effector, slot) | Handoff::Placed(effector, slot)) = handoff;
        if at != Some(slot.station) {
            steps.go();
        }
        at = Some(slot.station);
        match handoff {
            Handoff::Picked(..) => steps.pick(effector, slot.station, slot.slot),
            Handoff::Placed(..) => steps.place(effector, slot.station, slot.slot),
        }
    }
    steps.trajectory()
}

/// Shortest duration that a search finds from wafers one by one (s).
fn optimised(cell: &Cell, wafers: usize) -> f64 {
    let given = one_by_one(cell, wafers);
    let flow = WaferFlow::new(cell, &Program::default(), &given).unwrap();
    // One speed and blend radius: their effects are not simulated.
    let options = OptimiseOptions { station_candidates: 0, ..OptimiseOptions::default() };
    let mut search = Search::new(cell, &flow, options);
    let mut shortest = f64::INFINITY;
    while let Some(candidate) = search.next_candidate() {
        let trajectory = executed(cell, &search.order(&candidate));
        shortest = shortest.min(trajectory.duration());
        let objectives = Objectives {
            wafers_per_hour: 3600.0 * wafers as f64 / trajectory.duration(),
            clearance: 0.01,
            slip_margin: 0.5,
        };
        let (objectives, timing) = (Some(objectives), TimingModel::measure(&trajectory));
        search.record(Evaluation { objectives, timing });
    }
    shortest
}

#[test]
fn the_search_finds_orders_as_short_as_the_published_ones() {
    let mut found = Vec::new();
    for processes in [&[0.5][..], &[4.0], &[20.0], &[6.0, 6.0], &[3.0, 15.0], &[15.0, 3.0]] {
        let mut cell = tool(processes, 10);
        found.push((processes, 1, optimised(&cell, 10), single_arm(&cell, 10).duration()));
        let second = cell.robot.arms[0].effectors[0].clone();
        cell.robot.arms[0].effectors.push(Effector { name: "B".into(), ..second });
        for station in &mut cell.stations {
            station.effectors = vec![A, B];
        }
        found.push((processes, 2, optimised(&cell, 10), dual_arm(&cell, 10).duration()));
    }
    let longer: Vec<_> =
        found.iter().filter(|(.., shortest, published)| *shortest > published + 1e-9).collect();
    assert!(longer.is_empty(), "{longer:#?} of {found:#?}");
}

#[test]
fn only_the_station_that_costs_friction_gets_a_lower_speed() {
    const SLIPPERY: usize = 1;
    let cell = tool(&[6.0, 6.0], 10);
    let flow = WaferFlow::new(&cell, &Program::default(), &one_by_one(&cell, 3)).unwrap();
    // Friction depends on the speed at one station, at which the robot waits in any case.
    let objectives = |candidate: &Candidate| {
        let speed = |station: usize| candidate.settings_at(station).speed;
        let others = (0..cell.stations.len()).filter(|&station| station != SLIPPERY);
        let rate: f64 = others.map(speed).sum();
        Objectives {
            wafers_per_hour: 100.0 * rate / (cell.stations.len() - 1) as f64,
            clearance: 0.01 - candidate.settings_at(SLIPPERY).blend_radius,
            slip_margin: 1.0 - speed(SLIPPERY).powi(2),
        }
    };
    let run = |station_candidates: usize| {
        let options =
            OptimiseOptions { rounds: 1, station_candidates, ..OptimiseOptions::default() };
        let mut search = Search::new(&cell, &flow, options);
        while let Some(candidate) = search.next_candidate() {
            let evaluation =
                Evaluation { objectives: Some(objectives(&candidate)), timing: Vec::new() };
            search.record(evaluation);
        }
        (search.front(), search.evaluated().len())
    };
    let (uniform, fewest) = run(0);
    let (best, count) = run(12);
    let (again, _) = run(12);

    assert_eq!(best, again);
    assert!(count <= fewest + 12, "{count} {fewest}");
    assert_eq!(uniform[0].1.slip_margin, 0.0);
    let (candidate, found) = &best[0];
    assert_eq!(candidate.settings.speed, 1.0);
    assert_eq!(candidate.stations.keys().copied().collect::<Vec<_>>(), [SLIPPERY]);
    assert!((found.wafers_per_hour - 100.0).abs() < 1e-9, "{found:?}");
    assert!((found.slip_margin - 0.36).abs() < 1e-9, "{found:?}");
}

/// Two wafers into chamber 1: the first is picked after a wait, the second stays.
fn forgetful(cell: &Cell, wait: f64) -> Trajectory {
    let mut steps = Steps::new(cell);
    steps.go();
    steps.pick(A, LOAD_LOCK, 1);
    steps.place(A, 1, 1);
    steps.placed[1] = None;
    steps.line = 2;
    steps.wait(wait);
    steps.line = 3;
    steps.pick(A, 1, 1);
    steps.place(A, 2, 1);
    steps.pick(A, 2, 1);
    steps.place(A, LOAD_LOCK, 1);
    steps.line = 4;
    steps.pick(A, LOAD_LOCK, 2);
    steps.place(A, 1, 1);
    steps.trajectory()
}

fn rule_violations(cell: &Cell, trajectory: &Trajectory) -> Vec<Violation> {
    let rules = [
        ViolationKind::LongDwell,
        ViolationKind::ShortDwell,
        ViolationKind::LeftInStation,
        ViolationKind::VisitRule,
    ];
    let report = check(cell, trajectory, &CheckOptions::default());
    report.violations.into_iter().filter(|one| rules.contains(&one.kind)).collect()
}

#[test]
fn long_and_short_stays_and_forgotten_wafers_are_violations() {
    let mut cell = tool(&[0.0, 0.0], 2);
    let trajectory = forgetful(&cell, 10.0);
    let [unload, ..] = durations(&cell);
    let wafer = |slot| EntityId::Wafer(SlotId { station: LOAD_LOCK, slot });
    let limits = |min: f64, max: Option<f64>| DwellLimits { station: 1, min, max };
    let dwell = 10.0 + unload;
    let mut found = |limits| {
        cell.rules = WaferRules { dwell: vec![limits], visits: Vec::new() };
        let found = rule_violations(&cell, &trajectory);
        let row = |one: Violation| (one.kind, one.entities, one.place.line, one.worst);
        found.into_iter().map(row).collect::<Vec<_>>()
    };
    let none: Vec<(ViolationKind, Vec<EntityId>, usize, f64)> = Vec::new();
    assert_eq!(found(limits(dwell - 1e-6, None)), none);
    let short = found(limits(dwell + 0.5, None));
    let [(ViolationKind::ShortDwell, entities, 3, worst)] = short.as_slice() else {
        panic!("{short:?}")
    };
    assert_eq!(entities, &[wafer(1), EntityId::Station(1)]);
    assert!((worst - dwell).abs() < 1e-9);
    let left = found(limits(0.0, Some(dwell)));
    let [(ViolationKind::LeftInStation, entities, 4, _)] = left.as_slice() else {
        panic!("{left:?}")
    };
    assert_eq!(entities, &[wafer(2), EntityId::Station(1)]);
    let long = found(limits(0.0, Some(dwell - 0.5)));
    let [(ViolationKind::LongDwell, _, 3, worst), (ViolationKind::LeftInStation, ..)] =
        long.as_slice()
    else {
        panic!("{long:?}")
    };
    assert!((worst - dwell).abs() < 1e-9);
}

#[test]
fn a_visit_can_be_required_at_all_before_another_and_a_number_of_times() {
    let mut cell = tool(&[0.0, 0.0], 2);
    let trajectory = forgetful(&cell, 1.0);
    let rule = |stations: &[usize], before: &[usize], count| VisitRule {
        name: "rule".into(),
        stations: stations.to_vec(),
        before: before.to_vec(),
        origins: Vec::new(),
        count,
    };
    let mut wafers = |rule: VisitRule| {
        cell.rules = WaferRules { dwell: Vec::new(), visits: vec![rule] };
        let found = rule_violations(&cell, &trajectory);
        found.iter().map(|one| (one.entities[0], one.place.line)).collect::<Vec<_>>()
    };
    let wafer = |slot| EntityId::Wafer(SlotId { station: LOAD_LOCK, slot });
    // Wafer 1 visits 1, then 2; wafer 2 visits 1.
    assert_eq!(wafers(rule(&[1], &[], None)), []);
    assert_eq!(wafers(rule(&[2], &[], None)), [(wafer(2), 4)]);
    assert_eq!(wafers(rule(&[1, 2], &[], None)), []);
    assert_eq!(wafers(rule(&[1], &[2], None)), []);
    assert_eq!(wafers(rule(&[2], &[1], None)), [(wafer(1), 1), (wafer(2), 4)]);
    assert_eq!(wafers(rule(&[1], &[], Some(1))), []);
    assert_eq!(wafers(rule(&[1, 2], &[], Some(1))), [(wafer(1), 3)]);
    assert_eq!(wafers(rule(&[1], &[], Some(2))), [(wafer(1), 3), (wafer(2), 4)]);
    let elsewhere = VisitRule { origins: vec![1], ..rule(&[2], &[], None) };
    assert_eq!(wafers(elsewhere), []);
}

#[test]
fn rules_that_contradict_each_other_are_invalid() {
    let rule = |stations: &[usize], before: &[usize]| VisitRule {
        name: format!("{stations:?} before {before:?}"),
        stations: stations.to_vec(),
        before: before.to_vec(),
        origins: Vec::new(),
        count: None,
    };
    let validate = |visits| WaferRules { dwell: Vec::new(), visits }.validate(3);
    assert_eq!(validate(vec![rule(&[1], &[2]), rule(&[0], &[1])]), Ok(()));
    assert_eq!(validate(vec![rule(&[1, 0], &[2]), rule(&[2], &[1])]), Ok(()));
    for visits in [
        vec![rule(&[1], &[1])],
        vec![rule(&[1], &[2]), rule(&[2], &[1])],
        vec![rule(&[0], &[1]), rule(&[1], &[2]), rule(&[2], &[0])],
    ] {
        assert!(matches!(validate(visits), Err(CellError::Contradiction { .. })));
    }
    assert!(validate(vec![rule(&[3], &[])]).is_err());
    assert!(validate(vec![rule(&[], &[1])]).is_err());
}
