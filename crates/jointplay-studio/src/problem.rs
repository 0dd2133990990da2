//! Errors as problem documents (RFC 9457).

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::format::explain::explain;
use jointplay::format::json::{self, JsonError};
use jointplay::gpr::BrokenLimit;
use jointplay::report::{self, LimitReport};
use serde::Serialize;
use utoipa::ToSchema;

use crate::display::display_units;

/// An error as `application/problem+json`.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct Problem {
    /// Always `about:blank`; see `kind`.
    r#type: &'static str,
    /// Name of the status.
    title: &'static str,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    status: u16,
    /// What was found, what is allowed, what to do.
    detail: String,
    /// Kind of the problem.
    kind: Kind,
    /// The invalid field of the request, such as `command.angle_rad` or `models[1].solver`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    field: Option<String>,
    /// Limits that the pose violates.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    limits_broken: Vec<LimitReport>,
}

/// Kind of the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    /// The request is invalid.
    Input,
    /// The pose is beyond the robot's limits.
    Limits,
    /// There is no solution.
    Unsolved,
    /// The origin of the request is not allowed.
    Refused,
    /// The server cannot process the request, at the moment or in this build.
    Unavailable,
}

impl Problem {
    fn new(status: StatusCode, kind: Kind, detail: impl Into<String>) -> Self {
        Self {
            r#type: "about:blank",
            title: status.canonical_reason().unwrap_or_default(),
            status: status.as_u16(),
            detail: detail.into(),
            kind,
            field: None,
            limits_broken: Vec::new(),
        }
    }

    /// An invalid request with a status of its own.
    pub(crate) fn request(status: StatusCode, detail: impl Into<String>) -> Self {
        Self::new(status, Kind::Input, detail)
    }

    /// An invalid value of a field.
    pub(crate) fn field(field: impl Into<String>, detail: impl Into<String>) -> Self {
        let field = Some(field.into()).filter(|field| !field.is_empty());
        Self { field, ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, Kind::Input, detail) }
    }

    /// A field that refers to an outdated state.
    pub(crate) fn outdated(field: &str, detail: impl Into<String>) -> Self {
        let field = Some(field.to_owned());
        Self { field, ..Self::new(StatusCode::CONFLICT, Kind::Input, detail) }
    }

    /// The origin of the request is not allowed.
    pub(crate) fn refused(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, Kind::Refused, detail)
    }

    /// The server cannot process the request.
    pub(crate) fn unavailable(status: StatusCode, detail: impl Into<String>) -> Self {
        Self::new(status, Kind::Unavailable, detail)
    }

    /// An internal error.
    pub(crate) fn broken(what: &str) -> Self {
        let detail = format!("internal error: {what}; please report it with this request");
        Self::unavailable(StatusCode::INTERNAL_SERVER_ERROR, detail)
    }

    /// The pose is beyond the robot's limits.
    pub(crate) fn limits(broken: &[BrokenLimit]) -> Self {
        let limits_broken = report::limits(broken, display_units());
        let words: Vec<&str> = limits_broken.iter().map(|limit| limit.message.as_str()).collect();
        let detail = format!(
            "the pose is beyond the robot's limits: {}; set \"ignore_limits\": true to ignore them",
            words.join("; ")
        );
        Self { limits_broken, ..Self::new(StatusCode::CONFLICT, Kind::Limits, detail) }
    }
}

impl From<jointplay::Error> for Problem {
    fn from(error: jointplay::Error) -> Self {
        use jointplay::Error as E;
        let is_invalid_input =
            matches!(error, E::NotFinite { .. } | E::TiltTooLarge { .. } | E::OutOfRange { .. });
        if is_invalid_input {
            Self::new(
                StatusCode::UNPROCESSABLE_ENTITY,
                Kind::Input,
                explain(&error, display_units()),
            )
        } else {
            Self::new(StatusCode::CONFLICT, Kind::Unsolved, explain(&error, display_units()))
        }
    }
}

impl From<JsonError> for Problem {
    fn from(error: JsonError) -> Self {
        match error.problem {
            json::Problem::NotJson(_) => {
                Self::request(StatusCode::BAD_REQUEST, format!("the body is {}", error.problem))
            }
            problem => Self::field(error.field, problem.to_string()),
        }
    }
}

impl From<jointplay::study::Error> for Problem {
    fn from(error: jointplay::study::Error) -> Self {
        match error {
            jointplay::study::Error::Pose { source, .. } => Self::from(*source),
            other => Self::field("", other.to_string()),
        }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status =
            StatusCode::from_u16(self.status).expect("a problem is made from a status of HTTP");
        let mut response = (status, Json(self)).into_response();
        let kind = HeaderValue::from_static("application/problem+json");
        response.headers_mut().insert(header::CONTENT_TYPE, kind);
        response
    }
}
