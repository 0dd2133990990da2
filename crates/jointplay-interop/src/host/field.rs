//! Fields of the patterns of commands.

use crate::controller_text::Kind;

/// Kind of text that a field of a pattern matches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldKind {
    /// The name of a station.
    Station,
    /// A code of `[station_codes]`.
    StationCode,
    /// The name of an effector.
    Effector,
    /// A code of `[effector_codes]`.
    EffectorCode,
    /// The name of an axis.
    Axis,
    /// Letters, digits, `_`, `.` and `-`, which answers repeat.
    Identifier,
    /// A whole number.
    Integer,
    /// A number.
    Real,
}

/// A field: its name in patterns, what it matches, and its name in templates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) name: &'static str,
    pub(super) kind: FieldKind,
    pub(super) in_templates: &'static str,
}

const fn field(name: &'static str, kind: FieldKind, in_templates: &'static str) -> Field {
    Field { name, kind, in_templates }
}

/// Name of the field that answers repeat.
pub(super) const IDENTIFIER: &str = "id";
/// Name, in templates, of the unit of an axis.
pub(super) const UNIT: &str = "unit";

pub(super) const FIELDS: [Field; 20] = [
    field("station", FieldKind::Station, "station"),
    field("station_2", FieldKind::Station, "station_2"),
    field("station_code", FieldKind::StationCode, "station"),
    field("station_code_2", FieldKind::StationCode, "station_2"),
    field("effector", FieldKind::Effector, "effector"),
    field("effector_2", FieldKind::Effector, "effector_2"),
    field("effector_code", FieldKind::EffectorCode, "effector"),
    field("effector_code_2", FieldKind::EffectorCode, "effector_2"),
    field("axis", FieldKind::Axis, "axis"),
    field(IDENTIFIER, FieldKind::Identifier, IDENTIFIER),
    field("slot", FieldKind::Integer, "slot"),
    field("slot_2", FieldKind::Integer, "slot_2"),
    field("value", FieldKind::Real, "value"),
    field("angle", FieldKind::Real, "angle"),
    field("azimuth", FieldKind::Real, "azimuth"),
    field("percent", FieldKind::Real, "percent"),
    field("duration", FieldKind::Real, "duration"),
    field("x", FieldKind::Real, "x"),
    field("y", FieldKind::Real, "y"),
    field("z", FieldKind::Real, "z"),
];

impl FieldKind {
    /// Kind of its value in templates.
    pub(super) fn value_kind(self) -> Kind {
        match self {
            Self::Integer => Kind::Integer,
            Self::Real => Kind::Real,
            _ => Kind::Text,
        }
    }
}
