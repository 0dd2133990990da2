//! Lists of tables in a document, `[[key]]` or `key = [{ … }]`, changed with their comments.

use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, RawString, Table, TableLike, Value};

use super::super::problem::Fault;

/// Appends a table to a list.
///
/// # Errors
/// The value of the key is not a list.
pub(super) fn append(parent: &mut dyn TableLike, key: &str, mut table: Table) -> Result<(), Fault> {
    match parent.entry(key).or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new())) {
        Item::ArrayOfTables(list) => {
            // Tables without a position are written after the one before them.
            set_positions(&mut table, None);
            list.push(table);
        }
        Item::Value(Value::Array(list)) => {
            insert(list, list.len(), Value::InlineTable(table.into_inline_table()));
        }
        _ => {
            let why = format!("`{key}` is not a list of tables: add the entry in the text");
            return Err(Fault::Unfit(why));
        }
    }
    Ok(())
}

/// Duplicates a table of a list after itself, and changes the duplicate.
pub(super) fn duplicate(
    parent: &mut dyn TableLike,
    key: &str,
    index: usize,
    change: impl FnOnce(&mut dyn TableLike),
) {
    match parent.get_mut(key) {
        Some(Item::ArrayOfTables(list)) => {
            let Some(mut copy) = list.get(index).cloned() else { return };
            change(&mut copy);
            copy.decor_mut().set_prefix("\n");
            // Tables are written in the order of their positions: after the original and all tables in it.
            let last = last_position(&copy);
            set_positions(&mut copy, last);
            list.push(copy);
        }
        Some(Item::Value(Value::Array(list))) => {
            let Some(mut copy) = list.get(index).cloned() else { return };
            if let Some(table) = copy.as_inline_table_mut() {
                change(table);
            }
            copy.decor_mut().clear();
            insert(list, index + 1, copy);
        }
        _ => {}
    }
}

/// Comments of a section that remain after a removal, and the position of the last removed table.
pub(super) type SectionComments = (String, isize);

/// Removes a table of a list, with the comment directly above it.
pub(super) fn remove(
    parent: &mut dyn TableLike,
    key: &str,
    index: usize,
) -> Option<SectionComments> {
    match parent.get_mut(key) {
        Some(Item::ArrayOfTables(list)) => {
            let table = list.get(index)?;
            let comments = separate_comments(text(table.decor().prefix())).to_owned();
            let position = last_position(table);
            list.remove(index);
            if list.is_empty() {
                parent.remove(key);
            }
            Some((comments, position?)).filter(|(comments, _)| !comments.trim().is_empty())
        }
        Some(Item::Value(Value::Array(list))) => {
            remove_value(list, index);
            None
        }
        _ => None,
    }
}

/// Writes the comments of a section before the table that is now at their place.
pub(super) fn place_comments(document: &mut DocumentMut, (comments, position): SectionComments) {
    let mut positions = Vec::new();
    // Positions are read by the same visit as they are written.
    move_positions(document.as_table_mut(), &mut |one| {
        positions.extend(one);
        one
    });
    let next = positions.into_iter().filter(|&one| one > position).min();
    if let Some(next) = next.and_then(|next| table_at(document.as_table_mut(), next)) {
        let before = text(next.decor().prefix()).trim_start_matches('\n').to_owned();
        next.decor_mut().set_prefix(format!("{comments}{before}"));
    } else {
        let trailing = format!("{comments}{}", text(Some(document.trailing())));
        document.set_trailing(trailing);
    }
}

/// The table with a position, among all tables within a table.
fn table_at(table: &mut Table, position: isize) -> Option<&mut Table> {
    table.iter_mut().find_map(|(_, item)| {
        let tables: Vec<&mut Table> = match item {
            Item::Table(inner) => vec![inner],
            Item::ArrayOfTables(list) => list.iter_mut().collect(),
            _ => Vec::new(),
        };
        tables.into_iter().find_map(|one| {
            if one.position() == Some(position) { Some(one) } else { table_at(one, position) }
        })
    })
}

/// The largest position of a table and of all tables within it.
pub(super) fn last_position(table: &Table) -> Option<isize> {
    let within = table.iter().filter_map(|(_, item)| match item {
        Item::Table(inner) => last_position(inner),
        Item::ArrayOfTables(list) => list.iter().filter_map(last_position).max(),
        _ => None,
    });
    within.chain(table.position()).max()
}

/// Sets the position of a table and of all tables within it.
fn set_positions(table: &mut Table, position: Option<isize>) {
    move_positions(table, &mut |_| position);
}

/// Replaces the position of a table and of all tables within it.
pub(super) fn move_positions(
    table: &mut Table,
    to: &mut dyn FnMut(Option<isize>) -> Option<isize>,
) {
    table.set_position(to(table.position()));
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(inner) => move_positions(inner, to),
            Item::ArrayOfTables(list) => {
                list.iter_mut().for_each(|inner| move_positions(inner, to));
            }
            _ => {}
        }
    }
}

/// The comments above a table that are separated from it by an empty line, with this line.
pub(super) fn separate_comments(prefix: &str) -> &str {
    let mut end = 0;
    let mut at = 0;
    for line in prefix.split_inclusive('\n') {
        at += line.len();
        if line.trim().is_empty() {
            end = at;
        }
    }
    &prefix[..end]
}

/// White space and comments as text.
pub(super) fn text(raw: Option<&RawString>) -> &str {
    raw.and_then(RawString::as_str).unwrap_or_default()
}

// A comment after a value in an array, up to the end of its line, belongs to this value;
// comments on the lines after it belong to the next value.

/// Inserts a value into an array, on a line of its own if the others are.
pub(super) fn insert(list: &mut Array, index: usize, mut value: Value) {
    let gap = gap(list, index);
    let previous = index.checked_sub(1).and_then(|index| list.get(index));
    let (prefix, gap) = match gap.split_once('\n') {
        Some((line, rest)) => {
            let indent = previous.and_then(|value| text(value.decor().prefix()).rsplit_once('\n'));
            let indent = indent.map_or("    ", |(_, indent)| indent);
            (format!("{line}\n{indent}"), format!("\n{rest}"))
        }
        None if previous.is_some() => (" ".to_owned(), gap),
        None => (String::new(), gap),
    };
    value.decor_mut().set_prefix(prefix);
    value.decor_mut().set_suffix("");
    if index == list.len() {
        set_end(list, "");
    }
    list.insert_formatted(index, value);
    set_gap(list, index + 1, &gap);
}

/// Removes a value of an array, with its comments.
pub(super) fn remove_value(list: &mut Array, index: usize) {
    let Some(value) = list.get(index) else { return };
    let before = text(value.decor().prefix()).to_owned();
    let after = gap(list, index + 1);
    let is_last = index + 1 == list.len();
    let line = before.split_once('\n').map(|(line, _)| line);
    let gap = match after.split_once('\n') {
        Some((_, rest)) => format!("{}\n{rest}", line.unwrap_or_default()),
        None if is_last => match line {
            Some(line) if line.contains('#') => format!("{line}\n"),
            _ => after,
        },
        None if index == 0 || line.is_some() => before,
        None => after,
    };
    list.remove(index);
    set_gap(list, index, &gap);
}

/// Text before the value of an index, or before the end of the array.
fn gap(list: &Array, index: usize) -> String {
    if let Some(value) = list.get(index) {
        return text(value.decor().prefix()).to_owned();
    }
    let trailing = text(Some(list.trailing()));
    match list.iter().last() {
        Some(last) if !list.trailing_comma() => {
            format!("{}{trailing}", text(last.decor().suffix()))
        }
        _ => trailing.to_owned(),
    }
}

fn set_gap(list: &mut Array, index: usize, gap: &str) {
    match list.get_mut(index) {
        Some(value) => value.decor_mut().set_prefix(gap),
        None => set_end(list, gap),
    }
}

fn set_end(list: &mut Array, end: &str) {
    let last = list.len().checked_sub(1);
    let last = if list.trailing_comma() { None } else { last };
    match last.and_then(|last| list.get_mut(last)) {
        Some(value) => {
            value.decor_mut().set_suffix(end);
            list.set_trailing("");
        }
        None => list.set_trailing(end),
    }
}
