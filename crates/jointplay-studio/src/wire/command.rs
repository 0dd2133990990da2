//! Command of the robot.

use jointplay::format::json;
use jointplay::gpr::Gpr;
use jointplay::spatial::Tilt;
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::{Rods, angle, length, tilt_angle};
use crate::problem::Problem;

/// Command of the robot.
#[derive(ToSchema)]
#[serde(untagged)]
pub(crate) enum Command {
    /// A tilt by azimuth and angle, at a height.
    Tilt(TiltCommand),
    /// A tilt as rotation vector, at a height.
    TiltXy(TiltXyCommand),
    /// Three rod lengths.
    Rods(RodsCommand),
}

// Read by its kind, so that errors name the inner field.
/// Command of the robot.
#[derive(Deserialize, ToSchema)]
#[schema(value_type = Command)]
pub(crate) struct CommandFields(Value);

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TiltKind {
    Tilt,
}

/// A tilt by azimuth and angle.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltCommand {
    /// Kind of the command.
    #[expect(dead_code, reason = "known before it is read")]
    kind: TiltKind,
    /// Azimuth of the tilt, from x toward y (rad).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) azimuth_rad: f64,
    /// Angle of the tilt (rad).
    #[schema(exclusive_minimum = -1.5707963267948966, exclusive_maximum = 1.5707963267948966)]
    pub(crate) tilt_rad: f64,
    /// Height of the platform; default: the working height of the robot.
    pub(crate) height: Option<Height>,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TiltXyKind {
    TiltXy,
}

/// A tilt as rotation vector in the base plane, as in machine controllers.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltXyCommand {
    /// Kind of the command.
    #[expect(dead_code, reason = "known before it is read")]
    kind: TiltXyKind,
    /// Component about x (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Component about y (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
    /// Height of the platform; default: the working height of the robot.
    pub(crate) height: Option<Height>,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum RodsKind {
    Rods,
}

/// Three rod lengths.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RodsCommand {
    /// Kind of the command.
    #[expect(dead_code, reason = "known before it is read")]
    kind: RodsKind,
    /// q_1, q_2, q_3 (m).
    pub(crate) rods_m: Rods,
}

/// A height with its reference point.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Height {
    /// Reference point.
    pub(crate) kind: HeightKind,
    /// The height (m).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) value_m: f64,
}

/// Reference point of a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HeightKind {
    /// The intersection of the platform plane with the base axis.
    Axis,
    /// The platform centre.
    Center,
}

/// A checked command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// A tilt at a height.
    Tilt { tilt: Tilt, height: Height },
    /// Rod lengths (m).
    Rods([f64; 3]),
}

impl CommandFields {
    /// Checks the command at `field`; a missing height is the working height.
    pub(crate) fn read(self, gpr: &Gpr, field: &str) -> Result<Target, Problem> {
        let Self(value) = self;
        let at = |name: &str| format!("{field}.{name}");
        let command = match json::kind(&value, field, &["tilt", "tilt_xy", "rods"])? {
            "tilt" => Command::Tilt(json::read_value(value, field)?),
            "tilt_xy" => Command::TiltXy(json::read_value(value, field)?),
            _ => Command::Rods(json::read_value(value, field)?),
        };
        match command {
            Command::Tilt(found) => {
                let azimuth = angle(found.azimuth_rad, &at("azimuth_rad"))?;
                let tilt = Tilt { azimuth, angle: tilt_angle(found.tilt_rad, &at("tilt_rad"))? };
                Ok(Target::Tilt { tilt, height: height(found.height, gpr, field)? })
            }
            Command::TiltXy(found) => {
                let about_x = tilt_angle(found.about_x_rad, &at("about_x_rad"))?;
                let about_y = tilt_angle(found.about_y_rad, &at("about_y_rad"))?;
                let tilt = Tilt::from_about_x_and_y(about_x, about_y);
                tilt_angle(tilt.angle, field)?;
                Ok(Target::Tilt { tilt, height: height(found.height, gpr, field)? })
            }
            Command::Rods(found) => rods(found.rods_m.0, &at("rods_m")).map(Target::Rods),
        }
    }
}

/// The requested height; default: the working height of the robot.
pub(crate) fn height(asked: Option<Height>, gpr: &Gpr, field: &str) -> Result<Height, Problem> {
    let usual = Height { kind: HeightKind::Axis, value_m: gpr.working_height() };
    let height = asked.unwrap_or(usual);
    length(height.value_m, &format!("{field}.height.value_m"))?;
    Ok(height)
}

/// Checks three rod lengths (m).
pub(crate) fn rods(rods: [f64; 3], field: &str) -> Result<[f64; 3], Problem> {
    for (k, &rod) in rods.iter().enumerate() {
        length(rod, &format!("{field}[{k}]"))?;
    }
    Ok(rods)
}
