use std::collections::BTreeMap;

use serde::Deserialize;

use super::*;

#[derive(Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Rank {
    Norm,
    Largest,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stiffness {
    linear: Option<f64>,
    angular: Option<f64>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number or a text")]
enum NumberOrText {
    Number(f64),
    Text(String),
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    to: Option<[f64; 3]>,
    at: Option<BTreeMap<String, f64>>,
    steps: Option<usize>,
    teeth: Option<u8>,
    shift: Option<i64>,
    poses: Option<bool>,
    rank: Option<Rank>,
    names: Option<Vec<String>>,
    lists: Option<Vec<Stiffness>>,
    set: Option<NumberOrText>,
    target: Option<Value>,
}

fn refused(text: &str) -> String {
    read::<Request>(text.as_bytes()).err().unwrap().to_string()
}

/// Before, errors had types of Rust, such as "invalid type: boolean `true`, expected f64".
#[test]
fn errors_name_the_field_what_it_is_and_what_is_allowed() {
    for (text, message) in [
        ("[]", "expected an object, got a list"),
        ("null", "expected an object, got null"),
        (r#"{"to": [0.5, true, 0.5]}"#, "`to[1]`: expected a number, got true"),
        (r#"{"to": [0.5]}"#, "`to`: expected a list of 3, got a list of 1"),
        (r#"{"to": {}}"#, "`to`: expected a list, got an object"),
        (r#"{"at": {"A": "a `b`"}}"#, "`at.A`: expected a number, got \"a `b`\""),
        (r#"{"at": [1]}"#, "`at`: expected an object, got a list"),
        (r#"{"steps": 1.5}"#, "`steps`: expected a whole number from 0, got 1.5"),
        (r#"{"steps": -1}"#, "`steps`: expected a whole number from 0, got -1"),
        (r#"{"steps": 1e3}"#, "`steps`: expected a whole number from 0, got 1000.0"),
        (r#"{"steps": 18446744073709551616}"#, "`steps`: expected a whole number from 0, got 1"),
        (r#"{"teeth": 256}"#, "`teeth`: expected a whole number from 0 to 255, got 256"),
        (r#"{"shift": "1"}"#, "`shift`: expected a whole number, got \"1\""),
        (r#"{"poses": 1}"#, "`poses`: expected true or false, got 1"),
        (r#"{"rank": "small"}"#, "`rank`: expected one of \"norm\", \"largest\", got \"small\""),
        (r#"{"rank": {"norm": 1}}"#, "`rank`: expected one of \"norm\", \"largest\", got an"),
        (r#"{"names": ["a", 7]}"#, "`names[1]`: expected a text, got 7"),
        (r#"{"lists": [{}, {"linear": []}]}"#, "`lists[1].linear`: expected a number, got a list"),
        (r#"{"lists": [[1, 2]]}"#, "`lists[0]`: expected an object, got a list"),
        (
            r#"{"lists": [{"liner": 1}]}"#,
            "`lists[0].liner`: unknown field `liner` (did you mean `linear`?); known: linear, angular",
        ),
        (r#"{"set": [1]}"#, "`set`: expected a number or a text"),
    ] {
        let found = refused(text);
        assert!(found.starts_with(message), "{text}: {found}");
    }
    let long = "x".repeat(100_000);
    for text in [
        format!("{{\"steps\": \"{long}\"}}"),
        format!("{{\"{long}\": 1}}"),
        format!("{{\"at\": {{\"{long}\": true}}}}"),
        format!("{{\"at\": {{\"{long}\": 1, \"{long}\": 1}}}}"),
    ] {
        let found = refused(&text);
        assert!(found.chars().count() < 300, "{found}");
    }
}

#[test]
fn texts_that_are_not_json_have_their_position() {
    for (text, message) in [
        ("{", "not valid JSON: EOF while parsing an object at line 1 column 1"),
        ("{\"steps\": 1e999}", "not valid JSON: number out of range at line 1 column 15"),
        ("{\"steps\": NaN}", "not valid JSON: expected value at line 1 column 11"),
        ("{\"steps\": 1} 2", "not valid JSON: trailing characters at line 1 column 14"),
    ] {
        assert_eq!(refused(text), message);
    }
    let twice = refused("{\"steps\": 1,\n\"steps\": 2}");
    assert!(twice.starts_with("not valid JSON: \"steps\" is given twice at line 2"), "{twice}");
    assert!(refused(&"[".repeat(100_000)).contains("recursion limit"));
    assert!(parse(b"\xff").is_err());
}

#[test]
fn kinds_are_one_of_those_that_are_known() {
    let known = &["forward", "move"];
    let refused = |text: &str| request_of_kind(text.as_bytes(), known).err().unwrap().to_string();
    assert_eq!(refused("3"), "expected an object with a `kind` of \"forward\", \"move\", got 3");
    assert_eq!(refused("{}"), "missing field `kind`; known: \"forward\", \"move\"");
    let message = "`kind`: expected one of \"forward\", \"move\", got ";
    assert_eq!(refused(r#"{"kind": "mov"}"#), format!("{message}\"mov\""));
    assert_eq!(refused(r#"{"kind": null}"#), format!("{message}null"));
    let (kind, rest) = request_of_kind(br#"{"kind": "move", "steps": 3}"#, known).unwrap();
    assert_eq!((kind, rest), ("move", serde_json::json!({ "steps": 3 })));
    let error = super::kind(&serde_json::json!({ "kind": 1 }), "command", known).err().unwrap();
    assert_eq!(error.field, "command.kind");
}

#[test]
fn what_is_valid_is_read() {
    let text = br#"{"to": [1, -2, 0.1], "at": {"A": 1e-3}, "steps": 7, "teeth": 255, "shift": -5,
        "poses": true, "rank": "largest", "names": [], "lists": [{"linear": null}],
        "set": "5 mm", "target": {"kind": ["x", 1]}}"#;
    let request: Request = read(text).unwrap();
    assert_eq!(
        request,
        Request {
            to: Some([1.0, -2.0, 0.1]),
            at: Some(BTreeMap::from([("A".to_owned(), 1e-3)])),
            steps: Some(7),
            teeth: Some(255),
            shift: Some(-5),
            poses: Some(true),
            rank: Some(Rank::Largest),
            names: Some(vec![]),
            lists: Some(vec![Stiffness { linear: None, angular: None }]),
            set: Some(NumberOrText::Text("5 mm".to_owned())),
            target: Some(serde_json::json!({ "kind": ["x", 1] })),
        }
    );
    // To the bit: without `float_roundtrip`, the last digit is another.
    assert_eq!(read::<f64>(b"5e-324").unwrap(), 5e-324);
    assert_eq!(read::<f64>(b"31.245270191439438").unwrap(), 31.245_270_191_439_438);
}
