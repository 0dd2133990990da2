//! Errors of files of parts.

use jointplay_format::place::{listed, suggestion};

/// Why a file of parts cannot be animated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// Not a binary glTF file.
    #[error("the file of parts is not binary glTF (GLB): {why}")]
    NotBinary {
        /// What was found.
        why: String,
    },
    /// A name in the table of parts that no node has.
    #[error(
        "no node of the file of parts is named {found:?}{}; it has {}",
        suggestion(nearest),
        listed(known)
    )]
    UnknownNode {
        /// The name found.
        found: String,
        /// The most similar name.
        nearest: Option<String>,
        /// Names of nodes.
        known: Vec<String>,
    },
    /// A name in the table of parts that no link has.
    #[error(
        "no link is named {found:?}{}; the mechanism has {}",
        suggestion(nearest),
        listed(known)
    )]
    UnknownLink {
        /// The name found.
        found: String,
        /// The most similar name.
        nearest: Option<String>,
        /// Names of links.
        known: Vec<String>,
    },
    /// A name that several nodes have.
    #[error(
        "{count} nodes of the file of parts are named {name:?}; give each part a name of its own"
    )]
    Ambiguous {
        /// The name.
        name: String,
        /// Number of nodes.
        count: usize,
    },
    /// A node that a table assigns to two links.
    #[error("the table of parts moves {node:?} with {:?} and with {:?}; a part moves with one link", links[0], links[1])]
    TwoLinks {
        /// Name of the node.
        node: String,
        /// Names of the links.
        links: [String; 2],
    },
    /// No node moves.
    #[error(
        "no node of the file of parts has the name of a link; name the parts, or use a table of parts\n  nodes: {}\n  links: {}",
        listed(nodes),
        listed(links)
    )]
    NoMatch {
        /// Names of nodes.
        nodes: Vec<String>,
        /// Names of links.
        links: Vec<String>,
    },
}
