//! Lengths and angles as typed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A length or an angle as typed.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct QuantityRequest {
    /// A number or an expression, with or without a unit at its end: `1/3`, `0.5 mil`.
    pub(crate) text: String,
    /// Unit of the number where the text has none.
    pub(crate) unit: TypedUnit,
}

/// Unit of a field.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TypedUnit {
    /// Millimetres.
    Mm,
    /// Inches.
    In,
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

/// Quantity of a value.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum QuantityKind {
    /// A length (m).
    Length,
    /// An angle (rad).
    Angle,
}

/// Unit of a value.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ValueUnit {
    /// Metres.
    M,
    /// Radians.
    Rad,
}

/// The value of a text.
#[derive(Serialize, ToSchema)]
pub(crate) struct QuantityDocument {
    /// Quantity of the value.
    pub(crate) kind: QuantityKind,
    /// The value (m, rad).
    pub(crate) value: f64,
    /// Unit of the value.
    pub(crate) unit: ValueUnit,
}
