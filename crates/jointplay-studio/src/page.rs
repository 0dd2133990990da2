//! The built page, embedded.

use axum::http::{Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rust_embed::RustEmbed;

use crate::problem::Problem;

/// Files of the page, as built by `npm run build` in the folder `studio`.
///
/// Release builds embed the files; debug builds read them from the folder, so that a new page needs no new build.
#[derive(RustEmbed)]
#[folder = "page"]
struct Page;

/// Folder of the files with a hash of their contents in their names.
const HASHED: &str = "assets/";

/// Response with a file of the page.
pub(crate) fn answer(method: &Method, path: &str) -> Response {
    if method != Method::GET && method != Method::HEAD {
        let detail = format!("{path} is a file of the page and accepts GET only");
        return Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail).into_response();
    }
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let Some(file) = Page::get(name) else {
        let detail = format!("unknown file {path}");
        return Problem::request(StatusCode::NOT_FOUND, detail).into_response();
    };
    let keep = if name.starts_with(HASHED) { "max-age=31536000, immutable" } else { "no-cache" };
    let headers = [(header::CONTENT_TYPE, kind(name)), (header::CACHE_CONTROL, keep)];
    (headers, file.data.into_owned()).into_response()
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
