//! Bodies of requests in JSON.

use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::{StatusCode, header};
use jointplay::format::json;
use serde::de::DeserializeOwned;

use crate::problem::Problem;

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
        Ok(Self(json::read(&bytes)?))
    }
}
