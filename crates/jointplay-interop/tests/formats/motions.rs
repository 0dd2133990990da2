//! Mechanisms in motion: units for simulators, and scenes for viewers.

use std::io::{Cursor, Read as _};

use jointplay_core::mechanism::{
    AttachedFrame, FrameId, Kinematics, Mechanism, guess, pose_commanded,
};
use jointplay_core::spatial::Pose;
use jointplay_format::{catalogue, mechanism};
use jointplay_interop::export::MechanismMotion;
use jointplay_interop::fmu::{FmiVersion, Fmu, Resources, archive};
use nalgebra::{DVector, Quaternion, Translation3, UnitQuaternion};
use serde_json::Value;

use super::probes::{CLEARANCE, LIMITS, STIFFNESS, is_near};

const COLUMNS: [&str; 3] = ["FMU (FMI 2.0)", "FMU (FMI 3.0)", "glTF"];
/// Rods at the end of the motion: those of a tilt (m).
const END: [f64; 3] = [0.0031, -0.00155, -0.00155];

/// The three-rod robot as a mechanism, with a frame and the properties of its play.
fn robot() -> Mechanism {
    let text = catalogue::find("gpr-mechanism").unwrap().text;
    let plain = mechanism::parse(text).unwrap().mechanism;
    let mut joints = plain.joints().to_vec();
    joints[0].limits = vec![LIMITS];
    let mut plays = plain.virtual_joints().to_vec();
    for play in &mut plays {
        (play.clearance, play.stiffness) = (Some(CLEARANCE), Some(STIFFNESS));
    }
    let frame = AttachedFrame {
        name: "tool tip".to_owned(),
        link: plain.link("platform").unwrap(),
        link_from_frame: Pose::translation(0.15, 0.05, 0.01),
    };
    let changed = plain.with_joints(joints).unwrap().with_virtual_joints(plays).unwrap();
    changed.with_frames(vec![frame]).unwrap()
}

/// The mechanism at its end, with poses of its links.
struct End {
    mechanism: Mechanism,
    coordinates: DVector<f64>,
    poses: Vec<Pose>,
}

fn end() -> End {
    let mechanism = robot();
    let commands: Vec<(usize, f64)> = END.into_iter().enumerate().collect();
    let coordinates = pose_commanded(&mechanism, &commands, None).unwrap().closed.coordinates;
    let poses = Kinematics::new(&mechanism).link_poses(&coordinates).unwrap();
    // Displacements that a test can see.
    assert!(coordinates[mechanism.joint_freedoms()].abs() > 1e-5);
    End { mechanism, coordinates, poses }
}

pub(crate) fn table() -> String {
    let end = end();
    let columns = [of_unit(&end, FmiVersion::V2), of_unit(&end, FmiVersion::V3), of_scene(&end)];
    let names = [
        "names of links",
        "poses of links over a motion",
        "actuated joints as inputs",
        "limits of actuated joints",
        "coordinates of passive joints",
        "displacements of virtual joints",
        "clearance of virtual joints",
        "stiffness of virtual joints",
        "attached frames",
    ];
    let rows: Vec<(&str, Vec<String>)> = names
        .into_iter()
        .enumerate()
        .map(|(k, name)| (name, columns.iter().map(|column| column[k].clone()).collect()))
        .collect();
    super::table("part of a motion", &COLUMNS, &rows)
}

fn yes(kept: bool) -> String {
    if kept { "kept" } else { "no" }.to_owned()
}

fn difference(a: &Pose, b: &Pose) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).amax()
}

/// The unit is unpacked: what its description declares, and what an instance of its resources computes.
fn of_unit(end: &End, version: FmiVersion) -> Vec<String> {
    let mechanism = &end.mechanism;
    let resources = Resources::for_model(mechanism::write(mechanism, None));
    let bytes = archive(&resources, "linkage", &[], version).unwrap();
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut text = |name: &str| {
        let mut text = String::new();
        zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    };
    let description = text("modelDescription.xml");
    let [model, settings] = ["resources/model.toml", "resources/settings.toml"].map(&mut text);
    let document = roxmltree::Document::parse(&description).unwrap();
    let named = |name: &str| {
        let mut nodes = document.descendants();
        nodes.find(|node| {
            node.attribute("name") == Some(name) && node.has_attribute("valueReference")
        })
    };
    let reference =
        |name: &str| -> Option<u32> { named(name)?.attribute("valueReference")?.parse().ok() };
    let mut fmu = Fmu::new(&Resources::parse([&model, &settings]).unwrap()).unwrap();
    let drives = [1, 2, 3].map(|k| reference(&format!("drive.'rod {k}'")).unwrap());
    fmu.set(&drives.into_iter().zip(END).collect::<Vec<_>>()).unwrap();
    fmu.update().unwrap();
    let value = |name: &str| fmu.value(reference(name)?).ok();
    let pose = |name: &str| {
        let is_plain = name.chars().all(|one| one.is_ascii_alphanumeric());
        let part = if is_plain { name.to_owned() } else { format!("'{name}'") };
        let numbers: Option<Vec<f64>> = ["x", "y", "z", "qw", "qx", "qy", "qz"]
            .iter()
            .map(|of| value(&format!("pose.{part}.{of}")))
            .collect();
        let numbers = numbers?;
        let turn = Quaternion::new(numbers[3], numbers[4], numbers[5], numbers[6]);
        let place = Translation3::new(numbers[0], numbers[1], numbers[2]);
        let turn = UnitQuaternion::new_normalize(turn).to_rotation_matrix();
        Some(Pose::from_parts(place, turn))
    };
    let links = || mechanism.links().iter().zip(&end.poses).skip(1);
    let drive = named("drive.'rod 1'").unwrap();
    let limits: Vec<f64> = std::iter::once(drive)
        .chain(drive.children())
        .flat_map(|node| ["min", "max"].map(|key| node.attribute(key)))
        .flatten()
        .map(|text| text.parse().unwrap())
        .collect();
    let passive = mechanism.joints().iter().filter(|joint| !joint.actuated);
    let play = mechanism.joint_freedoms();
    let frame = mechanism.frame_pose(FrameId::Attached(0), &end.poses);
    let inside = |mark: &str| {
        if description.contains(mark) {
            "kept".to_owned()
        } else {
            assert!(model.contains(mark), "{mark}");
            "in the model, without a variable".to_owned()
        }
    };
    vec![
        yes(links().all(|(name, _)| pose(name).is_some())),
        yes(links().all(|(name, at)| pose(name).is_some_and(|of| difference(&of, at) < 1e-9))),
        yes(drive.attribute("causality") == Some("input")),
        yes(limits.len() == 2 && is_near(limits[0], LIMITS[0]) && is_near(limits[1], LIMITS[1])),
        yes(passive.into_iter().all(|joint| description.contains(&joint.name))),
        yes(value("virtual_joint.l1")
            .is_some_and(|found| (found - end.coordinates[play]).abs() < 1e-9)),
        inside(&format!("{CLEARANCE:?}")),
        inside(&format!("{STIFFNESS:?}")),
        yes(pose("tool tip").is_some_and(|found| difference(&found, &frame) < 1e-9)),
    ]
}

/// The scene is read as a viewer does, at the end of its animation.
fn of_scene(end: &End) -> Vec<String> {
    let mechanism = &end.mechanism;
    let start = guess(mechanism);
    let motion =
        MechanismMotion::new(mechanism, &start, [&start, &end.coordinates], vec![0.0, 1.0], 1.0)
            .unwrap();
    let file = motion.gltf(1e-6).unwrap();
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    let text = &file[20..20 + word(12)];
    let binary = &file[28 + word(12)..];
    let document: Value = serde_json::from_slice(text).unwrap();
    let nodes = document["nodes"].as_array().unwrap();
    let node = |name: &str| nodes.iter().position(|node| node["name"] == name);
    // The last numbers of an accessor of single precision.
    let last = |accessor: &Value, count: usize| -> Vec<f64> {
        let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let keys = number(&accessor["count"]);
        let stride = number(&view["byteStride"]).max(4 * count);
        let from =
            number(&view["byteOffset"]) + number(&accessor["byteOffset"]) + (keys - 1) * stride;
        (0..count)
            .map(|k| {
                let bytes = binary[from + 4 * k..from + 4 * k + 4].try_into().unwrap();
                f64::from(f32::from_le_bytes(bytes))
            })
            .collect()
    };
    let animation = &document["animations"][0];
    let at_end = |name: &str| {
        let node = node(name)?;
        let of = |path: &str, count: usize| {
            let mut channels = animation["channels"].as_array().unwrap().iter();
            let channel = channels.find(|channel| {
                channel["target"]["node"] == node && channel["target"]["path"] == path
            });
            match channel {
                Some(channel) => {
                    let sampler = channel["sampler"].as_u64().unwrap() as usize;
                    Some(last(&animation["samplers"][sampler]["output"], count))
                }
                None => {
                    let own = nodes[node][path].as_array()?;
                    Some(own.iter().filter_map(Value::as_f64).collect())
                }
            }
        };
        let place = of("translation", 3).unwrap_or_else(|| vec![0.0; 3]);
        let turn = of("rotation", 4).unwrap_or_else(|| vec![0.0, 0.0, 0.0, 1.0]);
        let turn = Quaternion::new(turn[3], turn[0], turn[1], turn[2]);
        let turn = UnitQuaternion::new_normalize(turn).to_rotation_matrix();
        Some(Pose::from_parts(Translation3::new(place[0], place[1], place[2]), turn))
    };
    let links = || mechanism.links().iter().zip(&end.poses);
    let whole = document.to_string();
    vec![
        yes(links().all(|(name, _)| node(name).is_some())),
        yes(links().all(|(name, at)| at_end(name).is_some_and(|of| difference(&of, at) < 1e-6))),
        yes(whole.contains("drive")),
        yes(whole.contains(&LIMITS[1].to_string())),
        yes(whole.contains("\"S1\"")),
        yes(node("l1").is_some()),
        yes(whole.contains(&CLEARANCE.to_string())),
        yes(whole.contains(&STIFFNESS.to_string())),
        yes(node("tool tip").is_some()),
    ]
}
