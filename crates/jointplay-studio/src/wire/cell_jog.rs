//! A robot with arms that is moved by hand.

use jointplay::cell::jog::SlotRelativePose;
use jointplay::cell::robot::WaferTarget;
use jointplay::cell::workcell::Cell;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::Tilt;
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::{Triple, angle, length, pitch};
use crate::body;
use crate::problem::Problem;
use crate::strict;

/// The robot of a cell moved by hand, from where it is.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JogRequest {
    /// Key of a plan that the server remembers, in place of both texts.
    #[serde(default)]
    pub(crate) plan: Option<String>,
    /// Text of a cell file; without it, that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of a program; without it, that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// The moment of the program from which the robot is moved: who carries a wafer then, carries it along [s].
    #[serde(default)]
    #[schema(required = false, default = 0.0)]
    pub(crate) time_s: f64,
    /// Positions of all axes that it is at, rods first [m or rad]; without them, those of the moment.
    #[serde(default)]
    #[schema(value_type = Option<Vec<f64>>, max_items = 11)]
    pub(crate) from: Option<Vec<f64>>,
    /// Which effector's wafer is moved; without it, the first.
    #[serde(default)]
    pub(crate) effector: Option<String>,
    /// From which slot it is seen.
    #[serde(default, deserialize_with = "strict::maybe")]
    pub(crate) seen_from: Option<SlotFields>,
    /// Where to; without it, the robot stays.
    #[serde(default)]
    pub(crate) to: Option<JogFields>,
    /// Whether all axes go straight from `from` toward the positions found, and stop at the last state without a contact.
    ///
    /// What touches at the start does not stop them.
    #[serde(default)]
    pub(crate) stop_at_contact: bool,
}

/// A slot of a station.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SlotFields {
    /// Name of the station.
    pub(crate) station: String,
    /// Number of the slot, from 1.
    #[schema(minimum = 1)]
    pub(crate) slot: usize,
}

// Kept as it stands in the body: read by its kind, so that errors name the field within.
/// Where the robot is moved to.
#[derive(Deserialize, ToSchema)]
#[schema(value_type = Jog)]
pub(crate) struct JogFields(Value);

/// Where the robot is moved to.
#[derive(ToSchema)]
#[serde(untagged)]
pub(crate) enum Jog {
    /// All axes.
    Axes(AxesJog),
    /// The platform; the arms stay as they are.
    Platform(PlatformJog),
    /// A wafer in the base frame.
    World(WorldJog),
    /// A wafer as seen from the slot.
    Slot(SlotJog),
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum AxesKind {
    Axes,
}

/// All axes: each motor up to its stops, the rods up to their limits and that of the tilt.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AxesJog {
    /// Which it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: AxesKind,
    /// Positions of all axes, rods first [m or rad].
    #[schema(max_items = 11)]
    pub(crate) positions: Vec<f64>,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum PlatformKind {
    Platform,
}

/// The platform, its arms staying as they are.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlatformJog {
    /// Which it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: PlatformKind,
    /// Where its plane crosses the base axis [m].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) height_m: f64,
    /// Turn about x [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Turn about y [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum WorldKind {
    World,
}

/// A wafer in the base frame.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WorldJog {
    /// Which it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: WorldKind,
    /// Its centre, on the plane that it rests on [m].
    pub(crate) center_m: Triple,
    /// Turn of its plane about x [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Turn of its plane about y [rad].
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
    /// Where it heads, from x before it leans [rad]; of meaning where the arm may choose.
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) heading_rad: f64,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum SlotKind {
    Slot,
}

/// A wafer as seen from the slot, in the slot's plane.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SlotJog {
    /// Which it is.
    #[expect(dead_code, reason = "known before it is read")]
    kind: SlotKind,
    /// R: how much farther from the axis that the arm turns about than the slot; negative before it [m].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) radial_m: f64,
    /// T: angle about that axis from the slot [rad].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) turn_rad: f64,
    /// Z: height over the plane that wafers rest on in the slot [m].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) height_m: f64,
    /// Where it heads, from the slot's inward direction [rad]; of meaning where the arm may choose.
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) yaw_rad: f64,
}

/// Where to, with its values checked.
pub(crate) enum JogTarget {
    Axes(Vec<f64>),
    Platform { tilt: Tilt, height: f64 },
    World(WaferTarget),
    Slot(SlotRelativePose),
}

impl JogFields {
    pub(crate) fn read(self, cell: &Cell) -> Result<JogTarget, Problem> {
        let Self(value) = self;
        let kinds = ["axes", "platform", "world", "slot"];
        let jog = match body::kind(&value, "to", &kinds)? {
            "axes" => Jog::Axes(body::read(value, "to")?),
            "platform" => Jog::Platform(body::read(value, "to")?),
            "world" => Jog::World(body::read(value, "to")?),
            _ => Jog::Slot(body::read(value, "to")?),
        };
        match jog {
            Jog::Axes(found) => {
                positions(cell, found.positions, "to.positions").map(JogTarget::Axes)
            }
            Jog::Platform(found) => Ok(JogTarget::Platform {
                tilt: lean(found.about_x_rad, found.about_y_rad)?,
                height: length(found.height_m, "to.height_m")?,
            }),
            Jog::World(found) => {
                for (k, &value) in found.center_m.0.iter().enumerate() {
                    length(value, &format!("to.center_m[{k}]"))?;
                }
                Ok(JogTarget::World(WaferTarget {
                    center: Vector3::from(found.center_m.0),
                    normal: lean(found.about_x_rad, found.about_y_rad)?.normal(),
                    heading: Some(angle(found.heading_rad, "to.heading_rad")?),
                }))
            }
            Jog::Slot(found) => Ok(JogTarget::Slot(SlotRelativePose {
                radial: length(found.radial_m, "to.radial_m")?,
                turn: angle(found.turn_rad, "to.turn_rad")?,
                height: length(found.height_m, "to.height_m")?,
                yaw: angle(found.yaw_rad, "to.yaw_rad")?,
            })),
        }
    }
}

fn lean(about_x: f64, about_y: f64) -> Result<Tilt, Problem> {
    let tilt = Tilt::from_about_x_and_y(
        pitch(about_x, "to.about_x_rad")?,
        pitch(about_y, "to.about_y_rad")?,
    );
    pitch(tilt.pitch, "to")?;
    Ok(tilt)
}

/// Positions of all axes of a cell.
pub(crate) fn positions(cell: &Cell, given: Vec<f64>, field: &str) -> Result<Vec<f64>, Problem> {
    let (found, needed) = (given.len(), cell.robot.axes.len());
    if found != needed {
        let names: Vec<&str> = cell.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        let detail =
            format!("there are {found} positions, for {needed} axes: {}", names.join(", "));
        return Err(Problem::field(field, detail));
    }
    for (k, &value) in given.iter().enumerate() {
        length(value, &format!("{field}[{k}]"))?;
    }
    Ok(given)
}
