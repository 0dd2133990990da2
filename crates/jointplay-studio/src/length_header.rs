//! The request header that names the unit of lengths in messages.

use axum::extract::Request;
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use jointplay::format::display_units::DisplayUnits;

use crate::display;
use crate::problem::Problem;

/// Name of the header; its values are `mm`, the default, and `in`.
const HEADER: &str = "length-unit";

/// Serves a request in the units of its header.
pub(crate) async fn serve(request: Request, next: Next) -> Response {
    let units = match request.headers().get(HEADER).map(|value| value.to_str().unwrap_or("?")) {
        None => DisplayUnits::default(),
        Some(name) => match DisplayUnits::named(name) {
            Some(units) => units,
            None => {
                let detail = format!("unknown unit {name:?} in the header {HEADER}; known: mm, in");
                return Problem::field(HEADER, detail).into_response();
            }
        },
    };
    display::scope(units, next.run(request)).await
}
