//! Plans of the example cell: against a look at every sample, and after changes against planning from scratch.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, CheckResult, Report, Violation, ViolationKind, check};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::{Handoff, Path, Phase, Step, expand};
use jointplay_cell::robot::{AxesMotion, EffectorId};
use jointplay_cell::station::SlotId;
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::Droop;
use jointplay_cell::workcell::Cell;
use jointplay_cell::{CacheStats, IncrementalPlanner, PlanError, PlanOptions};
use jointplay_format::{cell, program};
use proptest::prelude::*;

const SHORT: &str = "HOME\nTRANSFER LP1 SLOT 3 TO ALIGN WITH A\nGET ALIGN WITH A\nSWAP PM1 GET B PUT A\nPUT LP2 SLOT 7 WITH B\n";

/// The example, with a wafer in the process station.
fn example() -> Cell {
    let mut cell = cell::read(cell::EXAMPLE, &mut |_| Err(String::new())).unwrap();
    let station = cell.stations.iter().position(|station| station.name == "PM1").unwrap();
    cell.occupied.push(SlotId { station, slot: 1 });
    cell
}

fn steps(cell: &Cell, text: &str) -> Vec<Step> {
    expand(cell, &program::parse(text).unwrap()).unwrap()
}

fn names_of(cell: &Cell, entities: &[EntityId]) -> BTreeSet<String> {
    entities.iter().map(|&entity| cell.entity_name(entity)).collect()
}

fn distances(kind: ViolationKind) -> bool {
    matches!(
        kind,
        ViolationKind::Collision
            | ViolationKind::Clearance
            | ViolationKind::SlotClearance
            | ViolationKind::KeepOut
    )
}

/// Who is where: the label of a wafer by its present place, and by the one that it came from.
struct Labels<'c> {
    cell: &'c Cell,
    came_from: BTreeMap<String, String>,
}

impl Labels<'_> {
    fn slot(&self, slot: SlotId) -> String {
        self.cell.entity_name(EntityId::Wafer(slot))
    }

    fn effector(&self, id: EffectorId) -> String {
        self.cell.entity_name(EntityId::HeldWafer(id))
    }

    fn hand_off(&mut self, from: String, to: String) {
        let first = self.came_from.remove(&from).unwrap_or(from);
        self.came_from.insert(to, first);
    }
}

/// Names of a pair, kind of violation, time, and distance.
type TooNear = (BTreeSet<String>, ViolationKind, f64, f64);

/// Minimum distances and violations, from an independent check of a dwell at each sample.
fn sample_by_sample(
    cell: &Cell,
    motion: &Trajectory,
    options: &CheckOptions,
) -> (BTreeMap<BTreeSet<String>, f64>, Vec<TooNear>) {
    let mut current = cell.clone();
    let mut labels = Labels { cell, came_from: BTreeMap::new() };
    let (mut least, mut broken) = (BTreeMap::new(), Vec::new());
    for (index, step) in motion.steps.iter().enumerate() {
        let (start, end) = (motion.times[index], motion.times[index + 1]);
        let count = ((end - start) * options.rate - 1e-3).ceil().max(0.0) as usize;
        let times = (0..count).map(|k| start + k as f64 / options.rate).chain([end]);
        for (k, time) in times.enumerate() {
            let positions = match k {
                0 => step.from.clone(),
                k if k == count => step.to.clone(),
                _ => motion.sample_at(time).positions,
            };
            let (from, to) = (positions.clone(), positions);
            let path = Path::Dwell(0.0);
            // Clearance rules of the step apply, whose path names the effector.
            let acting = match (step.path, step.handoff) {
                (Path::Line(id), None) => Some(Path::Line(id)),
                _ => None,
            };
            let still = Step { from, to, path: acting.unwrap_or(path), ..step.clone() };
            let found =
                plan_trajectory(&current, vec![still], &TrajectoryOptions::default()).unwrap();
            let report = check(&current, &found, options);
            let named = |entities: &[EntityId]| -> BTreeSet<String> {
                let first = |&entity: &EntityId| {
                    let name = current.entity_name(entity);
                    labels.came_from.get(&name).cloned().unwrap_or(name)
                };
                entities.iter().map(first).collect()
            };
            for row in &report.distances {
                let known = least.entry(named(&row.entities)).or_insert(f64::INFINITY);
                *known = row.distance.min(*known);
            }
            for one in report.violations.iter().filter(|one| distances(one.kind)) {
                broken.push((named(&one.entities), one.kind, time, one.worst));
            }
        }
        match step.handoff {
            Some(Handoff::Picked(id, slot)) => {
                current.occupied.retain(|&at| at != slot);
                current.loaded_effectors.push(id);
                labels.hand_off(labels.slot(slot), labels.effector(id));
            }
            Some(Handoff::Placed(id, slot)) => {
                current.loaded_effectors.retain(|&at| at != id);
                current.occupied.push(slot);
                labels.hand_off(labels.effector(id), labels.slot(slot));
            }
            None => {}
        }
    }
    (least, broken)
}

#[test]
fn the_check_reports_every_violation_of_a_sample() {
    let options = CheckOptions { rate: 20.0, ..CheckOptions::default() };
    for (clearance, result) in [(1e-3, CheckResult::Passed), (6e-3, CheckResult::Failed)] {
        let mut cell = example();
        (cell.clearance, cell.slot_clearance) = (clearance, clearance);
        let motion =
            plan_trajectory(&cell, steps(&cell, SHORT), &TrajectoryOptions::default()).unwrap();
        let report = check(&cell, &motion, &options);
        let (least, broken) = sample_by_sample(&cell, &motion, &options);
        assert_eq!(report.result, result, "{:#?}", report.violations);
        assert_eq!(broken.is_empty(), result == CheckResult::Passed);
        let mut found: BTreeMap<BTreeSet<String>, f64> = BTreeMap::new();
        for row in &report.distances {
            let names = names_of(&cell, &row.entities);
            let truth = least.get(&names).copied().unwrap_or(options.report_distance);
            assert!(row.distance >= truth - 1e-6, "{names:?}: {} {truth}", row.distance);
            assert!(row.distance <= truth + row.tolerance + 1e-6, "{names:?}: {row:?} {truth}");
            found.insert(names, row.distance);
        }
        assert!(found.len() > 20, "{}", found.len());
        for (names, distance) in &least {
            let close = *distance < 0.97 * options.report_distance;
            assert!(!close || found.contains_key(names), "{names:?} at {distance}");
        }
        for (names, kind, time, value) in &broken {
            let reported = report.violations.iter().any(|one| {
                names_of(&cell, &one.entities) == *names
                    && (one.start - 1e-9..one.end + 1e-9).contains(time)
                    && one.worst <= value + 1e-6
            });
            let of_pair = |one: &&Violation| names_of(&cell, &one.entities).is_superset(names);
            let others: Vec<&Violation> = report.violations.iter().filter(of_pair).collect();
            assert!(reported, "{kind} of {names:?} at {time}: {value}, not in {others:#?}");
        }
    }
}

/// At each sample of a step with a carried wafer: time, and utilization of the friction.
fn pushes(cell: &Cell, motion: &Trajectory, index: usize, rate: f64) -> Vec<(f64, f64)> {
    let step = &motion.steps[index];
    let count = (motion.step_duration(index) * rate - 1e-3).ceil() as usize;
    let mut pushes = Vec::new();
    let end = motion.times[index] + motion.step_duration(index);
    for time in (0..count).map(|k| motion.times[index] + k as f64 / rate).chain([end]) {
        let sample = motion.sample_at(time.max(motion.times[index]));
        let now = AxesMotion {
            positions: &sample.positions,
            velocities: &sample.velocities,
            accelerations: &sample.accelerations,
        };
        let shares =
            step.loaded.iter().map(|&id| cell.friction_demand(id, &now).unwrap().utilization());
        pushes.extend(shares.reduce(f64::max).map(|share| (time, share)));
    }
    pushes
}

#[test]
fn slip_is_the_largest_utilization_of_all_samples() {
    let blended = format!("BLEND 10 mm\n{SHORT}");
    for (text, friction, soft) in [(SHORT, 0.4, 1.0), (SHORT, 0.4, 6.0), (&blended, 0.12, 1.0)] {
        let mut cell = example();
        for arm in &mut cell.robot.arms {
            let Droop::Cantilever { stiffness, .. } = &mut arm.droop else { panic!("{arm:?}") };
            *stiffness /= soft;
        }
        let motion =
            plan_trajectory(&cell, steps(&cell, text), &TrajectoryOptions::default()).unwrap();
        // Less friction than the trajectory was planned for: then it is slow enough for none to slip.
        for arm in &mut cell.robot.arms {
            arm.effectors.iter_mut().for_each(|effector| effector.friction = friction);
        }
        let options = CheckOptions::default();
        let report = check(&cell, &motion, &options);
        let slips: Vec<&Violation> =
            report.violations.iter().filter(|one| one.kind == ViolationKind::Slip).collect();
        let mut over = 0;
        for row in &report.by_instruction {
            let pushes: Vec<(f64, f64)> = row
                .steps
                .clone()
                .flat_map(|index| pushes(&cell, &motion, index, options.rate))
                .collect();
            let most = pushes.iter().map(|push| push.1).reduce(f64::max);
            let found = row.slip.map(|slip| slip.ratio);
            match (most, found) {
                (Some(most), Some(found)) => {
                    // Within the resolution of the report; accelerations of the platform are differences of positions, with round-off in the ninth digit.
                    assert!(
                        found <= most + 1e-8 && found > most - 1.01e-4,
                        "{}: {most} {found} at {:?}, {:?}",
                        row.instruction,
                        row.slip.map(|slip| slip.time),
                        pushes.iter().filter(|push| push.1 > most - 1e-6).collect::<Vec<_>>()
                    );
                }
                (most, found) => assert_eq!(most, found),
            }
            for (time, share) in pushes {
                let reported =
                    slips.iter().any(|one| one.start <= time + 1e-6 && time - 1e-6 <= one.end);
                assert!(reported || share <= 1.0 + 1e-6, "{time} {share}");
                assert!(
                    share > 1.0 - 1e-6
                        || !slips
                            .iter()
                            .any(|one| { one.start + 1.5e-3 < time && time < one.end - 1.5e-3 }),
                    "{time} {share}"
                );
                over += usize::from(share > 1.0);
            }
        }
        // Wafers slip only with the low friction.
        assert_eq!(over > 500, friction < 0.2, "{over}");
        assert_eq!(slips.is_empty(), over == 0);
    }
}

#[test]
fn blending_does_not_make_a_wafer_slip() {
    let mut cell = example();
    let blended = format!("BLEND 40 mm\n{SHORT}");
    let planned = |cell: &Cell, text: &str| {
        let motion =
            plan_trajectory(cell, steps(cell, text), &TrajectoryOptions::default()).unwrap();
        let report = check(cell, &motion, &CheckOptions::default());
        let most = report.by_instruction.iter().filter_map(|row| row.slip);
        let most = most.map(|slip| slip.ratio).fold(0.0, f64::max);
        (motion.duration(), most)
    };
    let most = planned(&cell, SHORT).1;
    let free = planned(&cell, &blended).0;
    // Friction that just suffices for motions without blends.
    for arm in &mut cell.robot.arms {
        arm.effectors.iter_mut().for_each(|effector| effector.friction *= most / 0.98);
    }
    let ((plain, alone), (shorter, together)) = (planned(&cell, SHORT), planned(&cell, &blended));
    assert!((alone - 0.98).abs() < 1e-3 && together < 1.0, "{alone} {together}");
    assert!(free < shorter && shorter < 0.95 * plain, "{free} {shorter} {plain}");
}

#[test]
fn blending_keeps_wafers_inside_safe_zones() {
    let mut cell = example();
    let text = "BLEND 10 mm\nTRANSFER LP1 SLOT 2 TO LP2 SLOT 3 WITH A\nTRANSFER LP2 SLOT 3 TO LP1 SLOT 2 WITH A";
    let planned = |cell: &Cell| {
        let motion =
            plan_trajectory(cell, steps(cell, text), &TrajectoryOptions::default()).unwrap();
        let report = check(cell, &motion, &CheckOptions::default());
        let zones =
            report.violations.iter().filter(|one| one.kind == ViolationKind::SafeZone).count();
        (motion, zones)
    };
    let (motion, violations) = planned(&cell);
    assert_eq!(violations, 0);
    let zones = std::mem::take(&mut cell.zones);
    let (free, _) = planned(&cell);
    cell.zones = zones;
    let report = check(&cell, &free, &CheckOptions::default());
    assert!(report.violations.iter().any(|one| one.kind == ViolationKind::SafeZone));
    assert!(free.duration() < motion.duration());
}

/// Runs a computation on `count` threads.
fn on_threads<T: Send>(count: usize, compute: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(compute)
}

/// One change of a cell or its program.
#[derive(Debug, Clone)]
enum Change {
    Station(usize, f64),
    Limit(usize, f64),
    Body(usize, f64),
    Clearance(f64),
    Line(usize, usize),
    Corners(u32),
    Zone(f64),
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        (0..4_usize, -4e-4..4e-4_f64).prop_map(|(station, by)| Change::Station(station, by)),
        (0..6_usize, 0.8..1.0_f64).prop_map(|(axis, by)| Change::Limit(axis, by)),
        (0..40_usize, -0.02..0.02_f64).prop_map(|(body, by)| Change::Body(body, by)),
        (5e-4..6e-3_f64).prop_map(Change::Clearance),
        (3..5_usize, 4..25_usize).prop_map(|(line, slot)| Change::Line(line, slot)),
        (0..30_u32).prop_map(Change::Corners),
        (0.04..0.08_f64).prop_map(Change::Zone),
    ]
}

impl Change {
    fn make(&self, cell: &mut Cell, lines: &mut [String]) {
        match *self {
            Self::Station(station, by) => {
                cell.stations[station].base_from_station.translation.vector.x += by;
            }
            Self::Limit(axis, by) => cell.robot.axes[axis].loaded.velocity *= by,
            Self::Body(body, by) => {
                let body = body % cell.bodies.len();
                cell.bodies[body].parent_from_shape.translation.vector.z += by;
            }
            Self::Corners(millimeters) => lines[0] = format!("BLEND {millimeters} mm\nHOME"),
            Self::Zone(radius) => {
                cell.zones[0].shape = Shape::Cylinder { radius, half_height: 0.35 };
            }
            Self::Clearance(clearance) => cell.clearance = clearance,
            Self::Line(line, slot) => {
                lines[line] = format!("GET LP1 SLOT {slot} WITH A\nPUT LP1 SLOT {slot} WITH A");
            }
        }
    }
}

fn planned(memory: &mut IncrementalPlanner, cell: &Cell, text: &str) -> (Trajectory, Report) {
    let check = CheckOptions { rate: 100.0, report_distance: 0.05 };
    let options = PlanOptions { check, ..PlanOptions::default() };
    memory.plan(cell, &program::parse(text).unwrap(), &options).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    /// An incremental plan on several threads equals a new plan on one thread, to the bit.
    #[test]
    fn incremental_plans_equal_new_plans_on_any_number_of_threads(changes in prop::collection::vec(change(), 1..4)) {
        let mut cell = example();
        let mut lines = ["HOME", "GET LP1 SLOT 3 WITH A", "PUT ALIGN WITH A", "", ""].map(String::from);
        let mut planner = IncrementalPlanner::default();
        planned(&mut planner, &cell, &lines.join("\n"));
        for change in &changes {
            change.make(&mut cell, &mut lines);
            let text = lines.join("\n");
            // The debug format distinguishes all numbers.
            let (motion, report) = on_threads(3, || planned(&mut planner, &cell, &text));
            let (same_motion, same_report) =
                on_threads(1, || planned(&mut IncrementalPlanner::default(), &cell, &text));
            prop_assert!(format!("{motion:?}") == format!("{same_motion:?}"), "{change:?}");
            prop_assert_eq!(format!("{report:?}"), format!("{same_report:?}"), "{:?}", change);
        }
    }
}

#[test]
fn an_interrupted_plan_continues_to_the_same_bits() {
    let cell = example();
    let program = program::parse(SHORT).unwrap();
    let check = CheckOptions { rate: 100.0, report_distance: 0.05 };
    let options = PlanOptions { check, ..PlanOptions::default() };
    let whole = IncrementalPlanner::default().plan(&cell, &program, &options).unwrap();
    let (mut memory, mut stopped) = (IncrementalPlanner::default(), 0);
    for most in [0, 1, 3, 10, 20, 30, 40, 60, 80, 100, 10_000] {
        let polls = AtomicUsize::new(0);
        let stop = || polls.fetch_add(1, Ordering::Relaxed) >= most;
        match memory.plan(&cell, &program, &PlanOptions { stop: &stop, ..options }) {
            Err(PlanError::Interrupted(_)) => stopped += 1,
            found => assert_eq!(format!("{:?}", found.unwrap()), format!("{whole:?}")),
        }
    }
    assert!(stopped >= 6, "{stopped}");
    let again = memory.plan(&cell, &program, &options).unwrap();
    assert_eq!(format!("{again:?}"), format!("{whole:?}"));
}

#[test]
fn only_segments_affected_by_a_change_are_recomputed() {
    let mut cell = example();
    let mut memory = IncrementalPlanner::default();
    let none = |reuse: CacheStats| reuse.hits == 0 && reuse.misses > 0;
    planned(&mut memory, &cell, SHORT);
    assert!(none(memory.segment_cache_stats()) && none(memory.distance_cache_stats()));
    planned(&mut memory, &cell, SHORT);
    let all = |memory: &IncrementalPlanner| {
        [
            memory.ik_cache_stats(),
            memory.segment_cache_stats(),
            memory.findings_cache_stats(),
            memory.distance_cache_stats(),
        ]
    };
    for reuse in all(&memory) {
        assert!(reuse.misses == 0 && reuse.hits > 20, "{reuse:?}");
    }
    // Another position of the last station: only the motions to it and from it are recomputed.
    let port = cell.stations.iter().position(|station| station.name == "LP2").unwrap();
    cell.stations[port].base_from_station.translation.vector.z += 1e-4;
    planned(&mut memory, &cell, SHORT);
    for reuse in all(&memory) {
        assert!(reuse.hits > 2 * reuse.misses && reuse.misses > 0, "{reuse:?}");
    }
    // A body out of reach: nothing is recomputed.
    cell.bodies[0].parent_from_shape.translation.vector.z -= 5.0;
    planned(&mut memory, &cell, SHORT);
    assert_eq!(
        [memory.ik_cache_stats(), memory.segment_cache_stats()].map(|reuse| reuse.misses),
        [0; 2]
    );
    assert_eq!(memory.findings_cache_stats().misses, 0);
    // A limit: everything is recomputed.
    let axis = &mut cell.robot.axes[3];
    axis.empty.velocity *= 0.5;
    axis.loaded.velocity = axis.loaded.velocity.min(axis.empty.velocity);
    planned(&mut memory, &cell, SHORT);
    assert!(all(&memory).into_iter().all(none));
}

#[test]
fn an_arm_retracts_to_the_same_positions_from_every_slot() {
    let mut cell = example();
    let text = "HOME\nTRANSFER LP1 SLOT 3 TO LP2 SLOT 7 WITH A\nTRANSFER LP2 SLOT 7 TO ALIGN WITH A\n\
        TRANSFER PM1 TO LP2 SLOT 9 WITH B\nTRANSFER LP2 SLOT 9 TO LP1 SLOT 3 WITH B\nGET ALIGN WITH A\n";
    let mut memory = IncrementalPlanner::default();
    let (motion, _) = planned(&mut memory, &cell, text);
    let axis = |name: &str| cell.robot.axes.iter().position(|axis| axis.name == name).unwrap();
    // The extending motor of each arm, from its first GET on.
    for (name, from) in [("RA", 1), ("RB", 3)] {
        let axis = axis(name);
        let retracted = |step: &&Step| matches!(step.phase, Phase::Retract | Phase::Level);
        let waits: BTreeSet<u64> = motion
            .steps
            .iter()
            .filter(|step| retracted(step) && step.instruction >= from)
            .map(|step| step.to[axis].to_bits())
            .collect();
        assert_eq!(waits.len(), 1, "{name}");
    }
    // So a change of a tilted station changes the motions there, and not those of the other arm elsewhere.
    let port = cell.stations.iter().position(|station| station.name == "LP2").unwrap();
    cell.stations[port].base_from_station.translation.vector.y += 1e-4;
    let (moved, _) = planned(&mut memory, &cell, text);
    let last = moved.steps.last().unwrap().instruction;
    for (step, same) in motion.steps.iter().zip(&moved.steps) {
        let away = step.instruction == last;
        assert!(
            !away || step.phase == Phase::Turn || (&step.from, &step.to) == (&same.from, &same.to)
        );
    }
}
