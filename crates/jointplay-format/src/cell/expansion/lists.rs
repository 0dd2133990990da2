//! Tables of stations, bodies, zones and frames.

use toml::de::DeTable;

use super::super::tree::Reader;
use super::document::{Node, take_list};
use super::groups::Groups;
use super::inheritance::inherit;
use super::pattern::repeat;

/// Kinds of tables that patterns and parts generate.
#[derive(Default)]
pub(super) struct Lists<'a> {
    pub(super) frames: Vec<Node<'a>>,
    pub(super) stations: Vec<Node<'a>>,
    pub(super) bodies: Vec<Node<'a>>,
    pub(super) zones: Vec<Node<'a>>,
}

impl<'a> Lists<'a> {
    /// Takes the tables of a document, with the keys of their templates, and repeated.
    pub(super) fn take(
        reader: &Reader<'a>,
        document: &mut DeTable<'a>,
        templates: &[Node<'a>],
        groups: &mut Groups,
    ) -> Self {
        let mut take = |kind: &str| {
            let nodes = inherit(reader, kind, take_list(document, kind), templates);
            repeat(reader, nodes, groups)
        };
        Self {
            frames: take("frame"),
            stations: take("station"),
            bodies: take("body"),
            zones: take("zone"),
        }
    }
}
