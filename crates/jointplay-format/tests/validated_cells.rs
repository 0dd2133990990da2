//! Cells that are invalid are rejected before planning, also where they were not read from a file.

use jointplay_cell::check::CheckOptions;
use jointplay_cell::geometry::Shape;
use jointplay_cell::robot::EffectorId;
use jointplay_cell::station::{DwellLimits, SlotId};
use jointplay_cell::workcell::{Cell, ParentFrame};
use jointplay_cell::{CellError, CellPart, IncrementalPlanner, PlanError, PlanOptions};
use jointplay_format::{cell, program};
use proptest::prelude::*;

const PROGRAM: &str = "GET LP1 SLOT 3 WITH A\nPUT ALIGN WITH A\n";

fn example() -> Cell {
    cell::read(cell::EXAMPLE, &mut |path| Err(format!("{path} does not exist"))).unwrap()
}

fn invalid_parts(cell: &Cell) -> Vec<CellPart> {
    cell.validate().unwrap_err().into_iter().map(|one| one.part).collect()
}

/// Sets one number or index of a cell.
fn mutate(cell: &mut Cell, field: usize, value: f64, index: usize) {
    let station = index % cell.stations.len();
    let body = index % cell.bodies.len();
    let arm = index % cell.robot.arms.len();
    let axis = index % cell.robot.axes.len();
    // Valid but slow motions have too many samples for a test.
    let speed = if value > 0.0 { value.max(0.05) } else { value };
    match field {
        0 => cell.wafer.diameter = value,
        1 => cell.wafer.thickness = value,
        2 => cell.wafer.material.young = value,
        3 => cell.wafer.material.poisson = value,
        4 => cell.wafer.material.density = value,
        5 => cell.play_budget = value,
        6 => cell.clearance = value,
        7 => cell.slot_clearance = value,
        8 => cell.gravity = value,
        9 => cell.plane_threshold = value,
        10 => cell.stations[station].pitch = value,
        11 => cell.stations[station].slots = index,
        12 => cell.stations[station].stroke.below = value,
        13 => cell.stations[station].stroke.speed = speed,
        14 => cell.stations[station].offset[index % 3] = value,
        15 => cell.stations[station].retract_reach = value,
        16 => cell.stations[station].process_time = value,
        17 => cell.stations[station].base_from_station.translation.vector[index % 3] = value,
        18 => cell.stations[station].effectors = vec![EffectorId { arm: index, effector: 0 }],
        19 => cell.stations[station].name = cell.stations[0].name.clone(),
        20 => cell.bodies[body].shape = Shape::Cylinder { radius: value, half_height: 0.1 },
        21 => cell.bodies[body].shape = Shape::Convex { points: vec![[value; 3]; index] },
        22 => cell.bodies[body].parent = ParentFrame::Link { arm: index, link: index },
        23 => cell.bodies[body].parent_from_shape.translation.vector.x = value,
        24 => cell.allowed_pairs.push([0, index]),
        25 => cell.occupied.push(SlotId { station: index, slot: index }),
        26 => cell.loaded_effectors.push(EffectorId { arm: index, effector: index }),
        27 => cell.robot.axes[axis].max = value,
        28 => cell.robot.axes[axis].empty.jerk = speed,
        29 => cell.robot.arms[arm].mount[index % 3] = value,
        30 => cell.robot.arms[arm].joints[0].length = value,
        32 => {
            let limits = DwellLimits { station: index, min: value, max: Some(0.1) };
            cell.rules.dwell.push(limits);
        }
        31 => cell.robot.arms[arm].effectors[0].friction = value,
        _ => cell.stations[station].via = vec![[value; 3]],
    }
}

fn value() -> impl Strategy<Value = f64> {
    let special = prop::sample::select(vec![
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        0.0,
        1e-300,
        1e-9,
        1e6,
        1e300,
    ]);
    prop_oneof![special, -0.5..0.5_f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn mutated_cells_are_rejected_or_planned_without_panic(
        mutations in prop::collection::vec((0..34_usize, value(), 0..30_usize), 1..3)
    ) {
        let mut cell = example();
        for (field, value, index) in mutations {
            mutate(&mut cell, field, value, index);
        }
        let is_valid = cell.validate().is_ok();
        let check = CheckOptions { rate: 20.0, report_distance: 0.01 };
        let options = PlanOptions { check, ..PlanOptions::default() };
        let program = program::parse(PROGRAM).unwrap();
        let planned = IncrementalPlanner::default().plan(&cell, &program, &options);
        prop_assert_eq!(is_valid, !matches!(planned, Err(PlanError::Cell(_))));
    }
}

/// Took minutes when the travel between two samples was bounded by the limit of the jerk alone.
#[test]
fn cells_without_a_limit_of_jerk_are_checked_at_a_low_rate() {
    let check = CheckOptions { rate: 20.0, report_distance: 0.01 };
    let options = PlanOptions { check, ..PlanOptions::default() };
    let program = program::parse(PROGRAM).unwrap();
    let plan = |jerk: f64| {
        let mut cell = example();
        for axis in &mut cell.robot.axes {
            (axis.empty.jerk, axis.loaded.jerk) = (jerk, jerk);
        }
        IncrementalPlanner::default().plan(&cell, &program, &options).unwrap()
    };
    let [large, larger] = [1e6, 1e9].map(plan);
    assert_eq!(large.1.result, larger.1.result);
}

#[test]
fn validation_reports_each_invalid_part() {
    assert_eq!(example().validate(), Ok(()));
    let mut cell = example();
    cell.clearance = -0.001;
    cell.wafer.thickness = 0.2 * cell.wafer.diameter;
    cell.stations[1].retract_reach = 5.0;
    cell.bodies[0].shape = Shape::Convex { points: vec![[0.0; 3]; 4] };
    cell.occupied.push(SlotId { station: 0, slot: 0 });
    let parts = [
        CellPart::Cell,
        CellPart::Wafer,
        CellPart::Station(1),
        CellPart::Body(0),
        CellPart::Occupied(cell.occupied.len() - 1),
    ];
    assert_eq!(invalid_parts(&cell), parts);
}

#[test]
fn names_and_wafers_must_be_unique() {
    let mut cell = example();
    cell.stations[1].name = cell.stations[0].name.clone();
    cell.bodies[1].name = cell.bodies[0].name.clone();
    cell.occupied.push(cell.occupied[0]);
    let parts =
        [CellPart::Station(1), CellPart::Body(1), CellPart::Occupied(cell.occupied.len() - 1)];
    assert_eq!(invalid_parts(&cell), parts);
}

#[test]
fn a_station_that_tilts_further_than_the_robot_is_invalid() {
    let mut cell = example();
    let max = cell.robot.gpr.limits().tilt_max;
    let steep = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), 1.01 * max);
    cell.stations[0].base_from_station.rotation = steep;
    let invalid = cell.validate().unwrap_err();
    assert!(matches!(invalid[0].error, CellError::StationTilt { .. }), "{invalid:?}");
}
