//! The numbers that the WebAssembly module is compared with in JavaScript: those of the Rust library, by name.
//!
//! `INSTA_UPDATE=always cargo test --workspace --all-features --test native` writes them.

use std::path::Path;

use jointplay_core::Error;
use jointplay_core::gpr::{AxisHeight, CenterHeight, Gpr, Limb, Limits, PlatformPose};
use jointplay_core::nalgebra::Vector2;
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::{Metric, SolveOptions, Solver, Virtualization, built_in};
use serde_json::{Value, json};

const FILE: &str = "js/native.json";

fn robots() -> [Gpr; 3] {
    let limb = |x, y, socket_radius, socket_angle| Limb {
        base_point: Vector2::new(x, y),
        socket_radius,
        socket_angle,
    };
    // Uneven, in metres instead of centimetres, and with sockets that run round in the opposite sense.
    let uneven = [
        limb(0.0803, 0.0012, 0.08, 0.0),
        limb(-0.0452, 0.0831, 0.095, 2.07),
        limb(-0.0371, -0.0789, 0.087, 4.27),
    ];
    let large = [limb(1.5, 0.01, 1.5, 0.0), limb(-0.4, -1.2, 1.3, -1.9), limb(-0.5, 1.1, 1.2, 2.0)];
    let robot = |limbs, limits, height| Gpr::new(limbs, limits, height).expect("a robot");
    let limits = Limits { rod_min: 0.1, rod_max: 0.4, tilt_max: 0.05 };
    let high = Limits { rod_min: 1.0, rod_max: 6.0, tilt_max: 0.3 };
    [
        Gpr::paper(),
        robot(uneven, limits, 0.25).with_ball_clearance(150e-6).expect("a clearance"),
        robot(large, high, 3.0),
    ]
}

fn geometry(robot: &Gpr) -> Value {
    let limbs = robot.limbs().map(|limb| {
        json!({
            "base_point_m": limb.base_point.as_slice(),
            "socket_radius_m": limb.socket_radius,
            "socket_angle_rad": limb.socket_angle,
        })
    });
    let Limits { rod_min, rod_max, tilt_max } = *robot.limits();
    let mut geometry = json!({
        "limbs": limbs, "rod_min_m": rod_min, "rod_max_m": rod_max, "tilt_max_rad": tilt_max,
        "working_height_m": robot.working_height(),
    });
    if let Some(radius) = robot.ball_clearance() {
        geometry["ball_clearance_m"] = radius.into();
    }
    geometry
}

fn placed(pose: &Pose) -> Value {
    let rotation = pose.rotation.matrix();
    let row = |k: usize| [0, 1, 2].map(|column| rotation[(k, column)]);
    json!({ "origin_m": pose.translation.vector.as_slice(), "rotation": [row(0), row(1), row(2)] })
}

fn tilt(tilt: Tilt) -> Value {
    json!({ "azimuth_rad": tilt.azimuth, "angle_rad": tilt.angle })
}

fn pose(robot: &Gpr, pose: &PlatformPose, virtualization: &dyn Virtualization) -> Value {
    let (solution, clearance) = (&pose.solution, robot.needed_clearance(pose, virtualization));
    let vectors = |points: &[Vector2<f64>]| -> Vec<Value> {
        points.iter().map(|point| json!(point.as_slice())).collect()
    };
    json!({
        "rods_m": pose.rods,
        "sides_m": pose.sides,
        "tilt": tilt(pose.tilt()),
        "axis_height_m": pose.axis_height().0,
        "center_shift_m": pose.center_shift().as_slice(),
        "torsion_rad": pose.torsion(),
        "base_from_platform": placed(&pose.base_from_platform),
        "balls_m": robot.ball_centers(&pose.rods).map(|ball| [ball.x, ball.y, ball.z]),
        "sockets_m": vectors(&virtualization.sockets(robot.platform(), &solution.virtual_joints)),
        "clearance": {
            "displacements_m": clearance.displacements,
            "lower_bound_m": clearance.lower_bound,
            "upper_bound_m": clearance.upper_bound(),
            "is_sufficient": clearance.is_sufficient(),
        },
        "displacement_m": robot.displacement(pose, virtualization),
        "characteristic_length_m": solution.characteristic_length,
        "solver": solution.solver.to_string(),
        "iterations": solution.iterations,
        "residual_m": solution.residual,
        "virtual_joints": solution.virtual_joints.to_vec(),
        "virtual_displacements": robot.virtual_displacements(pose, virtualization).to_vec(),
    })
}

/// A result, or the kind and message of the error.
fn result(found: Result<Value, Error>) -> Value {
    found.unwrap_or_else(|error| {
        let kind = if error.is_infeasible() { "infeasible" } else { "invalid" };
        json!({ "kind": kind, "message": error.to_string() })
    })
}

fn cases() -> Vec<Value> {
    let mut cases = Vec::new();
    for robot in robots() {
        let geometry = geometry(&robot);
        let most = robot.limits().tilt_max;
        let height = robot.working_height();
        for (azimuth, share) in [(0.0, 0.0), (-2.9, 0.999), (1.9, 1e-4), (0.3, 1.2)] {
            let angle = share * most;
            let wanted = Tilt { azimuth, angle };
            let rods = robot.inverse(wanted, AxisHeight(height));
            let mut case = |call: &str, arguments: Value, found: Result<Value, Error>| {
                cases.push(json!({ "robot": geometry, "call": call, "arguments": arguments, "result": result(found) }));
            };
            case("inverse", json!([tilt(wanted), height]), rods.clone().map(|rods| json!(rods)));
            case(
                "approximate",
                json!([tilt(wanted), height]),
                robot.approximate(wanted, AxisHeight(height)).map(|found| {
                    json!({
                        "rods_m": found.rods,
                        "base_from_platform": placed(&found.base_from_platform),
                        "gaps_m": found.gaps.map(|gap| [gap.x, gap.y, gap.z]),
                    })
                }),
            );
            let rods = rods.unwrap_or([robot.limits().rod_max * 1.1, height, height]);
            let broken = robot.limits().broken(&rods, robot.plane_tilt(&rods));
            case(
                "limits",
                json!([rods]),
                Ok(json!({
                    "tilt": tilt(robot.plane_tilt(&rods)),
                    "axis_height_m": robot.plane_height(&rods).0,
                    "rods_broken": broken.rods(),
                    "tilt_broken": broken.tilt(),
                })),
            );
            let level = [height; 3];
            case(
                "clampToLimits",
                json!([level, rods]),
                Ok(json!(robot.clamp_to_limits(&level, &rods))),
            );
            for virtualization in built_in() {
                for solver in [Solver::Newton, Solver::ClosedForm] {
                    let length = 0.5 * robot.platform().mean_radius();
                    let options = SolveOptions {
                        solver,
                        metric: Metric::Length(length),
                        ..SolveOptions::default()
                    };
                    let model = json!({
                        "virtualization": virtualization.name(),
                        "solver": solver.to_string(),
                        "characteristic_length_m": length,
                    });
                    let found = robot.forward(rods, virtualization, &options);
                    let found = found.map(|found| pose(&robot, &found, virtualization));
                    case("forward", json!([rods, model]), found);
                    if solver == Solver::Newton {
                        continue;
                    }
                    let center = CenterHeight(height);
                    let found = robot.inverse_for_center(wanted, center, virtualization, &options);
                    let found = found.map(|found| pose(&robot, &found, virtualization));
                    case("inverseForCenter", json!([tilt(wanted), height, model]), found);
                }
            }
        }
    }
    cases
}

#[test]
fn numbers_of_the_library_are_those_that_javascript_compares_with() {
    let text: Vec<String> = cases().iter().map(Value::to_string).collect();
    let text = format!("[\n{}\n]\n", text.join(",\n"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    if std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
        std::fs::write(&path, &text).unwrap();
    }
    let saved = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(text == saved, "{FILE} has other numbers: see the top of this test");
    // The robot of the start page of the documentation; JavaScript writes 0 for 0.0.
    let paper: Value = serde_json::from_str(include_str!("../js/paper.json")).unwrap();
    assert_eq!(with_real_numbers(paper), geometry(&Gpr::paper()));
}

fn with_real_numbers(value: Value) -> Value {
    match value {
        Value::Number(number) => json!(number.as_f64()),
        Value::Array(all) => all.into_iter().map(with_real_numbers).collect(),
        Value::Object(all) => {
            all.into_iter().map(|(key, value)| (key, with_real_numbers(value))).collect()
        }
        other => other,
    }
}
