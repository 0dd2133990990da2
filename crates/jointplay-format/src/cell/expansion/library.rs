//! Texts of parts: those of the library, and files.

use std::borrow::Cow;
use std::collections::BTreeMap;

use toml::de::DeTable;

use super::super::files::{Files, read_named_file};
use super::super::problem::Fault;
use super::super::tree::{Entry, Reader};

/// The `kind` of files of parts.
pub(super) const PART_KIND: &str = "part";

/// Longer texts of parts are refused.
const MAX_PART_BYTES: usize = 100_000;

/// The included parts, by name.
const PARTS: [(&str, &str); 10] = [
    ("foup", include_str!("../../../parts/foup.toml")),
    ("load-port", include_str!("../../../parts/load-port.toml")),
    ("aligner", include_str!("../../../parts/aligner.toml")),
    ("wafer-rest", include_str!("../../../parts/wafer-rest.toml")),
    ("slit-valve", include_str!("../../../parts/slit-valve.toml")),
    ("chamber", include_str!("../../../parts/chamber.toml")),
    ("blade", include_str!("../../../parts/blade.toml")),
    ("fork-blade", include_str!("../../../parts/fork-blade.toml")),
    ("support-pads", include_str!("../../../parts/support-pads.toml")),
    ("dual-arm-bodies", include_str!("../../../parts/dual-arm-bodies.toml")),
];

/// A part of the library.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name in cell files.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
    /// Description in one sentence.
    pub description: String,
    /// Whether it is a station.
    pub is_station: bool,
    /// Its parameters, in the order of the file.
    pub parameters: Vec<PartParameter>,
}

/// A parameter of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartParameter {
    /// Name, which ends in the unit.
    pub name: String,
    /// Default: a number, or an expression of other parameters.
    pub default: String,
    /// Meaning.
    pub meaning: String,
}

/// All parts of the library.
///
/// # Panics
/// Never: a test reads all parts.
#[must_use]
pub fn parts() -> Vec<Part> {
    PARTS.iter().map(|&(name, text)| described(name, text)).collect()
}

/// Whether a part of the library is a station; `None` for other parts.
pub(in super::super) fn is_station(name: &str) -> Option<bool> {
    let (name, text) = PARTS.iter().find(|(known, _)| *known == name)?;
    Some(described(name, text).is_station)
}

fn described(name: &'static str, text: &'static str) -> Part {
    let document = DeTable::parse(text).expect("the included parts are valid, as a test checks");
    let document = document.get_ref();
    let table = |key: &str| document.get(key).and_then(|value| value.get_ref().as_table());
    let meaning = |key: &str| {
        let meaning = table("meaning").and_then(|table| table.get(key)?.get_ref().as_str());
        meaning.unwrap_or_default().to_owned()
    };
    let mut keys: Vec<_> = table("parameters").into_iter().flatten().collect();
    keys.sort_by_key(|(key, _)| key.span().start);
    let parameter =
        |(key, value): (&toml::Spanned<Cow<str>>, &toml::Spanned<toml::de::DeValue>)| {
            let key: &str = key.get_ref();
            let span = value.span();
            let default = text.get(span).unwrap_or_default().trim_matches('"').to_owned();
            PartParameter { name: key.to_owned(), default, meaning: meaning(key) }
        };
    Part {
        name,
        text,
        description: document
            .get("description")
            .and_then(|value| value.get_ref().as_str())
            .unwrap_or_default()
            .to_owned(),
        is_station: document.contains_key("station"),
        parameters: keys.into_iter().map(parameter).collect(),
    }
}

/// Texts of the parts that a document names.
pub(in super::super) struct Library(BTreeMap<String, Result<Cow<'static, str>, String>>);

impl Library {
    /// Reads the texts of all parts that a document names.
    pub(in super::super) fn load(document: &DeTable, files: &mut Files) -> Self {
        let lists = ["part", "template"].into_iter().filter_map(|key| document.get(key));
        let tables = lists.filter_map(|list| list.get_ref().as_array()).flatten();
        let names = tables.filter_map(|table| {
            table.get_ref().as_table()?.get("part").and_then(|name| name.get_ref().as_str())
        });
        let mut texts = BTreeMap::new();
        for name in names {
            if texts.contains_key(name) {
                continue;
            }
            let included = PARTS.iter().find(|(known, _)| *known == name);
            let text = match included {
                Some((_, text)) => Ok(Cow::Borrowed(*text)),
                None if name.ends_with(".toml") => read_text(name, files).map(Cow::Owned),
                None => continue,
            };
            texts.insert(name.to_owned(), text);
        }
        Self(texts)
    }

    /// Name and text of a part; an unknown one is reported.
    pub(super) fn text<'a>(
        &'a self,
        part: &Entry<'_, 'a>,
        reader: &Reader<'a>,
    ) -> Option<(String, &'a str)> {
        let name = part.line(reader)?.to_owned();
        match self.0.get(&name) {
            Some(Ok(text)) => Some((name, text)),
            Some(Err(why)) => {
                part.report(reader, Fault::File { name, why: why.clone() });
                None
            }
            None => {
                let included = PARTS.iter().map(|&(name, _)| name);
                let known: Vec<String> =
                    included.chain(["or a file ….toml"]).map(str::to_owned).collect();
                part.unknown(reader, "part", &name, &known);
                None
            }
        }
    }
}

fn read_text(name: &str, files: &mut Files) -> Result<String, String> {
    let bytes = read_named_file(name, files)?;
    if bytes.len() > MAX_PART_BYTES {
        return Err(format!(
            "it has {} bytes, but a part has at most {MAX_PART_BYTES}",
            bytes.len()
        ));
    }
    String::from_utf8(bytes).map_err(|_| "it is not text in UTF-8".to_owned())
}
