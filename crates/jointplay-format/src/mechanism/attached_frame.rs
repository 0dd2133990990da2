//! Frames attached to links, from their tables.

use jointplay_core::mechanism::AttachedFrame;

use super::frame;
use super::joint::{Links, named};
use super::tree::Table;
use super::values::Values;

/// A frame from its table; its link has to be one of `links`.
pub(super) fn attached_frame(
    values: &Values,
    table: &mut Table,
    links: &Links,
) -> Option<AttachedFrame> {
    let name = named(table, "frame");
    let link = table.needed("link").and_then(|entry| {
        let wanted = entry.text(values.reader)?;
        let index = links.find(wanted);
        if index.is_none() {
            entry.unknown(values.reader, "link", wanted, &links.names);
        }
        index
    });
    let pose = frame::attached(values, table);
    table.finish();
    Some(AttachedFrame { name: name?, link: link?, link_from_frame: pose? })
}
