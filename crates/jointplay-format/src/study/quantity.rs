//! Quantities that a study file can ask for, by name and unit.

use super::Problem;
use super::tree::{Table, entries, report_twice};
use crate::file_problem::FileProblem;
use crate::units::Unit;

pub(super) const LENGTHS: &[Unit] = &Unit::LENGTHS;
pub(super) const ANGLES: &[Unit] = &Unit::ANGLES;
pub(super) const NUMBERS: &[Unit] = &[Unit::One];
pub(super) const TIMES: &[Unit] = &Unit::TIMES;

/// Something that can be asked for.
pub(super) struct Term<Q> {
    /// Its name without unit.
    pub(super) stem: String,
    pub(super) units: &'static [Unit],
    pub(super) wanted: Q,
}

/// A name of several quantities.
pub(super) struct Group<Q> {
    pub(super) name: &'static str,
    /// Units that the name can have; none where each quantity has its own.
    pub(super) units: &'static [Unit],
    pub(super) has: Box<dyn Fn(&Q) -> bool>,
}

/// Something asked for, with the unit that it is to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Asked<Q> {
    pub(super) wanted: Q,
    pub(super) unit: Unit,
}

/// The quantities of a study file, in its order.
pub(super) fn quantities<Q: Copy + PartialEq>(
    top: &Table,
    terms: &[Term<Q>],
    groups: &[Group<Q>],
) -> Option<Vec<Asked<Q>>> {
    let reader = top.reader;
    let list = entries(&top.needed("quantities")?, reader)?;
    let mut all: Vec<Asked<Q>> = Vec::new();
    let mut are_valid = true;
    for entry in list {
        let found = entry.text(reader).and_then(|name| {
            let asked = resolve(name, terms, groups);
            let asked = asked.map_err(|problem| entry.report(reader, problem)).ok()?;
            // The same quantity may have two units, but not one unit twice: columns have names of their own.
            if asked.iter().any(|asked| all.contains(asked)) {
                report_twice(&entry, reader, name);
                return None;
            }
            Some(asked)
        });
        are_valid &= found.is_some();
        all.extend(found.unwrap_or_default());
    }
    are_valid.then_some(all)
}

/// Quantities of a name: one entry for each term with it, or for each of a group.
fn resolve<Q: Copy>(
    name: &str,
    terms: &[Term<Q>],
    groups: &[Group<Q>],
) -> Result<Vec<Asked<Q>>, Problem> {
    let named = |stem: &str, units: &[Unit]| {
        units.iter().copied().find(|unit| name.strip_prefix(stem) == Some(unit.suffix()))
    };
    let found: Vec<Asked<Q>> = terms
        .iter()
        .filter_map(|term| {
            let unit = named(&term.stem, term.units)?;
            Some(Asked { wanted: term.wanted, unit })
        })
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    for group in groups {
        let given = named(group.name, group.units);
        if given.is_some() || (group.units.is_empty() && name == group.name) {
            let members = terms.iter().filter(|term| (group.has)(&term.wanted));
            let asked = |term: &Term<Q>| Asked {
                wanted: term.wanted,
                unit: given.unwrap_or(term.units[0]),
            };
            return Ok(members.map(asked).collect());
        }
    }
    let every = || {
        let terms = terms.iter().map(|term| (term.stem.as_str(), term.units));
        terms.chain(groups.iter().map(|group| (group.name, group.units)))
    };
    let with_units = |stem: &str, units: &[Unit]| -> Vec<String> {
        let units = if units.is_empty() { NUMBERS } else { units };
        units.iter().map(|unit| format!("{stem}{}", unit.suffix())).collect()
    };
    // The quantity without its unit, or with one of another kind.
    let bare = every().find(|(stem, units)| {
        let all = [LENGTHS, ANGLES, TIMES, NUMBERS].concat();
        let rest = name.strip_prefix(stem);
        rest.is_some_and(|rest| !units.is_empty() && all.iter().any(|unit| unit.suffix() == rest))
    });
    if let Some((stem, units)) = bare
        && units != NUMBERS
    {
        let units = with_units(stem, units);
        return Err(Problem::Unit { quantity: stem.to_owned(), units });
    }
    let mut known: Vec<String> = Vec::new();
    for (stem, units) in every() {
        let usual = with_units(stem, units).swap_remove(0);
        if !known.contains(&usual) {
            known.push(usual);
        }
    }
    let known = known.iter().map(String::as_str);
    Err(Problem::Common(FileProblem::unknown("quantity", name, known)))
}
