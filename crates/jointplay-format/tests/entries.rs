//! Stations and bodies of cell files, added, duplicated and removed.

use jointplay_format::cell::{
    Change, EXAMPLE, EntryAdded, EntryList, NewEntry, Problem, add_entry, duplicate_entry, read,
    remove_entry, set_station,
};
use nalgebra::Vector3;

fn no_files(_: &str) -> Result<Vec<u8>, String> {
    Err("no files".to_owned())
}

fn comments(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.trim_start().starts_with('#')).collect()
}

#[track_caller]
fn cell(text: &str) -> jointplay_cell::workcell::Cell {
    read(text, &mut no_files).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn a_duplicated_station_has_its_bodies_and_follows_the_original() {
    let before = cell(EXAMPLE);
    let EntryAdded { text, name } =
        duplicate_entry(EXAMPLE, EntryList::Station, "LP1", &mut no_files).unwrap();
    assert_eq!(name, "LP3");
    let after = cell(&text);
    let stations: Vec<&str> = after.stations.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(stations, ["LP1", "LP3", "LP2", "ALIGN", "PM1"]);
    let of_original = before.bodies.iter().filter(|it| it.name.starts_with("LP1")).count();
    assert!(of_original > 3);
    assert_eq!(after.bodies.len(), before.bodies.len() + of_original);
    assert!(text.contains("name = \"LP3-left\"\non = { station = \"LP3\" }"));
    assert_eq!(comments(&text), comments(EXAMPLE));
    // What is added is removed again, with all that belongs to it.
    assert_eq!(remove_entry(&text, EntryList::Station, "LP3").unwrap(), EXAMPLE);
}

#[test]
fn a_removed_entry_leaves_the_comments_of_sections_and_of_others() {
    let text = remove_entry(EXAMPLE, EntryList::Station, "LP1").unwrap();
    let after = cell(&text);
    assert!(after.stations.iter().all(|it| it.name != "LP1"));
    assert!(after.bodies.iter().all(|it| !it.name.starts_with("LP1")));
    assert_eq!(comments(&text), comments(EXAMPLE));
    // Its own comment and its allowed contacts are removed with it.
    let text = remove_entry(EXAMPLE, EntryList::Body, "wall").unwrap();
    assert!(!text.contains("# The wall of the cell;"));
    assert_eq!(comments(&text).len(), comments(EXAMPLE).len() - 1);
    let text = remove_entry(EXAMPLE, EntryList::Body, "post-A").unwrap();
    assert!(!text.contains("post-A"));
    cell(&text);
}

#[test]
fn a_new_entry_is_valid_and_removed_without_a_trace() {
    let position = Vector3::new(0.4, -0.2, 0.61);
    // Where the wafer is with the robot at home.
    let axis = Vector3::new(0.0, 0.0, 0.6);
    let entries = [
        (NewEntry::Station { position: axis, heading: 0.5 }, EntryList::Station, "S1"),
        (NewEntry::Station { position, heading: 0.5 }, EntryList::Station, "S1"),
        (NewEntry::Body { position }, EntryList::Body, "body-1"),
    ];
    for (entry, list, expected) in entries {
        let EntryAdded { text, name } = add_entry(EXAMPLE, &entry, &mut no_files).unwrap();
        assert_eq!(name, expected);
        let after = cell(&text);
        match entry {
            NewEntry::Station { position, .. } => {
                let made = after.stations.iter().find(|it| it.name == name).unwrap();
                let origin = made.slot_frame(1).translation.vector;
                if position == axis {
                    assert!((origin.xy().norm() - 0.3).abs() < 1e-9 && origin.z == axis.z);
                } else {
                    assert!((origin - position).norm() < 1e-12);
                }
            }
            NewEntry::Body { .. } => assert!(after.bodies.iter().any(|it| it.name == name)),
            NewEntry::Arm | NewEntry::Effector { .. } => {
                unreachable!("arms and effectors have tests of their own")
            }
        }
        let again = add_entry(&text, &entry, &mut no_files).unwrap();
        assert_ne!(again.name, name);
        assert_eq!(remove_entry(&text, list, &name).unwrap(), EXAMPLE);
    }
}

#[test]
fn tables_within_tables_and_inline_lists_are_duplicated_too() {
    let nested = "[[station]]\nname = \"A\"\n[station.stroke]\nbelow_mm = 1 # low\n[[station]]\nname = \"B\"\n";
    let found = duplicate_entry(nested, EntryList::Station, "A", &mut no_files).unwrap();
    assert_eq!(found.name, "A2");
    let expected = "[[station]]\nname = \"A\"\n[station.stroke]\nbelow_mm = 1 # low\n\n[[station]]\nname = \"A2\"\n[station.stroke]\nbelow_mm = 1 # low\n[[station]]\nname = \"B\"\n";
    assert_eq!(found.text, expected);
    let inline = "station = [{ name = \"A\" }, { name = \"B\" }]\n";
    let found = duplicate_entry(inline, EntryList::Station, "A", &mut no_files).unwrap();
    assert_eq!(found.text.matches("name").count(), 3);
    let removed = remove_entry(inline, EntryList::Station, "B").unwrap();
    assert!(removed.contains("\"A\"") && !removed.contains("\"B\""));
}

#[test]
fn what_cannot_be_changed_is_refused_with_the_reason() {
    let like = "[[station]]\nname = \"A\"\n[[station]]\nname = \"B\"\nlike = \"A\"\n";
    let message = |found: Result<String, Problem>| found.unwrap_err().to_string();
    assert!(message(remove_entry(like, EntryList::Station, "A")).contains("`like`"));
    assert!(message(remove_entry(like, EntryList::Station, "C")).contains("\"C\""));
    assert!(message(remove_entry(EXAMPLE, EntryList::Body, "wal")).contains("wall"));
    assert_eq!(remove_entry("= 1", EntryList::Body, "a").unwrap_err().place.line, 1);
    let station = NewEntry::Station { position: Vector3::zeros(), heading: 0.0 };
    let added = add_entry("station = 3\n", &station, &mut no_files);
    assert!(added.unwrap_err().to_string().contains("not a list"));
}

#[test]
fn changed_cells_keep_the_line_ends_of_their_file() {
    let text = EXAMPLE.replace('\n', "\r\n");
    let added = add_entry(&text, &NewEntry::Body { position: Vector3::zeros() }, &mut no_files);
    let copied = duplicate_entry(&text, EntryList::Arm, "upper", &mut no_files);
    let station = duplicate_entry(&text, EntryList::Station, "LP1", &mut no_files).unwrap();
    let removed = remove_entry(&station.text, EntryList::Station, "LP3").unwrap();
    let moved = set_station(&text, "LP1", &[Change::Heading(0.5)]).unwrap();
    for changed in [station.text, removed.clone(), moved]
        .into_iter()
        .chain([added, copied].into_iter().flatten().map(|it| it.text))
    {
        assert_eq!(changed.matches('\n').count(), changed.matches("\r\n").count());
    }
    assert_eq!(removed, text);
}
