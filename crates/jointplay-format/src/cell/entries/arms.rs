//! Arms of the robot and their effectors.

use std::collections::{BTreeMap, BTreeSet};

use jointplay_cell::robot::Effector;
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::super::described::tables_of;
use super::super::edit::{inline, replace};
use super::super::file::robot_of;
use super::super::files::Files;
use super::super::problem::Fault;
use super::added::EntryAdded;
use super::attached::{self, NewNames, Owners, names_in, rename};
use super::mounting::Heights;
use super::names::{Names, name};
use super::robot_table::{
    embedded, last_arm, last_effector, no_more_arms, no_more_effectors, raise,
};
use super::{contacts, lists};
use crate::catalogue;
use crate::file_problem::FileProblem;

/// Robot of the catalogue whose arm a new arm is.
const SOURCE: &str = "radial-arm";

/// Bodies of a new arm: suffix of the name, link, centre and size (mm).
///
/// Each may touch the next one. They fit the links of [`SOURCE`].
const BODIES: [(&str, i64, [f64; 3], [f64; 3]); 4] = [
    ("upper-arm", 1, [115.0, 0.0, 0.0], [280.0, 50.0, 10.0]),
    ("forearm", 2, [115.0, 0.0, 0.0], [270.0, 40.0, 10.0]),
    ("wrist", 3, [45.0, 0.0, 2.0], [130.0, 40.0, 10.0]),
    ("blade", 3, [260.0, 0.0, 8.4], [340.0, 220.0, 3.0]),
];

/// Half the height of the lowest of these bodies (m).
const BELOW_MOUNT: f64 = 0.005;

/// Height of the mount of a new arm where that of the others is unknown (mm).
const UNKNOWN_MOUNT_MM: f64 = 250.0;

/// Distance of a duplicated effector above its original, and of a new one above the others: the pitch of carriers for wafers of 300 mm (mm).
const EFFECTOR_PITCH_MM: f64 = 10.0;

/// Centre of the blade of a new effector from the centre of the wafer's lower face, along the heading (mm): the blade of [`BODIES`] from the effector of [`SOURCE`].
const BLADE_POSITION: [f64; 3] = [-40.0, 0.0, -1.6];

/// Adds an arm with one effector and bodies, mounted above the other arms.
pub(super) fn add(
    document: &mut DocumentMut,
    text: &str,
    files: &mut Files,
) -> Result<EntryAdded, Fault> {
    let arms = tables_of(embedded(document)?, "arm").len();
    if let Some(why) = no_more_arms(arms) {
        return Err(Fault::Unfit(why));
    }
    let mount = match arms {
        // Directly on the platform, as in the catalogue.
        0 => None,
        _ => Some(Heights::of(text, files).map_or(UNKNOWN_MOUNT_MM, |it| it.mount_mm(BELOW_MOUNT))),
    };
    let mut names = Names::of(document);
    let new = names.take("arm-1");
    let source = source();
    let mut axes = tables(&source, "axis");
    let mut renamed = BTreeMap::new();
    for axis in &mut axes {
        let old = name(axis).unwrap_or_default().to_owned();
        let new = names.take(&old);
        rename(axis, &new);
        axis.decor_mut().set_prefix("\n");
        renamed.insert(old, new);
    }
    let mut arm = source_arm(&source);
    rename_arm(&mut arm, &new, &renamed, &mut names);
    arm.decor_mut().set_prefix(
        "\n# Lengths, droop, axis limits and bodies are assumed: change them to those of the real arm.\n",
    );
    if let (Some(height), Some(mount)) = (mount_height(&mut arm), mount) {
        *height = Value::from(mount);
        height.decor_mut().set_prefix(" ");
    }
    let robot = embedded(document)?;
    for axis in axes {
        lists::append(robot, "axis", axis)?;
    }
    lists::append(robot, "arm", arm)?;
    let mut bodies = Vec::new();
    for (suffix, link, position, size) in BODIES {
        let body = names.take(&format!("{new}-{suffix}"));
        let on = inline([("arm", Value::from(&new)), ("link", Value::from(link))]);
        lists::append(document.as_table_mut(), "body", a_box(&body, on, position, size))?;
        bodies.push(body);
    }
    let pairs: Vec<[String; 2]> =
        bodies.windows(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect();
    contacts::add(document, &pairs);
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Duplicates an arm with its own axes, its effectors, the bodies attached to it and their allowed contacts, mounted above the other arms.
pub(super) fn duplicate(
    document: &mut DocumentMut,
    arm: &str,
    text: &str,
    files: &mut Files,
) -> Result<EntryAdded, Fault> {
    let robot = embedded(document)?;
    let found = Found::new(robot, arm)?;
    if let Some(why) = no_more_arms(found.arms) {
        return Err(Fault::Unfit(why));
    }
    let by = Heights::of(text, files).map_or(UNKNOWN_MOUNT_MM, |it| it.raise_mm(found.index));
    let mut names = Names::of(document);
    let new = names.take(arm);
    let mut renamed = BTreeMap::new();
    for axis in &found.axes {
        renamed.insert(axis.clone(), names.take(axis));
    }
    let attached = attached::attached(document, found.owners());
    let robot = embedded(document)?;
    let mut new_names = NewNames::from([(("arm", arm.to_owned()), new.clone())]);
    lists::duplicate(robot, "arm", found.index, |copy| {
        let effectors = rename_arm(copy, &new, &renamed, &mut names);
        new_names.extend(effectors.into_iter().map(|(old, new)| (("effector", old), new)));
        if let Some(height) = mount_height(copy) {
            raise(height, by);
        }
    });
    for (index, axis) in names_in(robot, "axis").into_iter().enumerate().rev() {
        if let Some(new) = renamed.get(&axis) {
            lists::duplicate(robot, "axis", index, |copy| rename(copy, new));
        }
    }
    let bodies = attached::duplicate(document, &attached, (arm, &new), &mut new_names, &mut names);
    contacts::duplicate(document, &bodies);
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Removes an arm with the axes that move no other, its effectors, the bodies attached to it and their allowed contacts.
pub(super) fn remove(document: &mut DocumentMut, arm: &str) -> Result<String, Fault> {
    let found = Found::new(embedded(document)?, arm)?;
    if let Some(why) = last_arm(found.arms) {
        return Err(Fault::Unfit(why));
    }
    let attached = attached::attached(document, found.owners());
    let bodies: Vec<&str> = attached.iter().map(|one| one.name.as_str()).collect();
    attached::check_not_borrowed(document, &bodies)?;
    let mut comments = attached::remove(document, &attached);
    let robot = embedded(document)?;
    comments.extend(lists::remove(robot, "arm", found.index));
    for (index, axis) in names_in(robot, "axis").into_iter().enumerate().rev() {
        if found.axes.contains(&axis) {
            comments.extend(lists::remove(robot, "axis", index));
        }
    }
    comments.into_iter().for_each(|one| lists::place_comments(document, one));
    contacts::remove(document, &bodies);
    Ok(document.to_string())
}

/// Adds an effector with a blade to an arm, one pitch above its highest one.
pub(super) fn add_effector(
    document: &mut DocumentMut,
    arm: &str,
    text: &str,
    files: &mut Files,
) -> Result<EntryAdded, Fault> {
    let robot = embedded(document)?;
    let found = Found::new(robot, arm)?;
    let others = tables_of(tables_of(robot, "arm")[found.index], "effector");
    if let Some(why) = no_more_effectors(others.len()) {
        return Err(Fault::Unfit(why));
    }
    let highest = highest_effector(text, files, found.index).and_then(|index| others.get(index));
    let mut effector = source_effector();
    let mut base = name(&effector).unwrap_or_default().to_owned();
    if let Some(below) = highest.or(others.last()) {
        base = name(*below).map_or(base, str::to_owned);
        place_as(&mut effector, *below);
        if let Some(height) = height(&mut effector, "wafer_center_mm") {
            raise(height, EFFECTOR_PITCH_MM);
        }
    }
    let mut names = Names::of(document);
    let new = names.take(&base);
    rename(&mut effector, &new);
    effector.decor_mut().set_prefix(
        "\n# Position, support, friction and blade are assumed: change them to those of the real effector.\n",
    );
    let mut appended = Ok(());
    change_arm(embedded(document)?, found.index, |arm| {
        appended = lists::append(arm, "effector", effector);
    });
    appended?;
    let body = names.take(&format!("{new}-blade"));
    let [.., (_, _, _, size)] = BODIES;
    let on = inline([("effector", Value::from(&new))]);
    lists::append(document.as_table_mut(), "body", a_box(&body, on, BLADE_POSITION, size))?;
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Index of the highest effector of an arm; `None` if the robot has errors.
fn highest_effector(text: &str, files: &mut Files, arm: usize) -> Option<usize> {
    let robot = robot_of(text, files)?;
    let effectors = robot.arms.get(arm)?.effectors.iter().enumerate();
    let height = |effector: &Effector| effector.wafer_center[2];
    effectors.max_by(|(_, a), (_, b)| height(a).total_cmp(&height(b))).map(|(index, _)| index)
}

/// Gives an effector the wafer centre and the heading of another one, without their comments.
fn place_as(effector: &mut Table, other: &dyn TableLike) {
    let plain = |value: &Value| {
        let mut value = value.clone();
        value.decor_mut().clear();
        value
    };
    if let (Some(center), Some(own)) = (
        other.get("wafer_center_mm").and_then(Item::as_array),
        effector.get_mut("wafer_center_mm").and_then(Item::as_value_mut),
    ) {
        replace(own, Value::Array(center.iter().map(plain).collect()));
    }
    if let Some(heading) = other.get("heading_deg").and_then(Item::as_value) {
        effector.insert("heading_deg", Item::Value(plain(heading)));
    }
}

/// The robot of the catalogue whose arm a new arm is.
fn source() -> DocumentMut {
    let source = catalogue::find(SOURCE).and_then(|entry| entry.text.parse::<DocumentMut>().ok());
    source.expect("the files of the catalogue are valid, as a test checks")
}

/// The arm of [`source`].
fn source_arm(source: &DocumentMut) -> Table {
    tables(source, "arm").into_iter().next().expect("this robot has an arm")
}

/// The effector of [`source`].
fn source_effector() -> Table {
    tables(&source_arm(&source()), "effector").into_iter().next().expect("this arm has an effector")
}

/// The tables of a list.
fn tables(parent: &Table, key: &str) -> Vec<Table> {
    let list = parent.get(key).and_then(Item::as_array_of_tables);
    list.into_iter().flat_map(|list| list.iter().cloned()).collect()
}

/// A body that is a box, with its centre and size in its parent frame (mm).
fn a_box(name: &str, on: Value, position: [f64; 3], size: [f64; 3]) -> Table {
    let values = [
        ("name", Value::from(name)),
        ("on", on),
        ("position_mm", Value::Array(position.into_iter().collect())),
        ("box", inline([("size_mm", Value::Array(size.into_iter().collect()))])),
    ];
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    for (key, value) in values {
        table.insert(key, Item::Value(value));
    }
    table
}

/// Duplicates an effector with the bodies attached to it, one pitch above the original.
pub(super) fn duplicate_effector(
    document: &mut DocumentMut,
    effector: &str,
) -> Result<EntryAdded, Fault> {
    let found = FoundEffector::new(embedded(document)?, effector)?;
    if let Some(why) = no_more_effectors(found.effectors) {
        return Err(Fault::Unfit(why));
    }
    let mut names = Names::of(document);
    let new = names.take(effector);
    let attached = attached::attached(document, owner(effector));
    change_arm(embedded(document)?, found.arm, |arm| {
        lists::duplicate(arm, "effector", found.index, |copy| {
            rename(copy, &new);
            if let Some(height) = height(copy, "wafer_center_mm") {
                raise(height, EFFECTOR_PITCH_MM);
            }
        });
    });
    let mut new_names = NewNames::from([(("effector", effector.to_owned()), new.clone())]);
    let bodies =
        attached::duplicate(document, &attached, (effector, &new), &mut new_names, &mut names);
    contacts::duplicate(document, &bodies);
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Removes an effector with the bodies attached to it and their allowed contacts.
pub(super) fn remove_effector(document: &mut DocumentMut, effector: &str) -> Result<String, Fault> {
    let found = FoundEffector::new(embedded(document)?, effector)?;
    if let Some(why) = last_effector(found.effectors) {
        return Err(Fault::Unfit(why));
    }
    let attached = attached::attached(document, owner(effector));
    let bodies: Vec<&str> = attached.iter().map(|one| one.name.as_str()).collect();
    attached::check_not_borrowed(document, &bodies)?;
    let mut comments = attached::remove(document, &attached);
    change_arm(embedded(document)?, found.arm, |arm| {
        comments.extend(lists::remove(arm, "effector", found.index));
    });
    comments.into_iter().for_each(|one| lists::place_comments(document, one));
    contacts::remove(document, &bodies);
    Ok(document.to_string())
}

/// An arm of the robot's table.
struct Found {
    name: String,
    index: usize,
    /// Number of arms.
    arms: usize,
    /// Axes that move this arm and no other.
    axes: BTreeSet<String>,
    effectors: Vec<String>,
}

impl Found {
    fn new(robot: &dyn TableLike, arm: &str) -> Result<Self, Fault> {
        let arms = tables_of(robot, "arm");
        let index = arms.iter().position(|one| name(*one) == Some(arm));
        let index = index.ok_or_else(|| unknown("arm", arm, names_in(robot, "arm")))?;
        let others = arms.iter().enumerate().filter(|(other, _)| *other != index);
        let shared: BTreeSet<String> = others.flat_map(|(_, one)| axes_of(*one)).collect();
        Ok(Self {
            name: arm.to_owned(),
            index,
            arms: arms.len(),
            axes: axes_of(arms[index]).filter(|axis| !shared.contains(axis)).collect(),
            effectors: names_in(arms[index], "effector"),
        })
    }

    fn owners(&self) -> Owners {
        Owners::from([("arm", vec![self.name.clone()]), ("effector", self.effectors.clone())])
    }
}

/// An effector of the robot's table.
struct FoundEffector {
    /// Index of its arm.
    arm: usize,
    index: usize,
    /// Number of effectors of its arm.
    effectors: usize,
}

impl FoundEffector {
    fn new(robot: &dyn TableLike, effector: &str) -> Result<Self, Fault> {
        let arms: Vec<Vec<String>> =
            tables_of(robot, "arm").into_iter().map(|arm| names_in(arm, "effector")).collect();
        let found = arms.iter().enumerate().find_map(|(arm, names)| {
            let index = names.iter().position(|one| one == effector)?;
            Some(Self { arm, index, effectors: names.len() })
        });
        found.ok_or_else(|| unknown("effector", effector, arms.concat()))
    }
}

/// The owner of the bodies of an effector.
fn owner(effector: &str) -> Owners {
    Owners::from([("effector", vec![effector.to_owned()])])
}

fn unknown(what: &str, found: &str, known: Vec<String>) -> Fault {
    FileProblem::unknown(what, found, known.iter().map(String::as_str)).into()
}

/// Axes that drive the joints of an arm.
fn axes_of(arm: &dyn TableLike) -> impl Iterator<Item = String> {
    let joints = tables_of(arm, "joint").into_iter();
    let drives = joints.filter_map(|joint| joint.get("drives")?.as_table_like());
    drives.flat_map(|drives| drives.iter().map(|(axis, _)| axis.to_owned()).collect::<Vec<_>>())
}

/// Gives an arm, its axes and its effectors new names; returns those of the effectors.
fn rename_arm(
    arm: &mut dyn TableLike,
    new: &str,
    axes: &BTreeMap<String, String>,
    names: &mut Names,
) -> BTreeMap<String, String> {
    rename(arm, new);
    each_table(arm, "joint", &mut |joint| {
        let Some(drives) = joint.get_mut("drives").and_then(Item::as_table_like_mut) else {
            return;
        };
        let all: Vec<(String, Item)> =
            drives.iter().map(|(axis, ratio)| (axis.to_owned(), ratio.clone())).collect();
        all.iter().for_each(|(axis, _)| drop(drives.remove(axis)));
        for (axis, ratio) in all {
            drives.insert(axes.get(&axis).unwrap_or(&axis), ratio);
        }
    });
    let mut effectors = BTreeMap::new();
    each_table(arm, "effector", &mut |effector| {
        let Some(old) = name(effector).map(str::to_owned) else { return };
        let new = names.take(&old);
        rename(effector, &new);
        effectors.insert(old, new);
    });
    effectors
}

/// Changes each table of a list.
fn each_table(parent: &mut dyn TableLike, key: &str, change: &mut dyn FnMut(&mut dyn TableLike)) {
    match parent.get_mut(key) {
        Some(Item::ArrayOfTables(list)) => list.iter_mut().for_each(|table| change(table)),
        Some(Item::Value(Value::Array(list))) => {
            let tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.for_each(|table: &mut InlineTable| change(table));
        }
        _ => {}
    }
}

/// Changes one arm of the robot's table.
fn change_arm(robot: &mut dyn TableLike, index: usize, change: impl FnOnce(&mut dyn TableLike)) {
    let mut change = Some(change);
    let mut next = 0;
    each_table(robot, "arm", &mut |arm| {
        if next == index
            && let Some(change) = change.take()
        {
            change(arm);
        }
        next += 1;
    });
}

/// The z coordinate of an arm's mount.
fn mount_height(arm: &mut dyn TableLike) -> Option<&mut Value> {
    height(arm, "mount_mm")
}

/// The third coordinate of a point.
fn height<'t>(table: &'t mut dyn TableLike, key: &str) -> Option<&'t mut Value> {
    table.get_mut(key)?.as_array_mut()?.get_mut(2)
}
