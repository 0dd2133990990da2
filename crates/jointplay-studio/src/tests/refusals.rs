//! Rejected requests.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode};

use super::{HOST, PORT, get, post, refused, send};

/// Sends a request with these headers and returns its status.
#[track_caller]
fn status(method: Method, path: &str, headers: &[(&str, &str)]) -> StatusCode {
    let mut request = Request::builder().method(method).uri(path);
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    let answer = send(request.body(Body::empty()).unwrap());
    if !answer.status.is_success() {
        assert_eq!(answer.header("content-type"), "application/problem+json");
    }
    // Every response has security headers.
    assert!(answer.header("content-security-policy").contains("frame-ancestors 'none'"));
    assert_eq!(answer.header("x-content-type-options"), "nosniff");
    assert!(answer.header("server").starts_with("jointplay/"));
    answer.status
}

#[test]
fn other_hosts_are_rejected() {
    let host = |host: &str| status(Method::GET, "/api/v1/robot", &[("host", host)]);
    for known in ["127.0.0.1", "localhost", "LOCALHOST", "[::1]"] {
        assert_eq!(host(&format!("{known}:{PORT}")), StatusCode::OK, "{known}");
    }
    for other in
        ["evil.example", "evil.example:4816", "127.0.0.1", "127.0.0.1:1", "localhost:48160", ""]
    {
        assert_eq!(host(other), StatusCode::FORBIDDEN, "{other:?}");
    }
    assert_eq!(status(Method::GET, "/", &[("host", "evil.example:4816")]), StatusCode::FORBIDDEN);
    assert_eq!(status(Method::GET, "/", &[]), StatusCode::FORBIDDEN, "no host");
}

#[test]
fn other_origins_are_rejected() {
    let origin =
        |origin: &str| status(Method::GET, "/api/v1/robot", &[("host", HOST), ("origin", origin)]);
    assert_eq!(origin("http://127.0.0.1:4816"), StatusCode::OK);
    assert_eq!(origin("http://localhost:4816"), StatusCode::OK);
    for other in
        ["http://evil.example", "null", "https://127.0.0.1:4816", "http://127.0.0.1:4817", ""]
    {
        assert_eq!(origin(other), StatusCode::FORBIDDEN, "{other:?}");
    }
}

#[test]
fn foreign_pages_may_link_but_not_send_requests() {
    let from = |site: &str, mode: &str| {
        let headers = [("host", HOST), ("sec-fetch-site", site), ("sec-fetch-mode", mode)];
        status(Method::GET, "/", &headers)
    };
    assert_eq!(from("none", "navigate"), StatusCode::OK);
    assert_eq!(from("same-origin", "cors"), StatusCode::OK);
    assert_eq!(from("cross-site", "navigate"), StatusCode::OK);
    assert_eq!(from("cross-site", "no-cors"), StatusCode::FORBIDDEN);
    assert_eq!(from("same-site", "no-cors"), StatusCode::FORBIDDEN, "another port of this machine");
}

#[test]
fn content_types_of_forms_are_rejected() {
    for kind in ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""] {
        let request = Request::post("/api/v1/pose")
            .header("host", HOST)
            .header("content-type", kind)
            .body(Body::from("{}"));
        let answer = send(request.unwrap());
        assert_eq!(answer.status, StatusCode::UNSUPPORTED_MEDIA_TYPE, "{kind}");
    }
}

#[test]
fn unknown_paths_and_methods_are_rejected() {
    assert_eq!(get("/api/v1/nothing").status, StatusCode::NOT_FOUND);
    assert_eq!(get("/api/v1/pose").status, StatusCode::METHOD_NOT_ALLOWED);
    assert_eq!(status(Method::DELETE, "/", &[("host", HOST)]), StatusCode::METHOD_NOT_ALLOWED);
    let refused = status(Method::DELETE, "/api/v1/robot", &[("host", HOST)]);
    assert_eq!(refused, StatusCode::METHOD_NOT_ALLOWED);
}

#[test]
fn an_oversized_body_is_rejected() {
    let long = format!("{{\"command\": \"{}\"}}", "x".repeat(crate::body::MAX_BODY_BYTES));
    refused("/api/v1/pose", &long, 413, None, "exceeds 10000000 bytes");
}

/// The limit that the page compares its requests with (bytes); that of the server in an archive of the crate, which has no source of the page.
fn limit_of_page() -> usize {
    let Some(sources) = super::repository("studio/src") else {
        return crate::body::MAX_BODY_BYTES;
    };
    let text = std::fs::read_to_string(sources.join("lib/requestSize.ts")).unwrap();
    let (_, rest) = text.split_once("export const MAX_BODY_BYTES = ").unwrap();
    let (number, _) = rest.split_once(';').unwrap();
    number.replace('_', "").parse().unwrap()
}

#[test]
fn the_page_knows_the_maximum_size_of_a_body() {
    let limit = limit_of_page();
    let frame = "{\"command\": \"\"}";
    let body = |bytes: usize| {
        let text = "x".repeat(bytes - frame.len());
        format!("{{\"command\": \"{text}\"}}")
    };
    assert_eq!(body(limit).len(), limit);
    assert_ne!(post("/api/v1/pose", &body(limit)).status, StatusCode::PAYLOAD_TOO_LARGE);
    assert_eq!(post("/api/v1/pose", &body(limit + 1)).status, StatusCode::PAYLOAD_TOO_LARGE);
}
