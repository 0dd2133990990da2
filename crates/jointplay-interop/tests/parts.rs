//! Parts of CAD models that move as the links of a mechanism: broken files, names, places.

use jointplay_core::mechanism::{Drive, MechanismSystem};
use jointplay_core::mechanism::{Mechanism, assemble, drive, guess};
use jointplay_format::{catalogue, mechanism};
use jointplay_interop::export::{
    Error, KEY_TOLERANCE, MechanismMotion, PartTable, PartsError, PartsFile, UpAxis,
    proportional_times,
};
use proptest::prelude::*;
use serde_json::{Value, json};

/// A quarter of a turn of the four-bar linkage.
fn with_motion<T>(answer: impl FnOnce(&MechanismMotion<'_>, &Mechanism) -> T) -> T {
    let linkage = mechanism::parse(catalogue::find("four-bar").unwrap().text).unwrap().mechanism;
    let start = assemble(&linkage, &guess(&linkage), &[], 10).unwrap().coordinates;
    let system = MechanismSystem::new(&linkage, start.clone()).unwrap();
    let free: Vec<usize> = (1..linkage.joint_freedoms()).collect();
    let drives = [Drive { coordinate: 0, to: start[0] + 1.5 }];
    let moved = drive(&system, &drives, &free, 12).unwrap();
    let configurations = moved.waypoints.iter().map(|waypoint| &waypoint.coordinates);
    // The first half takes three quarters of the time.
    let times =
        (0..=12).map(|k| if k < 6 { 0.25 * f64::from(k) } else { 1.0 + f64::from(k) / 12.0 });
    let times = times.collect();
    let motion = MechanismMotion::new(&linkage, &start, configurations, times, 1.0).unwrap();
    answer(&motion, &linkage)
}

/// A binary glTF file of a description without data.
fn file(document: &Value) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let length = |length: usize| u32::try_from(length).unwrap().to_le_bytes();
    let head =
        [*b"glTF", 2_u32.to_le_bytes(), length(20 + text.len()), length(text.len()), *b"JSON"];
    [head.concat(), text].concat()
}

fn description(file: &[u8]) -> Value {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&file[20..20 + length]).unwrap()
}

fn parts() -> Value {
    json!({
        "asset": { "version": "2.0", "generator": "hand", "extras": { "note": 1 } },
        "scenes": [{ "nodes": [0, 3] }],
        "nodes": [
            { "name": "assembly", "children": [1, 2], "translation": [0.1, 0.2, 0.3], "scale": [2.0, 2.0, 2.0] },
            { "name": "Crank", "translation": [1.0, 0.0, 0.0] },
            { "name": "a part" },
            { "name": "rocker" },
        ],
        "extensions": { "VENDOR_kept": { "value": 7 } },
    })
}

#[test]
fn parts_are_matched_by_name_and_by_table() {
    with_motion(|motion, linkage| {
        let links = linkage.links();
        let [crank, coupler, rocker] = &links[1..] else { panic!("{links:?}") };
        let mut document = parts();
        // Without regard to case, and with _ for a space.
        document["nodes"][1]["name"] = json!(crank.to_uppercase().replace(' ', "_"));
        document["nodes"][3]["name"] = json!(rocker);
        let parts = PartsFile::parse(&file(&document)).unwrap();
        assert_eq!(parts.names().count(), 4);
        assert_eq!(parts.up_axis(), UpAxis::Y);
        let table = [("a part".to_owned(), coupler.clone())];
        let animated = motion.gltf_of_parts(&parts, &table, UpAxis::Y, KEY_TOLERANCE).unwrap();
        assert!(animated.missing.is_empty());
        let found = description(&animated.bytes);
        assert_eq!(found["extensions"], document["extensions"]);
        assert_eq!(found["animations"].as_array().unwrap().len(), 1);
        // The group has lost its parts; it, and the animated nodes, are in the scene.
        assert!(found["nodes"][0].get("children").is_none());
        assert_eq!(found["scenes"][0]["nodes"].as_array().unwrap().len(), 4);
        for node in found["nodes"].as_array().unwrap() {
            let matrix = node["matrix"].as_array().map_or(0, Vec::len);
            assert!(matrix == 0 || matrix == 16, "{node}");
        }
        let animated = motion.gltf_of_parts(&parts, &[], UpAxis::Z, KEY_TOLERANCE).unwrap();
        assert_eq!(animated.missing, std::slice::from_ref(coupler));
    });
}

#[test]
fn unknown_names_and_broken_files_are_refused() {
    with_motion(|motion, linkage| {
        let link = linkage.links()[1].clone();
        let refusal = |document: &Value, table: &[(&str, &str)]| {
            let table: Vec<(String, String)> =
                table.iter().map(|&(node, link)| (node.to_owned(), link.to_owned())).collect();
            let parts = PartsFile::parse(&file(document)).map_err(Error::from)?;
            motion.gltf_of_parts(&parts, &table, UpAxis::Y, KEY_TOLERANCE)
        };
        let message = |document: &Value, table: &[(&str, &str)]| {
            refusal(document, table).unwrap_err().to_string()
        };
        let document = parts();
        assert!(message(&document, &[("a prat", &link)]).contains("did you mean `a part`"));
        assert!(message(&document, &[("a part", "nothing")]).contains("no link is named"));
        let mut twice = parts();
        twice["nodes"][2]["name"] = json!(link);
        twice["nodes"][3]["name"] = json!(link);
        assert!(message(&twice, &[]).contains("2 nodes"), "{}", message(&twice, &[]));
        let none = json!({ "asset": { "version": "2.0" }, "nodes": [{ "name": "table" }] });
        assert!(matches!(refusal(&none, &[]), Err(Error::Parts(PartsError::NoMatch { .. }))));
        for (key, value, part) in [
            ("nodes", json!([{ "children": [0] }]), "a child that is not there"),
            ("nodes", json!([{ "children": [2] }, { "children": [2] }, {}]), "two parents"),
            ("nodes", json!([{ "children": [1] }, { "children": [0] }]), "its own ancestor"),
            ("nodes", json!([{ "rotation": [0, 0, 0, 0] }]), "node 0 is not finite"),
            ("nodes", json!([1, 2]), "not that of glTF"),
            ("asset", json!("2.0"), "not that of glTF"),
            ("buffers", json!([{ "uri": "a.bin", "byteLength": 1 }]), "in other files"),
        ] {
            let mut broken = parts();
            broken[key] = value;
            assert!(message(&broken, &[]).contains(part), "{}", message(&broken, &[]));
        }
        for bytes in [&b""[..], b"glTF", b"solid", &file(&parts())[..30]] {
            assert!(PartsFile::parse(bytes).is_err());
        }
    });
}

#[test]
fn tables_of_parts_are_read_and_errors_have_places() {
    let table = PartTable::parse(
        "kind = \"parts\"\n[links]\n\"crank ø6\" = [\"GEHÄUSE:1\", \"pin = 3\"]\nrod = \"Rod\"\n",
    )
    .unwrap();
    let expected = [("GEHÄUSE:1", "crank ø6"), ("pin = 3", "crank ø6"), ("Rod", "rod")];
    assert_eq!(table.parts, expected.map(|(a, b)| (a.to_owned(), b.to_owned())));
    assert_eq!(table.up, None);
    let refuse = |text: &str, message: &str, line: usize| {
        let errors = PartTable::parse(text).unwrap_err();
        assert!(errors.to_string().contains(message), "{errors}");
        assert_eq!(errors[0].place.line, line, "{errors}");
    };
    refuse("kind = \"loops\"\n[links]\n", "the kind", 1);
    refuse("kind = \"parts\"\nup = \"x\"\n[links]\n", "axis", 2);
    refuse("kind = \"parts\"\n[links]\na = 3\n", "a list", 3);
    refuse("kind = \"parts\"\n[links]\na = [\"b\", 3]\n", "a text", 3);
    refuse("kind = \"parts\"\ncolor = 1\n[links]\n", "color", 2);
    assert!(PartTable::parse("kind = \"parts\"\n").unwrap_err().to_string().contains("links"));
    assert!(PartTable::parse("kind = ").is_err());
    assert!(PartTable::parse(&" ".repeat(4_000_001)).is_err());
}

/// A node cannot move with two links, and a thousand parts are matched at once.
#[test]
fn nodes_move_with_one_link_and_many_are_matched() {
    with_motion(|motion, linkage| {
        let links = linkage.links();
        let twice: Vec<(String, String)> =
            [1, 2].map(|link| ("a part".to_owned(), links[link].clone())).to_vec();
        let parts_file = PartsFile::parse(&file(&parts())).unwrap();
        let error =
            motion.gltf_of_parts(&parts_file, &twice, UpAxis::Y, KEY_TOLERANCE).unwrap_err();
        assert!(error.to_string().contains("a part moves with one link"), "{error}");
        let many: Vec<Value> = (0..2_000).map(|k| json!({ "name": format!("part {k}") })).collect();
        let roots: Vec<usize> = (0..many.len()).collect();
        let document =
            json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": roots }], "nodes": many });
        let parts_file = PartsFile::parse(&file(&document)).unwrap();
        let table: Vec<(String, String)> =
            (0..2_000).map(|k| (format!("part {k}"), links[1 + k % 3].clone())).collect();
        let animated = motion.gltf_of_parts(&parts_file, &table, UpAxis::Y, KEY_TOLERANCE).unwrap();
        let found = description(&animated.bytes);
        assert_eq!(found["nodes"].as_array().unwrap().len(), 4_000);
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn mutated_files_do_not_panic(
        cuts in prop::collection::vec((0.0..1.0_f64, 0..12_usize, "[-{}\\[\\]:,\"0-9a-z]{0,4}"), 1..4),
        cut in 0.0..1.3_f64,
    ) {
        let mut text = parts().to_string();
        for (part, length, replacement) in cuts {
            let start = (part * text.len() as f64) as usize;
            let end = (start + length).min(text.len());
            if text.is_char_boundary(start) && text.is_char_boundary(end) {
                text.replace_range(start..end, &replacement);
            }
        }
        let mut bytes = match serde_json::from_str::<Value>(&text) {
            Ok(document) => file(&document),
            Err(_) => file(&json!(text)),
        };
        bytes.truncate((cut * bytes.len() as f64) as usize);
        if let Ok(parts) = PartsFile::parse(&bytes) {
            with_motion(|motion, linkage| {
                let table = [("a part".to_owned(), linkage.links()[1].clone())];
                let _ = motion.gltf_of_parts(&parts, &table, UpAxis::Y, KEY_TOLERANCE);
            });
        }
    }
}

/// Times at which the keys of an accessor are, in a binary glTF file.
fn numbers(file: &[u8], document: &Value, accessor: &Value) -> Vec<f64> {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    let binary = &file[28 + word(12)..];
    let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
    let accessor = &document["accessors"][number(accessor)];
    let view = &document["bufferViews"][number(&accessor["bufferView"])];
    let start = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
    let single = |k: usize| f32::from_le_bytes(binary[start + 4 * k..][..4].try_into().unwrap());
    (0..number(&accessor["count"])).map(|k| f64::from(single(k))).collect()
}

/// Steps of a table with times were shown at equal intervals.
#[test]
fn configurations_are_shown_at_their_times() {
    with_motion(|motion, _| {
        let file = motion.gltf(1e-9).unwrap();
        let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
        let document: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
        let samplers = document["animations"][0]["samplers"].as_array().unwrap();
        let times = samplers.iter().map(|sampler| numbers(&file, &document, &sampler["input"]));
        let most = times.max_by_key(Vec::len).unwrap();
        assert_eq!(most.len(), 13, "{most:?}");
        assert!((most[5] - 1.25).abs() < 1e-6 && (most[6] - 1.5).abs() < 1e-6, "{most:?}");
        assert!((most[7] - 1.0 - 7.0 / 12.0).abs() < 1e-6 && most[12] == 2.0, "{most:?}");
    });
}

#[test]
fn times_grow_and_are_as_many_as_configurations() {
    assert_eq!(proportional_times(2.0, &[3.0, 5.0, 7.0]).unwrap(), [0.0, 1.0, 2.0]);
    assert_eq!(proportional_times(2.0, &[-3.0]).unwrap(), [0.0]);
    assert!(proportional_times(2.0, &[]).unwrap().is_empty());
    for duration in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(proportional_times(duration, &[0.0, 1.0]), Err(Error::Duration { .. })));
    }
    let linkage = mechanism::parse(catalogue::find("four-bar").unwrap().text).unwrap().mechanism;
    let start = assemble(&linkage, &guess(&linkage), &[], 10).unwrap().coordinates;
    let refused = |times: Vec<f64>| {
        MechanismMotion::new(&linkage, &start, [&start, &start], times, 1.0).unwrap_err()
    };
    assert_eq!(refused(vec![1.0]), Error::TimeCount { times: 1, configurations: 2 });
    for next in [1.0, 0.5, 1.0 + 1e-12, f64::NAN] {
        let error = refused(vec![1.0, next]);
        assert!(matches!(error, Error::Times { time: 1.0, .. }), "{error}");
    }
}
