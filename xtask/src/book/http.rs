//! The reference of the HTTP interface as a chapter: every request and every type of the server's own description.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Map, Value};

/// Line of a chapter that is replaced.
pub(super) const MARKER: &str =
    "<!-- requests and types of crates/jointplay-studio/openapi.json -->";

/// The description of the server in the repository.
pub(super) const DESCRIPTION: &str = "crates/jointplay-studio/openapi.json";

/// Names of references to types in the description.
const TYPES: &str = "#/components/schemas/";

/// The chapter of a description.
///
/// # Errors
/// If the text is not JSON, or has no paths and types.
pub(super) fn chapter(description: &str) -> Result<String, String> {
    let all: Value = serde_json::from_str(description).map_err(|error| error.to_string())?;
    let object = |value: &Value, what: &str| {
        value.as_object().cloned().ok_or_else(|| format!("{DESCRIPTION} has no {what}"))
    };
    let mut out = String::from("## Requests\n");
    for (path, methods) in object(&all["paths"], "paths")? {
        for (method, operation) in object(&methods, "methods")? {
            if let Value::Object(operation) = operation {
                request(&mut out, &path, &method, &operation);
            }
        }
    }
    out.push_str("\n## Types\n");
    let types: BTreeMap<_, _> =
        object(&all["components"]["schemas"], "types")?.into_iter().collect();
    for (name, schema) in &types {
        let _ = writeln!(out, "\n### {name}\n");
        type_of(&mut out, schema);
    }
    Ok(out)
}

/// A request with its parameters, body and answers.
fn request(out: &mut String, path: &str, method: &str, operation: &Map<String, Value>) {
    let text = |key: &str| operation.get(key).and_then(Value::as_str).unwrap_or_default();
    let _ = writeln!(out, "\n### `{} {path}`\n", method.to_uppercase());
    let _ = writeln!(out, "{}.", text("summary").trim_end_matches('.'));
    if !text("description").is_empty() {
        let _ = writeln!(out, "{}", one_line(text("description")));
    }
    let parameters = operation.get("parameters").and_then(Value::as_array);
    for parameter in parameters.into_iter().flatten() {
        let name = parameter["name"].as_str().unwrap_or_default();
        let place = parameter["in"].as_str().unwrap_or_default();
        let note = parameter["description"].as_str().map(one_line).unwrap_or_default();
        let _ = writeln!(
            out,
            "\nParameter in {place}: `{name}`, {}. {note}",
            shape(&parameter["schema"])
        );
    }
    if let Some(body) = operation.get("requestBody") {
        let _ = writeln!(out, "\nBody: {}.", contents(&body["content"]));
    }
    out.push_str("\n| status | answer | content |\n| --- | --- | --- |\n");
    let answers = operation.get("responses").and_then(Value::as_object);
    for (status, answer) in answers.into_iter().flatten() {
        let note = answer["description"].as_str().map(cell).unwrap_or_default();
        let _ = writeln!(out, "| {status} | {note} | {} |", contents(&answer["content"]));
    }
}

/// Media types with what they contain.
fn contents(content: &Value) -> String {
    let all = content.as_object().into_iter().flatten();
    let all = all.map(|(media, value)| match &value["schema"] {
        Value::Null => format!("`{media}`"),
        schema => format!("{} as `{media}`", shape(schema)),
    });
    all.collect::<Vec<_>>().join(", ")
}

/// A type: what it is, and its fields.
fn type_of(out: &mut String, schema: &Value) {
    if let Some(note) = schema["description"].as_str() {
        let _ = writeln!(out, "{}", one_line(note));
    }
    let mut fields = Vec::new();
    collect(schema, &mut fields);
    if fields.is_empty() {
        let _ = writeln!(out, "\n{}{}", shape(schema), range(schema));
        return;
    }
    let included = schema["allOf"].as_array().into_iter().flatten();
    for part in included.filter(|part| part["$ref"].is_string()) {
        let _ = writeln!(out, "\nIt has the fields of {}.", shape(part));
    }
    out.push_str("\n| field | type | description |\n| --- | --- | --- |\n");
    for (name, field, required) in fields {
        let note = field["description"].as_str().map(cell).unwrap_or_default();
        let optional = if required { "" } else { ", optional" };
        let _ = writeln!(out, "| `{name}` | {}{}{optional} | {note} |", shape(field), range(field));
    }
}

/// The fields of an object, of its own and of unnamed parts.
fn collect<'a>(schema: &'a Value, fields: &mut Vec<(&'a str, &'a Value, bool)>) {
    let required: Vec<&str> =
        schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        fields.push((name, field, required.contains(&name.as_str())));
    }
    schema["allOf"].as_array().into_iter().flatten().for_each(|part| collect(part, fields));
}

/// A type in a table: a link to a named one, or its kind.
fn shape(schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.trim_start_matches(TYPES);
        return format!("[{name}](#{})", name.to_lowercase());
    }
    for key in ["oneOf", "anyOf", "allOf"] {
        if let Some(all) = schema[key].as_array() {
            return all.iter().map(shape).collect::<Vec<_>>().join(" or ");
        }
    }
    if let Some(values) = schema["enum"].as_array() {
        return values.iter().map(|value| format!("`{value}`")).collect::<Vec<_>>().join(", ");
    }
    match &schema["type"] {
        Value::Array(kinds) => {
            let kinds = kinds.iter().map(|kind| {
                let mut one = schema.clone();
                one["type"] = kind.clone();
                shape(&one)
            });
            kinds.collect::<Vec<_>>().join(" or ")
        }
        Value::String(kind) if kind == "array" => format!("array of {}", shape(&schema["items"])),
        Value::String(kind) if kind == "object" => match &schema["additionalProperties"] {
            Value::Object(value) => format!("map to {}", shape(&Value::Object(value.clone()))),
            _ => named(schema),
        },
        Value::String(kind) => kind.clone(),
        _ => "any value".to_owned(),
    }
}

/// An object without a name of its own, by its fields.
fn named(schema: &Value) -> String {
    let fields = schema["properties"].as_object().into_iter().flatten();
    let fields: Vec<_> =
        fields.map(|(name, field)| format!("`{name}`: {}", shape(field))).collect();
    if fields.is_empty() {
        "object".to_owned()
    } else {
        format!("object with {}", fields.join(", "))
    }
}

/// The allowed numbers of a type.
fn range(schema: &Value) -> String {
    let bounds = [
        ("minimum", "from"),
        ("exclusiveMinimum", "above"),
        ("maximum", "to"),
        ("exclusiveMaximum", "below"),
    ];
    let bounds = bounds.iter().filter(|(key, _)| !schema[*key].is_null());
    bounds.map(|(key, word)| format!(" {word} {}", schema[*key])).collect()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    one_line(text).replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_request_and_type_has_a_section_with_links() {
        let root = crate::root::find();
        let text = std::fs::read_to_string(root.join(DESCRIPTION)).unwrap();
        let all: Value = serde_json::from_str(&text).unwrap();
        let chapter = chapter(&text).unwrap();
        let types = all["components"]["schemas"].as_object().unwrap();
        let requests: usize = all["paths"]
            .as_object()
            .unwrap()
            .values()
            .map(|path| path.as_object().unwrap().len())
            .sum();
        let sections = chapter.lines().filter(|line| line.starts_with("### ")).count();
        assert_eq!(sections, types.len() + requests);
        let drive = chapter.split("### `POST /api/v1/mechanism/drive`").nth(1).unwrap();
        assert!(drive.contains("\nBody: [DriveRequest](#driverequest) as `application/json`."));
        let fields = chapter.split("### DriveRequest\n").nth(1).unwrap();
        let scale =
            "| `play_scale` | number from 1 to 1000000000, optional | Play scale of the poses. |";
        assert!(fields.contains(scale), "{fields}");
        assert!(fields.contains("| `to` | map to string | "), "{fields}");
    }

    #[test]
    fn what_is_no_description_is_an_error() {
        assert!(super::chapter("{}").unwrap_err().contains("paths"));
        assert!(super::chapter("no").is_err());
    }
}
