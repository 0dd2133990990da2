//! Robots of every kind that the inverse kinematics distinguishes, a cell around one, and its stations and steps.
#![allow(dead_code, reason = "each test uses some of them")]

use jointplay_cell::program::{Path, Phase, SourceLocation, Step};
use jointplay_cell::robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel,
};
use jointplay_cell::station::teach::FrameUncertainty;
use jointplay_cell::station::{Approach, Origin, Station, Stroke};
use jointplay_cell::wafer::{Droop, Material, Support, Wafer};
use jointplay_cell::workcell::Cell;
use jointplay_core::gpr::{Gpr, Limb};
use jointplay_core::spatial::Pose;

use AxisKind::{Linear, Rotary};

/// The first effector of the first arm.
pub(crate) const A: EffectorId = EffectorId { arm: 0, effector: 0 };
/// Standard gravity (m/s²).
pub(crate) const GRAVITY: f64 = 9.80665;

pub(crate) fn axis(name: &str, kind: AxisKind, min: f64, max: f64) -> Axis {
    let dynamics = KinematicLimits { velocity: 2.0, acceleration: 10.0, jerk: 100.0 };
    let home = 0.5 * (min + max);
    Axis { name: name.to_owned(), kind, min, max, home, empty: dynamics, loaded: dynamics }
}

pub(crate) fn joint(kind: AxisKind, zero: f64, drives: &[(usize, f64)], length: f64) -> ArmJoint {
    ArmJoint { kind, zero, drives: drives.to_vec(), length, offset: 0.0, rise: 0.012 }
}

pub(crate) fn arm(name: &str, joints: Vec<ArmJoint>, wafer: [f64; 3]) -> Arm {
    let effector = Effector {
        name: name.to_owned(),
        wafer_center: wafer,
        heading: 0.1,
        support: Support::Edge,
        friction: 0.4,
    };
    Arm {
        name: format!("arm {name}"),
        mount: [0.01, -0.02, 0.15],
        joints,
        effectors: vec![effector],
        droop: Droop::Rigid,
    }
}

/// The paper's robot on an uneven base, with arms and their motors.
pub(crate) fn robot(motors: Vec<Axis>, arms: Vec<Arm>) -> HybridRobot {
    let paper = Gpr::paper();
    let mut limbs: [Limb; 3] = paper.limbs();
    limbs[0].base_point.x += 2e-4;
    limbs[1].socket_radius += 1e-4;
    let gpr = Gpr::new(limbs, *paper.limits(), paper.working_height()).unwrap();
    let mut axes: Vec<Axis> = ["q1", "q2", "q3"]
        .map(|name| axis(name, Linear, gpr.limits().rod_min, gpr.limits().rod_max))
        .into();
    axes.extend(motors);
    let name = "test".to_owned();
    let model = PlatformModel::default();
    HybridRobot { name, gpr, model, axes, arms, assumed: Vec::new() }.checked().unwrap()
}

const WIDE: f64 = 2.9;

/// A kind of robot by its number, and the number of kinds.
pub(crate) const KINDS: usize = 11;

pub(crate) fn kind(number: usize, lengths: [f64; 3]) -> HybridRobot {
    let [a, b, w] = lengths;
    let t = || axis("T", Rotary, -3.4, 3.4);
    let turn = |name: &str| axis(name, Rotary, -WIDE, WIDE);
    let slide = |name: &str| axis(name, Linear, -0.1, 0.5);
    let half = std::f64::consts::FRAC_PI_2;
    let belt = |t: usize, r: usize, b: f64| {
        vec![
            joint(Rotary, -half, &[(t, 1.0), (r, 1.0)], b),
            joint(Rotary, 2.0 * half, &[(r, -2.0)], b),
            joint(Rotary, -half, &[(r, 1.0)], 0.0),
        ]
    };
    match number {
        // 1 : −2 : 1, the wafer straight ahead.
        0 => robot(vec![t(), turn("R")], vec![arm("A", belt(3, 4, a), [w, 0.0, 0.005])]),
        // The same arm, its wafer offset and its effector reversed.
        1 => robot(vec![t(), turn("R")], vec![arm("A", belt(3, 4, a), [-w, 0.03, 0.0])]),
        // Two such arms on one T axis.
        2 => robot(
            vec![t(), turn("R1"), turn("R2")],
            vec![arm("A", belt(3, 4, a), [w, 0.0, 0.0]), arm("B", belt(3, 5, b), [w, 0.01, 0.03])],
        ),
        // A prismatic joint.
        3 => {
            let joints =
                vec![joint(Rotary, 0.2, &[(3, 1.0)], 0.05), joint(Linear, 0.05, &[(4, 1.0)], 0.0)];
            robot(vec![t(), slide("R")], vec![arm("A", joints, [w, 0.04, 0.0])])
        }
        // Two links whose heading follows, with belts that make the revolutions a lattice of half revolutions.
        4 => {
            let joints = vec![
                joint(Rotary, 0.3, &[(3, 1.0), (4, 1.0)], a),
                joint(Rotary, -0.2, &[(4, -2.0)], 0.0),
            ];
            robot(vec![t(), turn("R")], vec![arm("A", joints, [b, 0.02, 0.0])])
        }
        // Three links.
        5 | 6 => {
            let mut joints = vec![
                joint(Rotary, 0.3, &[(3, 1.0)], a),
                joint(Rotary, -0.2, &[(4, 1.0)], b),
                joint(Rotary, 0.1, &[(5, 1.0)], 0.0),
            ];
            joints[0].offset = 0.02;
            if number == 6 {
                // A differential wrist.
                joints[1].drives = vec![(4, 0.5), (5, 0.5)];
                joints[2].drives = vec![(4, 1.0), (5, -1.0)];
            }
            robot(vec![t(), turn("J2"), turn("J3")], vec![arm("A", joints, [w, 0.01, 0.0])])
        }
        // A radial arm with a wrist.
        7 => {
            let mut joints = belt(3, 4, a);
            joints.push(joint(Rotary, 0.0, &[(5, 1.0)], 0.0));
            joints[2].length = 0.04;
            robot(vec![t(), turn("R"), turn("W")], vec![arm("A", joints, [w, 0.0, 0.0])])
        }
        // A prismatic joint with a wrist.
        8 => {
            let joints = vec![
                joint(Rotary, 0.2, &[(3, 1.0)], 0.05),
                joint(Linear, 0.05, &[(4, 1.0)], 0.02),
                joint(Rotary, 0.0, &[(5, 1.0)], 0.0),
            ];
            robot(vec![t(), slide("R"), turn("W")], vec![arm("A", joints, [w, 0.0, 0.0])])
        }
        // Four links.
        9 => {
            let joints = vec![
                joint(Rotary, 0.0, &[(3, 1.0)], a),
                joint(Rotary, 0.1, &[(4, 1.0)], b),
                joint(Rotary, 0.2, &[(5, 1.0)], 0.8 * b),
                joint(Rotary, 0.3, &[(6, 1.0)], 0.0),
            ];
            robot(
                vec![t(), turn("J2"), turn("J3"), turn("J4")],
                vec![arm("A", joints, [w, 0.0, 0.0])],
            )
        }
        // No closed form: a prismatic joint before a rotating link on a rotating link.
        _ => {
            let joints = vec![
                joint(Linear, 0.0, &[(3, 1.0)], 0.0),
                joint(Rotary, 0.0, &[(4, 1.0)], a),
                joint(Rotary, 0.0, &[(5, 1.0)], 0.0),
            ];
            robot(
                vec![axis("X", Linear, -0.4, 0.4), turn("J2"), turn("J3")],
                vec![arm("A", joints, [w, 0.0, 0.0])],
            )
        }
    }
}

/// A cell of a robot alone, without droop, whose first effector carries a wafer.
pub(crate) fn cell(robot: HybridRobot) -> Cell {
    let material =
        Material { name: "silicon".into(), young: 147e9, poisson: 0.18, density: 2329.0 };
    Cell {
        name: "test".into(),
        assumed: Vec::new(),
        robot,
        wafer: Wafer { diameter: 0.3, thickness: 775e-6, material },
        stations: Vec::new(),
        occupied: Vec::new(),
        loaded_effectors: vec![A],
        bodies: Vec::new(),
        allowed_pairs: Vec::new(),
        zones: Vec::new(),
        rules: jointplay_cell::station::WaferRules::default(),
        play_budget: 1e-2,
        clearance: 1e-3,
        slot_clearance: 1e-3,
        gravity: GRAVITY,
        plane_threshold: 1e-6,
        coverage_factor: 2.0,
        tolerances: jointplay_cell::displacement::Tolerances::default(),
    }
}

/// A station of one slot, which the first effector enters along radial lines.
pub(crate) fn station(name: &str, base_from_station: Pose) -> Station {
    Station {
        name: name.to_owned(),
        base_from_station,
        origin: Origin::Nominal,
        uncertainty: FrameUncertainty::UNKNOWN,
        slots: 1,
        pitch: 0.0,
        slot_step: [0.0; 2],
        stroke: Stroke { below: 0.002, above: 0.002, speed: 0.05 },
        offset: [0.0; 3],
        retract_reach: 0.0,
        via: Vec::new(),
        approach: Approach::Radial,
        effectors: vec![A],
        process_time: 0.0,
    }
}

/// A point-to-point motion of the robot, whose first effector carries a wafer, in line 10 plus the number of its instruction.
pub(crate) fn step(instruction: usize, from: &[f64], to: &[f64]) -> Step {
    Step {
        instruction,
        place: SourceLocation { line: instruction + 10, column: 1 },
        phase: Phase::Move,
        from: from.to_vec(),
        to: to.to_vec(),
        path: Path::PointToPoint,
        speed_scaling: 1.0,
        blend_radius: 0.0,
        postures: None,
        line_speed: None,
        loaded: vec![A],
        handoff: None,
        slot: None,
    }
}
