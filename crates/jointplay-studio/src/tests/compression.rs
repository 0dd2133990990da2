//! Responses are compressed for clients that accept gzip, and their contents stay the same.

use std::io::{Read as _, Write as _};

use axum::body::Body;
use axum::http::{Request, header};

use super::{Answer, HOST, send};

fn get(path: &str, accepted: Option<&str>) -> Answer {
    let request = Request::builder().uri(path).header(header::HOST, HOST);
    let request = match accepted {
        Some(accepted) => request.header(header::ACCEPT_ENCODING, accepted),
        None => request,
    };
    send(request.body(Body::empty()).unwrap())
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut found = Vec::new();
    flate2::read::GzDecoder::new(bytes).read_to_end(&mut found).unwrap();
    found
}

#[test]
fn long_responses_are_compressed_for_clients_that_accept_it() {
    let path = "/api/v1/openapi.json";
    let plain = get(path, None);
    assert_eq!(plain.header("content-encoding"), "");
    // Before, only the compressed response had it, and a cache could send the plain one to all.
    assert_eq!(plain.header("vary"), "accept-encoding");
    let vary = plain.headers.get_all("vary").iter().count();
    assert_eq!(vary, 1, "once");
    for accepted in ["gzip", "br, GZIP;q=0.5", "deflate, gzip, zstd"] {
        let compressed = get(path, Some(accepted));
        assert_eq!(compressed.header("content-encoding"), "gzip", "{accepted}");
        assert!(compressed.header("vary").contains("accept-encoding"), "{accepted}");
        assert_eq!(compressed.header("content-type"), plain.header("content-type"));
        assert!(3 * compressed.bytes.len() < plain.bytes.len(), "{accepted}");
        assert_eq!(unpacked(&compressed.bytes), plain.bytes, "{accepted}");
    }
}

#[test]
fn other_responses_are_not_compressed() {
    for accepted in ["br", "gzip;q=0", "gzip;q=x", "identity", ""] {
        let answer = get("/api/v1/openapi.json", Some(accepted));
        assert_eq!(answer.header("content-encoding"), "", "{accepted}");
    }
    assert_eq!(get("/api/v1/robot", Some("gzip")).header("content-encoding"), "", "a short one");
}

/// Embedded files are compressed already; all else would be computed to be thrown away.
#[test]
fn heads_are_those_of_the_responses_that_are_embedded() {
    for (path, expected) in [("/api/v1/openapi.json", "gzip"), ("/api/v1/catalogue", "")] {
        assert_eq!(get(path, Some("gzip")).header("content-encoding"), "gzip", "{path}");
        let head = Request::builder().method("HEAD").uri(path);
        let head = head.header(header::HOST, HOST).header(header::ACCEPT_ENCODING, "gzip");
        let answer = send(head.body(Body::empty()).unwrap());
        assert_eq!(answer.header("content-encoding"), expected, "{path}");
        assert!(answer.bytes.is_empty(), "{path}");
    }
}

#[test]
fn files_of_the_page_that_the_browser_keeps_are_compressed_well() {
    let index = String::from_utf8(get("/", None).bytes).unwrap();
    let assets: Vec<&str> =
        index.split("./").skip(1).filter(|one| one.starts_with("assets/")).collect();
    let names = assets.iter().map(|one| one.split('"').next().unwrap());
    let mut count = 0;
    for name in names {
        let path = format!("/{name}");
        let [plain, compressed] = [None, Some("gzip")].map(|accepted| get(&path, accepted));
        if plain.bytes.len() < 1_024 {
            continue;
        }
        count += 1;
        assert_eq!(compressed.header("content-encoding"), "gzip", "{path}");
        assert_eq!(unpacked(&compressed.bytes), plain.bytes, "{path}");
        let mut fast = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        fast.write_all(&plain.bytes).unwrap();
        assert!(compressed.bytes.len() < fast.finish().unwrap().len(), "{path}");
    }
    assert!(count > 0, "{index}");
}
