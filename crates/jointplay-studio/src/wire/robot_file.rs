//! Documents of the robot file: its text, errors, and changes of its numbers.

use std::collections::BTreeMap;

use jointplay::format::robot::{self, Dimension, Robot};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::robot::RobotDocument;
use crate::problem::Problem;

/// A three-rod robot as text.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RobotSource {
    /// Text of a robot file (TOML).
    pub(crate) text: String,
    /// Values of parameters in place of those of the file, in its units.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) parameters: BTreeMap<String, f64>,
}

impl RobotSource {
    /// Reads the robot; all errors of the text, if there are any.
    pub(crate) fn parse(&self) -> Result<Robot, robot::Errors> {
        let replaced: Vec<(String, f64)> =
            self.parameters.iter().map(|(name, &value)| (name.clone(), value)).collect();
        robot::parse_with(&self.text, &replaced)
    }

    /// Reads the robot at `field` of a request.
    pub(crate) fn read(&self, field: &str) -> Result<Robot, Problem> {
        self.parse().map_err(|errors| {
            let first = &errors[0];
            let detail =
                format!("line {}, column {}: {first}", first.place.line, first.place.column);
            Problem::field(format!("{field}.text"), detail)
        })
    }
}

/// The file of the robot of this server.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RobotFileDocument {
    /// Name of the file or of the catalogue entry.
    pub(crate) name: String,
    /// Whether it is a file that can be saved.
    pub(crate) writable: bool,
    /// Its text.
    pub(crate) text: String,
    /// Values of parameters in place of those of the file, in its units.
    pub(crate) parameters: BTreeMap<String, f64>,
    /// Version of the text, for `replaces`.
    pub(crate) version: String,
}

/// Request to save the text of the robot file.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveRobotRequest {
    /// The text.
    pub(crate) text: String,
    /// Version of the file that the text replaces.
    pub(crate) replaces: Option<String>,
}

/// Request to read a robot file, after changes of its numbers.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpenRobotRequest {
    /// The robot.
    pub(crate) robot: RobotSource,
    /// Numbers to replace in the text, in this order; comments and everything else remain.
    #[serde(default)]
    #[schema(required = false, max_items = 64)]
    pub(crate) changes: Vec<DimensionChange>,
}

/// Largest number of changes of a request.
pub(crate) const MAX_CHANGES: usize = 64;

/// A number of a robot file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DimensionName {
    /// A parameter, in the units of the file; needs `name`.
    Parameter,
    /// Distance of a socket from the platform centre (m); needs `limb`.
    SocketRadius,
    /// Direction of a socket (rad); needs `limb`.
    SocketAngle,
    /// x of the point of a rod in the base plane (m); needs `limb`.
    BaseX,
    /// y of the point of a rod in the base plane (m); needs `limb`.
    BaseY,
    /// Shortest rod (m).
    RodMin,
    /// Longest rod (m).
    RodMax,
    /// Largest tilt (rad).
    TiltLimit,
    /// Axis height at which the robot works (m).
    WorkingHeight,
    /// Clearance of the balls, as a radius (m).
    BallClearance,
}

/// A new value of a number.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DimensionChange {
    /// The number.
    pub(crate) dimension: DimensionName,
    /// Index of its limb, from 0.
    #[schema(maximum = 2)]
    pub(crate) limb: Option<usize>,
    /// Name of the parameter.
    pub(crate) name: Option<String>,
    /// The value (m, rad), of parameters in the units of the file.
    pub(crate) value: f64,
}

impl DimensionChange {
    /// The number of the file at `field`.
    pub(crate) fn read(self, field: &str) -> Result<(Dimension, f64), Problem> {
        let missing =
            |key: &str| Problem::field(format!("{field}.{key}"), format!("{key} is missing"));
        let limb = || match self.limb {
            Some(limb) if limb < 3 => Ok(limb),
            Some(limb) => {
                let detail = format!("a robot has limbs 0 to 2, got {limb}");
                Err(Problem::field(format!("{field}.limb"), detail))
            }
            None => Err(missing("limb")),
        };
        let dimension = match self.dimension {
            DimensionName::Parameter => {
                Dimension::Parameter(self.name.clone().ok_or_else(|| missing("name"))?)
            }
            DimensionName::SocketRadius => Dimension::SocketRadius(limb()?),
            DimensionName::SocketAngle => Dimension::SocketAngle(limb()?),
            DimensionName::BaseX => Dimension::BaseX(limb()?),
            DimensionName::BaseY => Dimension::BaseY(limb()?),
            DimensionName::RodMin => Dimension::RodMin,
            DimensionName::RodMax => Dimension::RodMax,
            DimensionName::TiltLimit => Dimension::TiltLimit,
            DimensionName::WorkingHeight => Dimension::WorkingHeight,
            DimensionName::BallClearance => Dimension::BallClearance,
        };
        Ok((dimension, self.value))
    }
}

/// An opened robot file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct OpenedRobotDocument {
    /// The text after the changes.
    pub(crate) text: String,
    /// Errors of the text; the robot is `null` if there are any.
    pub(crate) diagnostics: Vec<RobotDiagnostic>,
    /// The robot.
    #[schema(required = true)]
    pub(crate) robot: Option<RobotDocument>,
    /// Parameters that are numbers.
    pub(crate) parameters: Vec<RobotParameter>,
    /// Numbers that are expressions of parameters, which can be changed by parameters or in the text only.
    pub(crate) expressions: Vec<DimensionExpression>,
}

/// An error in a text, with its position.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub(crate) struct RobotDiagnostic {
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column, from 1.
    pub(crate) column: usize,
    /// Number of characters.
    pub(crate) width: usize,
    /// The error.
    pub(crate) message: String,
}

impl From<&robot::Error> for RobotDiagnostic {
    fn from(error: &robot::Error) -> Self {
        let place = &error.place;
        let message = error.to_string();
        Self { line: place.line, column: place.column, width: place.width, message }
    }
}

/// A parameter of a robot file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RobotParameter {
    /// Its name.
    pub(crate) name: String,
    /// Its value, in the units of the file.
    pub(crate) value: f64,
}

/// A number of a robot file that is an expression.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub(crate) struct DimensionExpression {
    /// The number.
    pub(crate) dimension: DimensionName,
    /// Index of its limb, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub(crate) limb: Option<usize>,
    /// The expression.
    pub(crate) expression: String,
}

impl DimensionExpression {
    pub(crate) fn new(dimension: &Dimension, expression: String) -> Self {
        let (dimension, limb) = match *dimension {
            Dimension::Parameter(_) => (DimensionName::Parameter, None),
            Dimension::SocketRadius(limb) => (DimensionName::SocketRadius, Some(limb)),
            Dimension::SocketAngle(limb) => (DimensionName::SocketAngle, Some(limb)),
            Dimension::BaseX(limb) => (DimensionName::BaseX, Some(limb)),
            Dimension::BaseY(limb) => (DimensionName::BaseY, Some(limb)),
            Dimension::RodMin => (DimensionName::RodMin, None),
            Dimension::RodMax => (DimensionName::RodMax, None),
            Dimension::TiltLimit => (DimensionName::TiltLimit, None),
            Dimension::WorkingHeight => (DimensionName::WorkingHeight, None),
            Dimension::BallClearance => (DimensionName::BallClearance, None),
        };
        Self { dimension, limb, expression }
    }
}
