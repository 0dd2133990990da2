//! Linkages of known closed form, and random ones, that several tests share.
#![allow(dead_code, reason = "each test uses some of them")]

use jointplay_core::mechanism::{Joint, JointKind, LinearAndAngular, Mechanism};
use jointplay_core::nalgebra::{Rotation3, Translation3, Vector3};
use jointplay_core::spatial::Pose;
use proptest::prelude::*;

pub(crate) fn joint(name: &str, kind: JointKind, links: [usize; 2], frames: [Pose; 2]) -> Joint {
    Joint {
        name: name.to_owned(),
        kind,
        links,
        frames,
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

pub(crate) fn at(x: f64) -> Pose {
    Pose::from_parts(Translation3::new(x, 0.0, 0.0), Rotation3::identity())
}

/// A hinge about z at places along x of its links.
pub(crate) fn hinge(name: &str, links: [usize; 2], places: [f64; 2]) -> Joint {
    joint(name, JointKind::Revolute, links, places.map(at))
}

/// Ground, crank, coupler and rocker, hinged about z in the order A, B, C, D.
pub(crate) fn four_bar([ground, crank, coupler, rocker]: [f64; 4]) -> Mechanism {
    let joints = vec![
        hinge("A", [0, 1], [0.0, 0.0]),
        hinge("B", [1, 2], [crank, 0.0]),
        hinge("C", [2, 3], [coupler, rocker]),
        hinge("D", [0, 3], [ground, 0.0]),
    ];
    let links = ["ground", "crank", "coupler", "rocker"].map(str::to_owned).to_vec();
    Mechanism::new("four-bar", links, joints).unwrap().with_characteristic_length(1.0).unwrap()
}

/// Both closed configurations of a four-bar at a crank angle, in closed form.
pub(crate) fn closed_form([ground, crank, coupler, rocker]: [f64; 4], theta: f64) -> Vec<[f64; 4]> {
    let tip = [crank * theta.cos(), crank * theta.sin()];
    let (dx, dy) = (ground - tip[0], -tip[1]);
    let span = dx.hypot(dy);
    let along = (coupler * coupler - rocker * rocker + span * span) / (2.0 * span);
    let height = coupler * coupler - along * along;
    if height < 0.0 {
        return Vec::new();
    }
    let configuration = |sense: f64| {
        let (u, v) = ([dx / span, dy / span], sense * height.sqrt());
        let c = [tip[0] + along * u[0] - v * u[1], tip[1] + along * u[1] + v * u[0]];
        let phi = (c[1] - tip[1]).atan2(c[0] - tip[0]);
        let psi = c[1].atan2(c[0] - ground);
        [theta, phi - theta, psi - phi, psi]
    };
    [1.0, -1.0].map(configuration).to_vec()
}

fn kind() -> impl Strategy<Value = JointKind> {
    prop_oneof![
        3 => Just(JointKind::Revolute),
        2 => Just(JointKind::Prismatic),
        1 => Just(JointKind::Cylindrical),
        2 => Just(JointKind::Universal),
        2 => Just(JointKind::Spherical),
        1 => Just(JointKind::Planar),
    ]
}

/// A ring of links, with a second one on it, closed where all coordinates are zero.
pub(crate) fn rings() -> impl Strategy<Value = Vec<Joint>> {
    let place = (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64));
    prop::collection::vec((kind(), place), 7).prop_map(|made| {
        let ends = [[0, 1], [1, 2], [2, 3], [3, 0], [1, 4], [4, 5], [5, 3]];
        let one = |(k, (ends, (kind, (point, turn)))): (usize, ([usize; 2], (JointKind, _)))| {
            let (point, turn): ([f64; 3], [f64; 3]) = (point, turn);
            let frame = Pose::from_parts(
                Translation3::from(Vector3::from(point)),
                Rotation3::new(Vector3::from(turn)),
            );
            let mut made = joint(&format!("j{k}"), kind, ends, [frame; 2]);
            made.limits = vec![[-1.5, 1.5]; kind.freedoms()];
            made
        };
        ends.into_iter().zip(made).enumerate().map(one).collect()
    })
}
