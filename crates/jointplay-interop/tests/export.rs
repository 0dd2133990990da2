//! Exported motions: duration, exact ends, and violations.

use jointplay_cell::check::{CheckOptions, PoseContext, check_pose};
use jointplay_cell::program::{Handoff, Path, Phase, SourceLocation, Step};
use jointplay_cell::robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel,
};
use jointplay_cell::station::teach::FrameUncertainty;
use jointplay_cell::station::{Approach, Origin, SlotId, Station, Stroke};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::{Droop, Material, Support, Wafer};
use jointplay_cell::workcell::Cell;
use jointplay_core::gpr::Gpr;
use jointplay_core::spatial::Pose;
use jointplay_core::virtualization::BuiltIn;
use jointplay_format::cell;
use jointplay_interop::export::dialect::{DIALECTS, Dialect};
use jointplay_interop::export::{
    Frame, MACRO, MotionExport, ViolationNote, frames, gltf, gltf_within, samples, solidworks,
    solidworks_names,
};
use jointplay_report::table::Values;
use nalgebra::SVector;
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};
use serde_json::Value;
use std::collections::BTreeMap;

use crate::planned::{example, planned};

const PROGRAM: &str = "HOME\nGET port WITH A\nWAIT 0.25\n";
const ID: EffectorId = EffectorId { arm: 0, effector: 0 };
const SLOT: SlotId = SlotId { station: 0, slot: 1 };

fn axis(name: &str, kind: AxisKind, [min, max, home]: [f64; 3]) -> Axis {
    let dynamics = KinematicLimits { velocity: 2.0, acceleration: 10.0, jerk: 100.0 };
    Axis { name: name.to_owned(), kind, min, max, home, empty: dynamics, loaded: dynamics }
}

/// A robot with one radial arm before one slot with a wafer.
fn cell() -> Cell {
    let gpr = Gpr::paper();
    let limits = *gpr.limits();
    let half = std::f64::consts::FRAC_PI_2;
    let joint = |zero: f64, drives: &[(usize, f64)], length: f64| ArmJoint {
        kind: AxisKind::Rotary,
        zero,
        drives: drives.to_vec(),
        length,
        offset: 0.0,
        rise: 0.01,
    };
    let arm = Arm {
        name: "upper".to_owned(),
        mount: [0.0, 0.0, 0.1],
        joints: vec![
            joint(-half, &[(3, 1.0), (4, 1.0)], 0.2),
            joint(2.0 * half, &[(4, -2.0)], 0.2),
            joint(-half, &[(4, 1.0)], 0.0),
        ],
        effectors: vec![Effector {
            name: "A".to_owned(),
            wafer_center: [0.2, 0.0, 0.004],
            heading: 0.0,
            support: Support::Edge,
            friction: 0.4,
        }],
        droop: Droop::Rigid,
    };
    let rod = |name: &str| {
        axis(name, AxisKind::Linear, [limits.rod_min, limits.rod_max, gpr.working_height()])
    };
    let axes = vec![
        rod("q1"),
        rod("q2"),
        rod("q3"),
        axis("T", AxisKind::Rotary, [-3.0, 3.0, 0.0]),
        axis("R", AxisKind::Rotary, [-1.5, 1.5, 0.2]),
    ];
    let robot = HybridRobot {
        name: "one arm".to_owned(),
        gpr,
        model: PlatformModel::default(),
        axes,
        arms: vec![arm],
        assumed: vec![],
    };
    let silicon =
        Material { name: "silicon".to_owned(), young: 147e9, poisson: 0.18, density: 2329.0 };
    Cell {
        name: "small".to_owned(),
        assumed: vec![],
        robot: robot.checked().unwrap(),
        wafer: Wafer { diameter: 0.3, thickness: 775e-6, material: silicon },
        stations: vec![Station {
            name: "port".to_owned(),
            base_from_station: Pose::translation(0.5, 0.1, 0.62),
            origin: Origin::Nominal,
            uncertainty: FrameUncertainty::UNKNOWN,
            slots: 1,
            pitch: 0.01,
            slot_step: [0.0; 2],
            stroke: Stroke { below: 0.005, above: 0.005, speed: 0.05 },
            offset: [0.0; 3],
            retract_reach: 0.3,
            via: vec![],
            approach: Approach::Radial,
            effectors: vec![ID],
            process_time: 0.0,
        }],
        occupied: vec![SLOT],
        loaded_effectors: vec![],
        bodies: vec![],
        allowed_pairs: vec![],
        zones: vec![],
        rules: jointplay_cell::station::WaferRules::default(),
        play_budget: 1e-4,
        clearance: 0.001,
        slot_clearance: 0.001,
        gravity: 9.81,
        plane_threshold: 1e-3,
        coverage_factor: 2.0,
        tolerances: jointplay_cell::displacement::Tolerances::default(),
    }
}

/// Extend, pick the wafer, retract, and wait.
fn motion(cell: &Cell) -> Trajectory {
    let home: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    let mut out = home.clone();
    (out[3], out[4]) = (0.7, 1.1);
    let step = |instruction: usize, phase, from: &[f64], to: &[f64], path| Step {
        instruction,
        place: SourceLocation { line: instruction + 1, column: 1 },
        phase,
        from: from.to_vec(),
        to: to.to_vec(),
        path,
        speed_scaling: 1.0,
        blend_radius: 0.0,
        postures: None,
        line_speed: None,
        loaded: vec![],
        handoff: None,
        slot: None,
    };
    let mut extend = step(1, Phase::Extend, &home, &out, Path::PointToPoint);
    extend.handoff = Some(Handoff::Picked(ID, SLOT));
    let mut retract = step(1, Phase::Retract, &out, &home, Path::PointToPoint);
    retract.loaded = vec![ID];
    let mut wait = step(2, Phase::Wait, &home, &home, Path::Dwell(0.25));
    wait.loaded = vec![ID];
    plan_trajectory(cell, vec![extend, retract, wait], &TrajectoryOptions::default()).unwrap()
}

fn violation_note() -> Vec<ViolationNote> {
    vec![ViolationNote {
        from: 0.1,
        to: 0.2,
        message: "line 2: slip: the wafer \"slips\"".to_owned(),
    }]
}

/// A cell that names a fixed body of an exported file has it at the same place.
fn assert_body_is_read_back(cell: &Cell, name: &str, file: &[u8]) {
    use jointplay_cell::geometry::Shape;
    let wall = "position_mm = [100.0, -600.0, 500.0]\nbox = { size_mm = [600.0, 20.0, 1000.0] }";
    let mesh = format!("mesh = {{ file = \"t.glb\", node = \"{name}\" }}");
    let example = jointplay_format::cell::EXAMPLE;
    assert!(example.contains(wall));
    let text = example.replacen(wall, &mesh, 1);
    let read = jointplay_format::cell::read(&text, &mut |_| Ok(file.to_vec())).unwrap();
    let found = read.bodies.iter().find(|body| body.name == "wall").unwrap();
    let Shape::Mesh { vertices, .. } = &found.shape else { panic!() };
    let body = cell.bodies.iter().find(|body| body.name == name).unwrap();
    let expected: Vec<nalgebra::Point3<f64>> = body
        .shape
        .surface()
        .vertices
        .into_iter()
        .map(|vertex| body.parent_from_shape * nalgebra::Point3::from(vertex))
        .collect();
    let nearest = |point: &nalgebra::Point3<f64>, all: &[nalgebra::Point3<f64>]| {
        all.iter().map(|other| (point - other).norm()).fold(f64::INFINITY, f64::min)
    };
    let vertices: Vec<_> = vertices.iter().map(|&vertex| nalgebra::Point3::from(vertex)).collect();
    assert!(vertices.iter().all(|vertex| nearest(vertex, &expected) < 1e-6), "{name}");
    assert!(expected.iter().all(|vertex| nearest(vertex, &vertices) < 1e-6), "{name}");
}

/// Runs a test with a motion without violations and one with a violation.
fn with(test: impl Fn(&MotionExport<'_>)) {
    let cell = cell();
    let motion = motion(&cell);
    for violation_notes in [vec![], violation_note()] {
        test(&MotionExport {
            cell: &cell,
            motion: &motion,
            program: PROGRAM,
            violation_notes: &violation_notes,
        });
    }
}

#[test]
fn a_table_ends_with_the_motion() {
    with(|motion_export| {
        let columns = samples(motion_export, 100.0).unwrap();
        let real = |name: &str| match &columns.iter().find(|one| one.name == name).unwrap().values {
            Values::Real(values) => values.clone(),
            Values::Count(_) => panic!("{name} is counted"),
        };
        let duration = motion_export.motion.duration();
        let time = real("time_s");
        assert_eq!(time.last(), Some(&duration));
        assert_eq!(time[7], 0.07);
        assert_eq!(real("T_deg").last(), Some(&0.0));
        let fastest = real("T_deg_per_s").into_iter().fold(0.0, f64::max);
        assert!(fastest > 10.0 && fastest <= 2_f64.to_degrees() + 1e-9, "{fastest}");
        let pose = motion_export
            .cell
            .robot
            .forward(&motion_export.motion.sample_at(0.0).positions)
            .unwrap();
        let x = pose.base_from_wafer[0][0].translation.vector.x;
        assert!((real("A_x_mm")[0] - 1e3 * x).abs() < 1e-9);
        let violations = columns.iter().find(|one| one.name == "violations");
        assert_eq!(violations.is_some(), !motion_export.violation_notes.is_empty());
        if let Some(violations) = violations {
            let Values::Count(counts) = &violations.values else { panic!("not counted") };
            assert_eq!((counts[0], counts[15], counts[30]), (0, 1, 0));
        }
    });
}

/// The description and the numbers of a binary glTF file.
fn parts(file: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
    let json = word(12);
    let numbers = 20 + json;
    assert_eq!(numbers + 8 + word(numbers), file.len());
    (serde_json::from_slice(&file[20..numbers]).unwrap(), file[numbers + 8..].to_vec())
}

/// The numbers of an accessor.
fn numbers(root: &Value, bytes: &[u8], accessor: usize) -> Vec<f32> {
    let accessor = &root["accessors"][accessor];
    let view =
        &root["bufferViews"][usize::try_from(accessor["bufferView"].as_u64().unwrap()).unwrap()];
    let index = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let start = index(&view["byteOffset"]);
    let bytes = &bytes[start..start + index(&view["byteLength"])];
    bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

#[test]
fn the_platform_pose_follows_the_robot_s_virtualization() {
    let mut shifts = Vec::new();
    for virtualization in [BuiltIn::Planar, BuiltIn::Radial, BuiltIn::Polar] {
        let mut cell = cell();
        cell.robot.model.virtualization = virtualization;
        let mut motion = motion(&cell);
        for step in &mut motion.steps {
            (step.from[0], step.to[0]) = (0.501, 0.501);
        }
        let motion = plan_trajectory(&cell, motion.steps, &TrajectoryOptions::default()).unwrap();
        let motion_export =
            MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
        let (root, _) = parts(&gltf(&motion_export, 50.0).unwrap());
        let nodes = root["nodes"].as_array().unwrap();
        let node = nodes.iter().find(|node| node["name"] == "platform").unwrap();
        let pose = cell.robot.forward(&motion.sample_at(0.0).positions).unwrap();
        let origin = pose.platform.base_from_platform.translation.vector;
        for k in 0..3 {
            let shown = node["translation"][k].as_f64().unwrap();
            assert!((shown - origin[k]).abs() < 1e-7 * origin[k].abs() + 1e-9, "{node} {origin}");
        }
        shifts.push(origin.xy());
        let columns = samples(&motion_export, 50.0).unwrap();
        let column = columns.iter().find(|one| one.name == "A_x_mm").unwrap();
        let Values::Real(values) = &column.values else { panic!("not real") };
        let x = pose.base_from_wafer[0][0].translation.vector.x;
        assert!((values[0] - 1e3 * x).abs() < 1e-9, "{values:?} {x}");
    }
    assert!((shifts[0] - shifts[1]).norm() > 1e-6 && (shifts[1] - shifts[2]).norm() > 1e-6);
}

#[test]
fn a_3d_scene_lasts_as_long_as_the_motion_and_its_wafer_is_carried() {
    with(|motion_export| {
        let (root, bytes) = parts(&gltf(motion_export, 60.0).unwrap());
        let index = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
        let animation = &root["animations"][0];
        let mut moved = Vec::new();
        for channel in animation["channels"].as_array().unwrap() {
            let sampler = &animation["samplers"][index(&channel["sampler"])];
            let times = numbers(&root, &bytes, index(&sampler["input"]));
            assert_eq!(times[0], 0.0);
            assert_eq!(*times.last().unwrap(), motion_export.motion.duration() as f32);
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
            let node = &root["nodes"][index(&channel["target"]["node"])];
            let values = numbers(&root, &bytes, index(&sampler["output"]));
            moved.push((
                node["name"].as_str().unwrap().to_owned(),
                channel["target"]["path"].clone(),
                values,
            ));
        }
        // Only the arm and the wafer move.
        let names: Vec<&str> = moved.iter().map(|(name, ..)| name.as_str()).collect();
        assert_eq!(
            names,
            ["upper link 1", "upper link 2", "upper link 3", "wafer of port 1", "wafer of port 1"]
        );
        let (_, _, places) = moved.iter().find(|(_, path, _)| path == "translation").unwrap();
        let robot = &motion_export.cell.robot;
        let at = |time: f64| {
            robot.forward(&motion_export.motion.sample_at(time).positions).unwrap().base_from_wafer
                [0][0]
        };
        let taken = at(motion_export.motion.times[1]);
        let slot = motion_export.cell.stations[0].slot_frame(1);
        let expected = at(motion_export.motion.duration()) * taken.inverse() * slot;
        // A key is the slope before it, the value, and the slope after it.
        let key = &places[places.len() - 9..];
        let last: Vec<f64> = key[3..6].iter().map(|&one| f64::from(one)).collect();
        assert_eq!((&key[..3], &key[6..]), (&[0.0; 3][..], &[0.0; 3][..]));
        let off = nalgebra::Vector3::from_row_slice(&last) - expected.translation.vector;
        assert!(off.norm() < 1e-6, "{off}");
        let warned = root["asset"]["extras"]["warning"].is_string();
        assert_eq!(warned, !motion_export.violation_notes.is_empty());
        assert_eq!(
            root["asset"]["extras"]["duration_s"].as_f64().unwrap(),
            motion_export.motion.duration()
        );
    });
}

#[test]
fn droop_is_the_same_in_programs_and_in_jogging() {
    let cell = example();
    let motion = planned(&cell, "HOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\n");
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: "", violation_notes: &[] };
    let pose = |frames: &[Frame], name: &str| {
        let frame = frames.iter().find(|frame| frame.name == name).unwrap();
        let [x, y, z] = frame.place;
        let [i, j, k, w] = frame.turn;
        let turn = nalgebra::Unit::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
        Pose::from_parts(nalgebra::Translation3::new(x, y, z), turn.to_rotation_matrix())
    };
    let mut drops = Vec::new();
    for (k, step) in motion.steps.iter().enumerate() {
        // Within the step: a hand-off may occur at its end.
        let time = 0.5 * (motion.times[k] + motion.times[k + 1]);
        let at = motion.sample_at(time).positions;
        let (frames, carried) = frames(&motion_export, time, &at).unwrap();
        assert_eq!(carried, step.loaded);
        let rigid = cell.robot.forward(&at).unwrap();
        let last = (1..=4).fold(pose(&frames, "platform"), |link, number| {
            link * pose(&frames, &format!("upper link {number}"))
        });
        let shown = last * rigid.base_from_link[0][3].inverse() * rigid.base_from_wafer[0][0];
        let drooping = cell.wafer_pose(ID, &at, step.loaded.contains(&ID)).unwrap();
        let off = (shown.translation.vector - drooping.translation.vector).norm();
        let turned = (shown.rotation.matrix() - drooping.rotation.matrix()).norm();
        assert!(off < 1e-8 && turned < 1e-10, "{k}: {off} {turned}");
        let drop = rigid.base_from_wafer[0][0].translation.z - shown.translation.z;
        drops.push(drop);
        // The table has the same values.
        let columns = samples(&motion_export, 1.0 / time).unwrap();
        let column = columns.iter().find(|one| one.name == "A_z_mm").unwrap();
        let Values::Real(values) = &column.values else { panic!("not real") };
        assert!((values[1] - 1e3 * drooping.translation.z).abs() < 1e-6, "{k}: {values:?}");
    }
    // No droop of the folded arm, half a millimetre of the extended one.
    assert!(drops.iter().all(|drop| (-1e-9..6e-4).contains(drop)), "{drops:?}");
    assert!(drops.iter().any(|drop| *drop > 5e-4), "{drops:?}");
    // The wafer rests in its slots within a micrometre, and the file lists the times.
    let end = motion.duration();
    let (frames, _) = frames(&motion_export, end, &motion.sample_at(end).positions).unwrap();
    let slot = cell.stations[3].slot_frame(1);
    let off = pose(&frames, "wafer of LP1 1").translation.vector - slot.translation.vector;
    assert!(off.norm() < 1e-6, "{off}");
    let file = gltf(&motion_export, 50.0).unwrap();
    for name in ["LP1-left", "slit-above", "LP2-back"] {
        assert_body_is_read_back(&cell, name, &file);
    }
    let (root, _) = parts(&file);
    let nodes = root["nodes"].as_array().unwrap();
    let named = |name: &str| nodes.iter().find(|node| node["name"] == name).unwrap();
    // Slots and bodies of a station refer to it.
    for (name, station) in [("LP1-left", "LP1"), ("LP2 25", "LP2"), ("process-right", "PM1")] {
        assert_eq!(named(name)["extras"]["station"], station);
    }
    for name in ["wall", "slit-below", "optics"] {
        assert!(named(name).get("extras").is_none(), "{name}");
    }
    let node = named("wafer of LP1 1");
    let handed: Vec<f64> = motion
        .steps
        .iter()
        .zip(&motion.times[1..])
        .filter_map(|(step, &time)| step.handoff.map(|_| time))
        .collect();
    let lies = serde_json::json!([
        { "slot": "LP1 1", "from_s": 0.0, "to_s": handed[0] },
        { "slot": "PM1 1", "from_s": handed[1], "to_s": end },
    ]);
    assert_eq!((node["extras"]["lies"].clone(), handed.len()), (lies, 2));
}

#[test]
fn durations_of_controller_text_add_up_to_the_motion() {
    with(|motion_export| {
        let text = Dialect::neutral().write(motion_export, 100.0).unwrap();
        let mut total = 0_i64;
        for line in text.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            if matches!(words[0], "MOVE" | "LINE" | "WAIT") {
                total += words[1].replace('.', "").parse::<i64>().unwrap();
            }
        }
        let duration = motion_export.motion.duration();
        assert_eq!(total, (duration * 1e6).round() as i64);
        assert!(text.ends_with(&format!("END {duration:.6}\n")), "{text}");
        assert!(text.contains("TAKE A port 1\nMOVE "), "{text}");
        assert!(text.contains("# line 2: GET port WITH A\nMOVE "), "{text}");
        assert_eq!(
            text.starts_with("# NOT SAFE TO RUN: 1 violation"),
            !motion_export.violation_notes.is_empty()
        );
    });
}

#[test]
fn controller_text_contains_the_overlap_of_blends() {
    let cell = cell();
    let [out, back] = [0, 1].map(|k| motion(&cell).steps[k].clone());
    let mut steps = vec![Step { handoff: None, ..out }, Step { loaded: vec![], ..back }];
    steps.iter_mut().for_each(|step| step.blend_radius = 0.05);
    let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    let overlap = motion.blend(0).unwrap().overlap;
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    let text = Dialect::neutral().write(&motion_export, 100.0).unwrap();
    let words: Vec<Vec<&str>> = text.lines().map(|line| line.split(' ').collect()).collect();
    let commands: Vec<_> = words.iter().filter(|words| !words[0].starts_with('#')).collect();
    assert_eq!(commands[2][0], "MOVE", "{text}");
    assert_eq!(commands[3], &["BLEND", &format!("{overlap:.6}")], "{text}");
    assert_eq!(commands[4][0], "MOVE", "{text}");
    let lasts = |k: usize| commands[k][1].parse::<f64>().unwrap();
    assert!((lasts(2) + lasts(4) - motion.duration()).abs() < 2e-6);
}

#[test]
fn a_wait_of_zero_length_is_not_exported() {
    let cell = cell();
    let mut steps = motion(&cell).steps;
    let wait = Path::ProcessDwell { placed_at_step: 0, seconds: 0.1 };
    steps.insert(2, Step { path: wait, ..steps[2].clone() });
    let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    assert_eq!(motion.times[2], motion.times[3]);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    let text = Dialect::neutral().write(&motion_export, 100.0).unwrap();
    let lines = text.lines().map(|line| line.split(' ').take(2).collect::<Vec<_>>());
    let waits: Vec<_> = lines.filter(|words| words[0] == "WAIT").collect();
    assert_eq!(waits, [["WAIT", "0.250000"]]);
    #[cfg(feature = "mcap")]
    {
        let file = jointplay_interop::export::mcap::write(&motion_export, 100.0).unwrap();
        let messages = mcap::MessageStream::new(&file).unwrap().map(Result::unwrap);
        let trajectories = messages.filter(|one| one.channel.topic == "/joint_trajectory");
        assert_eq!(trajectories.count(), 3);
    }
    // The remaining steps keep their numbers.
    let columns = samples(&motion_export, 100.0).unwrap();
    let column = columns.iter().find(|one| one.name == "step").unwrap();
    let Values::Count(mut numbers) = column.values.clone() else { panic!("not counted") };
    numbers.dedup();
    assert_eq!(numbers, [1, 2, 4]);
}

#[test]
fn controller_text_of_every_dialect() {
    let cell = cell();
    let motion = motion(&cell);
    let violation_notes = violation_note();
    let motion_export = MotionExport {
        cell: &cell,
        motion: &motion,
        program: PROGRAM,
        violation_notes: &violation_notes,
    };
    for entry in DIALECTS {
        let dialect = Dialect::parse(entry.text).unwrap();
        insta::assert_snapshot!(entry.name, dialect.write(&motion_export, 5.0).unwrap());
    }
}

#[test]
fn each_motor_of_solidworks_has_a_file_as_long_as_the_motion() {
    with(|motion_export| {
        let files = solidworks(motion_export, 100.0, 1e-6).unwrap();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        let (last, motors) = names.split_last().unwrap();
        assert!(last.ends_with(MACRO), "{last}");
        // The planar model has two virtual joints at each ball.
        assert_eq!(motors.len(), motion_export.cell.robot.axes.len() + 6);
        let (macro_text, motor_files) = files.split_last().unwrap();
        for (name, text) in motor_files {
            let (time, _) = text.lines().last().unwrap().split_once(',').unwrap();
            assert_eq!(time.parse::<f64>().unwrap(), motion_export.motion.duration(), "{name}");
            assert!(macro_text.1.contains(&format!("folder & \"{name}\"")), "{name}");
            let load = macro_text.1.lines().find(|line| line.contains(name.as_str())).unwrap();
            let axis = |axis: &&Axis| load.contains(&format!("Load \"{}\",", axis.name));
            let axis = motion_export.cell.robot.axes.iter().find(axis);
            assert!(axis.is_some() || load.contains("Load \"play "), "{load}");
            let is_rotary = axis.is_some_and(|axis| axis.kind == AxisKind::Rotary);
            let kind = if is_rotary { "swFmAEMRotationalMotor" } else { "swFmAEMLinearMotor" };
            assert!(load.trim_end().ends_with(&format!(", {kind}")), "{load}");
            assert_eq!(name.starts_with("NOT-SAFE"), !motion_export.violation_notes.is_empty());
        }
        assert_eq!(
            macro_text.1.contains("MsgBox \"NOT SAFE"),
            !motion_export.violation_notes.is_empty()
        );
        // A quotation mark within a string of Visual Basic is written twice.
        assert!(motion_export.violation_notes.is_empty() || macro_text.1.contains("\"\"slips\"\""));
    });
}

#[test]
fn motors_of_like_names_have_files_of_their_own() {
    let mut cell = cell::read(cell::EXAMPLE, &mut |_| Err(String::new())).unwrap();
    let plain = solidworks_names(&cell);
    for (axis, name) in [(3, "play_u1"), (4, "PLAY-U1")] {
        cell.robot.axes[axis].name = name.to_owned();
    }
    let names = solidworks_names(&cell);
    let different: std::collections::BTreeSet<String> =
        names.iter().map(|name| name.to_ascii_lowercase()).collect();
    assert_eq!((names.len(), different.len()), (plain.len(), plain.len()), "{names:?}");
}

/// Motors of the play follow the poses of the platform, and no curve deviates from its samples by more than the tolerance.
#[test]
fn curves_of_motors_are_reduced_within_the_tolerance() {
    with(|motion_export| {
        let robot = &motion_export.cell.robot;
        let rate = 200.0;
        let samples: Vec<_> = motion_export.motion.samples(rate).collect();
        let mut counts = vec![samples.len() * (robot.axes.len() + 6)];
        for tolerance in [1e-6, 1e-4] {
            let mut count = 0;
            let files = solidworks(motion_export, rate, tolerance).unwrap();
            for (index, (name, text)) in files[..files.len() - 1].iter().enumerate() {
                let points: Vec<(f64, f64)> = text
                    .lines()
                    .map(|line| line.split_once(',').unwrap())
                    .map(|(time, value)| (time.parse().unwrap(), value.parse().unwrap()))
                    .collect();
                count += points.len();
                let (mut segment, mut largest) = (0, 0.0_f64);
                for at in &samples {
                    while points[segment + 1].0 < at.time {
                        segment += 1;
                    }
                    let [(s, x), (t, y)] = [points[segment], points[segment + 1]];
                    let found = x + (y - x) * (at.time - s) / (t - s);
                    let axis = robot.axes.get(index);
                    let (value, allowed) = match axis {
                        // The farthest point of a wafer is at least half a metre from each axis.
                        Some(axis) if axis.kind == AxisKind::Rotary => {
                            (at.positions[index].to_degrees(), tolerance.to_degrees())
                        }
                        Some(_) => (1e3 * at.positions[index], 1e3 * tolerance),
                        None => {
                            let rods = [0, 1, 2].map(|k| at.positions[k]);
                            let pose = robot.model.forward(&robot.gpr, rods).unwrap();
                            let of = &jointplay_core::virtualization::Planar;
                            let moved = robot.gpr.virtual_displacements(&pose, of);
                            (1e3 * moved[index - robot.axes.len()], 1e3 * tolerance)
                        }
                    };
                    largest = largest.max((found - value).abs() / allowed);
                }
                assert!(
                    largest <= 2.0 && (axis_is_rotary(robot, index) || largest <= 1.0 + 1e-6),
                    "{name}: {largest}"
                );
            }
            counts.push(count);
        }
        // A larger tolerance leaves fewer points.
        assert!(counts.windows(2).all(|pair| 4 * pair[1] < 3 * pair[0]), "{counts:?}");
    });
}

fn axis_is_rotary(robot: &jointplay_cell::robot::HybridRobot, index: usize) -> bool {
    robot.axes.get(index).is_some_and(|axis| axis.kind == AxisKind::Rotary)
}

/// The macro read as Visual Basic: blocks are closed, each name is declared, a member, or known to SolidWorks or to Visual Basic.
#[test]
fn the_macro_is_well_formed() {
    const KNOWN: [&str; 60] = [
        "and",
        "application",
        "as",
        "attribute",
        "boolean",
        "byref",
        "byval",
        "const",
        "dim",
        "each",
        "else",
        "elseif",
        "end",
        "exit",
        "explicit",
        "false",
        "for",
        "function",
        "if",
        "in",
        "instrrev",
        "is",
        "isarray",
        "lbound",
        "left",
        "long",
        "mod",
        "msgbox",
        "next",
        "not",
        "nothing",
        "object",
        "on",
        "option",
        "or",
        "private",
        "public",
        "set",
        "simulationmotorfeaturedata",
        "sldworks",
        "step",
        "string",
        "sub",
        "swfmaemlinearmotor",
        "swfmaemrotationalmotor",
        "swsimulationmotordrive_displacement",
        "then",
        "to",
        "true",
        "ubound",
        "until",
        "variant",
        "vb_name",
        "vbexclamation",
        "wend",
        "while",
        "with",
        "double",
        "integer",
        "split",
    ];
    with(|motion_export| {
        let (_, text) = jointplay_interop::export::loader(motion_export);
        assert!(text.ends_with("\r\n") && text.is_ascii());
        let mut names: std::collections::BTreeSet<String> =
            KNOWN.iter().map(|name| (*name).to_owned()).collect();
        let mut lines: Vec<Vec<String>> = Vec::new();
        for line in text.lines() {
            assert!(line.len() < 1024, "the editor cuts longer lines: {line}");
            // Strings alternate with code; a comment ends the code.
            let mut code = String::new();
            for (part, piece) in line.split('"').enumerate() {
                if part % 2 == 1 {
                    code.push('#');
                    continue;
                }
                let (before, comment) =
                    piece.split_once('\'').map_or((piece, false), |it| (it.0, true));
                code.push_str(before);
                if comment {
                    break;
                }
            }
            assert!(code.matches('(').count() == code.matches(')').count(), "{line}");
            let code = code.replace('.', " .");
            let is_letter =
                |letter: char| letter.is_alphanumeric() || letter == '_' || letter == '.';
            let words: Vec<String> = code
                .split(|letter: char| !is_letter(letter))
                .filter(|word| {
                    !word.is_empty() && !word.starts_with(|first: char| first.is_ascii_digit())
                })
                .map(str::to_lowercase)
                .collect();
            for (k, word) in words.iter().enumerate() {
                let follows = |before: &[&str]| k > 0 && before.contains(&words[k - 1].as_str());
                let declares = follows(&["dim", "const", "sub", "function"])
                    || words.get(k + 1).is_some_and(|next| next == "as");
                if declares || (words[0] == "dim" && line.contains(&format!("{word}("))) {
                    names.insert(word.clone());
                }
            }
            lines.push(words);
        }
        let mut open: Vec<&str> = Vec::new();
        for words in &lines {
            for word in words.iter().filter(|word| !word.starts_with('.')) {
                assert!(names.contains(word), "{word} is not declared");
            }
            let first = words.first().map_or("", String::as_str);
            let second = words.get(1).map_or("", String::as_str);
            match (first, second) {
                ("private", kind @ ("sub" | "function")) => open.push(kind),
                ("sub" | "function" | "for", _) => open.push(first),
                ("if", _) if words.last().is_some_and(|last| last == "then") => open.push("if"),
                ("end", kind) => assert_eq!(open.pop(), Some(kind)),
                ("next", _) => assert_eq!(open.pop(), Some("for")),
                _ => {}
            }
        }
        assert!(open.is_empty(), "{open:?}");
    });
}

#[test]
fn invalid_sampling_rates_are_rejected() {
    let cell = cell();
    let motion = motion(&cell);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e12] {
        assert!(samples(&motion_export, rate).is_err(), "{rate}");
        assert!(gltf(&motion_export, rate).is_err(), "{rate}");
        assert!(solidworks(&motion_export, rate, 1e-6).is_err(), "{rate}");
        assert!(solidworks(&motion_export, 100.0, rate - 1e12).is_err(), "{rate}");
        assert!(Dialect::neutral().write(&motion_export, rate).is_err(), "{rate}");
    }
}

#[cfg(feature = "mcap")]
#[test]
fn mcap_has_every_sample_and_the_steps() {
    use std::collections::BTreeMap;

    with(|motion_export| {
        let file = jointplay_interop::export::mcap::write(motion_export, 100.0).unwrap();
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let mut last = 0;
        for message in mcap::MessageStream::new(&file).unwrap() {
            let message = message.unwrap();
            *counts.entry(message.channel.topic.clone()).or_default() += 1;
            last = last.max(message.log_time);
            assert_eq!(message.channel.message_encoding, "cdr");
        }
        assert_eq!(last, (motion_export.motion.duration() * 1e9).round() as u64);
        let rows = motion_export.motion.samples(100.0).count();
        assert_eq!((counts["/joint_states"], counts["/tf"]), (rows, rows));
        assert_eq!((counts["/joint_trajectory"], counts["/program"]), (3, 2));
        assert_eq!(
            counts.get("/violations").copied().unwrap_or(0),
            motion_export.violation_notes.len()
        );
    });
}

/// Times, and three values for each.
type Keys = (Vec<f32>, Vec<f32>);

/// Position and rotation of animated nodes, as a viewer interpolates them.
struct Animated<'a> {
    root: &'a Value,
    /// By node and path.
    channels: BTreeMap<(usize, &'a str), Keys>,
}

impl<'a> Animated<'a> {
    fn new(root: &'a Value, bytes: &[u8]) -> Self {
        let index = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
        let animation = &root["animations"][0];
        let channels = animation["channels"].as_array().unwrap().iter().map(|channel| {
            let sampler = &animation["samplers"][index(&channel["sampler"])];
            assert_eq!(sampler["interpolation"], "CUBICSPLINE");
            let [times, values] =
                ["input", "output"].map(|which| numbers(root, bytes, index(&sampler[which])));
            let target = &channel["target"];
            ((index(&target["node"]), target["path"].as_str().unwrap()), (times, values))
        });
        Self { root, channels: channels.collect() }
    }

    /// The value of a path, by the cubics of the specification.
    fn value<const N: usize>(&self, node: usize, path: &str, time: f64) -> SVector<f64, N> {
        let Some((times, values)) = self.channels.get(&(node, path)) else {
            let at = &self.root["nodes"][node][path];
            return SVector::from_fn(|k, _| at[k].as_f64().unwrap());
        };
        let number = |key: usize, part: usize| {
            SVector::<f64, N>::from_fn(|k, _| f64::from(values[(3 * key + part) * N + k]))
        };
        let after = times.partition_point(|&at| f64::from(at) <= time).clamp(1, times.len() - 1);
        let [from, to] = [after - 1, after].map(|key| f64::from(times[key]));
        let (span, s) = (to - from, ((time - from) / (to - from)).min(1.0));
        let (s2, s3) = (s * s, s * s * s);
        (2.0 * s3 - 3.0 * s2 + 1.0) * number(after - 1, 1)
            + span * (s3 - 2.0 * s2 + s) * number(after - 1, 2)
            + (3.0 * s2 - 2.0 * s3) * number(after, 1)
            + span * (s3 - s2) * number(after, 0)
    }
}

#[test]
fn a_3d_scene_follows_the_motion_between_keys() {
    let cell = example();
    // Late in a long motion, where single precision resolves times only to about 30 µs unless the rate is a power of two.
    let text = "WAIT 800 s\nHOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nTRANSFER PM1 TO LP2 SLOT 25 WITH B\nHOME\n";
    let motion = planned(&cell, text);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: text, violation_notes: &[] };
    let rate = 32.0;
    let (root, bytes) = parts(&gltf(&motion_export, rate).unwrap());
    let scene = Animated::new(&root, &bytes);
    let nodes = root["nodes"].as_array().unwrap();
    let wafer = nodes.iter().position(|node| node["name"] == "wafer of LP1 1").unwrap();
    // At the hand-off the arm droops at once; a viewer spreads this over the time between two keys.
    let ends = motion.steps.iter().zip(&motion.times[1..]);
    let handed: Vec<f64> =
        ends.filter(|(step, _)| step.handoff.is_some()).map(|(_, &time)| time).collect();
    let between = |at: f64| handed.iter().all(|time| (time - at).abs() > 1.0 / rate);
    let (mut off, mut turned) = (0_f64, 0_f64);
    let fine = motion.samples(5.0 * rate).filter(|at| at.time > 800.0 && between(at.time));
    for at in fine {
        let (frames, _) = frames(&motion_export, at.time, &at.positions).unwrap();
        let real = frames.iter().find(|frame| frame.name == "wafer of LP1 1").unwrap();
        let place = scene.value::<3>(wafer, "translation", at.time);
        off = off.max((place - SVector::from(real.place)).norm());
        let (turn, real) = (scene.value::<4>(wafer, "rotation", at.time), SVector::from(real.turn));
        let turn = turn.normalize();
        turned = turned.max(2.0 * (turn - real).norm().min((turn + real).norm()));
    }
    // Of the samples 6 µm, and of the keys that are omitted the tolerance of 1 µm.
    assert!(off > 0.0 && off < 7e-6 && turned < 25e-6, "{off} m, {turned} rad");
}

#[test]
fn the_check_and_the_3d_scene_have_the_same_poses() {
    // Small balls: on every link, on the platform, and four next to the robot as references.
    let mut text = cell::EXAMPLE.to_owned();
    let mut balls: Vec<(String, String)> = Vec::new();
    for (k, arm) in ["upper", "lower"].iter().enumerate() {
        for link in 1..=4 {
            let on = format!("on = {{ arm = \"{arm}\", link = {link} }}");
            balls.push((format!("ball-{k}{link}"), on));
        }
    }
    balls.push(("ball-platform".to_owned(), "on = \"platform\"".to_owned()));
    let place = |k: usize| [70.0 + 9.0 * k as f64, 11.0 * k as f64 - 40.0, 5.0 - 2.0 * k as f64];
    let ball = |name: &str, on: &str, at: [f64; 3]| {
        let shape = "capsule = { from_mm = [0, 0, 0], to_mm = [0, 0, 0.0001], radius_mm = 1.0 }";
        format!("[[body]]\nname = \"{name}\"\n{on}\nposition_mm = {at:?}\n{shape}\n")
    };
    let markers =
        [[900.0, 0.0, 900.0], [-500.0, 700.0, 300.0], [0.0, -900.0, 1100.0], [100.0, 90.0, 1300.0]];
    for (k, (name, on)) in balls.iter().enumerate() {
        text += &ball(name, on, place(k));
    }
    for (k, at) in markers.iter().enumerate() {
        text += &ball(&format!("marker-{k}"), "", *at);
    }
    let cell = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap();
    let program = "TRANSFER LP1 SLOT 25 TO PM1 WITH B\nTRANSFER PM1 TO LP2 SLOT 25 WITH A\n";
    let motion = planned(&cell, program);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: "", violation_notes: &[] };
    let rate = 64.0;
    let (root, bytes) = parts(&gltf(&motion_export, rate).unwrap());
    let scene = Animated::new(&root, &bytes);
    let nodes = root["nodes"].as_array().unwrap();
    let mut parents = vec![0; nodes.len()];
    for (k, node) in nodes.iter().enumerate() {
        for child in node["children"].as_array().into_iter().flatten() {
            parents[usize::try_from(child.as_u64().unwrap()).unwrap()] = k;
        }
    }
    // Where a node's origin is in the frame of the first one, which is the base.
    let origin = |name: &str, time: f64| {
        let mut node = nodes.iter().position(|node| node["name"] == name).unwrap();
        let mut at = SVector::<f64, 3>::zeros();
        while node != 0 {
            let has = |path: &str| {
                scene.channels.contains_key(&(node, path)) || nodes[node].get(path).is_some()
            };
            if has("rotation") {
                let [x, y, z, w] = scene.value::<4>(node, "rotation", time).into();
                let turn = nalgebra::Quaternion::new(w, x, y, z);
                at = nalgebra::Unit::new_normalize(turn) * at;
            }
            if has("translation") {
                at += scene.value::<3>(node, "translation", time);
            }
            node = parents[node];
        }
        at
    };
    let handed: Vec<f64> = motion
        .steps
        .iter()
        .zip(&motion.times[1..])
        .filter_map(|(step, &time)| step.handoff.map(|_| time))
        .collect();
    let options = CheckOptions { report_distance: 10.0, ..CheckOptions::default() };
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let (mut compared, mut lowest) = (0, 0.0_f64);
    while compared < 24 {
        let keys = (motion.duration() * rate) as u64;
        // At a key, so that nothing is interpolated.
        let time = random.random_range(0..keys) as f64 / rate;
        if handed.iter().any(|at| (at - time).abs() < 2.0 / rate) {
            continue;
        }
        compared += 1;
        let positions = motion.sample_at(time).positions;
        let moment = PoseContext { trajectory: &motion, time, slot_access: None };
        let report = check_pose(&cell, &moment, &positions, &options).unwrap();
        for (name, _) in &balls {
            let shown = origin(name, time);
            for (k, at) in markers.iter().enumerate() {
                let marker = SVector::from(at.map(|mm| 1e-3 * mm));
                let expected = (shown - marker).norm() - 2e-3;
                let pair = [name.clone(), format!("marker-{k}")];
                let row = report.distances.iter().find(|row| {
                    let names = row.entities.map(|one| cell.entity_name(one));
                    names == pair || names == [pair[1].clone(), pair[0].clone()]
                });
                let found = row.unwrap().distance;
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{name} to marker {k} at {time} s: {found} by the check, {expected} shown"
                );
            }
        }
        let rigid = cell.robot.forward(&positions).unwrap();
        let tip = rigid.base_from_link[0][3] * nalgebra::Point3::from(place(3).map(|mm| 1e-3 * mm));
        lowest = lowest.max(tip.z - origin("ball-04", time).z);
    }
    // The arm deflects visibly in some of these poses.
    assert!(lowest > 2e-4, "{lowest}");
}

#[test]
fn fewer_keys_stay_within_the_tolerance() {
    let cell = example();
    let text =
        "HOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nTRANSFER PM1 TO LP2 SLOT 25 WITH B\nHOME\n";
    let motion = planned(&cell, text);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: text, violation_notes: &[] };
    let rate = 100.0;
    // A tolerance below round-off omits samples only where nothing moves.
    let dense = gltf_within(&motion_export, rate, 1e-12).unwrap();
    let (root, bytes) = parts(&gltf_within(&motion_export, rate, 1e-6).unwrap());
    assert!(bytes.len() * 4 <= dense.len(), "{} of {} bytes", bytes.len(), dense.len());
    let scene = Animated::new(&root, &bytes);
    let nodes = root["nodes"].as_array().unwrap();
    let named = |name: &str| nodes.iter().position(|node| node["name"] == name).unwrap();
    let mut parents = vec![usize::MAX; nodes.len()];
    for (k, node) in nodes.iter().enumerate() {
        for child in node["children"].as_array().into_iter().flatten() {
            parents[usize::try_from(child.as_u64().unwrap()).unwrap()] = k;
        }
    }
    let pose = |place: SVector<f64, 3>, turn: SVector<f64, 4>| {
        let turn = nalgebra::Quaternion::new(turn[3], turn[0], turn[1], turn[2]);
        let turn = nalgebra::Unit::new_normalize(turn).to_rotation_matrix();
        Pose::from_parts(nalgebra::Translation3::from(place), turn)
    };
    let (mut worst, mut compared) = (0.0_f64, 0);
    for sample in motion.samples(rate).step_by(7) {
        let (frames, _) = frames(&motion_export, sample.time, &sample.positions).unwrap();
        let tracks: BTreeMap<usize, &Frame> =
            frames.iter().map(|frame| (named(&frame.name), frame)).collect();
        for &node in tracks.keys() {
            let (mut shown, mut real) = (Pose::identity(), Pose::identity());
            let mut at = node;
            while let Some(frame) = tracks.get(&at) {
                let place = scene.value::<3>(at, "translation", sample.time);
                let turn = scene.value::<4>(at, "rotation", sample.time);
                shown = pose(place, turn) * shown;
                real = pose(frame.place.into(), frame.turn.into()) * real;
                at = parents[at];
            }
            // The rim of a wafer.
            let rim = nalgebra::Point3::new(0.15, 0.0, 0.0);
            worst = worst.max((shown * rim - real * rim).norm());
            compared += 1;
        }
    }
    // Positions, and numbers in single precision at a metre.
    assert!(compared > 500 && worst < 1.3e-6, "{worst} m in {compared} poses");
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert!(gltf_within(&motion_export, rate, tolerance).is_err());
    }
}
