//! Access control: requests from the served page and from local programs are accepted, requests of other web pages are rejected.

use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::problem::Problem;

/// Content security policy: scripts and data from this server only; inline styles are allowed, as 3D views set them.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self' blob: data:; media-src 'self' blob:; \
    worker-src 'self' blob:; manifest-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// Name of this server in its responses, by which [`ping`](crate::ping()) recognises it.
pub(crate) const SERVER: &str = concat!("jointplay/", env!("CARGO_PKG_VERSION"));

const HEADERS: [(HeaderName, &str); 7] = [
    (header::SERVER, SERVER),
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// Accepted host names, and the deadline for the start of a response.
#[derive(Clone)]
pub(crate) struct Guard {
    hosts: [String; 3],
    deadline: Duration,
}

impl Guard {
    pub(crate) fn new(port: u16, deadline: Duration) -> Self {
        let hosts = ["127.0.0.1", "localhost", "[::1]"].map(|name| format!("{name}:{port}"));
        Self { hosts, deadline }
    }

    /// The reason to reject a request, if any.
    ///
    /// A foreign page can make a browser send requests to this server. They are recognized by their `Origin`, and with DNS rebinding by their `Host`.
    fn refusal(&self, method: &Method, headers: &HeaderMap) -> Option<String> {
        let known = |host: &str| self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host));
        let text = |name: &HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let hosts = self.hosts.join(", ");
        match text(&header::HOST) {
            Some(host) if known(host) => {}
            Some(host) => {
                return Some(format!("unknown host {host:?}; accepted hosts are {hosts}"));
            }
            None => return Some(format!("the request has no host; accepted hosts are {hosts}")),
        }
        if let Some(origin) = text(&header::ORIGIN) {
            let own = origin.strip_prefix("http://").is_some_and(known);
            if !own {
                return Some(format!("requests from pages of {origin:?} are not allowed"));
            }
        }
        // Links of other sites to the page are allowed; embedding as image, script or similar is not.
        let site = text(&HeaderName::from_static("sec-fetch-site"));
        let mode = text(&HeaderName::from_static("sec-fetch-mode"));
        let followed_link = mode == Some("navigate") && method == Method::GET;
        if matches!(site, Some("cross-site" | "same-site")) && !followed_link {
            return Some("requests from pages of other sites are not allowed".to_owned());
        }
        None
    }
}

/// Rejects foreign requests, enforces the deadline, and adds security headers.
pub(crate) async fn check(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let api = request.uri().path().starts_with("/api/");
    let mut response = match guard.refusal(request.method(), request.headers()) {
        Some(why) => Problem::refused(why).into_response(),
        None => match tokio::time::timeout(guard.deadline, next.run(request)).await {
            Ok(response) => response,
            Err(_) => {
                let detail =
                    format!("the request took longer than {} s", guard.deadline.as_secs_f64());
                Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail).into_response()
            }
        },
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if api && !headers.contains_key(header::CACHE_CONTROL) {
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    }
    response
}
