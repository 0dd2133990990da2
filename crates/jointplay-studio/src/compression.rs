//! Compression of responses for slow connections, such as tunnels to other machines.
//!
//! It takes place on another thread: the middleware of `tower-http` would compress on the only one that answers requests, which would wait.

use std::io::Write as _;

use axum::body::{Body, HttpBody as _, to_bytes};
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;

/// Sizes of compressed bodies (bytes): smaller ones are sent at once, and larger ones take long to compress.
const COMPRESSED_BYTES: std::ops::Range<u64> = 16_384..4_000_000;

/// Compresses the bodies of responses that a client accepts with gzip.
pub(crate) async fn compress(request: Request, next: Next) -> Response {
    let accepts = request.method() != Method::HEAD && accepts_gzip(request.headers());
    let response = next.run(request).await;
    let size = response.body().size_hint().exact();
    // What depends on the accepted encodings is in one of them already.
    let is_chosen = response.headers().contains_key(header::VARY);
    if is_chosen || !size.is_some_and(|size| COMPRESSED_BYTES.contains(&size)) {
        return response;
    }
    let (mut head, body) = response.into_parts();
    // Also of responses that are not compressed: a cache must not send one of both for the other.
    head.headers.append(header::VARY, HeaderValue::from_static("accept-encoding"));
    if !accepts {
        return Response::from_parts(head, body);
    }
    let Ok(bytes) = to_bytes(body, usize::MAX).await else {
        return StatusCode::INTERNAL_SERVER_ERROR.into_response();
    };
    let plain = bytes.clone();
    let compressed = tokio::task::spawn_blocking(move || gzip(&plain)).await.ok().flatten();
    let body = match compressed {
        Some(compressed) if compressed.len() < bytes.len() => {
            head.headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
            head.headers.remove(header::CONTENT_LENGTH);
            Body::from(compressed)
        }
        _ => Body::from(bytes),
    };
    Response::from_parts(head, body)
}

/// Whether a request lists gzip among the accepted encodings, with a weight above zero.
pub(crate) fn accepts_gzip(headers: &HeaderMap) -> bool {
    let lists = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|one| one.to_str().ok());
    lists.flat_map(|list| list.split(',')).any(|one| {
        let mut parts = one.split(';').map(str::trim);
        let is_gzip = parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"));
        let weight = parts.find_map(|part| part.strip_prefix("q=")).map(str::parse::<f64>);
        is_gzip && weight.is_none_or(|weight| weight.is_ok_and(|weight| weight > 0.0))
    })
}

/// The bytes as a gzip file.
fn gzip(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::fast());
    encoder.write_all(bytes).ok()?;
    encoder.finish().ok()
}
