//! Joints that close loops of an open chain, from a file beside it.

use jointplay_core::mechanism::{Kinematics, Mechanism};
use nalgebra::DVector;
use toml::Spanned;

use super::file::LoopsFile;
use super::header::{check_kind, units};
use super::joint::{Links, joint};
use super::parameters;
use super::problem::{Error, Problem};
use super::values::{Values, choice, unknown};
use crate::place;

/// The kind that a file of loops says it is.
const KIND: &str = "loops";

/// Closes an open chain to loops by the joints of a file, as a URDF needs that can write trees only.
///
/// A joint is placed on one of the links by `in`, or else in the base frame, where all links stand at zero; or on each of its links by `frames`.
///
/// # Errors
/// [`Error`] with its place in `text`: as for a mechanism file, links that the chain does not have, and a mechanism that has loops already.
///
/// # Example
/// ```
/// # let chain = jointplay_format::mechanism::parse(r#"
/// #     kind = "mechanism"
/// #     name = "pair"
/// #     units = { length = "mm", angle = "deg" }
/// #     base = "base"
/// #     joint = [
/// #         { name = "a", kind = "revolute", links = ["base", "left"], point = [0, 0, 0], axis = [0, 0, 1] },
/// #         { name = "b", kind = "revolute", links = ["base", "right"], point = [0, 0, 0], axis = [0, 0, 1] },
/// #     ]
/// # "#)?.mechanism;
/// let closed = jointplay_format::mechanism::with_loops(&chain, r#"
///     kind = "loops"
///     units = { length = "mm", angle = "deg" }
///     [[joint]]
///     name = "tips"
///     kind = "spherical"
///     links = ["left", "right"]
///     in = "left"
///     point = [0, 0, 100]
/// "#)?;
/// assert_eq!(closed.loops(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn with_loops(chain: &Mechanism, text: &str) -> Result<Mechanism, Error> {
    check_kind(text, KIND)?;
    let file: LoopsFile = place::read(text)?;
    choice(text, "kind", &file.kind, &[(KIND, ())])?;
    let units = units(text, &file.units)?;
    let scope = parameters::resolve(text, &file.parameters, &[], units.angle)?;
    let values = Values { text, units, scope };
    if chain.loops() > 0 {
        return Err(values.wrong(file.kind.span(), Problem::HasLoops { found: chain.loops() }));
    }
    let base_from_link = Kinematics::new(chain)
        .link_poses(&DVector::zeros(chain.joint_freedoms() + chain.virtual_joints().len()))
        .expect("zeros are finite, and as many as there are coordinates");
    let mut links = Links::of(chain.links());
    let known = |links: &Links, what: &'static str, name: &Spanned<String>| {
        if links.has(name.get_ref()) {
            return Ok(());
        }
        let names = chain.links().iter().map(String::as_str);
        Err(values.wrong(name.span(), unknown(what, name.get_ref(), names)))
    };
    let mut joints = chain.joints().to_vec();
    let mut places = Vec::new();
    for table in &file.joint {
        let table = table.get_ref();
        table.links.get_ref().iter().try_for_each(|link| known(&links, "link", link))?;
        let mut joint = joint(&values, table, &mut links)?;
        if table.frames.is_none() {
            let mut base_from = nalgebra::IsometryMatrix3::identity();
            if let Some(link) = &table.r#in {
                known(&links, "link", link)?;
                base_from = base_from_link[links.index(link.get_ref())];
            }
            let base_from_joint = base_from * joint.frames[0];
            joint.frames = joint.links.map(|link| base_from_link[link].inverse() * base_from_joint);
        } else if let Some(link) = &table.r#in {
            let why = "`frames` places this joint on each of its links already".to_owned();
            return Err(values.wrong(link.span(), Problem::Misplaced { key: "in", why }));
        }
        places.push((joint.name.clone(), table.name.span()));
        joints.push(joint);
    }
    let result = Mechanism::new(chain.name(), chain.links().to_vec(), joints)
        .and_then(|closed| closed.with_virtual_joints(chain.virtual_joints().to_vec()))
        .and_then(|closed| match chain.characteristic_length() {
            Some(length) => closed.with_characteristic_length(length),
            None => Ok(closed),
        });
    result.map_err(|error| {
        use jointplay_core::mechanism::MechanismError as E;
        let about = match &error {
            E::NameTwice { name }
            | E::JoinedToItself { joint: name, .. }
            | E::NotFinite { name, .. } => {
                places.iter().rev().find(|(found, _)| found == name).map(|(_, span)| span.clone())
            }
            _ => None,
        };
        values.wrong(about.unwrap_or(file.kind.span()), error)
    })
}
