//! Mechanisms of any number of loops, for tests and benchmarks.
#![allow(dead_code, reason = "no test uses all of it")]
#![allow(clippy::unwrap_used, reason = "a test may fail at any line")]
#![allow(clippy::cast_precision_loss, reason = "counts of stages")]

use jointplay_core::mechanism::{Joint, JointKind, LinearAndAngular, Mechanism};
use jointplay_core::nalgebra::{Matrix3, Rotation3, Translation3, Vector3};
use jointplay_core::spatial::Pose;

/// A frame with its z along an axis in the plane of y and z, and its x along x or against it.
fn place(x: f64, twist: f64, sense: f64) -> Pose {
    let z = Vector3::new(0.0, -twist.sin(), twist.cos());
    let zero = Vector3::x() * sense;
    let rotation = Matrix3::from_columns(&[zero, z.cross(&zero), z]);
    Pose::from_parts(Translation3::new(x, 0.0, 0.0), Rotation3::from_matrix_unchecked(rotation))
}

fn revolute(name: String, links: [usize; 2], frames: [Pose; 2], guess: f64) -> Joint {
    Joint {
        name,
        kind: JointKind::Revolute,
        links,
        frames,
        actuated: false,
        guess: vec![guess],
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("link {k}")).collect()
}

/// Crossed bars of length 2, one stage on the other, the first bar pinned to the base: `stages − 1` loops.
///
/// Coordinates count from bars that rise by half a radian.
pub(crate) fn scissor_lift(stages: usize) -> Mechanism {
    let mut joints = Vec::new();
    let pin = |name: String, links: [usize; 2], at: [(f64, f64); 2]| {
        let frames = at.map(|(along, angle)| {
            // Bars run along x of their own frame, from the lower end.
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), -angle);
            Pose::from_parts(Translation3::new(along, 0.0, 0.0), turned)
        });
        revolute(name, links, frames, 0.0)
    };
    let (rises, falls) = (0.5, std::f64::consts::PI - 0.5);
    joints.push(pin("foot".to_owned(), [0, 1], [(0.0, 0.0), (0.0, rises)]));
    for s in 0..stages {
        let [rising, falling] = [2 * s + 1, 2 * s + 2];
        joints.push(pin(format!("middle {s}"), [rising, falling], [(1.0, rises), (1.0, falls)]));
        if s + 1 < stages {
            let [next_rising, next_falling] = [rising + 2, falling + 2];
            let right = [(2.0, rises), (0.0, falls)];
            let left = [(2.0, falls), (0.0, rises)];
            joints.push(pin(format!("right {s}"), [rising, next_falling], right));
            joints.push(pin(format!("left {s}"), [falling, next_rising], left));
        }
    }
    Mechanism::new("scissor lift", names(2 * stages + 1), joints).unwrap()
}

/// A row of Bennett linkages that unfolds as one; the guesses close it.
///
/// # Source
/// Cells and their common hinges as in `crates/jointplay-format/robots/bennett-network.toml`
pub(crate) fn bennett_row(cells: usize) -> Mechanism {
    let (a, b) = (0.22, 0.11);
    let (alpha, beta) = (90.0_f64.to_radians(), 150.0_f64.to_radians());
    let p = 0.9_f64;
    // tan(θ₁/2) tan(θ₂/2) = sin((β + α)/2) / sin((β − α)/2)
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let q = 2.0 * (ratio / (0.5 * p).tan()).atan();
    // Link of beam A of cell k, counted from 1, and of beam B; the first B is the base.
    let beam_a = |k: usize| 2 * k - 1;
    let beam_b = |k: usize| 2 * k - 2;
    let straight = place(0.0, 0.0, 1.0);
    let mut joints = vec![revolute("P1".to_owned(), [0, beam_a(1)], [straight, straight], p)];
    let mut sign = 1.0;
    for k in 1..=cells {
        let first = k == 1;
        let q_frame = if first { place(a, alpha, 1.0) } else { place(-a, -alpha, -1.0) };
        let r_frame = if first { place(-b, -beta, 1.0) } else { place(2.0 * b, 2.0 * beta, -1.0) };
        let [q_k, p_k, r_k] = [format!("Q{k}"), format!("P{}", k + 1), format!("R{k}")];
        joints.push(revolute(q_k, [beam_a(k), beam_b(k + 1)], [q_frame, straight], sign * q));
        let p_frame = place(b, beta, 1.0);
        joints.push(revolute(p_k, [beam_b(k + 1), beam_a(k + 1)], [p_frame, straight], -sign * p));
        let frames = [place(a, alpha, 1.0), r_frame];
        joints.push(revolute(r_k, [beam_a(k + 1), beam_b(k)], frames, -sign * q));
        sign = -sign;
    }
    Mechanism::new("row of Bennett linkages", names(2 * cells + 2), joints)
        .unwrap()
        .with_characteristic_length(a)
        .unwrap()
}
