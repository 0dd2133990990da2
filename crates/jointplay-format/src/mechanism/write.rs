//! The file of a mechanism.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use jointplay_core::mechanism::{
    Carrier, Coupling, Joint, JointCoordinate, JointKind, LinearAndAngular, Mechanism,
    VirtualJoint, VirtualMotion,
};
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use super::values::Units;

/// Writes a mechanism file in m and rad, each joint placed on each of its links.
///
/// The file read again is the same mechanism; only its links are numbered in the order in which joints name them.
///
/// # Arguments
/// * `source` – where the mechanism comes from
#[must_use]
pub fn write(mechanism: &Mechanism, source: Option<&str>) -> String {
    let mut file = format!("kind = \"mechanism\"\nname = {}\n", quoted(mechanism.name()));
    if let Some(source) = source {
        line(&mut file, "source", quoted(source));
    }
    line(&mut file, "units", "{ length = \"m\", angle = \"rad\" }");
    line(&mut file, "base", quoted(&mechanism.links()[0]));
    if let Some(length) = mechanism.characteristic_length() {
        line(&mut file, "characteristic_length", decimal(length));
    }
    for joint in mechanism.joints() {
        write_joint(&mut file, mechanism.links(), joint);
    }
    for joint in mechanism.virtual_joints() {
        write_virtual_joint(&mut file, mechanism, joint, Units::SI);
    }
    for coupling in mechanism.couplings() {
        write_coupling(&mut file, coupling, &|one| coordinate_name(mechanism, one));
    }
    for frame in mechanism.frames() {
        file.push_str("\n[[frame]]\n");
        line(&mut file, "name", quoted(&frame.name));
        line(&mut file, "link", quoted(&mechanism.links()[frame.link]));
        for (key, value) in pose_keys(&frame.link_from_frame, "zero") {
            line(&mut file, key, value);
        }
    }
    file
}

/// Writes a file of joints that close loops, and of couplings, in m and rad, for [`super::with_loops`].
///
/// # Arguments
/// * `links` – names of the links to which the joints refer
/// * `couplings` – with the names of their coordinates
#[must_use]
pub fn write_loops(
    links: &[String],
    joints: &[Joint],
    (couplings, coordinate): (&[Coupling], &dyn Fn(JointCoordinate) -> String),
) -> String {
    let mut file = "kind = \"loops\"\n".to_owned();
    line(&mut file, "units", "{ length = \"m\", angle = \"rad\" }");
    for joint in joints {
        write_joint(&mut file, links, joint);
    }
    for coupling in couplings {
        write_coupling(&mut file, coupling, coordinate);
    }
    file
}

/// Keys and values that place a frame.
fn pose_keys(pose: &Pose, x_key: &'static str) -> [(&'static str, String); 3] {
    let rotation = pose.rotation.matrix();
    [
        ("point", vector(&pose.translation.vector)),
        ("axis", vector(&rotation.column(2).into_owned())),
        (x_key, vector(&rotation.column(0).into_owned())),
    ]
}

fn write_joint(file: &mut String, links: &[String], joint: &Joint) {
    let link = |side: usize| quoted(&links[joint.links[side]]);
    file.push_str("\n[[joint]]\n");
    line(file, "name", quoted(&joint.name));
    line(file, "kind", quoted(joint.kind.name()));
    line(file, "links", format!("[{}, {}]", link(0), link(1)));
    let x_key = if joint.kind == JointKind::Universal { "second_axis" } else { "zero" };
    file.push_str("frames = [\n");
    for frame in &joint.frames {
        let keys = pose_keys(frame, x_key).map(|(key, value)| format!("{key} = {value}"));
        writeln!(file, "  {{ {} }},", keys.join(", ")).expect("a string takes any text");
    }
    file.push_str("]\n");
    if let JointKind::Helical { lead } = joint.kind {
        line(file, "lead", decimal(lead * TAU));
    }
    if joint.actuated {
        line(file, "actuated", "true");
    }
    if !joint.limits.is_empty() {
        let pairs = joint.limits.iter().map(|pair| list(pair)).collect::<Vec<_>>();
        line(file, "limits", format!("[{}]", pairs.join(", ")));
    }
    if !joint.guess.is_empty() {
        line(file, "guess", list(&joint.guess));
    }
    for (key, play) in [("clearance", joint.clearance), ("stiffness", joint.stiffness)] {
        let LinearAndAngular { linear, angular } = play;
        let entries: Vec<_> = [("linear", linear), ("angular", angular)]
            .into_iter()
            .filter_map(|(key, value)| value.map(|value| format!("{key} = {}", decimal(value))))
            .collect();
        if !entries.is_empty() {
            line(file, key, format!("{{ {} }}", entries.join(", ")));
        }
    }
}

/// Appends the table of a virtual joint.
///
/// # Arguments
/// * `units` – the units of the file
pub(super) fn write_virtual_joint(
    file: &mut String,
    mechanism: &Mechanism,
    virtual_joint: &VirtualJoint,
    units: Units,
) {
    let joint = &mechanism.joints()[virtual_joint.joint];
    let side = usize::from(virtual_joint.carrier == Carrier::Second);
    file.push_str("\n[[virtual_joint]]\n");
    line(file, "name", quoted(&virtual_joint.name));
    line(file, "joint", quoted(&joint.name));
    line(file, "on", quoted(&mechanism.links()[joint.links[side]]));
    match virtual_joint.motion {
        VirtualMotion::Slide(axis) => line(file, "slide", vector(&axis)),
        VirtualMotion::Turn { axis, point } => {
            line(file, "turn", vector(&axis));
            line(file, "about", vector(&point.map(|x| units.length.from_meters(x))));
        }
    }
    if let Some(clearance) = virtual_joint.clearance {
        line(file, "clearance", decimal(units.of_motion(virtual_joint.motion, clearance)));
    }
    if let Some(stiffness) = virtual_joint.stiffness {
        line(file, "stiffness", decimal(stiffness));
    }
}

/// Name of a coordinate in files: that of its joint, with an index for a joint with several coordinates.
fn coordinate_name(mechanism: &Mechanism, one: JointCoordinate) -> String {
    let joint = &mechanism.joints()[one.joint];
    match joint.kind.freedoms() > 1 {
        true => format!("{}[{}]", joint.name, one.freedom),
        false => joint.name.clone(),
    }
}

fn write_coupling(
    file: &mut String,
    coupling: &Coupling,
    coordinate: &dyn Fn(JointCoordinate) -> String,
) {
    let name = |one: JointCoordinate| quoted(&coordinate(one));
    file.push_str("\n[[coupling]]\n");
    line(file, "name", quoted(&coupling.name));
    line(file, "coordinate", name(coupling.follower));
    if !coupling.terms.is_empty() {
        let term = |&(one, ratio): &(JointCoordinate, f64)| {
            format!("{{ coordinate = {}, ratio = {} }}", name(one), decimal(ratio))
        };
        let terms: Vec<String> = coupling.terms.iter().map(term).collect();
        line(file, "terms", format!("[{}]", terms.join(", ")));
    }
    if coupling.offset != 0.0 {
        line(file, "offset", decimal(coupling.offset));
    }
}

fn line(file: &mut String, key: &str, value: impl std::fmt::Display) {
    writeln!(file, "{key} = {value}").expect("a string takes any text");
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The shortest decimal that reads back as the same number.
fn decimal(value: f64) -> String {
    format!("{value:?}")
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&value| decimal(value)).collect::<Vec<_>>().join(", "))
}

fn vector(vector: &Vector3<f64>) -> String {
    list(vector.as_slice())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::parse;

    /// Writes a mechanism, reads it, and expects the same.
    fn check(mechanism: &Mechanism) {
        let text = write(mechanism, Some("here"));
        let read = parse(&text).map_err(|error| error.with_excerpt("written")).unwrap();
        assert_eq!(read.source.as_deref(), Some("here"));
        let read = read.mechanism;
        assert_eq!(read.name(), mechanism.name());
        assert_eq!(read.links(), mechanism.links());
        assert_eq!(read.characteristic_length(), mechanism.characteristic_length());
        assert_eq!(read.joints().len(), mechanism.joints().len());
        for (found, expected) in read.joints().iter().zip(mechanism.joints()) {
            for (found, expected) in found.frames.iter().zip(&expected.frames) {
                let off = found.to_homogeneous() - expected.to_homogeneous();
                assert!(off.amax() < 1e-12, "{off}");
            }
            let mut found = found.clone();
            found.frames = expected.frames;
            if let (JointKind::Helical { lead: found }, JointKind::Helical { lead }) =
                (&mut found.kind, expected.kind)
            {
                assert!((*found - lead).abs() <= 1e-15 * lead.abs());
                *found = lead;
            }
            assert_eq!(&found, expected);
        }
        assert_eq!(read.couplings(), mechanism.couplings());
        assert_eq!(read.frames().len(), mechanism.frames().len());
        for (found, expected) in read.frames().iter().zip(mechanism.frames()) {
            assert_eq!((&found.name, found.link), (&expected.name, expected.link));
            let [found, expected] = [found, expected].map(|f| f.link_from_frame.to_homogeneous());
            assert!((found - expected).amax() < 1e-15);
        }
        for (found, expected) in read.virtual_joints().iter().zip(mechanism.virtual_joints()) {
            let axis = |motion| match motion {
                VirtualMotion::Slide(axis) | VirtualMotion::Turn { axis, .. } => axis,
            };
            assert!((axis(found.motion).into_inner() - *axis(expected.motion)).amax() < 1e-15);
            let (mut found, mut expected) = (found.clone(), expected.clone());
            for joint in [&mut found, &mut expected] {
                match &mut joint.motion {
                    VirtualMotion::Slide(axis) | VirtualMotion::Turn { axis, .. } => {
                        *axis = Vector3::x_axis();
                    }
                }
            }
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_written_file_is_the_same_mechanism() {
        check(&parse(include_str!("sample.toml")).unwrap().mechanism);
    }

    #[test]
    fn couplings_are_read_in_the_units_of_the_file_and_written() {
        let couplings = r#"
[[coupling]]
name = "thread"
coordinate = "slider[0]"
terms = [{ coordinate = "crank", ratio = "10 / 360" }, { coordinate = "cardan[1]", ratio = 0.5 }]
offset = "a / 22"

[[coupling]]
name = "brake"
coordinate = "cardan[0]"
offset = 90
"#;
        let text = include_str!("sample.toml").replace("[[virtual_joint]]", "[[ignored]]");
        let joints = text.split("[[ignored]]").next().unwrap();
        let mechanism = parse(&format!("{joints}{couplings}"))
            .map_err(|error| error.with_excerpt("coupled"))
            .unwrap()
            .mechanism;
        let [thread, brake] = mechanism.couplings() else { panic!() };
        let lead = 0.01 / TAU;
        assert_eq!(thread.offset, 0.01);
        let (crank, ratio) = thread.terms[0];
        assert_eq!((crank.joint, crank.freedom), (0, 0));
        assert!((ratio - lead).abs() < 1e-15 * lead, "{ratio}");
        assert_eq!((thread.terms[1].0.joint, thread.terms[1].0.freedom), (1, 1));
        assert_eq!((brake.terms.len(), brake.offset), (0, f64::to_radians(90.0)));
        check(&mechanism);
    }

    #[test]
    fn the_whole_catalogue_is_read_and_written() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/robots");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            if crate::mechanism::kind_of(&text).as_deref() != Some("mechanism") {
                continue;
            }
            let file = parse(&text)
                .map_err(|error| error.with_excerpt(&path.display().to_string()))
                .unwrap_or_else(|message| panic!("{message}"));
            let freedoms = file.expected.freedoms.unwrap_or(file.mechanism.joint_freedoms());
            assert_eq!(file.mechanism.joint_freedoms(), freedoms, "{}", path.display());
            check(&file.mechanism);
            count += 1;
        }
        assert!(count > 0, "the catalogue is not where it should be");
    }
}
