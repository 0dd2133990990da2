//! `loop_closures.yaml`: hinges that an exporter cut to write a tree.
//!
//! `independent` joints are driven; `dependent` ones follow from the loops.

use std::collections::BTreeSet;

use jointplay_core::mechanism::{JointKind, Mechanism};
use jointplay_format::mechanism::frame::{pose, some_perpendicular};
use nalgebra::{Unit, Vector3};
use serde::Deserialize;
use serde_saphyr::Spanned;

use super::yaml::{ClosingNames, Yaml, poses_at_zero};
use crate::import::draft::bare;
use crate::import::problem::Error;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Closures {
    closures: Vec<Closure>,
    #[serde(default)]
    dependent: Vec<Spanned<String>>,
    #[serde(default)]
    independent: Vec<Spanned<String>>,
}

/// A hinge between two links.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Closure {
    link_a: Spanned<String>,
    link_b: Spanned<String>,
    /// A point of the axis in the base frame, with all coordinates at zero (m).
    point: Spanned<Vec<f64>>,
    /// Direction of the axis in the base frame.
    axis: Spanned<Vec<f64>>,
}

impl Closures {
    pub(super) fn solved(&self) -> BTreeSet<&str> {
        self.dependent.iter().map(|name| name.value.as_str()).collect()
    }

    pub(super) fn close(&self, yaml: Yaml<'_>, chain: &Mechanism) -> Result<Mechanism, Error> {
        yaml.check_open(chain)?;
        let base_from_link = poses_at_zero(chain);
        let mut joints = chain.joints().to_vec();
        let mut names_of_loops = ClosingNames::new(chain);
        let names = || chain.joints().iter().map(|joint| joint.name.as_str());
        for name in &self.independent {
            joints[yaml.find("joint", name, names())?].actuated = true;
        }
        for name in &self.dependent {
            joints[yaml.find("joint", name, names())?].actuated = false;
        }
        for closure in &self.closures {
            let links = || chain.links().iter().map(String::as_str);
            let ends = [&closure.link_a, &closure.link_b];
            let [a, b] = ends.map(|name| yaml.find("link", name, links()));
            let links @ [one, other] = [a?, b?];
            if one == other {
                return Err(yaml.unusable(&closure.link_b, "link_b", "another link than link_a"));
            }
            let point = vector(yaml, &closure.point, "point")?;
            let axis = vector(yaml, &closure.axis, "axis")?;
            let largest = axis.amax();
            if largest == 0.0 {
                return Err(yaml.unusable(
                    &shown(&closure.axis),
                    "axis",
                    "a direction that is not 0",
                ));
            }
            // Divided first, because squares of very large or small numbers overflow or underflow.
            let axis = Unit::new_normalize(axis / largest);
            let base_from_joint = pose(point, some_perpendicular(axis), axis);
            let frames = links.map(|link| base_from_link[link].inverse() * base_from_joint);
            let name = names_of_loops.name(&closure.link_a.value, &closure.link_b.value);
            joints.push(bare(name, JointKind::Revolute, links, frames));
        }
        chain.clone().with_joints(joints).map_err(|error| yaml.error_at_start(error))
    }
}

/// A list of numbers as text, for messages.
fn shown(value: &Spanned<Vec<f64>>) -> Spanned<String> {
    Spanned::new(format!("{:?}", value.value), value.referenced, value.defined)
}

fn vector(
    yaml: Yaml<'_>,
    value: &Spanned<Vec<f64>>,
    what: &'static str,
) -> Result<Vector3<f64>, Error> {
    let numbers: Option<[f64; 3]> = value.value.clone().try_into().ok();
    let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    numbers.map(Vector3::from).ok_or_else(|| yaml.unusable(&shown(value), what, "3 finite numbers"))
}
