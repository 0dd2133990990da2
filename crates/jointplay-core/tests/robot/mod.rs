//! The robot described link by link, for tests and benchmarks.
#![allow(dead_code, reason = "no test uses all of it")]
#![allow(clippy::unwrap_used, reason = "a test may fail at any line")]

use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, LinearAndAngular, Mechanism, VirtualJoint, VirtualMotion,
};
use jointplay_core::nalgebra::{
    DVector, Matrix3, Rotation3, Translation3, Unit, UnitVector3, Vector3,
};
use jointplay_core::spatial::Pose;

pub(crate) const RADIUS: f64 = 0.093218;

/// Three rods, three balls, a platform.
pub(crate) fn gpr(virtual_joints: impl Fn(usize, Vector3<f64>) -> Vec<VirtualMotion>) -> Mechanism {
    let links = ["base", "rod 1", "rod 2", "rod 3", "platform"].map(str::to_owned).to_vec();
    let (mut joints, mut relief) = (Vec::new(), Vec::new());
    for k in 0..3 {
        let angle = [0.0, 120.0_f64, 240.0][k].to_radians();
        let ball = Vector3::new(RADIUS * angle.cos(), RADIUS * angle.sin(), 0.0);
        let mut rod =
            joint(&format!("q{k}"), JointKind::Prismatic, [0, k + 1], ball.into(), [0.0, 0.0, 1.0]);
        // The length of a rod is its coordinate.
        rod.frames[1] = rod.frames[0];
        rod.actuated = true;
        joints.push(rod);
        joints.push(joint(
            &format!("s{k}"),
            JointKind::Spherical,
            [k + 1, 4],
            ball.into(),
            [0.0, 0.0, 1.0],
        ));
        for (m, motion) in virtual_joints(k, ball).into_iter().enumerate() {
            relief.push(VirtualJoint {
                name: format!("x{k}{m}"),
                joint: 2 * k + 1,
                carrier: Carrier::Second,
                motion,
                clearance: None,
                stiffness: None,
            });
        }
    }
    Mechanism::new("GPR", links, joints).unwrap().with_virtual_joints(relief).unwrap()
}

pub(crate) fn radial(_: usize, ball: Vector3<f64>) -> Vec<VirtualMotion> {
    vec![VirtualMotion::Slide(UnitVector3::new_normalize(ball))]
}

pub(crate) fn frame(point: [f64; 3], axis: [f64; 3]) -> Pose {
    let z = Unit::new_normalize(Vector3::from(axis));
    let other = if z.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let y = z.cross(&other).normalize();
    let x = y.cross(&z);
    Pose::from_parts(
        Translation3::from(Vector3::from(point)),
        Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z.into_inner()])),
    )
}

pub(crate) fn joint(
    name: &str,
    kind: JointKind,
    links: [usize; 2],
    point: [f64; 3],
    axis: [f64; 3],
) -> Joint {
    let place = frame(point, axis);
    Joint {
        name: name.to_owned(),
        kind,
        links,
        frames: [place; 2],
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

pub(crate) fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("link {k}")).collect()
}

pub(crate) fn home(mechanism: &Mechanism) -> DVector<f64> {
    DVector::zeros(mechanism.joint_freedoms() + mechanism.virtual_joints().len())
}

pub(crate) fn polar(_: usize, ball: Vector3<f64>) -> Vec<VirtualMotion> {
    vec![
        VirtualMotion::Turn { axis: Vector3::z_axis(), point: Vector3::zeros() },
        VirtualMotion::Slide(UnitVector3::new_normalize(ball)),
    ]
}

pub(crate) fn planar(_: usize, _: Vector3<f64>) -> Vec<VirtualMotion> {
    vec![VirtualMotion::Slide(Vector3::x_axis()), VirtualMotion::Slide(Vector3::y_axis())]
}

/// Legs at the corners of a polygon, each with a ball joint under one plate, tilting outward.
pub(crate) fn legs(points: &[[f64; 2]], tilt: f64) -> Mechanism {
    let count = points.len();
    let mut joints = Vec::new();
    for (k, &[x, y]) in points.iter().enumerate() {
        let out = Vector3::new(x, y, 0.0).normalize() * tilt.sin();
        let axis = [out.x, out.y, tilt.cos()];
        joints.push(joint(
            &format!("leg {k}"),
            JointKind::Prismatic,
            [0, k + 1],
            [x, y, 0.0],
            axis,
        ));
    }
    for (k, &[x, y]) in points.iter().enumerate() {
        let links = [k + 1, count + 1];
        joints.push(joint(
            &format!("ball {k}"),
            JointKind::Spherical,
            links,
            [x, y, 0.0],
            [0.0, 0.0, 1.0],
        ));
    }
    let mut links: Vec<String> = vec!["base".to_owned()];
    links.extend((0..count).map(|k| format!("leg {k}")));
    links.push("plate".to_owned());
    Mechanism::new("legs", links, joints).unwrap()
}
