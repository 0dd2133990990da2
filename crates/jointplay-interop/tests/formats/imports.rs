//! Models with one part each, imported.

use jointplay_core::mechanism::{Joint, JointKind, Kinematics, Mechanism, guess};
use jointplay_format::mechanism::{self, LengthUnit};
use jointplay_interop::import::{Imported, parse_closed, parse_with_unit};

use super::fixtures::{Fixture, Format, NAME, Part, fixture};
use super::probes::{
    CLEARANCE, LEAD, LENGTH, LIMITS, STIFFNESS, has_limits, is_near, kinds, kinds_of,
};

const FORMATS: [(Format, &str); 9] = [
    (Format::MechanismFile, "mechanism file"),
    (Format::Mjcf, "MJCF"),
    (Format::Sdf, "SDF"),
    (Format::Urdf, "URDF"),
    (Format::LoopsFile, "… with file of loops"),
    (Format::LoopClosures, "… with `loop_closures.yaml`"),
    (Format::RobotYaml, "… with `robot.yaml`"),
    (Format::FcStd, "FCStd"),
    (Format::Asmt, "ASMT"),
];

pub(crate) fn table() -> String {
    let mut rows: Vec<(&str, Part)> = vec![("names of links", Part::LinkName)];
    let names = [
        "revolute joint",
        "prismatic joint",
        "helical joint",
        "cylindrical joint",
        "universal joint",
        "spherical joint",
        "planar joint",
        "fixed joint",
        "floating joint",
    ];
    rows.extend(names.into_iter().zip(kinds().map(Part::Joint)));
    rows.extend([
        ("limits of a joint", Part::Limits),
        ("limit of a joint at one end", Part::OneLimit),
        ("actuated joint", Part::Actuated),
        ("value of a coordinate at the start", Part::Start),
        ("coupling of two joints", Part::Coupling),
        ("attached frames", Part::Frame),
        ("clearance of a joint", Part::Clearance),
        ("stiffness of a joint", Part::JointStiffness),
        ("virtual joint", Part::VirtualJoint),
        ("dimensions as parameters and formulas", Part::Parameters),
        ("characteristic length", Part::CharacteristicLength),
        ("shapes", Part::Shape),
        ("masses", Part::Mass),
        ("damping and friction", Part::Damping),
    ]);
    let columns = FORMATS.map(|(_, name)| name);
    let rows: Vec<(&str, Vec<String>)> = rows
        .into_iter()
        .map(|(name, part)| (name, FORMATS.iter().map(|(format, _)| cell(*format, part)).collect()))
        .collect();
    super::table("part of a model", &columns, &rows)
}

/// Result of reading a model.
struct Reading {
    mechanism: Mechanism,
    ignored: Vec<String>,
    parameters: usize,
}

fn read(format: Format, Fixture { text, loops }: &Fixture) -> Result<Reading, String> {
    if format == Format::MechanismFile {
        let file = mechanism::parse(text).map_err(|error| error.with_excerpt("fixture")).unwrap();
        let parameters = file.parameters.len();
        return Ok(Reading { mechanism: file.mechanism, ignored: Vec::new(), parameters });
    }
    let read = match loops {
        Some(loops) => parse_closed(text, None, loops).map_err(|error| error.to_string()),
        None => {
            parse_with_unit(text, LengthUnit::Meter).map_err(|error| error.with_excerpt("fixture"))
        }
    };
    let Imported { mechanism, ignored, .. } = read?;
    // What is written is read again.
    let written = mechanism::write(&mechanism, None);
    let again = mechanism::parse(&written).map_err(|errors| format!("{errors}\n{written}"));
    let mechanism = again.unwrap().mechanism;
    Ok(Reading { mechanism, ignored, parameters: 0 })
}

fn cell(format: Format, part: Part) -> String {
    let Some(fixture) = fixture(format, part) else { return "–".to_owned() };
    let reading = match read(format, &fixture) {
        Ok(reading) => reading,
        Err(message) => {
            // A fixture with an error of its own proves nothing about the format.
            assert!(
                message.contains("cannot be imported"),
                "{format:?} {part:?}: {message}\n{}",
                fixture.text
            );
            return "refused".to_owned();
        }
    };
    if let Some(kept) = kept(format, part, &reading) {
        return kept;
    }
    let words: &[&str] = match part {
        Part::Frame => &["site", "frame"],
        Part::Shape => &["geom", "visual"],
        Part::Mass => &["inertial", "Mass"],
        Part::Damping => &["damping", "dynamics"],
        Part::JointStiffness => &["stiffness", "dynamics"],
        Part::Coupling => &["mimic"],
        _ => &[],
    };
    if reading.ignored.iter().any(|one| words.iter().any(|word| one.contains(word))) {
        return "reported".to_owned();
    }
    // What changes the mechanism is never dropped without a word.
    assert!(
        matches!(part, Part::Frame | Part::Shape),
        "{format:?} drops {part:?}: {:?}\n{}\n{}",
        reading.ignored,
        mechanism::write(&reading.mechanism, None),
        fixture.text
    );
    "not read".to_owned()
}

/// The joint of the fixture: not those that hold the base or the tree.
fn joint_of(mechanism: &Mechanism) -> Option<&Joint> {
    let joints = mechanism.joints().iter();
    joints.rev().find(|joint| joint.name == "j")
}

fn kept(format: Format, part: Part, reading: &Reading) -> Option<String> {
    let found = &reading.mechanism;
    let yes = |is: bool| is.then(|| "kept".to_owned());
    match part {
        Part::Joint(kind) => Some(kind_of(format, kind, found)),
        Part::LinkName => yes(found.link(NAME).is_some()),
        Part::Limits => yes(has_limits(joint_of(found)?, &[LIMITS])),
        Part::OneLimit => {
            let [[least, most]] = joint_of(found)?.limits[..] else { return None };
            yes(least == f64::NEG_INFINITY && is_near(most, LIMITS[1]))
        }
        Part::Actuated => yes(found.joints().iter().any(|joint| joint.actuated)),
        Part::Start => {
            let value = joint_of(found)?.guess.first().copied().unwrap_or(0.0);
            yes(is_near(value, 0.5))
        }
        Part::Frame => {
            if let Some(frame) = found.frames().iter().find(|frame| frame.name == "tool tip") {
                return yes(is_near(frame.link_from_frame.translation.z, 0.1));
            }
            found.link("tool tip").map(|_| "as a fixed link".to_owned())
        }
        Part::Clearance => yes(joint_of(found)?.clearance.linear == Some(CLEARANCE)),
        Part::JointStiffness => yes(joint_of(found)?.stiffness.linear == Some(STIFFNESS)),
        Part::VirtualJoint => yes(found.virtual_joints().len() == 1),
        Part::Parameters => {
            let poses = Kinematics::new(found).link_poses(&guess(found)).unwrap();
            let point = joint_of(found)
                .map(|joint| (poses[joint.links[0]] * joint.frames[0]).translation.x)?;
            let as_numbers = is_near(point, 0.1).then(|| "as numbers".to_owned());
            yes(reading.parameters > 0).or(as_numbers)
        }
        Part::CharacteristicLength => {
            yes(found.characteristic_length().is_some_and(|length| is_near(length, LENGTH)))
        }
        Part::Coupling => coupled(found).then(|| "kept".to_owned()),
        Part::Shape | Part::Mass | Part::Damping => None,
    }
}

/// Whether one of two joints moves twice as far as the other.
fn coupled(found: &Mechanism) -> bool {
    let index = |name: &str| {
        let joint = found.joint(name)?;
        Some(Kinematics::new(found).coordinates_of(joint).start)
    };
    let (Some(j), Some(k)) = (index("j"), index("k")) else { return false };
    [(j, k), (k, j)].into_iter().any(|(slow, fast)| {
        let mut at = guess(found);
        at[slow] += 0.1;
        let closed = jointplay_core::mechanism::assemble(found, &at, &[slow], 0);
        closed.is_ok_and(|closed| (closed.coordinates[fast] - 0.2).abs() < 1e-9)
    })
}

/// The kinds of the joints that a joint became, checked for the place and the freedoms of the joint.
fn kind_of(format: Format, kind: JointKind, found: &Mechanism) -> String {
    let is_of_fixture = |joint: &&Joint| match format {
        Format::RobotYaml if kind == JointKind::Universal => joint.name == "j",
        Format::RobotYaml => joint.name != "j" && joint.name != "tree",
        _ => joint.name != "tree" && joint.name != "h",
    };
    let joints: Vec<&Joint> = found.joints().iter().filter(is_of_fixture).collect();
    let moving: Vec<&&Joint> =
        joints.iter().filter(|joint| joint.kind != JointKind::Fixed).collect();
    if let ([joint], [thread]) = (&moving[..], found.couplings()) {
        let [slide, turn] = [thread.follower.freedom, thread.terms[0].0.freedom];
        let ratio = if slide == 0 { thread.terms[0].1 } else { 1.0 / thread.terms[0].1 };
        assert!((joint.kind, slide + turn) == (JointKind::Cylindrical, 1));
        assert!((ratio - LEAD).abs() < 1e-12, "{format:?}: {thread:?}");
        return "as 1 cylindrical with a coupling".to_owned();
    }
    let freedoms: usize = joints.iter().map(|joint| joint.kind.freedoms()).sum();
    assert_eq!(freedoms, kind.freedoms(), "{format:?} {kind:?}");
    let poses = Kinematics::new(found).link_poses(&guess(found)).unwrap();
    for joint in joints.iter().filter(|joint| joint.kind != JointKind::Fixed) {
        let place = (poses[joint.links[0]] * joint.frames[0]).translation.vector;
        let off = (place - nalgebra::Vector3::new(0.1, 0.02, 0.05)).amax();
        // A body that nothing holds has its frame in the base.
        assert!(off < 1e-12 || kind == JointKind::Floating, "{format:?} {kind:?}: {place}");
    }
    let helical = joints.iter().find_map(|joint| match joint.kind {
        JointKind::Helical { lead } => Some(lead),
        _ => None,
    });
    assert!(helical.is_none_or(|lead| (lead - LEAD).abs() < 1e-15), "{format:?}: {helical:?}");
    let text = kinds_of(joints.into_iter());
    if text == format!("1 {}", kind.name()) { "kept".to_owned() } else { format!("as {text}") }
}
