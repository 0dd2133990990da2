//! Jogging in the example cell, and in a cell whose arm has a free heading.

use std::f64::consts::PI;

use jointplay_cell::jog::{SlotRelativePose, StopReason};
use jointplay_cell::robot::{EffectorId, LimitViolation, RODS, WaferTarget};
use jointplay_cell::station::SlotId;
use jointplay_cell::wafer::Unreachable;
use jointplay_cell::workcell::Cell;
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Tilt, heading};
use jointplay_format::cell::explain::explain_stopped;
use jointplay_format::cell::{EXAMPLE, read};
use jointplay_format::display_units::DisplayUnits;
use nalgebra::Vector3;

const A: EffectorId = EffectorId { arm: 0, effector: 0 };
const LP2: SlotId = SlotId { station: 1, slot: 7 };
const IN: SlotRelativePose = SlotRelativePose { radial: 0.0, turn: 0.0, height: 0.0, heading: 0.0 };

fn example() -> Cell {
    read(EXAMPLE, &mut |_| Err("no files".to_owned())).unwrap()
}

/// The example cell with an arm of four joints.
fn with_scara() -> Cell {
    let text = EXAMPLE.replace("\"dual-arm\"", "\"scara-4r\"");
    let bodies = text.find("[[body]]").unwrap();
    let zones = text.find("[[zone]]").unwrap();
    let text = format!("{}{}", &text[..bodies], &text[zones..]);
    let pairs = text.find("may_touch").unwrap();
    let wafer = text.find("[wafer]").unwrap();
    let text = format!("{}{}", &text[..pairs], &text[wafer..]);
    read(&text, &mut |_| Err("no files".to_owned())).unwrap()
}

fn home(cell: &Cell) -> Vec<f64> {
    cell.robot.axes.iter().map(|axis| axis.home).collect()
}

#[track_caller]
fn near(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "{found} is not {wanted}");
}

#[test]
fn motors_stop_at_their_limits_and_rods_at_the_tilt_limit() {
    let cell = example();
    let from = home(&cell);
    let mut to = from.clone();
    (to[3], to[4]) = (0.5, 5.0);
    let jogged = cell.jog_axes(&from, &to).unwrap();
    assert_eq!((jogged.positions[3], jogged.positions[4]), (0.5, cell.robot.axes[4].max));
    let stopped = jogged.stopped.unwrap();
    assert!(
        matches!(&stopped, StopReason::Limits(broken) if matches!(broken[..], [LimitViolation::Axis { axis: 4, .. }]))
    );
    assert_eq!(
        explain_stopped(&cell, &stopped, DisplayUnits::Metric),
        ["axis RA at 286.4789°, limits -45.0000° to 80.0000°"]
    );
    to = from.clone();
    to[0] += 0.05;
    let jogged = cell.jog_axes(&from, &to).unwrap();
    let tilt = cell.robot.gpr.plane_tilt(&[jogged.positions[0], from[1], from[2]]);
    near(tilt.angle, cell.robot.gpr.limits().tilt_max, 1e-9);
    assert!(
        explain_stopped(&cell, &jogged.stopped.unwrap(), DisplayUnits::Metric)[0]
            .starts_with("tilt of ")
    );
    assert_eq!(cell.jog_axes(&from, &from).unwrap().stopped, None);
    assert!(cell.jog_axes(&from, &from[1..]).is_err());
}

#[test]
fn the_platform_tilts_up_to_its_limit() {
    let cell = example();
    let from = home(&cell);
    let asked = Tilt::from_about_x_and_y(0.004, -0.006);
    let jogged = cell.jog_platform(&from, asked, AxisHeight(0.51)).unwrap();
    let rods = [jogged.positions[0], jogged.positions[1], jogged.positions[2]];
    near(cell.robot.gpr.plane_tilt(&rods).angle, asked.angle, 1e-14);
    near(cell.robot.gpr.plane_height(&rods).0, 0.51, 1e-14);
    assert_eq!((jogged.stopped, &jogged.positions[RODS..]), (None, &from[RODS..]));
    let far = cell.jog_platform(&from, Tilt { azimuth: 1.0, angle: 0.1 }, AxisHeight(0.5)).unwrap();
    assert!(matches!(far.stopped, Some(StopReason::Limits(_))));
    assert!(cell.robot.limit_violations(&far.positions).unwrap().is_empty());
}

#[test]
fn slot_relative_jogging_reaches_the_commanded_pose() {
    for (cell, free) in [(example(), false), (with_scara(), true)] {
        assert_eq!(cell.robot.heading_is_free(A).unwrap(), free);
        for loaded in [false, true] {
            let mut positions = home(&cell);
            for to in [
                SlotRelativePose { radial: -0.3, ..IN },
                IN,
                SlotRelativePose { radial: -0.05, turn: 0.02, height: 0.004, heading: 0.1 },
            ] {
                let jogged = cell.jog_slot_relative(&positions, A, loaded, LP2, &to).unwrap();
                assert_eq!(jogged.stopped, None, "{to:?}");
                positions = jogged.positions;
                let pose = cell.wafer_pose(A, &positions, loaded).unwrap();
                let seen = cell.slot_relative_pose(&pose, A, LP2);
                near(seen.radial, to.radial, 1e-11);
                near(seen.turn, to.turn, 1e-10);
                near(seen.height, to.height, 1e-11);
                if free {
                    near(seen.heading, to.heading, 1e-10);
                }
            }
        }
    }
}

#[test]
fn a_wafer_jogged_into_a_slot_teaches_the_station_frame() {
    let cell = example();
    let jogged = cell.jog_slot_relative(&home(&cell), A, true, LP2, &IN).unwrap();
    let pose = cell.wafer_pose(A, &jogged.positions, true).unwrap();
    let slot = cell.stations[1].slot_frame(7);
    near((pose.translation.vector - slot.translation.vector).norm(), 0.0, 1e-12);
    // With its heading inward, the wafer teaches the frame of the station.
    let station = &cell.stations[1];
    let taught = station.taught_by(7, &pose);
    near(
        (taught.translation.vector - station.base_from_station.translation.vector).norm(),
        0.0,
        1e-6,
    );
    let (found, is) = (heading(&taught), heading(&station.base_from_station));
    // The heading follows the arm's tilted axis, which is millimetres away from the robot's.
    near((found - is + PI).rem_euclid(2.0 * PI) - PI, 0.0, 3e-3);
}

#[test]
fn jogging_beyond_the_reach_stops_at_the_reach() {
    let cell = example();
    let jogged = cell.jog_slot_relative(
        &home(&cell),
        A,
        false,
        LP2,
        &SlotRelativePose { radial: 0.4, ..IN },
    );
    let jogged = jogged.unwrap();
    let Some(StopReason::Unreachable(why)) = &jogged.stopped else {
        panic!("{:?}", jogged.stopped)
    };
    assert!(matches!(why, Unreachable::OutOfReach(_) | Unreachable::Limits(_)), "{why:?}");
    assert!(cell.robot.limit_violations(&jogged.positions).unwrap().is_empty());
    let pose = cell.wafer_pose(A, &jogged.positions, false).unwrap();
    let seen = cell.slot_relative_pose(&pose, A, LP2);
    assert!(seen.radial > 0.0 && seen.radial < 0.4, "{seen:?}");
    // A micrometre farther is unreachable.
    let farther = SlotRelativePose { radial: seen.radial + 1e-6, ..seen };
    let more = cell.jog_slot_relative(&jogged.positions, A, false, LP2, &farther).unwrap();
    assert!(more.stopped.is_some());
}

/// A millimetre turns the motors of a redundant arm by some mrad, also in a posture that is not the one farthest from limits.
#[test]
fn a_redundant_arm_takes_the_posture_nearest_to_the_present_one() {
    let cell = with_scara();
    let start = SlotRelativePose { radial: -0.2, ..IN };
    let mut start = cell.jog_slot_relative(&home(&cell), A, false, LP2, &start).unwrap().positions;
    for turned in [0.0, 0.5, -0.5] {
        start[5] += turned;
        let before = WaferTarget::from_pose(&cell.wafer_pose(A, &start, false).unwrap());
        let center = before.center + Vector3::new(0.6e-3, -0.8e-3, 0.0);
        let jogged = cell.jog_wafer(&start, A, false, &WaferTarget { center, ..before }).unwrap();
        assert_eq!(jogged.stopped, None);
        let turns = start.iter().zip(&jogged.positions).skip(3).map(|(a, b)| (a - b).abs());
        assert!(turns.fold(0.0, f64::max) < 0.02, "{start:?} {:?}", jogged.positions);
    }
}

#[test]
fn jogging_in_the_base_frame_keeps_normal_and_heading() {
    let cell = with_scara();
    let start = cell.jog_slot_relative(
        &home(&cell),
        A,
        false,
        LP2,
        &SlotRelativePose { radial: -0.2, ..IN },
    );
    let start = start.unwrap().positions;
    let before = WaferTarget::from_pose(&cell.wafer_pose(A, &start, false).unwrap());
    let by = Vector3::new(0.01, -0.02, 0.03);
    let to = WaferTarget { center: before.center + by, ..before };
    let jogged = cell.jog_wafer(&start, A, false, &to).unwrap();
    assert_eq!(jogged.stopped, None);
    let after = WaferTarget::from_pose(&cell.wafer_pose(A, &jogged.positions, false).unwrap());
    near((after.center - before.center - by).norm(), 0.0, 1e-11);
    near((after.normal - before.normal).norm(), 0.0, 1e-11);
    near(after.heading.unwrap(), before.heading.unwrap(), 1e-10);
    let upside = WaferTarget { normal: -Vector3::z(), ..before };
    assert!(matches!(cell.jog_wafer(&start, A, false, &upside), Err(Unreachable::Robot(_))));
}
