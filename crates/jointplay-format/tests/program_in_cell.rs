//! Programs in a cell: their steps and their planning errors.

use jointplay_cell::program::{
    Handoff, MAX_CALL_DEPTH, MAX_INSTRUCTIONS, Path, Phase, ProgramProblem, Step, expand,
};
use jointplay_cell::robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel,
};
use jointplay_cell::station::teach::FrameUncertainty;
use jointplay_cell::station::{Approach, Origin, SlotId, Station, Stroke};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::{Droop, Material, Support, Wafer};
use jointplay_cell::workcell::Cell;
use jointplay_core::gpr::Gpr;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::program::{explain, parse};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

const A: EffectorId = EffectorId { arm: 0, effector: 0 };
const B: EffectorId = EffectorId { arm: 1, effector: 0 };

fn axis(name: &str, kind: AxisKind, min: f64, max: f64, home: f64) -> Axis {
    let dynamics = KinematicLimits { velocity: 2.0, acceleration: 10.0, jerk: 100.0 };
    Axis { name: name.into(), kind, min, max, home, empty: dynamics, loaded: dynamics }
}

/// An arm of two equal links with a 1 : −2 : 1 belt, folded where its motor R is at zero.
fn arm(name: &str, r: usize, height: f64) -> Arm {
    let joint = |zero: f64, drives: Vec<(usize, f64)>, length| ArmJoint {
        kind: AxisKind::Rotary,
        zero,
        drives,
        length,
        offset: 0.0,
        rise: 0.012,
    };
    let effector = Effector {
        name: name.into(),
        wafer_center: [0.25, 0.0, 0.005],
        heading: 0.0,
        support: Support::ThreePoints { radius: 0.1 },
        friction: 0.3,
    };
    Arm {
        name: format!("arm {name}"),
        mount: [0.0, 0.0, height],
        joints: vec![
            joint(-FRAC_PI_2, vec![(3, 1.0), (r, 1.0)], 0.22),
            joint(PI, vec![(r, -2.0)], 0.22),
            joint(-FRAC_PI_2, vec![(r, 1.0)], 0.0),
        ],
        effectors: vec![effector],
        droop: Droop::Cantilever { stiffness: 900.0, mass_per_length: 2.5 },
    }
}

fn station(name: &str, azimuth: f64, tilt: Tilt, slots: usize) -> Station {
    let (sin, cos) = azimuth.sin_cos();
    let facing = Rotation3::from_axis_angle(&Vector3::z_axis(), azimuth - FRAC_PI_2);
    let origin = Vector3::new(0.6 * cos, 0.6 * sin, 0.7);
    Station {
        name: name.into(),
        base_from_station: Pose::from_parts(origin.into(), tilt_rotation(&tilt.normal()) * facing),
        origin: Origin::Nominal,
        uncertainty: FrameUncertainty::UNKNOWN,
        slots,
        pitch: 0.01,
        slot_step: [0.0; 2],
        stroke: Stroke { below: 0.004, above: 0.003, speed: 0.02 },
        offset: [0.0; 3],
        retract_reach: 0.3,
        via: Vec::new(),
        approach: Approach::Radial,
        effectors: vec![A, B],
        process_time: 0.0,
    }
}

/// Two arms, a straight and a tilted port of five slots, an aligner for one arm, and a process station with a via point.
fn cell() -> Cell {
    let gpr = Gpr::paper();
    let (min, max) = (gpr.limits().rod_min, gpr.limits().rod_max);
    let mut axes: Vec<Axis> =
        ["q1", "q2", "q3"].map(|rod| axis(rod, AxisKind::Linear, min, max, 0.5)).into();
    axes.push(axis("T", AxisKind::Rotary, -PI, PI, 0.0));
    axes.push(axis("R1", AxisKind::Rotary, -1.2, 1.5, 0.0));
    axes.push(axis("R2", AxisKind::Rotary, -1.2, 1.5, 0.0));
    let robot = HybridRobot {
        name: "test".into(),
        gpr,
        model: PlatformModel::default(),
        axes,
        arms: vec![arm("A", 4, 0.14), arm("B", 5, 0.17)],
        assumed: Vec::new(),
    };
    let tilted = Tilt { azimuth: 2.0, angle: 0.8_f64.to_radians() };
    let aligner = Station { effectors: vec![A], ..station("aligner", PI, Tilt::LEVEL, 1) };
    let process = Station {
        process_time: 30.0,
        via: vec![[0.0, -0.2, 0.0]],
        approach: Approach::Line,
        ..station("process", -FRAC_PI_2, Tilt::LEVEL, 1)
    };
    let slot = |slot| SlotId { station: 0, slot };
    Cell {
        name: "test".into(),
        assumed: Vec::new(),
        robot: robot.checked().unwrap(),
        wafer: Wafer {
            diameter: 0.3,
            thickness: 775e-6,
            material: Material {
                name: "silicon".into(),
                young: 147e9,
                poisson: 0.18,
                density: 2329.0,
            },
        },
        stations: vec![
            station("port-1", 0.0, Tilt::LEVEL, 5),
            station("port-2", FRAC_PI_2, tilted, 5),
            aligner,
            process,
        ],
        occupied: vec![slot(1), slot(2), slot(3), slot(5)],
        loaded_effectors: Vec::new(),
        bodies: Vec::new(),
        allowed_pairs: Vec::new(),
        zones: Vec::new(),
        rules: jointplay_cell::station::WaferRules::default(),
        play_budget: 1e-3,
        clearance: 1e-3,
        slot_clearance: 1e-3,
        gravity: 9.80665,
        plane_threshold: 1e-6,
        coverage_factor: 2.0,
        tolerances: jointplay_cell::displacement::Tolerances::default(),
    }
}

/// The steps of a program, checked against the invariants of all programs.
#[track_caller]
fn steps(cell: &Cell, text: &str) -> Vec<Step> {
    let program = parse(text).unwrap();
    let steps = expand(cell, &program).unwrap_or_else(|errors| {
        panic!(
            "{}",
            errors.iter().map(|it| format!("{}: {it}\n", it.place.line)).collect::<String>()
        )
    });
    let mut before: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    let mut loaded = cell.loaded_effectors.clone();
    for (index, step) in steps.iter().enumerate() {
        assert_eq!(step.from, before, "step {index}");
        assert_eq!(step.loaded, loaded, "step {index}");
        assert_eq!(cell.robot.limit_violations(&step.to).unwrap(), []);
        before.clone_from(&step.to);
        match step.handoff {
            Some(Handoff::Picked(effector, _)) => loaded.push(effector),
            Some(Handoff::Placed(effector, _)) => loaded.retain(|&id| id != effector),
            None => {}
        }
        loaded.sort_unstable();
    }
    steps
}

fn phases(steps: &[Step]) -> Vec<Phase> {
    steps.iter().map(|step| step.phase).collect()
}

use Phase::{Align, Extend, Level, Lift, Lower, Move, Retract, RetractArms, Turn, Wait};

#[test]
fn get_expands_to_turn_align_extend_lift_retract_level() {
    let cell = cell();
    let steps = steps(&cell, "SPEED 50 %\nGET port-1 SLOT 3 WITH A");
    // The last phase levels the platform, which the droop compensation has tilted.
    assert_eq!(phases(&steps), [Turn, Align, Extend, Lift, Lift, Retract, Level]);
    let slot = SlotId { station: 0, slot: 3 };
    let waypoints = cell.waypoints(A, slot, &steps[0].from).unwrap();
    for (index, step) in steps.iter().enumerate() {
        assert_eq!((step.instruction, step.place.line), (1, 2));
        assert!((step.speed_scaling - 0.5).abs() < 1e-15);
        let within = (2..=5).contains(&index);
        assert_eq!(step.slot, within.then_some(slot));
        assert_eq!(step.path, if within { Path::Line(A) } else { Path::PointToPoint });
        assert_eq!(step.line_speed.is_some(), matches!(step.phase, Lift));
    }
    assert_eq!(steps[3].handoff, Some(Handoff::Picked(A, slot)));
    // The turn moves no rod, and the alignment moves no motor.
    assert_eq!(steps[0].from[..3], steps[0].to[..3]);
    assert_eq!(steps[1].from[3..], steps[1].to[3..]);
    // Wafer poses with compensated droop of the arm, and with the sag of the wafer.
    let sag = cell.sag(A).unwrap().plane_height;
    assert!(sag < -1e-6);
    let at = |step: usize, target: &jointplay_cell::robot::WaferTarget, loaded, sag: f64| {
        let pose = cell.wafer_pose(A, &steps[step].to, loaded).unwrap();
        let center = target.center - target.normal * sag;
        assert!((pose.translation.vector - center).norm() < 1e-11, "step {step}");
        assert!((pose.rotation * Vector3::z() - target.normal).norm() < 1e-9, "step {step}");
    };
    at(1, &waypoints.retracted_below, false, 0.0);
    at(2, &waypoints.below, false, 0.0);
    at(3, &waypoints.resting, false, sag);
    at(4, &waypoints.above, true, sag);
    at(5, &waypoints.retracted_above, true, sag);
    let rods = &steps[6].to[..3];
    assert!(rods[0] == rods[1] && rods[1] == rods[2], "{rods:?}");
}

#[test]
fn blends_follow_the_program_and_exclude_motions_in_a_slot() {
    let mut cell = cell();
    // High friction, so that no segment is slowed for it: a slowed segment has no friction left for an overlap.
    for arm in &mut cell.robot.arms {
        arm.effectors.iter_mut().for_each(|effector| effector.friction = 3.0);
    }
    let text = "BLEND 5 mm\nGET port-1 SLOT 3 WITH A\nBLEND OFF\nPUT port-2 SLOT 5 WITH A";
    let motion = plan_trajectory(&cell, steps(&cell, text), &TrajectoryOptions::default()).unwrap();
    let corners: Vec<Phase> = (0..motion.steps.len())
        .filter(|&step| motion.blend(step).is_some())
        .map(|step| motion.steps[step].phase)
        .collect();
    assert_eq!(corners, [Turn, Align, Retract]);
    let stated = (0..motion.steps.len()).filter_map(|step| motion.blend(step));
    assert!(stated.map(|blend| blend.deviation).fold(0.0, f64::max) <= 0.005);
}

#[test]
fn put_reverses_the_phases_of_get_in_a_tilted_station() {
    let cell = cell();
    let all = steps(&cell, "GET port-1 SLOT 3 WITH A\nPUT port-2 SLOT 5 WITH A");
    let put: Vec<Step> = all.into_iter().filter(|step| step.instruction == 1).collect();
    assert_eq!(phases(&put), [Turn, Align, Extend, Lower, Lower, Retract, Level]);
    let slot = SlotId { station: 1, slot: 5 };
    assert_eq!(put[3].handoff, Some(Handoff::Placed(A, slot)));
    let waypoints = cell.waypoints(A, slot, &put[0].from).unwrap();
    let pose = cell.wafer_pose(A, &put[3].to, true).unwrap();
    let sag = cell.sag(A).unwrap().plane_height;
    let rests = pose.translation.vector + waypoints.resting.normal * sag;
    assert!((rests - waypoints.resting.center).norm() < 1e-11);
    assert!((pose.rotation * Vector3::z() - waypoints.resting.normal).norm() < 1e-9);
    let below = cell.wafer_pose(A, &put[4].to, false).unwrap();
    assert!((below.translation.vector - waypoints.below.center).norm() < 1e-11);
    assert_eq!(put[4].loaded, []);
}

#[test]
fn via_points_are_passed_on_approach_and_retract() {
    let steps = steps(&cell(), "TRANSFER port-1 SLOT 1 TO process WITH A");
    let put: Vec<Step> = steps.into_iter().skip(7).collect();
    assert_eq!(phases(&put), [Turn, Align, Extend, Extend, Lower, Lower, Retract, Retract, Level]);
    assert!(put.iter().all(|step| step.instruction == 0));
}

#[test]
fn a_get_waits_for_the_end_of_the_process() {
    let text = "TRANSFER port-1 SLOT 1 TO process WITH A\nSWAP aligner GET A PUT B";
    // The aligner is not open to B.
    assert!(matches!(
        expand(&cell(), &parse(text).unwrap()).unwrap_err()[0].problem,
        ProgramProblem::NotAllowed { .. }
    ));
    let text = "TRANSFER port-1 SLOT 1 TO process WITH A\nGET port-1 SLOT 2 WITH B\nSWAP process GET A PUT B\nPUT port-1 SLOT 1 WITH A\nGET process WITH A";
    let steps = steps(&cell(), text);
    let waits: Vec<&Step> = steps.iter().filter(|step| step.phase == Wait).collect();
    let left = |effector| {
        let slot = SlotId { station: 3, slot: 1 };
        steps.iter().position(|step| step.handoff == Some(Handoff::Placed(effector, slot))).unwrap()
    };
    let [first, second] = waits[..] else { panic!("{waits:?}") };
    assert_eq!(first.path, Path::ProcessDwell { placed_at_step: left(A), seconds: 30.0 });
    assert_eq!(second.path, Path::ProcessDwell { placed_at_step: left(B), seconds: 30.0 });
    assert_eq!((first.instruction, second.instruction), (2, 4));
    assert_eq!(first.from, first.to);
    // Before the slot, not in it.
    let at = steps.iter().position(|step| step.phase == Wait).unwrap();
    assert_eq!((steps[at - 1].phase, steps[at + 1].phase), (Align, Extend));
    // A wafer of the initial occupancy is already processed.
    let mut done = cell();
    done.occupied.push(SlotId { station: 3, slot: 1 });
    let steps = self::steps(&done, "GET process WITH A");
    assert!(steps.iter().all(|step| step.phase != Wait));
}

#[test]
fn extended_arms_retract_before_the_next_turn() {
    let cell = cell();
    let all = steps(
        &cell,
        "MOVE T 20 deg R1 30 deg\nMOVE LINE WITH A BY Z 5 mm\nGOTO port-2 SLOT 1 WITH A",
    );
    assert_eq!(phases(&all), [Move, Move, RetractArms, Turn, Align]);
    let pose = |step: &Step, at: &[f64]| {
        assert!(step.loaded.is_empty());
        cell.wafer_pose(A, at, false).unwrap()
    };
    let (from, to) = (pose(&all[1], &all[1].from), pose(&all[1], &all[1].to));
    let moved = to.translation.vector - from.translation.vector;
    assert!((moved - Vector3::new(0.0, 0.0, 0.005)).norm() < 1e-11);
    assert!((from.rotation.matrix() - to.rotation.matrix()).amax() < 1e-12);
    assert_eq!(all[2].to[4], cell.robot.axes[4].home);
    // T alone leaves the arms in.
    assert_eq!(phases(&steps(&cell, "MOVE T 20 deg\nHOME\nHOME")), [Move, Move]);
    let home: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    let all = steps(&cell, "MOVE R1 30 deg T 10 deg\nHOME");
    assert_eq!(phases(&all), [Move, RetractArms, Move]);
    assert_eq!(all[2].to, home);
}

#[test]
fn a_tilt_keeps_the_height_on_the_axis() {
    let cell = cell();
    let all = steps(&cell, "TILT 0.5 deg TOWARD 90 deg\nTILT LEVEL\nWAIT 2 s\nWAIT 0 s");
    assert_eq!(phases(&all), [Move, Move, Wait, Wait]);
    let rods = [all[0].to[0], all[0].to[1], all[0].to[2]];
    let gpr = &cell.robot.gpr;
    assert!((gpr.plane_tilt(&rods).angle - 0.5_f64.to_radians()).abs() < 1e-14);
    assert!((gpr.plane_height(&rods).0 - 0.5).abs() < 1e-14);
    assert_eq!(all[2].path, Path::Dwell(2.0));
}

#[test]
fn counters_increase_and_decrease_slot_numbers() {
    let text = "REPEAT 2 AS n\n  TRANSFER port-1 SLOT n + 1 TO port-2 SLOT 6 - n WITH B\nEND";
    let handed: Vec<Handoff> =
        steps(&cell(), text).into_iter().filter_map(|step| step.handoff).collect();
    let slot = |station, slot| SlotId { station, slot };
    assert_eq!(
        handed,
        [
            Handoff::Picked(B, slot(0, 2)),
            Handoff::Placed(B, slot(1, 5)),
            Handoff::Picked(B, slot(0, 3)),
            Handoff::Placed(B, slot(1, 4)),
        ]
    );
}

/// Messages of all planning errors, with their places.
fn refused(cell: &Cell, text: &str) -> String {
    let errors = expand(cell, &parse(text).unwrap()).unwrap_err();
    let messages = errors.iter().map(|error| {
        let shown = explain(&cell.robot, text, error, DisplayUnits::Metric);
        assert_eq!(shown.with_excerpt("lot").lines().count(), 4);
        format!("{}:{}: {shown}\n", shown.place.line, shown.place.column)
    });
    messages.collect()
}

#[test]
fn planning_errors_name_their_line() {
    insta::assert_snapshot!(refused(&cell(), include_str!("programs/invalid-names.program")));
    insta::assert_snapshot!(refused(&cell(), include_str!("programs/invalid-wafers.program")));
    insta::assert_snapshot!(refused(&cell(), include_str!("programs/invalid-limits.program")));
}

#[test]
fn an_unknown_station_has_a_suggestion() {
    let text = "HOME\nGET prot-1 SLOT 3 WITH A  # typing";
    let cell = cell();
    let errors = expand(&cell, &parse(text).unwrap()).unwrap_err();
    assert_eq!(
        explain(&cell.robot, text, &errors[0], DisplayUnits::Metric).with_excerpt("lot.program"),
        "lot.program:2:5: the station `prot-1` is not known; known: port-1, port-2, aligner, process (did you mean `port-1`?)\n  |\n2 | GET prot-1 SLOT 3 WITH A  # typing\n  |     ^^^^^^"
    );
}

#[test]
fn slot_numbers_without_a_value_and_later_parameters_are_reported_as_such() {
    let divided = refused(&cell(), "REPEAT 2 AS n\n  GET port-1 SLOT 1 / (n - 1) WITH A\nEND\n");
    assert!(divided.contains("the slot number for station port-1 is infinite"), "{divided}");
    assert!(divided.contains("divides by zero"), "{divided}");
    let undefined = refused(&cell(), "GET port-1 SLOT sqrt(-1) WITH A\n");
    assert!(undefined.contains("is not a number"), "{undefined}");
    let later =
        "PARAMETER first = 2 * second\nPARAMETER second = 1\nGET port-1 SLOT first WITH A\n";
    let later = refused(&cell(), later);
    assert!(later.contains("1:23: the parameter `second` is declared later, in line 2"), "{later}");
    // A parameter of itself is not declared later.
    let itself = refused(&cell(), "PARAMETER own = own\nHOME\n");
    assert!(itself.contains("`own` is not known"), "{itself}");
}

#[test]
fn unreachable_targets_name_the_reason() {
    let mut far = cell();
    far.stations[0].base_from_station.translation.x = 0.9;
    far.stations[1].base_from_station.translation.z = 1.1;
    let steep = Tilt { azimuth: 0.0, angle: 5_f64.to_radians() };
    far.stations[2].base_from_station.rotation = tilt_rotation(&steep.normal());
    far.occupied.push(SlotId { station: 2, slot: 1 });
    let text =
        "REPEAT 3 AS n\n  GET port-1 SLOT n WITH A\n  PUT port-2 SLOT n WITH A\nEND\nGET aligner";
    insta::assert_snapshot!(refused(&far, text));
    // Each branch is listed if different limits reject them.
    let mut stiff = cell();
    (stiff.robot.axes[4].min, stiff.robot.axes[4].max) = (-0.5, 0.5);
    insta::assert_snapshot!(refused(&stiff, "GET port-1 SLOT 1 WITH A"));
}

#[test]
fn a_support_larger_than_the_wafer_is_reported_in_mm() {
    let mut wide = cell();
    wide.robot.arms[0].effectors[0].support = Support::ThreePoints { radius: 0.1525 };
    wide.robot.arms[1].effectors[0].support = Support::TwoRails { distance: 0.3011 };
    assert_eq!(
        refused(&wide, "GET port-1 SLOT 1 WITH A\nGET port-1 SLOT 2 WITH B"),
        "1:1: effector A does not carry the wafer: a circle of three points with a radius of 152.500 mm does not support a wafer of 300.000 mm: it must be more than 0 and at most 150.000 mm\n\
         2:1: effector B does not carry the wafer: a distance of two rails of 301.100 mm does not support a wafer of 300.000 mm: it must be more than 0 and at most 300.000 mm\n"
    );
}

#[test]
fn endless_and_too_long_programs_are_rejected() {
    let deep = MAX_CALL_DEPTH + 1;
    let chain: String = (0..deep)
        .map(|k| format!("ROUTINE r{k}\n  CALL r{}\nEND\n", k + 1))
        .chain([format!("ROUTINE r{deep}\n  HOME\nEND\nCALL r0\n")])
        .collect();
    // The depth of a call includes the depth of its caller.
    let sums: String = (1..3000)
        .map(|k| format!("ROUTINE s{k}\n  CALL s{}\nEND\nCALL s{k}\n", k - 1))
        .chain(["ROUTINE s0\n  HOME\nEND\n".to_owned()])
        .collect();
    let messages: String = [
        "HOME\nREPEAT 1000000000000\n  WAIT 0 s\nEND",
        "REPEAT 1000000000000\nEND",
        "REPEAT 1000000\n  REPEAT 1000000\n    REPEAT 1000000\n      REPEAT 100000\n        HOME\n      END\n    END\n  END\nEND",
        "CALL a\nROUTINE a\n  HOME\n  CALL b\nEND\nROUTINE b\n  CALL a\nEND",
        "ROUTINE a\n  CALL a\nEND\nCALL a",
        &"REPEAT 10000\n  HOME\nEND\n".repeat(3),
        &chain,
        &sums,
    ]
    .iter()
    .map(|text| refused(&cell(), text))
    .collect();
    insta::assert_snapshot!(messages);
    assert_eq!(MAX_INSTRUCTIONS, 20_000);
    // An endless program does not hide other errors; all are reported.
    let text = "REPEAT 100000\n  WAIT 1 s\nEND\nGET port-1 SLOT 99 WITH A\nCALL a\nMOVE T 9000 deg\nREPEAT 30000\nEND\nROUTINE a\n  CALL a\nEND\n";
    let messages = refused(&cell(), text);
    let lines: Vec<&str> = messages.lines().map(|line| line.split(':').next().unwrap()).collect();
    assert_eq!(lines, ["1", "4", "6", "7", "10"], "{messages}");
}

/// Positions from inverse kinematics are rounded, but not beyond a limit that they are at.
#[test]
fn moves_from_a_pose_at_the_largest_tilt_keep_it() {
    let mut at_the_limit = 0;
    for azimuth in (0..360).step_by(11) {
        let tilt = format!("azimuth_deg = {azimuth}.0, angle_deg = 1.5");
        let text = jointplay_format::cell::EXAMPLE;
        let text = text.replace("azimuth_deg = 100.0, angle_deg = 0.8", &tilt);
        let mut cell = jointplay_format::cell::read(&text, &mut |_| Err(String::new())).unwrap();
        cell.robot.arms.iter_mut().for_each(|arm| arm.droop = Droop::Rigid);
        let steps = |text: &str| expand(&cell, &parse(text).unwrap());
        let Ok(there) = steps("GOTO LP2 SLOT 5 WITH A\n") else { continue };
        let rods = &there.last().unwrap().to;
        let tilt = cell.robot.gpr.plane_tilt(&[rods[0], rods[1], rods[2]]).angle;
        at_the_limit += usize::from((tilt - cell.robot.gpr.limits().tilt_max).abs() < 1e-9);
        let moved = steps("GOTO LP2 SLOT 5 WITH A\nMOVE T 0 deg\n");
        assert!(moved.is_ok(), "{azimuth}: {moved:?}");
    }
    assert!(at_the_limit > 20, "{at_the_limit}");
}
