//! What the robot is told to do.

use jointplay::gpr::Gpr;
use jointplay::spatial::Tilt;
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::{Rods, angle, length, pitch};
use crate::body;
use crate::problem::Problem;
use crate::strict;

/// What the robot is told to do.
#[derive(ToSchema)]
#[serde(untagged)]
pub(crate) enum Command {
    /// A tilt by azimuth and lean, at a height.
    Tilt(TiltCommand),
    /// A tilt by its turns about x and about y, at a height.
    TiltXy(TiltXyCommand),
    /// Three rod lengths.
    Rods(RodsCommand),
}

// Kept as it stands in the body: read by its kind, so that errors name the field within.
/// What the robot is told to do.
#[derive(Deserialize, ToSchema)]
#[schema(value_type = Command)]
pub(crate) struct CommandFields(Value);

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TiltKind {
    Tilt,
}

/// A tilt by azimuth and lean.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltCommand {
    /// Which command it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: TiltKind,
    /// Azimuth toward which the platform leans, from x toward y [rad].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) yaw_rad: f64,
    /// How far it leans [rad].
    #[schema(exclusive_minimum = -1.5707963267948966, exclusive_maximum = 1.5707963267948966)]
    pub(crate) pitch_rad: f64,
    /// Height of the platform; without it, the robot's working height.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) height: Option<Height>,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TiltXyKind {
    TiltXy,
}

/// A tilt as one rotation vector in the base plane, as machine controllers speak of it.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TiltXyCommand {
    /// Which command it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: TiltXyKind,
    /// Turn about x [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Turn about y [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
    /// Height of the platform; without it, the robot's working height.
    #[serde(default, deserialize_with = "strict::maybe")]
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
    /// Which command it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: RodsKind,
    /// q_1, q_2, q_3 [m].
    pub(crate) rods_m: Rods,
}

/// A height, and what it is of.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Height {
    /// What the height is of.
    pub(crate) kind: HeightKind,
    /// The height [m].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) value_m: f64,
}

/// What a height is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HeightKind {
    /// Where the platform plane crosses the base axis.
    Axis,
    /// The platform's own centre.
    Center,
}

/// A command with its values checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// A tilt at a height.
    Tilt { tilt: Tilt, height: Height },
    /// Rod lengths [m].
    Rods([f64; 3]),
}

impl CommandFields {
    /// The command that stands at `field`, with heights that are left out filled in.
    pub(crate) fn read(self, gpr: &Gpr, field: &str) -> Result<Target, Problem> {
        let Self(value) = self;
        let at = |name: &str| format!("{field}.{name}");
        let command = match body::kind(&value, field, &["tilt", "tilt_xy", "rods"])? {
            "tilt" => Command::Tilt(body::read(value, field)?),
            "tilt_xy" => Command::TiltXy(body::read(value, field)?),
            _ => Command::Rods(body::read(value, field)?),
        };
        match command {
            Command::Tilt(found) => {
                let yaw = angle(found.yaw_rad, &at("yaw_rad"))?;
                let tilt = Tilt { yaw, pitch: pitch(found.pitch_rad, &at("pitch_rad"))? };
                Ok(Target::Tilt { tilt, height: height(found.height, gpr, field)? })
            }
            Command::TiltXy(found) => {
                let about_x = pitch(found.about_x_rad, &at("about_x_rad"))?;
                let about_y = pitch(found.about_y_rad, &at("about_y_rad"))?;
                let tilt = Tilt::from_about_x_and_y(about_x, about_y);
                pitch(tilt.pitch, field)?;
                Ok(Target::Tilt { tilt, height: height(found.height, gpr, field)? })
            }
            Command::Rods(found) => rods(found.rods_m.0, &at("rods_m")).map(Target::Rods),
        }
    }
}

/// The height asked for; without one, the robot's working height.
pub(crate) fn height(asked: Option<Height>, gpr: &Gpr, field: &str) -> Result<Height, Problem> {
    let usual = Height { kind: HeightKind::Axis, value_m: gpr.working_height() };
    let height = asked.unwrap_or(usual);
    length(height.value_m, &format!("{field}.height.value_m"))?;
    Ok(height)
}

/// Three rod lengths within reason [m].
pub(crate) fn rods(rods: [f64; 3], field: &str) -> Result<[f64; 3], Problem> {
    for (k, &rod) in rods.iter().enumerate() {
        length(rod, &format!("{field}[{k}]"))?;
    }
    Ok(rods)
}
