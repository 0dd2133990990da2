//! Documents of requests to jog a robot with arms.

use jointplay::cell::jog::SlotRelativePose;
use jointplay::cell::robot::WaferTarget;
use jointplay::cell::workcell::Cell;
use jointplay::format::json;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::Tilt;
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::{Triple, angle, length, tilt_angle};
use crate::problem::Problem;

/// A jog of the robot of a cell.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JogRequest {
    /// Key of a kept plan, in place of both texts.
    #[serde(default)]
    pub(crate) plan: Option<String>,
    /// Text of the cell; default: that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of the program; default: that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Time of the program from which the robot is jogged; it determines which effectors are loaded (s).
    #[serde(default)]
    #[schema(required = false, default = 0.0)]
    pub(crate) time_s: f64,
    /// Start positions of all axes, rods first (m or rad); default: those at `time_s`.
    #[serde(default)]
    #[schema(value_type = Option<Vec<f64>>, max_items = 11)]
    pub(crate) from: Option<Vec<f64>>,
    /// Effector whose wafer is moved; default: the first one.
    #[serde(default)]
    pub(crate) effector: Option<String>,
    /// Slot of the relative coordinates.
    pub(crate) seen_from: Option<SlotFields>,
    /// Target; default: the start positions.
    #[serde(default)]
    pub(crate) to: Option<JogFields>,
    /// Whether all axes move in a straight line from `from` to the target positions and stop at the last state without contact.
    ///
    /// Contacts at the start do not stop them.
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

// Read by its kind, so that errors name the inner field.
/// Target of a jog.
#[derive(Deserialize, ToSchema)]
#[schema(value_type = Jog)]
pub(crate) struct JogFields(Value);

/// Target of a jog.
#[derive(ToSchema)]
#[serde(untagged)]
pub(crate) enum Jog {
    /// All axes.
    Axes(AxesJog),
    /// The platform; the positions of the arms do not change.
    Platform(PlatformJog),
    /// A wafer in the base frame.
    World(WorldJog),
    /// A wafer relative to the slot.
    Slot(SlotJog),
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum AxesKind {
    Axes,
}

/// All axes: motors up to their limits, rods up to their limits and the tilt limit.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AxesJog {
    /// Kind of the target.
    #[expect(dead_code, reason = "read before the other fields")]
    kind: AxesKind,
    /// Positions of all axes, rods first (m or rad).
    #[schema(max_items = 11)]
    pub(crate) positions: Vec<f64>,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum PlatformKind {
    Platform,
}

/// The platform; the positions of the arms do not change.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlatformJog {
    /// Kind of the target.
    #[expect(dead_code, reason = "read before the other fields")]
    kind: PlatformKind,
    /// Height at which its plane crosses the base axis (m).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) height_m: f64,
    /// Tilt about x (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Tilt about y (rad).
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
    /// Kind of the target.
    #[expect(dead_code, reason = "read before the other fields")]
    kind: WorldKind,
    /// Centre of its lower face (m).
    pub(crate) center_m: Triple,
    /// Tilt about x (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_x_rad: f64,
    /// Tilt about y (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    pub(crate) about_y_rad: f64,
    /// Heading from x, before the tilt (rad); ignored if the arm determines it.
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) heading_rad: f64,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum SlotKind {
    Slot,
}

/// A wafer relative to the slot, in the plane of the slot.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SlotJog {
    /// Kind of the target.
    #[expect(dead_code, reason = "read before the other fields")]
    kind: SlotKind,
    /// R: radial distance from the slot, about the rotation axis of the arm; negative toward the axis (m).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) radial_m: f64,
    /// T: angle about the rotation axis of the arm, from the slot (rad).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) turn_rad: f64,
    /// Z: height above the support plane of the slot (m).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) height_m: f64,
    /// Heading relative to the inward direction of the slot (rad); ignored if the arm determines it.
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) heading_rad: f64,
}

/// Target of a jog, checked.
pub(crate) enum JogTarget {
    Axes(Vec<f64>),
    Platform { tilt: Tilt, height: f64 },
    World(WaferTarget),
    Slot(SlotRelativePose),
}

impl JogFields {
    pub(crate) fn read(self, cell: &Cell) -> Result<JogTarget, Problem> {
        let Self(value) = self;
        let kinds = &["axes", "platform", "world", "slot"];
        let jog = match json::kind(&value, "to", kinds)? {
            "axes" => Jog::Axes(json::read_value(value, "to")?),
            "platform" => Jog::Platform(json::read_value(value, "to")?),
            "world" => Jog::World(json::read_value(value, "to")?),
            _ => Jog::Slot(json::read_value(value, "to")?),
        };
        match jog {
            Jog::Axes(found) => {
                positions(cell, found.positions, "to.positions").map(JogTarget::Axes)
            }
            Jog::Platform(found) => Ok(JogTarget::Platform {
                tilt: tilt(found.about_x_rad, found.about_y_rad)?,
                height: length(found.height_m, "to.height_m")?,
            }),
            Jog::World(found) => {
                for (k, &value) in found.center_m.0.iter().enumerate() {
                    length(value, &format!("to.center_m[{k}]"))?;
                }
                Ok(JogTarget::World(WaferTarget {
                    center: Vector3::from(found.center_m.0),
                    normal: tilt(found.about_x_rad, found.about_y_rad)?.normal(),
                    heading: Some(angle(found.heading_rad, "to.heading_rad")?),
                }))
            }
            Jog::Slot(found) => Ok(JogTarget::Slot(SlotRelativePose {
                radial: length(found.radial_m, "to.radial_m")?,
                turn: angle(found.turn_rad, "to.turn_rad")?,
                height: length(found.height_m, "to.height_m")?,
                heading: angle(found.heading_rad, "to.heading_rad")?,
            })),
        }
    }
}

fn tilt(about_x: f64, about_y: f64) -> Result<Tilt, Problem> {
    let tilt = Tilt::from_about_x_and_y(
        tilt_angle(about_x, "to.about_x_rad")?,
        tilt_angle(about_y, "to.about_y_rad")?,
    );
    tilt_angle(tilt.angle, "to")?;
    Ok(tilt)
}

/// Checks the positions of all axes of a robot.
pub(crate) fn positions(cell: &Cell, given: Vec<f64>, field: &str) -> Result<Vec<f64>, Problem> {
    let (found, needed) = (given.len(), cell.robot.axes.len());
    if found != needed {
        let names: Vec<&str> = cell.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        let detail = format!("got {found} positions for {needed} axes: {}", names.join(", "));
        return Err(Problem::field(field, detail));
    }
    for (k, &value) in given.iter().enumerate() {
        length(value, &format!("{field}[{k}]"))?;
    }
    Ok(given)
}
