//! Virtual joints from their tables.

use std::collections::BTreeMap;

use jointplay_core::mechanism::{Carrier, Joint, VirtualJoint, VirtualMotion};

use super::joint::named;
use super::problem::Problem;
use super::tree::{Entry, Table};
use super::values::Values;

/// The joints that virtual joints can belong to.
pub(super) struct Joints<'j> {
    /// The joints of the file; nothing for an invalid one.
    pub(super) joints: &'j [Option<Joint>],
    /// Names of links by index.
    pub(super) links: &'j [String],
    names: Vec<String>,
    indices: BTreeMap<String, usize>,
}

impl<'j> Joints<'j> {
    /// The joints of these tables.
    pub(super) fn new(tables: &[Table], joints: &'j [Option<Joint>], links: &'j [String]) -> Self {
        let name = |table: &Table| Some(table.entry("name")?.value.get_ref().as_str()?.to_owned());
        let names = tables.iter().enumerate().filter_map(|(k, table)| Some((name(table)?, k)));
        let indices: BTreeMap<String, usize> = names.clone().collect();
        let names = names.map(|(name, _)| name).collect();
        Self { joints, links, names, indices }
    }
}

/// A virtual joint from its table.
pub(super) fn virtual_joint(
    values: &Values,
    table: &mut Table,
    joints: &Joints,
) -> Option<VirtualJoint> {
    let name = named(table, "virtual joint");
    let index = table.needed("joint").and_then(|entry| {
        let wanted = entry.text(values.reader)?;
        let index = joints.indices.get(wanted).copied();
        // The name of a joint can be invalid, which is an error of its own.
        if index.is_none() && joints.names.len() == joints.joints.len() {
            entry.unknown(values.reader, "joint", wanted, &joints.names);
        }
        index
    });
    let joint = index.and_then(|index| joints.joints[index].as_ref());
    let carrier = carrier(values, table, joint, joints.links);
    let motion = motion(values, table);
    let clearance = values.positive(table, "clearance");
    let stiffness = values.positive(table, "stiffness");
    table.finish();
    let (index, joint, carrier) = (index?, joint?, carrier?);
    let frame = &joint.frames[usize::from(carrier == Carrier::Second)];
    let motion = match motion? {
        Motion::Slide(axis) => VirtualMotion::Slide(axis),
        Motion::Turn { axis, point } => {
            VirtualMotion::Turn { axis, point: point.unwrap_or(frame.translation.vector) }
        }
    };
    let clearance = clearance.map(|value| match motion {
        VirtualMotion::Slide(_) => values.length(value),
        VirtualMotion::Turn { .. } => values.angle(value),
    });
    Some(VirtualJoint { name: name?, joint: index, carrier, motion, clearance, stiffness })
}

/// The link that a virtual joint is on; without `on` the second.
fn carrier(
    values: &Values,
    table: &Table,
    joint: Option<&Joint>,
    links: &[String],
) -> Option<Carrier> {
    let Some(on) = table.entry("on") else { return Some(Carrier::Second) };
    on.text(values.reader)?;
    let names = joint?.links.map(|link| links[link].as_str());
    let carriers = [(names[0], Carrier::First), (names[1], Carrier::Second)];
    on.word(values.reader, "link of this joint", &carriers)
}

/// The motion of a virtual joint; the point of a turn is optional.
enum Motion {
    Slide(nalgebra::Unit<nalgebra::Vector3<f64>>),
    Turn { axis: nalgebra::Unit<nalgebra::Vector3<f64>>, point: Option<nalgebra::Vector3<f64>> },
}

fn motion(values: &Values, table: &Table) -> Option<Motion> {
    let [slide, turn, about] = ["slide", "turn", "about"].map(|key| table.entry(key));
    let slide_axis = slide.map(|entry| values.direction(&entry));
    let turn_axis = turn.map(|entry| values.direction(&entry));
    let point = about.map(|entry| values.point(&entry));
    let misplaced = |entry: Entry, key: &'static str, why: &str| {
        entry.report(values.reader, Problem::Misplaced { key, why: why.to_owned() });
    };
    match (slide_axis, turn_axis, turn) {
        (Some(axis), None, _) => {
            if let Some(about) = about {
                misplaced(about, "about", "only a `turn` has an axis to go through a point");
            }
            Some(Motion::Slide(axis?))
        }
        (None, Some(axis), _) => {
            let point = match point {
                Some(point) => Some(point?),
                None => None,
            };
            Some(Motion::Turn { axis: axis?, point })
        }
        (Some(_), Some(_), Some(turn)) => {
            let why = "a virtual joint has one freedom: state two, a `slide` and a `turn`";
            misplaced(turn, "turn", why);
            None
        }
        _ => {
            table.missing("slide` or `turn");
            None
        }
    }
}
