//! `robot.yaml`: pairs of frames of a URDF that coincide, kinds of its joints, and its motors.
//!
//! A frame is a link, or a joint, which names the frame of its child link.
//! URDF has no universal and, for many readers, no spherical joints: `joint_type` gives them to joints of any type.

use std::collections::BTreeMap;

use jointplay_core::mechanism::{Joint, JointKind, Mechanism};
use jointplay_core::spatial::Pose;
use jointplay_format::mechanism::frame::pose;
use nalgebra::{Unit, Vector3};
use serde::Deserialize;
use serde_saphyr::Spanned;

use super::yaml::{ClosingNames, Yaml};
use crate::import::draft::bare;
use crate::import::problem::{Error, Problem};

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FramePairs {
    closed_loop: Vec<Spanned<Vec<Spanned<String>>>>,
    #[serde(rename = "type", default)]
    kinds: Option<Spanned<Vec<Spanned<String>>>>,
    #[serde(default)]
    name_mot: Vec<Spanned<String>>,
    #[serde(default)]
    joint_name: Vec<Spanned<String>>,
    #[serde(default)]
    joint_type: Option<Spanned<Vec<Spanned<String>>>>,
}

impl FramePairs {
    pub(super) fn close(
        &self,
        yaml: Yaml<'_>,
        chain: &Mechanism,
        ignored: &mut Vec<String>,
    ) -> Result<Mechanism, Error> {
        yaml.check_open(chain)?;
        let mut joints = chain.joints().to_vec();
        let mut names_of_loops = ClosingNames::new(chain);
        let numbers: BTreeMap<&str, usize> =
            chain.joints().iter().enumerate().map(|(j, joint)| (joint.name.as_str(), j)).collect();
        let find = |name: &Spanned<String>| {
            let found = numbers.get(name.value.as_str()).copied();
            let names = || chain.joints().iter().map(|joint| joint.name.as_str());
            found.map_or_else(|| yaml.find("joint", name, names()), Ok)
        };
        for (name, kind) in self.joint_kinds(yaml)? {
            let joint = &mut joints[find(name)?];
            change_kind(yaml, joint, kind)?;
            if !std::mem::take(&mut joint.limits).is_empty() {
                ignored.push(format!("limits of {:?}, whose kind the file changes", name.value));
            }
        }
        for name in &self.name_mot {
            joints[find(name)?].actuated = true;
        }
        for (number, pair) in self.closed_loop.iter().enumerate() {
            let [first, second] = pair.value.as_slice() else {
                let found = format!("{} names", pair.value.len());
                let what = "closed_loop".to_owned();
                let problem = Problem::Value { what, found, expected: "pairs of two frames" };
                return Err(yaml.error(pair, problem));
            };
            let kind = self.kind(yaml, number)?;
            let link = |name: &Spanned<String>| match numbers.get(name.value.as_str()) {
                Some(&joint) => Ok(chain.joints()[joint].links[1]),
                None => {
                    let links = chain.links().iter().map(String::as_str);
                    yaml.find("link or joint", name, links)
                }
            };
            let links = [link(first)?, link(second)?];
            let name = names_of_loops.name(&first.value, &second.value);
            joints.push(bare(name, kind, links, [Pose::identity(); 2]));
            let [one, other] = links;
            if one == other {
                let found = format!("{} and {}", first.value, second.value);
                let what = "closed_loop".to_owned();
                let problem = Problem::Value { what, found, expected: "frames of two links" };
                return Err(yaml.error(pair, problem));
            }
        }
        chain.clone().with_joints(joints).map_err(|error| yaml.error_at_start(error))
    }

    /// Kind of the joint that closes a loop: 6d without a list of kinds.
    fn kind(&self, yaml: Yaml<'_>, number: usize) -> Result<JointKind, Error> {
        let Some(kinds) = &self.kinds else { return Ok(JointKind::Fixed) };
        check_count(yaml, kinds, "type", self.closed_loop.len())?;
        let kind = &kinds.value[number];
        match kind.value.to_ascii_lowercase().as_str() {
            "3d" => Ok(JointKind::Spherical),
            "6d" => Ok(JointKind::Fixed),
            _ => Err(yaml.unusable(kind, "type", "3d or 6d")),
        }
    }

    /// Joints whose kind the file changes, with the kind.
    fn joint_kinds(
        &self,
        yaml: Yaml<'_>,
    ) -> Result<impl Iterator<Item = (&Spanned<String>, &Spanned<String>)>, Error> {
        let kinds = match &self.joint_type {
            None if self.joint_name.is_empty() => &[][..],
            None => {
                let (whose, what) = ("joint_name".to_owned(), "joint_type");
                return Err(yaml.error(&self.joint_name[0], Problem::Missing { whose, what }));
            }
            Some(kinds) => {
                check_count(yaml, kinds, "joint_type", self.joint_name.len())?;
                kinds.value.as_slice()
            }
        };
        Ok(self.joint_name.iter().zip(kinds))
    }
}

fn check_count(
    yaml: Yaml<'_>,
    list: &Spanned<Vec<Spanned<String>>>,
    what: &str,
    needed: usize,
) -> Result<(), Error> {
    if list.value.len() == needed {
        return Ok(());
    }
    let found = format!("{} entries", list.value.len());
    let expected = "one entry for each loop or joint";
    Err(yaml.error(list, Problem::Value { what: what.to_owned(), found, expected }))
}

/// Changes the kind of a joint, which keeps its place.
fn change_kind(yaml: Yaml<'_>, joint: &mut Joint, kind: &Spanned<String>) -> Result<(), Error> {
    let expected = "SPHERICAL, FIXED, or UJOINT_ with two of the axes X, Y and Z";
    let axis = |letter: char| match letter {
        'X' => Some(Vector3::x_axis()),
        'Y' => Some(Vector3::y_axis()),
        'Z' => Some(Vector3::z_axis()),
        _ => None,
    };
    // The frame of the child link at the zero of the joint.
    let parent_from_child = joint.frames[0] * joint.frames[1].inverse();
    let universal = |axes: &str| {
        let axes: Option<Vec<Unit<Vector3<f64>>>> = axes.chars().map(axis).collect();
        match axes.as_deref() {
            Some(&[first, second]) if first != second => {
                Some(pose(Vector3::zeros(), second, first))
            }
            _ => None,
        }
    };
    let text = kind.value.as_str();
    let (kind, child_from_joint) = match text {
        "SPHERICAL" => (JointKind::Spherical, Pose::identity()),
        "FIXED" => (JointKind::Fixed, Pose::identity()),
        _ => {
            let place = text.strip_prefix("UJOINT_").and_then(universal);
            let place = place.ok_or_else(|| yaml.unusable(kind, "joint_type", expected))?;
            (JointKind::Universal, place)
        }
    };
    joint.kind = kind;
    joint.guess = Vec::new();
    joint.frames = [parent_from_child * child_from_joint, child_from_joint];
    Ok(())
}
