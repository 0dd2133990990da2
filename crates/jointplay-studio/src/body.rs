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
        Problem::field(field, error.inner().to_string())
    })
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
