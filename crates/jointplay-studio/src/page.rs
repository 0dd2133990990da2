//! The built page, embedded.

use axum::http::{Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rust_embed::RustEmbed;

use crate::problem::Problem;

/// Files of the built page; none where it was not built before this program.
#[derive(RustEmbed)]
#[folder = "../../studio/dist"]
#[allow_missing = true]
struct Page;

/// What is shown where there is no page.
const NOT_BUILT: &str = include_str!("not_built.html");
/// Files under it have a hash of their contents in their names.
const HASHED: &str = "assets/";

/// Answers with a file of the page.
pub(crate) fn answer(method: &Method, path: &str) -> Response {
    if method != Method::GET && method != Method::HEAD {
        let detail = format!("{path} is a file of the page, and takes GET only");
        return Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail).into_response();
    }
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let Some(file) = Page::get(name) else {
        if name == "index.html" {
            let headers = [
                (header::CONTENT_TYPE, "text/html; charset=utf-8"),
                (header::CACHE_CONTROL, "no-store"),
            ];
            return (headers, NOT_BUILT).into_response();
        }
        let detail = format!("the page has no file {path}");
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
