//! Couplings of joint coordinates, from their tables.

use std::collections::HashMap;

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{Coupling, Joint, JointCoordinate};

use super::joint::named;
use super::tree::{Entry, Table};
use super::values::Values;

/// A coordinate, and whether it is a slide or a turn.
type Found = (JointCoordinate, Coordinate);

/// The coordinates that couplings may name.
pub(super) struct NamedCoordinates {
    by_name: HashMap<String, Found>,
    /// All names, in their order; `None` where a joint is invalid, whose coordinates are not known, and whose error is one of its own.
    known: Option<Vec<String>>,
}

impl NamedCoordinates {
    /// # Arguments
    /// * `joints` – nothing for an invalid one
    pub(super) fn new(joints: &[Option<Joint>]) -> Self {
        let (mut by_name, mut names) = (HashMap::new(), Vec::new());
        for (index, joint) in joints.iter().enumerate() {
            let Some(joint) = joint else { continue };
            let quantities = joint.kind.coordinates();
            let several = quantities.len() > 1;
            for (freedom, quantity) in quantities.into_iter().enumerate() {
                let name =
                    if several { format!("{}[{freedom}]", joint.name) } else { joint.name.clone() };
                let found = (JointCoordinate { joint: index, freedom }, quantity);
                by_name.entry(name.clone()).or_insert(found);
                names.push(name);
            }
        }
        let known = joints.iter().all(Option::is_some).then_some(names);
        Self { by_name, known }
    }

    /// The joint coordinate with a name such as `crank` or `nut[1]`.
    fn coordinate(&self, values: &Values, entry: &Entry) -> Option<Found> {
        let wanted = entry.text(values.reader)?;
        let found = self.by_name.get(wanted).copied();
        if let (None, Some(known)) = (found, &self.known) {
            entry.unknown(values.reader, "coordinate", wanted, known);
        }
        found
    }
}

/// A coupling from its table.
pub(super) fn coupling(
    values: &Values,
    table: &mut Table,
    named_coordinates: &NamedCoordinates,
) -> Option<Coupling> {
    let name = named(table, "coupling");
    let follower =
        table.needed("coordinate").and_then(|entry| named_coordinates.coordinate(values, &entry));
    let offset = table.entry("offset").map(|entry| values.number(&entry));
    let terms: Vec<_> = table
        .tables("terms")
        .iter()
        .map(|term| read_term(values, term, named_coordinates))
        .collect();
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

fn read_term(
    values: &Values,
    table: &Table,
    named_coordinates: &NamedCoordinates,
) -> Option<(Found, f64)> {
    let found =
        table.needed("coordinate").and_then(|entry| named_coordinates.coordinate(values, &entry));
    let ratio = table.needed("ratio").and_then(|entry| values.number(&entry));
    table.finish();
    Some((found?, ratio?))
}

fn to_si(values: &Values, quantity: Coordinate, value: f64) -> f64 {
    match quantity {
        Coordinate::Slide => values.length(value),
        Coordinate::Turn => values.angle(value),
    }
}
