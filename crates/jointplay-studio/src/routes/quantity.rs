//! `POST /api/v1/quantity`: the value of a length or angle as typed.

use axum::Json;
use jointplay::format::command::{CommandValue, Names};
use jointplay::format::expression::AngleUnit;
use jointplay::format::mechanism::{LengthUnit, Units};
use jointplay::mechanism::joint::Coordinate;

use crate::body::Body;
use crate::mechanism_source::typed;
use crate::problem::Problem;
use crate::wire::quantity::{
    QuantityDocument, QuantityKind, QuantityRequest, TypedUnit, ValueUnit,
};

/// The value of a length or an angle as typed
///
/// The text is a number or an expression, in the unit of the field or in the unit at its end: `1/3`, `0.5 mil`, `2 * 1.5 mm`, `250 µrad`.
#[utoipa::path(
    post,
    path = "/api/v1/quantity",
    operation_id = "quantity",
    request_body = QuantityRequest,
    responses(
        (status = 200, description = "The value", body = QuantityDocument),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn quantity(
    Body(QuantityRequest { text, unit }): Body<QuantityRequest>,
) -> Result<Json<QuantityDocument>, Problem> {
    typed(&text, "text")?;
    let (kind, units) = match unit {
        TypedUnit::Mm => (QuantityKind::Length, Units::MM),
        TypedUnit::In => (QuantityKind::Length, Units { length: LengthUnit::Inch, ..Units::MM }),
        TypedUnit::Deg => (QuantityKind::Angle, Units::MM),
        TypedUnit::Rad => (QuantityKind::Angle, Units { angle: AngleUnit::Radian, ..Units::MM }),
    };
    let (coordinate, unit) = match kind {
        QuantityKind::Length => (Coordinate::Slide, ValueUnit::M),
        QuantityKind::Angle => (Coordinate::Turn, ValueUnit::Rad),
    };
    let names = Names::none(units);
    let value = CommandValue::parse(&ascii_units(&text), &names)
        .and_then(|value| value.evaluate(coordinate, &names, 0.0))
        .map_err(|error| Problem::field("text", error.to_string()))?;
    Ok(Json(QuantityDocument { kind, value, unit }))
}

/// A text with the names of units as files have them.
fn ascii_units(text: &str) -> String {
    text.replace(['µ', 'μ'], "u").replace('°', " deg").replace('−', "-")
}
