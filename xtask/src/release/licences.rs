//! Whether the licences of libraries are among those that `deny.toml` allows.

use std::path::Path;
use std::{fs, io};

use spdx::{Expression, Licensee, ParseMode};

use super::components::Component;

/// Refuses libraries whose licences are not allowed.
///
/// # Errors
/// With the first such library, or an error in `deny.toml`.
pub(super) fn check(components: &[Component], root: &Path) -> io::Result<()> {
    let allowed = allowed(&fs::read_to_string(root.join("deny.toml"))?)?;
    for component in components {
        if !is_allowed(&component.licence, &allowed)? {
            return Err(io::Error::other(format!(
                "{} {} is under {}, which deny.toml does not allow",
                component.name, component.version, component.licence
            )));
        }
    }
    Ok(())
}

fn allowed(deny: &str) -> io::Result<Vec<Licensee>> {
    let deny: toml::Table = deny.parse().map_err(io::Error::other)?;
    let list = deny.get("licenses").and_then(|table| table.get("allow")?.as_array());
    let words = list.into_iter().flatten().filter_map(toml::Value::as_str);
    words.map(|word| Licensee::parse(word).map_err(io::Error::other)).collect()
}

fn is_allowed(licence: &str, allowed: &[Licensee]) -> io::Result<bool> {
    let expression = Expression::parse_mode(licence, ParseMode::LAX).map_err(io::Error::other)?;
    Ok(expression.evaluate(|one| allowed.iter().any(|licensee| licensee.satisfies(one))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::release::components;

    #[test]
    fn libraries_of_all_platforms_are_allowed() {
        let root = crate::root::find();
        let found = components::crates(&root, None).unwrap();
        assert!(found.len() > 250, "{}", found.len());
        check(&found, &root).unwrap();
    }

    #[test]
    fn choices_and_conjunctions() {
        let allowed = allowed("[licenses]\nallow = [\"MIT\", \"BSD-3-Clause\"]").unwrap();
        for (licence, expect) in [
            ("MIT", true),
            ("Apache-2.0 OR MIT", true),
            ("MIT AND BSD-3-Clause", true),
            ("MIT AND Apache-2.0", false),
            ("(MIT OR GPL-3.0) AND (GPL-2.0 OR BSD-3-Clause)", true),
            ("LGPL-2.1-or-later", false),
        ] {
            assert_eq!(is_allowed(licence, &allowed).unwrap(), expect, "{licence}");
        }
        assert!(is_allowed("No licence", &allowed).is_err());
    }
}
