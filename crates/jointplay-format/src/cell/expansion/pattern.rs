//! Patterns of tables: `repeat = { count = 3, step_mm = [0, 0, 350] }`.

use toml::Spanned;
use toml::de::{DeArray, DeValue};

use super::super::problem::Fault;
use super::super::tree::{AllowedRange, Entry, Reader};
use super::document::{Node, Value, moved_value};
use super::groups::Groups;
use crate::expression::Scope;

/// Largest number of copies of a table.
const MAX_COPIES: usize = 400;

/// The number of a copy in expressions, counted from 1.
const NUMBER: &str = "n";

/// Replaces each table with `repeat` by its copies, whose names end in their numbers.
pub(super) fn repeat<'a>(
    reader: &Reader<'a>,
    nodes: Vec<Node<'a>>,
    groups: &mut Groups,
) -> Vec<Node<'a>> {
    let copies = |node: Node<'a>| {
        if node.table.contains_key("repeat") { copies(reader, node, groups) } else { vec![node] }
    };
    nodes.into_iter().flat_map(copies).collect()
}

fn copies<'a>(reader: &Reader<'a>, mut node: Node<'a>, groups: &mut Groups) -> Vec<Node<'a>> {
    let Some(value) = node.table.remove("repeat") else { return Vec::new() };
    let entry = Entry { key: "repeat", value: &value };
    // With an error in its pattern, a table counts as one without it, which prevents further errors.
    let Some(table) = entry.table(reader, "`repeat`") else { return vec![node] };
    let count = table.needed("count").and_then(|count| count.count(reader, 0, MAX_COPIES));
    let _ = table.entry("step_mm");
    table.finish();
    let step = table.entry("step_mm").map(|step| step.value.clone());
    let Some(scope) = reader.scope(node.span.start) else { return vec![node] };
    // One copy with an invalid count, so that `n` is known.
    let count = count.unwrap_or(1);
    if scope.parameters.contains(NUMBER) {
        let why = format!(
            "the parameter `{NUMBER}` hides the number of the copy, which is called `{NUMBER}` within `repeat`: rename the parameter"
        );
        entry.report(reader, Fault::Unfit(why));
        return vec![node];
    }
    if !groups.add_copies(count) {
        entry.report(reader, Groups::too_many());
        return vec![node];
    }
    if step.is_some()
        && let Some(key) =
            ["taught", "carrier_axis"].into_iter().find(|key| node.table.contains_key(*key))
    {
        let why = format!(
            "`step_mm` moves `position_mm`, but the position follows from `{key}`: describe each station by a table of its own"
        );
        table.report_at("step_mm", Fault::Unfit(why));
        return vec![node];
    }
    let copy = |number: usize| {
        let mut numbered = Scope::clone(&scope);
        #[expect(clippy::cast_precision_loss, reason = "at most 400")]
        numbered.values.insert(NUMBER.to_owned(), number as f64);
        numbered.parameters.insert(NUMBER.to_owned());
        let by = reader.copy(node.span.start, numbered);
        let mut copy = node.moved(by);
        if let Some(name) = copy.table.get("name")
            && let Some(base) = name.get_ref().as_str()
        {
            let (span, base) = (name.span(), base.to_owned());
            let name = format!("{base}{number}");
            groups.add(&base, &name);
            copy.set_text("name", name, span);
        }
        if let Some(step) = &step {
            add_steps(reader, &mut copy, &moved_value(step, by), number);
        }
        copy
    };
    (1..=count).map(copy).collect()
}

/// Moves the position of a copy by its number of steps.
fn add_steps<'a>(reader: &Reader<'a>, copy: &mut Node<'a>, step: &Value<'a>, number: usize) {
    let numbers =
        |key, value: &Value<'a>| Entry { key, value }.numbers::<3, _>(reader, AllowedRange::Any);
    let span = copy.table.get("position_mm").map_or(step.span(), Spanned::span);
    let position = match copy.table.get("position_mm") {
        Some(position) => numbers("position_mm", position),
        None => Some([0.0; 3]),
    };
    // The position remains where one of them is invalid, which is reported.
    let (Some(position), Some(step)) = (position, numbers("step_mm", step)) else { return };
    #[expect(clippy::cast_precision_loss, reason = "at most 400")]
    let steps = (number - 1) as f64;
    let moved: DeArray = (0..3)
        .map(|k| {
            // As an expression, for numbers of a document cannot be made; the positions differ, for values are known by them.
            let text = format!("{}", position[k] + steps * step[k]);
            Spanned::new(span.start + k..span.end, DeValue::String(text.into()))
        })
        .collect();
    copy.set("position_mm", Spanned::new(span, DeValue::Array(moved)));
}
