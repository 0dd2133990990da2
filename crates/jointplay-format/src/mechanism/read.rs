//! A mechanism from the text of its file.

use std::collections::BTreeMap;
use std::ops::Range;

use jointplay_core::mechanism::{Mechanism, MechanismError};
use serde::Deserialize;
use toml::Spanned;

use super::expression::AngleUnit;
use super::file::File;
use super::joint::{Links, joint, virtual_joint};
use super::parameters;
use super::problem::{Error, Problem};
use super::values::{LengthUnit, Units, Values, choice, unknown};
use crate::place;

/// Longest text that is read [bytes], so that a wrong file ends in a message and not in hours of work.
pub const MAX_BYTES: usize = 4_000_000;

/// A mechanism as read.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismFile {
    /// The mechanism [m, rad].
    pub mechanism: Mechanism,
    /// Where it comes from.
    pub source: Option<String>,
    /// The units of the file, in which to speak to its reader.
    pub units: Units,
    /// Values of all parameters, in the order and the units of the file.
    pub parameters: Vec<(String, f64)>,
    /// What the file says that an analysis should find.
    pub expected: Expected,
}

/// What a file says that an analysis should find; `None` where it says nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Expected {
    /// Freedoms of all joints together.
    pub freedoms: Option<usize>,
    /// Rank of the closure equations.
    pub rank: Option<usize>,
    /// Mobility by the count of Kutzbach.
    pub kutzbach: Option<i64>,
    /// Instantaneous mobility.
    pub instantaneous: Option<usize>,
    /// Finite mobility.
    pub finite: Option<usize>,
    /// Redundant closure equations.
    pub redundancy: Option<usize>,
    /// A remark.
    pub note: Option<String>,
}

/// The `kind` that a file says it is, such as `gpr` or `mechanism`; also where the rest of it is malformed.
#[must_use]
pub fn kind_of(text: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Kind {
        kind: String,
    }
    let kind = |text: &str| toml::from_str(text).ok().map(|Kind { kind }| kind);
    kind(text).or_else(|| {
        let mut top = text.lines().take_while(|line| !line.trim_start().starts_with('['));
        top.find_map(kind)
    })
}

/// Reads a mechanism file.
///
/// # Errors
/// [`Error`] with the place: TOML that is malformed, keys that are missing, unknown or contradict each other, numbers out of range, links and joints that make no mechanism.
pub fn parse(text: &str) -> Result<MechanismFile, Error> {
    parse_with(text, &[])
}

/// Reads a mechanism file with other values for some of its parameters, as a study needs that sweeps them.
///
/// # Arguments
/// * `replaced` – names of parameters of the file, and their values in the units of the file
///
/// # Errors
/// As [`parse`]; and if the file has no parameter of a name.
pub fn parse_with(text: &str, replaced: &[(String, f64)]) -> Result<MechanismFile, Error> {
    if text.len() > MAX_BYTES {
        let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
        return Err(Error::at(text, 0..0, problem));
    }
    // Before all else, lest a file of another kind be blamed for its keys.
    let other = kind_of(text).filter(|kind| kind != "mechanism");
    if other.is_some() {
        #[derive(Deserialize)]
        struct Kind {
            kind: Spanned<String>,
        }
        let Kind { kind } = place::read::<Kind, Problem>(text)?;
        choice(text, "kind", &kind, &[("mechanism", ())])?;
    }
    let file: File = place::read(text)?;
    choice(text, "kind", &file.kind, &[("mechanism", ())])?;
    let units = Units {
        length: choice(text, "unit of length", &file.units.length, &LengthUnit::ALL)?,
        angle: choice(text, "unit of angle", &file.units.angle, &AngleUnit::ALL)?,
    };
    let scope = parameters::resolve(text, &file.parameters, replaced, units.angle)?;
    let values = Values { text, units, scope };
    let mechanism = mechanism(&values, &file)?;
    let mut order: Vec<_> = file.parameters.keys().collect();
    order.sort_by_key(|name| name.span().start);
    let value =
        |name: &Spanned<String>| (name.get_ref().clone(), values.scope.values[name.get_ref()]);
    Ok(MechanismFile {
        mechanism,
        source: prose(text, "source", file.source.as_ref())?,
        units,
        parameters: order.into_iter().map(value).collect(),
        expected: Expected {
            freedoms: file.expected.freedoms,
            rank: file.expected.rank,
            kutzbach: file.expected.kutzbach,
            instantaneous: file.expected.instantaneous,
            finite: file.expected.finite,
            redundancy: file.expected.redundancy,
            note: prose(text, "note", file.expected.note.as_ref())?,
        },
    })
}

fn mechanism(values: &Values, file: &File) -> Result<Mechanism, Error> {
    let text = values.text;
    let title = name(text, "name", &file.name)?;
    let base = name(text, "base", &file.base)?;
    let mut links = Links::default();
    links.index(&base);
    let joints = file.joint.iter().map(|table| joint(values, table.get_ref(), &mut links));
    let joints = joints.collect::<Result<Vec<_>, _>>()?;
    if !joints.is_empty() && joints.iter().all(|joint| !joint.links.contains(&0)) {
        let names = links.names[1..].iter().map(String::as_str);
        return Err(values.wrong(file.base.span(), unknown("base", &base, names)));
    }
    let indices: BTreeMap<&str, usize> =
        joints.iter().enumerate().map(|(index, joint)| (joint.name.as_str(), index)).collect();
    let virtual_joints = file
        .virtual_joint
        .iter()
        .map(|table| virtual_joint(values, table.get_ref(), &joints, &indices, &links));
    let virtual_joints = virtual_joints.collect::<Result<Vec<_>, _>>()?;
    let placed = |error| values.wrong(blame(file, &error), error);
    let mechanism = Mechanism::new(title, links.names, joints)
        .and_then(|mechanism| mechanism.with_virtual_joints(virtual_joints))
        .map_err(placed)?;
    let length = file.characteristic_length.as_ref();
    let to_si = |length| values.length(length);
    match values.positive("characteristic_length", length, to_si)? {
        Some(length) => mechanism.with_characteristic_length(length).map_err(placed),
        None => Ok(mechanism),
    }
}

/// The part of the file that an error of the mechanism is about.
fn blame(file: &File, error: &MechanismError) -> Range<usize> {
    use MechanismError as E;
    let joints = || file.joint.iter().map(Spanned::get_ref);
    let found = match error {
        E::NameTwice { name } => {
            let real = joints().map(|joint| &joint.name);
            let imagined = file.virtual_joint.iter().map(|joint| &joint.get_ref().name);
            real.chain(imagined).filter(|found| found.get_ref() == name).nth(1).map(Spanned::span)
        }
        E::NoSuchLink { joint, .. } | E::JoinedToItself { joint, .. } => joints()
            .find(|table| {
                table.name.get_ref() == joint && {
                    let links = table.links.get_ref();
                    links.first().map(Spanned::get_ref) == links.last().map(Spanned::get_ref)
                }
            })
            .map(|table| table.links.span()),
        E::Dangling { link, .. } => joints()
            .flat_map(|joint| joint.links.get_ref())
            .find(|found| found.get_ref() == link)
            .map(Spanned::span),
        E::NotFinite { name, .. } => {
            joints().find(|joint| joint.name.get_ref() == name).map(|joint| joint.name.span())
        }
        _ => None,
    };
    found.unwrap_or_else(|| file.name.span())
}

/// A name that can be printed.
pub(super) fn name(text: &str, key: &'static str, name: &Spanned<String>) -> Result<String, Error> {
    let found = name.get_ref().clone();
    if found.trim().is_empty() || found.chars().any(char::is_control) {
        return Err(Error::at(text, name.span(), Problem::Name { key, found }));
    }
    Ok(found)
}

/// Text that can be printed, of any number of lines.
fn prose(
    text: &str,
    key: &'static str,
    prose: Option<&Spanned<String>>,
) -> Result<Option<String>, Error> {
    let Some(prose) = prose else { return Ok(None) };
    let found = prose.get_ref().clone();
    if found.chars().any(|character| character.is_control() && !"\r\n\t".contains(character)) {
        return Err(Error::at(text, prose.span(), Problem::Name { key, found }));
    }
    Ok(Some(found))
}
