//! Couplings of joint coordinates, from their tables.

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{Coupling, Joint, JointCoordinate};

use super::joint::named;
use super::tree::{Entry, Table};
use super::values::Values;

/// A coupling from its table.
///
/// # Arguments
/// * `joints` – the joints of which it may name coordinates; nothing for an invalid one
pub(super) fn coupling(
    values: &Values,
    table: &mut Table,
    joints: &[Option<Joint>],
) -> Option<Coupling> {
    let name = named(table, "coupling");
    let follower = table.needed("coordinate").and_then(|entry| coordinate(values, &entry, joints));
    let offset = table.entry("offset").map(|entry| values.number(&entry));
    let terms: Vec<_> =
        table.tables("terms").iter().map(|term| read_term(values, term, joints)).collect();
    table.finish();
    let (follower, of_follower) = follower?;
    let offset = offset.map_or(Some(0.0), |offset| Some(to_si(values, of_follower, offset?)))?;
    let mut converted = Vec::with_capacity(terms.len());
    for term in terms {
        let ((coordinate, quantity), ratio) = term?;
        let same = quantity == of_follower;
        let ratio = if same {
            ratio
        } else {
            to_si(values, of_follower, ratio) / to_si(values, quantity, 1.0)
        };
        converted.push((coordinate, ratio));
    }
    Some(Coupling { name: name?, follower, terms: converted, offset })
}

/// A coordinate, and whether it is a slide or a turn.
type Found = (JointCoordinate, Coordinate);

fn read_term(values: &Values, table: &Table, joints: &[Option<Joint>]) -> Option<(Found, f64)> {
    let found = table.needed("coordinate").and_then(|entry| coordinate(values, &entry, joints));
    let ratio = table.needed("ratio").and_then(|entry| values.number(&entry));
    table.finish();
    Some((found?, ratio?))
}

/// The joint coordinate with a name such as `crank` or `nut[1]`.
fn coordinate(values: &Values, entry: &Entry, joints: &[Option<Joint>]) -> Option<Found> {
    let wanted = entry.text(values.reader)?;
    let mut known = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        // The names of the coordinates of an invalid joint are not known, and its error is one of its own.
        let joint = joint.as_ref()?;
        let quantities = joint.kind.coordinates();
        let several = quantities.len() > 1;
        for (freedom, quantity) in quantities.into_iter().enumerate() {
            let name =
                if several { format!("{}[{freedom}]", joint.name) } else { joint.name.clone() };
            if name == wanted {
                return Some((JointCoordinate { joint: index, freedom }, quantity));
            }
            known.push(name);
        }
    }
    entry.unknown(values.reader, "coordinate", wanted, &known);
    None
}

fn to_si(values: &Values, quantity: Coordinate, value: f64) -> f64 {
    match quantity {
        Coordinate::Slide => values.length(value),
        Coordinate::Turn => values.angle(value),
    }
}
