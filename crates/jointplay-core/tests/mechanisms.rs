//! Laws of mechanisms in general, and the robot described as one.

use jointplay_core::constraint::{Configuration, System};
use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, Kinematics, Mechanism, MechanismSystem, Play, VirtualJoint,
    VirtualMotion, close,
};
use jointplay_core::mobility::{
    RANK_THRESHOLD, augmented_mobility, finite_mobility, instantaneous_mobility,
};
use jointplay_core::nalgebra::{
    DVector, Matrix3, Rotation3, Translation3, Unit, UnitVector3, Vector3,
};
use jointplay_core::spatial::Pose;

fn frame(point: [f64; 3], axis: [f64; 3]) -> Pose {
    let z = Unit::new_normalize(Vector3::from(axis));
    let other = if z.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let y = z.cross(&other).normalize();
    let x = y.cross(&z);
    Pose::from_parts(
        Translation3::from(Vector3::from(point)),
        Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z.into_inner()])),
    )
}

fn joint(name: &str, kind: JointKind, links: [usize; 2], point: [f64; 3], axis: [f64; 3]) -> Joint {
    let place = frame(point, axis);
    Joint {
        name: name.to_owned(),
        kind,
        links,
        frames: [place; 2],
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: Play::default(),
        stiffness: Play::default(),
    }
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("link {k}")).collect()
}

/// A single loop of revolute joints, in a closed configuration.
fn ring(points: &[[f64; 3]], axes: &[[f64; 3]]) -> Mechanism {
    let count = points.len();
    let joints = (0..count)
        .map(|k| {
            let links = [k, (k + 1) % count];
            joint(&format!("j{k}"), JointKind::Revolute, links, points[k], axes[k])
        })
        .collect();
    Mechanism::new("ring", names(count), joints).unwrap()
}

fn home(mechanism: &Mechanism) -> DVector<f64> {
    DVector::zeros(mechanism.joint_freedoms() + mechanism.virtual_joints().len())
}

const BRICARD: ([[f64; 3]; 6], [[f64; 3]; 6]) = (
    [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, -1.0, 1.0],
        [0.0, -1.0, 1.0],
        [0.0, 0.0, 1.0],
    ],
    [
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
    ],
);

#[track_caller]
fn check(
    mechanism: &Mechanism,
    rank: usize,
    instantaneous: usize,
    finite: usize,
    redundancy: usize,
) {
    let system = MechanismSystem::new(mechanism, home(mechanism)).unwrap();
    let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    let first = &found.instantaneous;
    assert_eq!(
        (first.rank, first.mobility, found.mobility, first.redundancy),
        (rank, instantaneous, Some(finite), redundancy),
        "{:?}",
        first.singular_values
    );
}

#[test]
fn known_linkages() {
    let planar = ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.3], [2.0, 2.0, 0.0], [3.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    check(&planar, 3, 1, 1, 3);
    check(&ring(&BRICARD.0, &BRICARD.1), 5, 1, 1, 1);
    let spherical = ring(
        &[[0.0; 3]; 4],
        &[[0.0, 0.0, 1.0], [0.3, 0.0, 1.0], [0.5, 0.6, 1.0], [-0.2, 0.7, 1.0]],
    );
    check(&spherical, 3, 1, 1, 3);
}

const RADIUS: f64 = 0.093218;

/// Three rods, three balls, a platform.
fn gpr(virtual_joints: impl Fn(usize, Vector3<f64>) -> Vec<VirtualMotion>) -> Mechanism {
    let links = ["base", "rod 1", "rod 2", "rod 3", "platform"].map(str::to_owned).to_vec();
    let (mut joints, mut relief) = (Vec::new(), Vec::new());
    for k in 0..3 {
        let angle = [0.0, 120.0_f64, 240.0][k].to_radians();
        let ball = Vector3::new(RADIUS * angle.cos(), RADIUS * angle.sin(), 0.0);
        let mut rod =
            joint(&format!("q{k}"), JointKind::Prismatic, [0, k + 1], ball.into(), [0.0, 0.0, 1.0]);
        // Rods are as long as their coordinate says.
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

fn radial(_: usize, ball: Vector3<f64>) -> Vec<VirtualMotion> {
    vec![VirtualMotion::Slide(UnitVector3::new_normalize(ball))]
}

#[test]
fn the_robot_as_a_mechanism() {
    let robot = gpr(radial);
    let mut at = home(&robot);
    for k in 0..3 {
        at[4 * k] = 0.5;
    }
    let system = MechanismSystem::new(&robot, at).unwrap();
    let level = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!(level.instantaneous.rank, 9);
    assert_eq!(level.instantaneous.mobility, 3);
    assert_eq!(level.mobility, Some(1));
    let relieved = augmented_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!((relieved.rank, relieved.mobility), (12, 3));

    let mut tilted = system.home().clone();
    for (k, q) in [0.49674475571, 0.501627622145, 0.501627622145].into_iter().enumerate() {
        tilted[4 * k] = q;
    }
    let free: Vec<usize> = (0..tilted.len()).filter(|k| ![0, 4, 8].contains(k)).collect();
    let closed = close(&system.at(tilted).unwrap(), &free, 50).unwrap();
    assert!(closed.is_closed(), "{closed:?}");
    for (k, expected) in [93.303230751, 93.218, 93.218].into_iter().enumerate() {
        let l = (RADIUS + closed.coordinates[12 + k]) * 1e3;
        assert!((l - expected).abs() < 1e-8, "{l} {expected}");
    }
    let there = system.at(closed.coordinates).unwrap();
    let found = finite_mobility(&there, &there.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!((found.instantaneous.rank, found.instantaneous.mobility), (11, 1));
    assert_eq!(found.mobility, Some(1));
}

/// Jacobians and second derivative against differences, at a displaced and open configuration.
#[test]
fn derivatives_are_those_of_the_residual() {
    let kinds = [
        JointKind::Universal,
        JointKind::Spherical,
        JointKind::Helical { lead: 0.3 },
        JointKind::Planar,
        JointKind::Cylindrical,
        JointKind::Revolute,
        JointKind::Floating,
        JointKind::Prismatic,
    ];
    // Two loops, joints in both senses.
    let links = [[0, 1], [2, 1], [2, 3], [3, 0], [4, 2], [0, 4], [3, 5], [5, 4]];
    let joints = kinds.iter().zip(links).enumerate().map(|(k, (&kind, links))| {
        let s = k as f64;
        let point = [s.sin(), (2.0 * s).cos(), 0.3 * s];
        joint(&format!("j{k}"), kind, links, point, [0.3 + (3.0 * s).sin(), 0.5, s.cos()])
    });
    let turn = VirtualMotion::Turn { axis: Vector3::y_axis(), point: Vector3::new(0.1, 0.2, 0.3) };
    let slide = VirtualMotion::Slide(Vector3::x_axis());
    let relief =
        [(0, turn, Carrier::First), (3, slide, Carrier::Second), (5, turn, Carrier::Second)]
            .into_iter()
            .enumerate()
            .map(|(m, (joint, motion, carrier))| VirtualJoint {
                name: format!("x{m}"),
                joint,
                carrier,
                motion,
                clearance: None,
                stiffness: None,
            });
    let mechanism = Mechanism::new("all kinds", names(6), joints.collect())
        .unwrap()
        .with_virtual_joints(relief.collect())
        .unwrap();
    let f = mechanism.joint_freedoms();
    let home = DVector::from_fn(f + 3, |k, _| 0.3 * (k as f64 * 1.7).sin());
    let system = MechanismSystem::new(&mechanism, home).unwrap();
    let mut at = system.at_home();
    at.coordinates = DVector::from_fn(f, |k, _| 0.2 * (k as f64).cos());
    let direction = DVector::from_fn(f, |k, _| (k as f64 * 0.7).sin());
    let shifted = |t: f64, m: Option<usize>| {
        let mut there = at.clone();
        match m {
            None => there.coordinates += &direction * t,
            Some(m) => there.virtual_joints[m] += t,
        }
        system.residual(&there)
    };
    let h = 1e-6;
    let along = (shifted(h, None) - shifted(-h, None)) / (2.0 * h);
    assert!((along - system.constraint_jacobian(&at) * &direction).amax() < 1e-8);
    for m in 0..3 {
        let along = (shifted(h, Some(m)) - shifted(-h, Some(m))) / (2.0 * h);
        assert!((along - system.virtual_jacobian(&at).column(m)).amax() < 1e-8);
    }
    let there = |t: f64| Configuration {
        coordinates: &at.coordinates + &direction * t,
        virtual_joints: at.virtual_joints.clone(),
    };
    let second = (system.constraint_jacobian(&there(h)) - system.constraint_jacobian(&there(-h)))
        * &direction
        / (2.0 * h);
    let off = (second - system.second_derivative(&at, &direction)).amax();
    assert!(off < 1e-7, "{off}");
    assert_eq!(Kinematics::new(&mechanism).closing_joints().len(), 3);
}

#[test]
fn the_count_of_loops() {
    let robot = gpr(radial);
    assert_eq!((robot.loops(), robot.joint_freedoms()), (2, 12));
    let found = instantaneous_mobility(
        &MechanismSystem::new(&robot, home(&robot)).unwrap(),
        &MechanismSystem::new(&robot, home(&robot)).unwrap().at_home(),
        RANK_THRESHOLD,
    )
    .unwrap();
    assert_eq!(found.rank + found.redundancy, 12);
}
