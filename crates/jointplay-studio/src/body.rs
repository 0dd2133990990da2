//! Strict parsing of JSON bodies, each error with its field.

use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::{StatusCode, header};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::problem::Problem;
use crate::strict;

/// Maximum size of a request body (bytes): twice that of the largest file, whose characters may be escaped, and room for all else.
///
/// The page knows it as `MAX_BODY_BYTES` in `studio/src/lib/requestSize.ts`; a test compares them.
pub(crate) const MAX_BODY_BYTES: usize = 10_000_000;

/// The body of a request, parsed as `T`.
pub(crate) struct Body<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequest<S> for Body<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        // Other content types can be sent by a form of any web page without the consent of this server.
        let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
        let essence = kind.and_then(|kind| kind.split(';').next()).unwrap_or_default().trim();
        if !essence.eq_ignore_ascii_case("application/json") {
            let detail = "the body must be JSON with Content-Type: application/json";
            return Err(Problem::request(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail));
        }
        let bytes = Bytes::from_request(request, state).await.map_err(|rejection| {
            let status = rejection.status();
            let detail = if status == StatusCode::PAYLOAD_TOO_LARGE {
                format!("the body exceeds {MAX_BODY_BYTES} bytes")
            } else {
                rejection.body_text()
            };
            Problem::request(status, detail)
        })?;
        let value: Value = serde_json::from_slice(&bytes).map_err(|error| {
            Problem::request(
                StatusCode::BAD_REQUEST,
                format!("the body is not valid JSON: {error}"),
            )
        })?;
        read(value, "").map(|strict::Object(body)| Self(body))
    }
}

/// Parses the part of a body at `path`.
pub(crate) fn read<T: DeserializeOwned>(value: Value, path: &str) -> Result<T, Problem> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let within = error.path().to_string();
        let field = match (path, within.as_str()) {
            (path, ".") => path.to_owned(),
            ("", within) => within.to_owned(),
            (path, within) if within.starts_with('[') => format!("{path}{within}"),
            (path, within) => format!("{path}.{within}"),
        };
        Problem::field(field, in_words_of_json(&error.inner().to_string()))
    })
}

/// Most characters of a value in an error.
const MOST_QUOTED: usize = 60;

/// An error of serde without the types of Rust, such as "expected a number, got true".
fn in_words_of_json(error: &str) -> String {
    let parts = |start: &str| error.strip_prefix(start)?.split_once(", expected ");
    let got_type = parts("invalid type: ").or_else(|| parts("invalid value: "));
    if let Some((found, expected)) = got_type {
        return format!("expected {}, got {}", allowed(expected), value(found));
    }
    match parts("invalid length ") {
        Some((found, expected)) => format!("expected {}, got {found}", allowed(expected)),
        None => error.to_owned(),
    }
}

fn allowed(expected: &str) -> String {
    if let Some(length) = expected.strip_prefix("an array of length ") {
        return format!("a list of {length}");
    }
    let words = match expected {
        "f64" | "f32" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a boolean" => "true or false",
        "a string" | "string" => "a text",
        "a map" | "map" => "an object",
        "a sequence" | "sequence" => "a list",
        "variant identifier" => "a text",
        other if other.starts_with("struct ") => "an object",
        other => other,
    };
    words.to_owned()
}

fn value(found: &str) -> String {
    let quoted = found.split_once('`').and_then(|(_, rest)| rest.strip_suffix('`'));
    let words = match (found, quoted) {
        ("map", _) => "an object",
        ("sequence", _) => "a list",
        ("unit value", _) => "null",
        (_, Some(value)) if !found.starts_with("string ") => value,
        _ => found.strip_prefix("string ").unwrap_or(found),
    };
    match words.char_indices().nth(MOST_QUOTED) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words.to_owned(),
    }
}

/// The variant of a part of a body, by its field `kind`.
pub(crate) fn kind<'a>(value: &'a Value, path: &str, known: &[&str]) -> Result<&'a str, Problem> {
    let listed =
        || known.iter().map(|name| format!("{name:?}")).collect::<Vec<String>>().join(", ");
    let Value::Object(fields) = value else {
        let detail = format!("expected an object with a `kind` of {}", listed());
        return Err(Problem::field(path, detail));
    };
    match fields.get("kind") {
        Some(Value::String(kind)) if known.contains(&kind.as_str()) => Ok(kind),
        Some(other) => {
            let detail = format!("unknown kind {other}; known: {}", listed());
            Err(Problem::field(format!("{path}.kind"), detail))
        }
        None => Err(Problem::field(path, format!("missing field `kind`; known: {}", listed()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn detail<T: DeserializeOwned>(text: &str) -> String {
        let error = serde_json::from_value::<T>(serde_json::from_str(text).unwrap()).err();
        in_words_of_json(&error.unwrap().to_string())
    }

    /// Before, the details had types of Rust, such as "invalid type: boolean `true`, expected f64".
    #[test]
    fn errors_have_the_words_of_json() {
        assert_eq!(detail::<f64>("true"), "expected a number, got true");
        assert_eq!(detail::<f64>("\"a `b`\""), "expected a number, got \"a `b`\"");
        assert_eq!(detail::<f64>("null"), "expected a number, got null");
        assert_eq!(detail::<usize>("1.5"), "expected a whole number from 0, got 1.5");
        assert_eq!(detail::<usize>("-1"), "expected a whole number from 0, got -1");
        assert_eq!(detail::<[f64; 3]>("[1, 2]"), "expected a list of 3, got 2");
        assert_eq!(detail::<[f64; 3]>("{}"), "expected a list of 3, got an object");
        assert_eq!(detail::<String>("7"), "expected a text, got 7");
        assert_eq!(detail::<bool>("7"), "expected true or false, got 7");
        assert_eq!(detail::<BTreeMap<String, f64>>("[]"), "expected an object, got a list");
        let long = format!("{:?}", "x".repeat(1000));
        assert!(detail::<Vec<f64>>(&long).starts_with("expected a list, got \"xxx"));
        assert!(detail::<Vec<f64>>(&long).chars().count() < 100);
    }
}
