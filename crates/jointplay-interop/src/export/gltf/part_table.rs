//! Tables of parts: which nodes of a CAD model move with which link.

use jointplay_format::file_problem::FileProblem;
use jointplay_format::place::Errors;
use jointplay_format::toml_reader::{Table, read_document};

use super::parts_file::UpAxis;

/// Longest accepted table (bytes).
const MAX_BYTES: usize = 4_000_000;
/// The value of the key `kind`.
const KIND: &str = "parts";
const AXES: [(&str, UpAxis); 2] = [("y", UpAxis::Y), ("z", UpAxis::Z)];

/// A table of parts, as a file has it.
///
/// ```
/// let table = jointplay_interop::export::PartTable::parse(r#"
///     kind = "parts"
///     up = "z"
///     [links]
///     "rod 1" = "part 7"
///     platform = ["plate", "ring"]
/// "#)?;
/// assert_eq!(table.parts[0], ("plate".to_owned(), "platform".to_owned()));
/// # Ok::<(), jointplay_format::place::Errors<jointplay_format::file_problem::FileProblem>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PartTable {
    /// The axis of the file of parts that is z of the base frame, if stated.
    pub up: Option<UpAxis>,
    /// Names of nodes with the names of the links that they move with.
    pub parts: Vec<(String, String)>,
}

impl PartTable {
    /// Reads a table of parts (TOML): `kind = "parts"`, `up`, and in `[links]` for each link the name of a node or a list of them.
    ///
    /// # Errors
    /// All errors in the order of their places, at least one.
    pub fn parse(text: &str) -> Result<Self, Errors<FileProblem>> {
        read_document(text, MAX_BYTES, "a table of parts", |top| {
            let kind = top.needed("kind");
            let kind = kind.and_then(|kind| kind.word(top.reader, "the kind", &[(KIND, ())]));
            let up = top.entry("up").and_then(|entry| entry.word(top.reader, "the axis", &AXES));
            let parts = links(top);
            top.finish();
            kind.map(|()| Self { up, parts })
        })
    }
}

fn links(top: &Table<'_, '_, FileProblem>) -> Vec<(String, String)> {
    let reader = top.reader;
    if top.needed("links").is_none() {
        return Vec::new();
    }
    let Some(table) = top.table("links", "`[links]`") else { return Vec::new() };
    let mut parts = Vec::new();
    for (entry, _) in table.entries() {
        let nodes = if entry.is_text() {
            entry.text(reader).into_iter().collect()
        } else {
            let list = entry.list(reader).unwrap_or_default();
            list.iter().filter_map(|node| node.text(reader)).collect::<Vec<_>>()
        };
        parts.extend(nodes.into_iter().map(|node| (node.to_owned(), entry.key.to_owned())));
    }
    parts
}
