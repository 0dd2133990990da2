//! Pictures of mechanisms: what they hold, and that no geometry is too odd to draw.

use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, LinearAndAngular, Mechanism, VirtualJoint, VirtualMotion,
};
use jointplay_core::spatial::Pose;
use jointplay_plot::{Error, Labels, MechanismPicture, View};
use nalgebra::{DVector, Rotation3, Translation3, Vector3};

const KINDS: [JointKind; 9] = [
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Helical { lead: 0.002 },
    JointKind::Cylindrical,
    JointKind::Universal,
    JointKind::Spherical,
    JointKind::Planar,
    JointKind::Fixed,
    JointKind::Floating,
];

fn joint(name: &str, kind: JointKind, links: [usize; 2], point: [f64; 3], axis: [f64; 3]) -> Joint {
    let turn = Rotation3::rotation_between(&Vector3::z(), &Vector3::from(axis)).unwrap();
    let frame = Pose::from_parts(Translation3::from(Vector3::from(point)), turn);
    Joint {
        name: name.to_owned(),
        kind,
        links,
        frames: [frame; 2],
        actuated: false,
        guess: vec![],
        limits: vec![],
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

fn links(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("link {k}")).collect()
}

/// A crank, a rod and a piston, with play in the crank pin.
fn slider_crank() -> Mechanism {
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let mut bearing = joint("bearing", JointKind::Revolute, [0, 1], [0.0; 3], Z);
    bearing.actuated = true;
    let joints = vec![
        bearing,
        joint("crank pin", JointKind::Revolute, [1, 2], [0.03, 0.04, 0.0], Z),
        joint("piston pin", JointKind::Revolute, [2, 3], [0.15, 0.0, 0.0], Z),
        joint("cylinder", JointKind::Prismatic, [0, 3], [0.15, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ];
    let motion = VirtualMotion::Slide(Vector3::y_axis());
    let give = VirtualJoint {
        name: "give".to_owned(),
        joint: 1,
        carrier: Carrier::Second,
        motion,
        clearance: None,
        stiffness: None,
    };
    Mechanism::new("Slider-crank", links(4), joints)
        .unwrap()
        .with_virtual_joints(vec![give])
        .unwrap()
}

/// A chain of one joint of each kind, at these points.
fn chain(point: impl Fn(usize) -> [f64; 3], axis: impl Fn(usize) -> [f64; 3]) -> Mechanism {
    let joints = KINDS
        .iter()
        .enumerate()
        .map(|(k, &kind)| joint(kind.name(), kind, [k, k + 1], point(k), axis(k)))
        .collect();
    Mechanism::new("Chain", links(KINDS.len() + 1), joints).unwrap()
}

fn drawn(mechanism: &Mechanism) -> Result<String, Error> {
    let count = mechanism.joint_freedoms() + mechanism.virtual_joints().len();
    MechanismPicture::new(mechanism, DVector::zeros(count)).to_svg()
}

#[test]
fn slider_crank_as_svg() {
    insta::assert_snapshot!(drawn(&slider_crank()).unwrap());
}

#[test]
fn every_kind_has_its_own_shape() {
    let shapes: Vec<String> = KINDS
        .iter()
        .map(|&kind| {
            let joints = vec![
                joint("first", JointKind::Spherical, [0, 1], [0.0; 3], [0.0, 0.0, 1.0]),
                joint("shown", kind, [1, 2], [0.2, 0.1, 0.1], [0.3, 0.2, 1.0]),
                joint("last", JointKind::Spherical, [2, 3], [0.3, 0.1, 0.3], [0.0, 0.0, 1.0]),
            ];
            drawn(&Mechanism::new("", links(4), joints).unwrap()).unwrap()
        })
        .collect();
    for (i, a) in shapes.iter().enumerate() {
        assert!(shapes[i + 1..].iter().all(|b| b != a), "{}", KINDS[i].name());
    }
}

#[test]
fn what_is_accented_is_in_the_legend() {
    let full = drawn(&slider_crank()).unwrap();
    for word in [">base<", ">actuated<", ">virtual joint<", ">give<", ">crank pin<", ">20 mm<"] {
        assert!(full.contains(word), "{word}");
    }
    assert!(!full.contains(">moved<"));
    let mechanism = slider_crank();
    let picture = MechanismPicture::new(&mechanism, DVector::zeros(5));
    let moved = DVector::from_vec(vec![0.3, 0.0, 0.0, 0.0, 0.0]);
    assert!(picture.clone().with_ghost(moved.clone()).to_svg().unwrap().contains(">moved<"));
    // The same configuration behind itself keeps the scale; another view does not keep the picture.
    let above = View { azimuth: 0.0, elevation: 1.5 };
    assert_ne!(picture.clone().with_view(above).to_svg().unwrap(), full);
    assert_ne!(MechanismPicture::new(&mechanism, moved).to_svg().unwrap(), full);
    assert_eq!(&picture.to_png(300).unwrap()[1..4], b"PNG");
}

#[test]
fn no_geometry_is_too_odd() {
    let spread = |k: usize| [k as f64 * 0.1, (k % 3) as f64 * 0.2, (k % 2) as f64 * 0.3];
    let up = |_| [0.0, 0.0, 1.0];
    let slanted = |k: usize| [1.0, k as f64, 2.0];
    for scale in [0.0, 1e-300, 1e-12, 1.0, 1e12, 1e150, 1e300] {
        let at = |k: usize| spread(k).map(|x| x * scale);
        for mechanism in [chain(at, up), chain(at, slanted), chain(|k| [at(k)[0], 0.0, 0.0], up)] {
            let svg = drawn(&mechanism).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{scale:e}");
            let picture =
                MechanismPicture::new(&mechanism, DVector::zeros(mechanism.joint_freedoms()));
            picture.to_png(200).unwrap();
        }
    }
    // One joint alone.
    let alone = joint("alone", JointKind::Revolute, [0, 1], [5.0; 3], [1.0, 1.0, 0.0]);
    drawn(&Mechanism::new("", links(2), vec![alone]).unwrap()).unwrap();
}

#[test]
fn invalid_pictures_are_errors() {
    let mechanism = slider_crank();
    let short = MechanismPicture::new(&mechanism, DVector::zeros(4)).to_svg();
    assert!(matches!(short, Err(Error::Coordinates(_))), "{short:?}");
    let lost = MechanismPicture::new(&mechanism, DVector::repeat(5, f64::NAN)).to_svg();
    assert!(matches!(lost, Err(Error::Coordinates(_))), "{lost:?}");
    let narrow = MechanismPicture::new(&mechanism, DVector::zeros(5)).with_width(10.0).to_svg();
    assert!(matches!(narrow, Err(Error::Size { .. })), "{narrow:?}");
    let slide = |name, links| joint(name, JointKind::Prismatic, links, [0.0; 3], [0.0, 0.0, 1.0]);
    let rails = vec![slide("near", [0, 1]), slide("far", [1, 2]), slide("farther", [2, 3])];
    let rails = Mechanism::new("Rails", links(4), rails).unwrap();
    let gone = MechanismPicture::new(&rails, DVector::repeat(3, 1.7e308)).to_svg();
    assert_eq!(gone, Err(Error::Unplaced { joint: "far".to_owned() }));
}

#[test]
fn names_are_those_asked_for() {
    let mechanism = slider_crank();
    let picture = || MechanismPicture::new(&mechanism, DVector::zeros(5));
    let shown = |picture: MechanismPicture<'_>| {
        let svg = picture.to_svg().unwrap();
        ["crank pin", "give", "link 1"].map(|name| svg.contains(&format!(">{name}</text>")))
    };
    let (joints, links) = ([true, true, false], [false, false, true]);
    assert_eq!(shown(picture()), joints);
    assert_eq!(shown(picture().with_labels(Labels::Joints)), joints);
    assert_eq!(shown(picture().with_labels(Labels::Links)), links);
    assert_eq!(shown(picture().with_labels(Labels::All)), [true; 3]);
    assert_eq!(shown(picture().with_labels(Labels::None)), [false; 3]);
    // Own labels replace names, and are shown whatever else is.
    let own = || picture().with_label("crank pin", "B").with_label("give", "");
    assert_eq!(shown(own().with_labels(Labels::All)), links);
    for labels in [Labels::Auto, Labels::Links, Labels::None] {
        let svg = own().with_labels(labels).to_svg().unwrap();
        assert!(svg.contains(">B</text>") && !svg.contains(">crank pin<"), "{labels:?}");
    }
    let unknown = picture().with_label("crank", "B").to_svg();
    assert_eq!(unknown, Err(Error::NoSuchName { name: "crank".to_owned() }));
    // No title leaves its room to the picture; the accessible name remains.
    let untitled = picture().with_title("").to_svg().unwrap();
    assert!(!untitled.contains(">Slider-crank</text>") && untitled.contains("Slider-crank"));
}

#[test]
fn names_of_many_joints_are_shown_on_request() {
    let turn = |k: usize| {
        let x = f64::from(u32::try_from(k).unwrap());
        let mut hinge = joint(
            &format!("J{k}"),
            JointKind::Revolute,
            [k, k + 1],
            [x, 0.0, 0.0],
            [0.0, 0.0, 1.0],
        );
        hinge.actuated = k == 3;
        hinge
    };
    let row = Mechanism::new("Row", links(19), (0..18).map(turn).collect()).unwrap();
    let count = |labels| {
        let svg = MechanismPicture::new(&row, DVector::zeros(18)).with_labels(labels).to_svg();
        svg.unwrap().matches(">J").count()
    };
    assert_eq!((count(Labels::Auto), count(Labels::Joints), count(Labels::None)), (1, 18, 0));
}
