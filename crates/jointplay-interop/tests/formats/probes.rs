//! Mechanisms with one part each, and comparisons of what is read with them.

use jointplay_core::mechanism::{
    AttachedFrame, Carrier, Joint, JointKind, Kinematics, LinearAndAngular, Mechanism,
    VirtualJoint, VirtualMotion, guess,
};
use jointplay_core::spatial::Pose;
use nalgebra::{DVector, Rotation3, Translation3, Vector3};

/// Numbers of probes; their texts are searched in files.
pub(crate) const STIFFNESS: f64 = 43_210.0;
pub(crate) const CLEARANCE: f64 = 0.000_25;
pub(crate) const LIMITS: [f64; 2] = [-0.75, 1.25];
pub(crate) const LEAD: f64 = 0.002;
pub(crate) const LENGTH: f64 = 0.987_654;

/// All kinds of joints.
pub(crate) fn kinds() -> [JointKind; 9] {
    [
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Helical { lead: LEAD },
        JointKind::Cylindrical,
        JointKind::Universal,
        JointKind::Spherical,
        JointKind::Planar,
        JointKind::Fixed,
        JointKind::Floating,
    ]
}

/// A joint `j` of two links, the second at the origin of the joint's frame.
pub(crate) fn joint(kind: JointKind) -> Joint {
    Joint {
        name: "j".to_owned(),
        kind,
        links: [0, 1],
        frames: [Pose::translation(0.1, 0.02, 0.05), Pose::identity()],
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

/// `base` and `part` with one joint.
pub(crate) fn pair(joint: Joint) -> Mechanism {
    Mechanism::new("pair", vec!["base".to_owned(), "part".to_owned()], vec![joint]).unwrap()
}

pub(crate) fn with_joint(change: impl FnOnce(&mut Joint)) -> Mechanism {
    let mut joint = joint(JointKind::Revolute);
    change(&mut joint);
    pair(joint)
}

/// A virtual joint `play` of the joint `j`.
pub(crate) fn play(
    motion: VirtualMotion,
    clearance: Option<f64>,
    stiffness: Option<f64>,
) -> Mechanism {
    let play = VirtualJoint {
        name: "play".to_owned(),
        joint: 0,
        carrier: Carrier::First,
        motion,
        clearance,
        stiffness,
    };
    pair(joint(JointKind::Revolute)).with_virtual_joints(vec![play]).unwrap()
}

pub(crate) fn slide() -> VirtualMotion {
    VirtualMotion::Slide(Vector3::x_axis())
}

pub(crate) fn turn() -> VirtualMotion {
    VirtualMotion::Turn { axis: Vector3::x_axis(), point: Vector3::new(0.0, 0.1, 0.0) }
}

/// A frame attached to the part.
pub(crate) fn frame() -> Mechanism {
    let turned = Rotation3::from_euler_angles(0.1, 0.2, 0.3);
    let frame = AttachedFrame {
        name: "tool tip".to_owned(),
        link: 1,
        link_from_frame: Pose::from_parts(Translation3::new(0.0, 0.0, 0.1), turned),
    };
    pair(joint(JointKind::Revolute)).with_frames(vec![frame]).unwrap()
}

/// A four-bar linkage whose last joint is of a kind, and closes the loop in its reference.
pub(crate) fn closed_by(kind: JointKind) -> Mechanism {
    let hinge = |name: &str, links: [usize; 2], at: [f64; 3], in_second: [f64; 3]| Joint {
        name: name.to_owned(),
        links,
        frames: [at, in_second].map(|[x, y, z]| Pose::translation(x, y, z)),
        ..joint(JointKind::Revolute)
    };
    let joints = vec![
        hinge("A", [0, 1], [0.0, 0.0, 0.0], [0.0; 3]),
        hinge("B", [1, 2], [0.0, 0.1, 0.0], [0.0; 3]),
        hinge("D", [0, 3], [0.3, 0.0, 0.0], [0.0; 3]),
        Joint { kind, ..hinge("C", [2, 3], [0.3, 0.1, 0.0], [0.0, 0.2, 0.0]) },
    ];
    let links = ["ground", "crank", "coupler", "rocker"].map(str::to_owned).to_vec();
    Mechanism::new("four-bar", links, joints).unwrap()
}

/// Joints by kind, such as `2 prismatic, 1 revolute`; rigid ones only where there are no others.
pub(crate) fn kinds_of<'a>(joints: impl Iterator<Item = &'a Joint>) -> String {
    let mut kinds: Vec<&str> = joints.map(|joint| joint.kind.name()).collect();
    kinds.sort_unstable();
    let rigid = |kind: &&str| *kind == JointKind::Fixed.name();
    if kinds.iter().all(rigid) {
        kinds.truncate(1);
    } else {
        kinds.retain(|kind| !rigid(kind));
    }
    let counts = kinds.chunk_by(|a, b| a == b).map(|same| format!("{} {}", same.len(), same[0]));
    counts.collect::<Vec<_>>().join(", ")
}

/// The joint of a name, or of that name with the ending that SDF gives it.
pub(crate) fn named<'a>(mechanism: &'a Mechanism, name: &str) -> Option<&'a Joint> {
    let ending = format!("{name} joint");
    mechanism.joints().iter().find(|joint| joint.name == name || joint.name == ending)
}

/// The largest difference of the poses of equally named links at two configurations (m); infinite where a link is missing.
pub(crate) fn pose_difference(a: &Mechanism, at: &DVector<f64>, b: &Mechanism) -> f64 {
    let (poses, found) = (
        Kinematics::new(a).link_poses(at).unwrap(),
        Kinematics::new(b).link_poses(&guess(b)).unwrap(),
    );
    let of = |(name, pose): (&String, &Pose)| match b.link(name) {
        Some(link) => (found[link].to_homogeneous() - pose.to_homogeneous()).amax(),
        None => f64::INFINITY,
    };
    a.links().iter().zip(&poses).map(of).fold(0.0, f64::max)
}

pub(crate) fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// Whether a joint has these limits, for each of its motions.
pub(crate) fn has_limits(joint: &Joint, limits: &[[f64; 2]]) -> bool {
    joint.limits.len() == limits.len()
        && joint.limits.iter().flatten().zip(limits.iter().flatten()).all(|(a, b)| is_near(*a, *b))
}
