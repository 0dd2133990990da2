//! Names and texts that can be printed.

use toml::Spanned;

use super::problem::{Error, Problem};

/// A name of a joint, by which commands find it.
pub(super) fn joint_name(text: &str, found: &Spanned<String>) -> Result<String, Error> {
    let read = printable_name(text, "name", found)?;
    if read.contains([',', '=', '[', ']']) {
        return Err(Error::at(text, found.span(), Problem::JointName { found: read }));
    }
    Ok(read)
}

/// A name that can be printed.
pub(super) fn printable_name(
    text: &str,
    key: &'static str,
    name: &Spanned<String>,
) -> Result<String, Error> {
    let found = name.get_ref().clone();
    if found.trim().is_empty() || found.chars().any(char::is_control) {
        return Err(Error::at(text, name.span(), Problem::Name { key, found }));
    }
    Ok(found)
}

/// Text that can be printed, of any number of lines.
pub(super) fn prose(
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
