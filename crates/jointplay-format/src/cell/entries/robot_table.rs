//! The robot as a table of the cell file, and the numbers of its arms and effectors that are allowed.

use jointplay_cell::robot::{HybridRobot, MAX_ARMS, MAX_EFFECTORS};
use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::super::edit::document;
use super::super::problem::Fault;
use super::super::robot::KIND;
use super::lists::{last_position, move_positions, separate_comments, text};
use crate::catalogue;

const KEY: &str = "robot";

/// Reasons why arms and effectors of a cell cannot be added, duplicated or removed; `None` where they can.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArmEdits {
    /// An arm, added or duplicated.
    pub add_arm: Option<String>,
    /// An arm, removed.
    pub remove_arm: Option<String>,
    /// An effector, added or duplicated, for each arm.
    pub add_effector: Vec<Option<String>>,
    /// An effector, removed, for each arm.
    pub remove_effector: Vec<Option<String>>,
}

impl ArmEdits {
    /// The reasons for a cell file with this robot.
    #[must_use]
    pub fn new(text: &str, robot: &HybridRobot) -> Self {
        let file = document(text).ok().and_then(|document| robot_file(&document));
        let refusal = |other: Option<String>| file.clone().or(other);
        let of_arms = |reason: fn(usize) -> Option<String>| {
            robot.arms.iter().map(|arm| refusal(reason(arm.effectors.len()))).collect()
        };
        Self {
            add_arm: refusal(no_more_arms(robot.arms.len())),
            remove_arm: refusal(last_arm(robot.arms.len())),
            add_effector: of_arms(no_more_effectors),
            remove_effector: of_arms(last_effector),
        }
    }
}

/// Reason why a robot with this number of arms gets no other.
pub(super) fn no_more_arms(arms: usize) -> Option<String> {
    (arms >= MAX_ARMS).then(|| {
        format!("the robot has {arms} arms, and at most {MAX_ARMS} are allowed: remove one first")
    })
}

/// Reason why a robot with this number of arms loses none.
pub(super) fn last_arm(arms: usize) -> Option<String> {
    (arms <= 1).then(|| "a robot needs at least one arm: add another one first".to_owned())
}

/// Reason why an arm with this number of effectors gets no other.
pub(super) fn no_more_effectors(effectors: usize) -> Option<String> {
    (effectors >= MAX_EFFECTORS).then(|| {
        format!("the arm has {effectors} effectors, and at most {MAX_EFFECTORS} are allowed: remove one first")
    })
}

/// Reason why an arm with this number of effectors loses none.
pub(super) fn last_effector(effectors: usize) -> Option<String> {
    (effectors <= 1).then(|| "an arm needs at least one effector: add another one first".to_owned())
}

/// Reason why the robot cannot be changed in this text: it is in another file.
fn robot_file(document: &DocumentMut) -> Option<String> {
    let name = document.get(KEY)?.as_str()?;
    if catalogue_text(name).is_some() {
        return None;
    }
    Some(format!(
        "the arms are described in {name:?}, and only the cell file is changed here: change {name:?} in its text, or describe the robot by a table `[robot]` of the cell file"
    ))
}

/// The text of a robot with arms of the catalogue.
fn catalogue_text(name: &str) -> Option<&'static str> {
    let entry = catalogue::find(name)?;
    (entry.kind().as_deref() == Some(KIND)).then_some(entry.text)
}

/// The robot's table; a robot of the catalogue is copied into the cell file first.
///
/// # Errors
/// The robot is missing, or in another file.
pub(super) fn embedded(document: &mut DocumentMut) -> Result<&mut dyn TableLike, Fault> {
    if let Some(why) = robot_file(document) {
        return Err(Fault::Unfit(why));
    }
    embed(document);
    let table = document.get_mut(KEY).and_then(Item::as_table_like_mut);
    table.ok_or_else(|| {
        Fault::Unfit(
            "the cell has no robot whose arms can be changed: name one by `robot`".to_owned(),
        )
    })
}

/// Replaces the name of a robot of the catalogue by its table, at the end of the document.
fn embed(document: &mut DocumentMut) {
    let name = document.get(KEY).and_then(Item::as_str).map(str::to_owned);
    let Some((name, source)) = name.and_then(|name| catalogue_text(&name).map(|text| (name, text)))
    else {
        return;
    };
    // The files of the catalogue are valid, as a test checks.
    let Ok(mut source) = source.parse::<DocumentMut>() else { return };
    let heading = source
        .remove_entry("kind")
        .map(|(key, _)| text(key.leaf_decor().prefix()).to_owned())
        .unwrap_or_default();
    let mut table = source.as_table().clone();
    table.set_implicit(false);
    let first = last_position(document.as_table()).unwrap_or(0) + 1;
    // The table itself is the first one.
    table.set_position(Some(-1));
    move_positions(&mut table, &mut |one| one.map(|one| one + 1 + first));
    let next = next_key(document);
    let Some((key, item)) = document.remove_entry(KEY) else { return };
    let above = text(key.leaf_decor().prefix());
    let behind = item.as_value().map(|value| text(value.decor().suffix())).unwrap_or_default();
    let of_section = separate_comments(above);
    let own = &above[of_section.len()..];
    if let Some(mut next) = next.as_deref().and_then(|next| document.key_mut(next)) {
        let before = text(next.leaf_decor().prefix()).to_owned();
        next.leaf_decor_mut().set_prefix(format!("{of_section}{before}"));
        set_header(&mut table, "", own, &name, &heading, behind);
    } else {
        set_header(&mut table, of_section, own, &name, &heading, behind);
    }
    let trailing = text(Some(document.trailing())).to_owned();
    document.set_trailing("");
    let prefix = text(table.decor().prefix()).to_owned();
    let separator = if trailing.is_empty() || trailing.ends_with('\n') { "" } else { "\n" };
    table.decor_mut().set_prefix(format!("{trailing}{separator}{prefix}"));
    document.insert(KEY, Item::Table(table));
}

/// The first key with a value after that of the robot.
fn next_key(document: &DocumentMut) -> Option<String> {
    let after = document.iter().skip_while(|(key, _)| *key != KEY).skip(1);
    after.filter(|(_, item)| item.is_value()).map(|(key, _)| key.to_owned()).next()
}

fn set_header(
    table: &mut toml_edit::Table,
    of_section: &str,
    own: &str,
    name: &str,
    heading: &str,
    behind: &str,
) {
    let source = format!("# Copied from {name:?} of the catalogue.\n");
    let of_section = of_section.trim_start_matches('\n');
    table.decor_mut().set_prefix(format!("\n{of_section}{own}{source}{}", heading.trim_end()));
    if !heading.trim().is_empty() {
        let prefix = format!("{}\n", text(table.decor().prefix()));
        table.decor_mut().set_prefix(prefix);
    }
    table.decor_mut().set_suffix(behind);
}

/// Adds a length to a number or an expression in mm.
pub(super) fn raise(value: &mut Value, by_mm: f64) {
    let raised = match &*value {
        Value::Float(number) => Value::from(number.value() + by_mm),
        #[expect(clippy::cast_precision_loss, reason = "as the number is read elsewhere")]
        Value::Integer(number) => Value::from(*number.value() as f64 + by_mm),
        Value::String(expression) => {
            let number = crate::number::number(by_mm);
            Value::from(format!("({}) + {number}", expression.value()))
        }
        _ => return,
    };
    super::super::edit::replace(value, raised);
}
