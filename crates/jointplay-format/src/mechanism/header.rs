//! What every file of mechanisms begins with.

use serde::Deserialize;
use toml::Spanned;

use super::expression::AngleUnit;
use super::file::UnitsTable;
use super::kind::kind_of;
use super::problem::{Error, Problem};
use super::values::{LengthUnit, Units, choice};
use crate::place;

/// Longest text that is read in bytes, so that a wrong file ends in a message and not in hours of work.
pub const MAX_BYTES: usize = 4_000_000;

/// Refuses a text that is too long or says that it is of another kind.
///
/// Before all else, lest a file of another kind be blamed for its keys.
pub(super) fn check_kind(text: &str, kind: &str) -> Result<(), Error> {
    if text.len() > MAX_BYTES {
        let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
        return Err(Error::at(text, 0..0, problem));
    }
    let other = kind_of(text).filter(|found| found != kind);
    if other.is_some() {
        #[derive(Deserialize)]
        struct Kind {
            kind: Spanned<String>,
        }
        let Kind { kind: found } = place::read::<Kind, Problem>(text)?;
        choice(text, "kind", &found, &[(kind, ())])?;
    }
    Ok(())
}

pub(super) fn units(text: &str, table: &UnitsTable) -> Result<Units, Error> {
    Ok(Units {
        length: choice(text, "unit of length", &table.length, &LengthUnit::ALL)?,
        angle: choice(text, "unit of angle", &table.angle, &AngleUnit::ALL)?,
    })
}
