//! What went wrong, as RFC 9457 says it.

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::format::explain::explain;
use jointplay::gpr::BrokenLimit;
use jointplay::report::{self, LimitReport};
use serde::Serialize;
use utoipa::ToSchema;

/// What went wrong, as `application/problem+json`.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct Problem {
    /// Always `about:blank`: `kind` says what sort of problem it is.
    r#type: &'static str,
    /// The words of the status.
    title: &'static str,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    status: u16,
    /// What was found, what is allowed, what to try.
    detail: String,
    /// What sort of problem it is.
    kind: Kind,
    /// Which field of the request is wrong, such as `command.pitch_rad` or `models[1].solver`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    field: Option<String>,
    /// The limits that the pose breaks.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    limits_broken: Vec<LimitReport>,
}

/// What sort of problem it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    /// The request is wrong.
    Input,
    /// The pose is beyond the robot's limits.
    Limits,
    /// There is no answer.
    Unsolved,
    /// The request comes from where none may come from.
    Refused,
    /// The server cannot, at the moment or in this build.
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

    /// The request is wrong in a way that has a status of its own.
    pub(crate) fn request(status: StatusCode, detail: impl Into<String>) -> Self {
        Self::new(status, Kind::Input, detail)
    }

    /// A field has a value that it cannot have.
    pub(crate) fn field(field: impl Into<String>, detail: impl Into<String>) -> Self {
        let field = Some(field.into()).filter(|field| !field.is_empty());
        Self { field, ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, Kind::Input, detail) }
    }

    /// A field speaks of what is another by now.
    pub(crate) fn outdated(field: &str, detail: impl Into<String>) -> Self {
        let field = Some(field.to_owned());
        Self { field, ..Self::new(StatusCode::CONFLICT, Kind::Input, detail) }
    }

    /// The request comes from where none may come from.
    pub(crate) fn refused(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, Kind::Refused, detail)
    }

    /// The server cannot.
    pub(crate) fn unavailable(status: StatusCode, detail: impl Into<String>) -> Self {
        Self::new(status, Kind::Unavailable, detail)
    }

    /// A mistake of ours.
    pub(crate) fn broken(what: &str) -> Self {
        let detail = format!("{what}: a mistake of ours, please report it with this request");
        Self::unavailable(StatusCode::INTERNAL_SERVER_ERROR, detail)
    }

    /// The pose is beyond the robot's limits.
    pub(crate) fn limits(broken: &[BrokenLimit]) -> Self {
        let limits_broken = report::limits(broken);
        let words: Vec<&str> = limits_broken.iter().map(|limit| limit.message.as_str()).collect();
        let detail = format!(
            "the pose is beyond the robot's limits: {}; \"ignore_limits\": true computes past them",
            words.join("; ")
        );
        Self { limits_broken, ..Self::new(StatusCode::CONFLICT, Kind::Limits, detail) }
    }
}

impl From<jointplay::Error> for Problem {
    fn from(error: jointplay::Error) -> Self {
        use jointplay::Error as E;
        let wrong =
            matches!(error, E::NotFinite { .. } | E::PitchTooLarge { .. } | E::OutOfRange { .. });
        if wrong {
            Self::new(StatusCode::UNPROCESSABLE_ENTITY, Kind::Input, explain(&error))
        } else {
            Self::new(StatusCode::CONFLICT, Kind::Unsolved, explain(&error))
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
