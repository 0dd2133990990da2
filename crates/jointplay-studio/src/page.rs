//! The built page and the description of the API, embedded in gzip.

use std::io::Read as _;

use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;

use crate::compression::accepts_gzip;
use crate::problem::Problem;

/// Paths of the files and their contents: the page as built by `npm run build` in the folder `studio`, and the description.
static FILES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// Path of the description of the API.
pub(crate) const DESCRIPTION: &str = "/api/v1/openapi.json";

/// Folder of the files with a hash of their contents in their names.
const HASHED: &str = "/assets/";

/// Response with a file, compressed if the client accepts it.
pub(crate) fn answer(method: &Method, path: &str, headers: &HeaderMap) -> Response {
    if method != Method::GET && method != Method::HEAD {
        let detail = format!("{path} is a file of the page and accepts GET only");
        return Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail).into_response();
    }
    let name = if path == "/" { "/index.html" } else { path };
    let Some((_, compressed)) = FILES.iter().find(|(known, _)| *known == name) else {
        let detail = format!("unknown file {path}");
        return Problem::request(StatusCode::NOT_FOUND, detail).into_response();
    };
    let keep = if name.starts_with(HASHED) { "max-age=31536000, immutable" } else { "no-cache" };
    let about = [
        (header::CONTENT_TYPE, kind(name)),
        (header::CACHE_CONTROL, keep),
        // Also of files that are not compressed: a cache must not send one of both for the other.
        (header::VARY, "accept-encoding"),
    ];
    if accepts_gzip(headers) {
        let encoding = [(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"))];
        return (about, encoding, *compressed).into_response();
    }
    let mut plain = Vec::new();
    match GzDecoder::new(*compressed).read_to_end(&mut plain) {
        Ok(_) => (about, plain).into_response(),
        Err(_) => Problem::broken("a file of the page is damaged").into_response(),
    }
}

/// The media type of a file, by its ending.
fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}
