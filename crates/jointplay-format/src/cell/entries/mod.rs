//! Entries of a cell file, added, duplicated and removed with the comments of all others: stations, bodies, arms and effectors.
//!
//! | file | contents |
//! | --- | --- |
//! | `lists` | tables of lists, and values of arrays |
//! | `names` | names in use |
//! | `contacts` | allowed contacts |
//! | `attached` | bodies, parts and frames that belong to a station, an arm or an effector |
//! | `robot_table` | the robot as a table of the cell file |
//! | `mounting` | heights of arms |
//! | `arms` | arms and effectors |

mod added;
mod arms;
mod attached;
mod contacts;
mod lists;
mod mounting;
mod names;
mod robot_table;

use nalgebra::Vector3;
use toml_edit::{Array, DocumentMut, Item, Table, TableLike, Value};

use super::described::{self, TABLES, is_called};
use super::edit::{document, inline, number, point};
use super::files::Files;
use super::problem::{Fault, Problem};
use crate::file_problem::FileProblem;
use crate::line_ends;
use crate::place::Error;
use crate::units::deg;
pub use added::EntryAdded;
use attached::{Attached, NewNames, Owners};
use names::Names;
pub use robot_table::ArmEdits;

/// List of a cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryList {
    /// Stations, including those that parts describe.
    Station,
    /// Bodies.
    Body,
    /// Arms of the robot.
    Arm,
    /// Effectors of all arms.
    Effector,
}

/// A new entry of a cell file, with assumed dimensions.
#[derive(Debug, Clone, PartialEq)]
pub enum NewEntry {
    /// A station with one slot.
    Station {
        /// Centre of the wafer at rest in the base frame; at least 0.3 m from the robot's axis (m).
        position: Vector3<f64>,
        /// Rotation about the vertical (rad).
        heading: f64,
    },
    /// A box of 100 mm that does not move.
    Body {
        /// Its centre in the base frame (m).
        position: Vector3<f64>,
    },
    /// An arm like that of the robot `radial-arm` of the catalogue, with axes, one effector and bodies of its own, mounted above the other arms.
    Arm,
    /// An effector like that of the robot `radial-arm` of the catalogue with a blade, 10 mm above the highest one of its arm, with the heading of that one.
    Effector {
        /// Name of the arm.
        arm: String,
    },
}

/// Least distance of a new station from the robot's axis, on which it would have no direction of approach (m).
const MIN_DISTANCE: f64 = 0.3;

/// Position of a new station: nearer to the robot's axis, it is moved out along its y axis.
fn off_the_axis(position: &Vector3<f64>, heading: f64) -> Vector3<f64> {
    if position.xy().norm() >= MIN_DISTANCE {
        return *position;
    }
    let (sin, cos) = heading.sin_cos();
    Vector3::new(-sin * MIN_DISTANCE, cos * MIN_DISTANCE, position.z)
}

/// Adds an entry after the last one of its list.
///
/// A robot of the catalogue is copied into the cell file before it gets an arm or an effector.
///
/// # Arguments
/// * `files` – as for [`read`](super::read); for an arm, which is mounted above all bodies of the others, and for an effector, which is above the others of its arm
///
/// # Errors
/// The text is not TOML, or the list is a value of another type; for an arm, the robot is in another file, or has two arms; for an effector, the robot is in another file or has no arm of this name, or the arm has four effectors.
pub fn add_entry(text: &str, entry: &NewEntry, files: &mut Files) -> Result<EntryAdded, Problem> {
    let mut document = document(text)?;
    let at_start = |fault| Error::at(text, 0..0, fault);
    let (key, base, values) = match entry {
        NewEntry::Station { position, heading } => {
            let stroke = [("below_mm", 4.0), ("above_mm", 3.0), ("speed_mm_s", 20.0)];
            let values = vec![
                ("position_mm", point(&off_the_axis(position, *heading))),
                ("heading_deg", number(deg(*heading))),
                ("stroke", inline(stroke.map(|(key, value)| (key, number(value))))),
                ("retract_mm", number(10.0)),
            ];
            ("station", "S1", values)
        }
        NewEntry::Body { position } => {
            let size: Array = [100.0, 100.0, 100.0].into_iter().collect();
            let values = vec![
                ("position_mm", point(position)),
                ("box", inline([("size_mm", Value::Array(size))])),
            ];
            ("body", "body-1", values)
        }
        NewEntry::Arm => {
            let added = arms::add(&mut document, text, files).map_err(at_start)?;
            return Ok(added.in_text(text));
        }
        NewEntry::Effector { arm } => {
            let added = arms::add_effector(&mut document, arm, text, files).map_err(at_start)?;
            return Ok(added.in_text(text));
        }
    };
    let name = Names::of(&document).take(base);
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    table.insert("name", Item::Value(Value::from(&name)));
    for (key, value) in values {
        table.insert(key, Item::Value(value));
    }
    lists::append(document.as_table_mut(), key, table).map_err(at_start)?;
    Ok(EntryAdded { text: document.to_string(), name }.in_text(text))
}

/// Duplicates an entry after itself under another name, with everything attached to it.
///
/// Bodies, parts and frames attached to a station, an arm or an effector are duplicated with it.
/// An arm is duplicated with its effectors and the axes that move no other arm, and mounted above all arms; an effector is duplicated 10 mm above the original.
/// Allowed contacts among the duplicated bodies are duplicated.
/// A robot of the catalogue is copied into the cell file first.
///
/// # Arguments
/// * `files` – as for [`add_entry`]
///
/// # Errors
/// The text is not TOML, or has no table of this name; for an arm or an effector, the robot is in another file, or has no place for another one.
pub fn duplicate_entry(
    text: &str,
    list: EntryList,
    name: &str,
    files: &mut Files,
) -> Result<EntryAdded, Problem> {
    let mut document = document(text)?;
    let document = &mut document;
    let duplicated = match list {
        EntryList::Station | EntryList::Body => duplicate(document, list, name),
        EntryList::Arm => arms::duplicate(document, name, text, files),
        EntryList::Effector => arms::duplicate_effector(document, name),
    };
    let duplicated = duplicated.map_err(|fault| Error::at(text, 0..0, fault))?;
    Ok(duplicated.in_text(text))
}

fn duplicate(document: &mut DocumentMut, list: EntryList, name: &str) -> Result<EntryAdded, Fault> {
    find(document, list, name)?;
    let mut names = Names::of(document);
    let new = names.take(name);
    let attached = attached_to(document, list, name);
    let mut new_names = NewNames::from([(("station", name.to_owned()), new.clone())]);
    let bodies = attached::duplicate(document, &attached, (name, &new), &mut new_names, &mut names);
    // Attached tables of the same list may have moved it.
    let (key, index) = find(document, list, name)?;
    lists::duplicate(document.as_table_mut(), key, index, |copy| attached::rename(copy, &new));
    contacts::duplicate(document, &bodies);
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Removes an entry, with the comment directly above it, and everything that belongs to it.
///
/// Bodies, parts and frames attached to a station, an arm or an effector are removed with it, and all their allowed contacts.
/// An arm is removed with its effectors and the axes that move no other arm.
/// Other references, such as those of stations to effectors, remain, and become errors of the cell or the program.
/// A robot of the catalogue is copied into the cell file first.
///
/// # Errors
/// The text is not TOML, has no table of this name, or another table takes values from it; for an arm or an effector, the robot is in another file, or it is the last one.
pub fn remove_entry(text: &str, list: EntryList, name: &str) -> Result<String, Problem> {
    let mut document = document(text)?;
    let document = &mut document;
    let removed = match list {
        EntryList::Station | EntryList::Body => remove(document, list, name),
        EntryList::Arm => arms::remove(document, name),
        EntryList::Effector => arms::remove_effector(document, name),
    };
    let removed = removed.map_err(|fault| Error::at(text, 0..0, fault))?;
    Ok(line_ends::as_before(removed, text))
}

fn remove(document: &mut DocumentMut, list: EntryList, name: &str) -> Result<String, Fault> {
    find(document, list, name)?;
    let attached = attached_to(document, list, name);
    let mut removed: Vec<&str> = attached.iter().map(|one| one.name.as_str()).collect();
    removed.push(name);
    attached::check_not_borrowed(document, &removed)?;
    let mut comments = attached::remove(document, &attached);
    // Attached tables of the same list may have moved it.
    let (key, index) = find(document, list, name)?;
    comments.extend(lists::remove(document.as_table_mut(), key, index));
    comments.into_iter().for_each(|one| lists::place_comments(document, one));
    contacts::remove(document, &removed);
    Ok(document.to_string())
}

/// Everything attached to a station; nothing is attached to bodies.
fn attached_to(document: &DocumentMut, list: EntryList, name: &str) -> Vec<Attached> {
    match list {
        EntryList::Station => {
            attached::attached(document, Owners::from([("station", vec![name.to_owned()])]))
        }
        _ => Vec::new(),
    }
}

/// List and index of the table of a station or a body.
fn find(
    document: &mut DocumentMut,
    list: EntryList,
    name: &str,
) -> Result<(&'static str, usize), Fault> {
    let keys: &[&'static str] = match list {
        EntryList::Station => &TABLES,
        _ => &["body"],
    };
    let is_meant = |table: &dyn TableLike| match list {
        EntryList::Station => is_called(table, name),
        _ => is_body(table, name),
    };
    for key in keys {
        let position = described::all(document, key).iter().position(|table| is_meant(*table));
        if let Some(index) = position {
            return Ok((key, index));
        }
    }
    if list == EntryList::Station {
        described::table(document, name)?;
    }
    let bodies = described::all(document, "body");
    let known = bodies.iter().filter_map(|table| names::name(*table));
    Err(FileProblem::unknown("body with a table of its own", name, known).into())
}

fn is_body(table: &dyn TableLike, name: &str) -> bool {
    names::name(table) == Some(name) && !table.contains_key("repeat")
}
