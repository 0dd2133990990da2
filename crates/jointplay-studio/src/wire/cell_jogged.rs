//! Where a robot with arms has come to that was moved by hand.

use jointplay::cell::jog::{SlotRelativePose, Stopped};
use jointplay::cell::robot::{
    self, Branch, BranchSelection, EffectorId, LimitViolation, WaferTarget,
};
use jointplay::cell::station::{SlotId, teach};
use jointplay::cell::wafer::{DroopError, Unreachable};
use jointplay::cell::workcell::Cell;
use jointplay::format::cell::explain::{explain_branch, explain_stopped};
use jointplay::interop::export::Frame;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::{Pose, Tilt};
use serde::Serialize;
use utoipa::ToSchema;

use super::Triple;
use super::cell_pose::PoseCheckDocument;

/// The robot where it has come to.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct JogDocument {
    /// All axes, rods first.
    pub(crate) axes: Vec<AxisDocument>,
    /// The platform.
    pub(crate) platform: PlatformDocument,
    /// All effectors.
    pub(crate) effectors: Vec<EffectorDocument>,
    /// The effector that is moved as seen from the slot; `null` where no slot is named.
    #[schema(required = true)]
    pub(crate) from_slot: Option<FromSlotDocument>,
    /// How else the arm could be bent to hold the wafer where it is.
    pub(crate) branches: Vec<BranchDocument>,
    /// Why the robot is not where it was told to go; `null` where it is.
    #[schema(required = true)]
    pub(crate) stopped: Option<StoppedDocument>,
    /// Where all that moves is, named and nested as in the picture of the cell.
    pub(crate) frames: Vec<FrameDocument>,
    /// Minimum distances and violations of this pose, by the rules of the check of programs.
    pub(crate) check: PoseCheckDocument,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AxisDocument {
    /// What it is called.
    pub(crate) name: String,
    /// Whether it turns or slides.
    pub(crate) kind: AxisKind,
    /// Where it is [m or rad].
    pub(crate) position: f64,
    /// Its least position [m or rad].
    pub(crate) min: f64,
    /// Its largest position [m or rad].
    pub(crate) max: f64,
    /// Where HOME puts it [m or rad].
    pub(crate) home: f64,
}

/// What an axis does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum AxisKind {
    /// It turns: its positions are angles.
    Turn,
    /// It slides: its positions are lengths.
    Slide,
}

/// The platform.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlatformDocument {
    /// Where its plane crosses the base axis [m].
    pub(crate) height_m: f64,
    /// Its turn about x [rad].
    pub(crate) about_x_rad: f64,
    /// Its turn about y [rad].
    pub(crate) about_y_rad: f64,
    /// How far it leans [rad].
    pub(crate) lean_rad: f64,
    /// How far it may lean [rad].
    pub(crate) lean_max_rad: f64,
}

/// An effector, with its wafer's frame; arms droop, and it with them.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct EffectorDocument {
    /// What it is called.
    pub(crate) name: String,
    /// Whether it carries a wafer.
    pub(crate) loaded: bool,
    /// Whether the arm may choose where the wafer heads.
    pub(crate) heading_free: bool,
    /// Centre of the wafer, on the plane that it rests on [m].
    pub(crate) center_m: Triple,
    /// Turn of the wafer's plane about x [rad].
    pub(crate) about_x_rad: f64,
    /// Turn of the wafer's plane about y [rad].
    pub(crate) about_y_rad: f64,
    /// Where the wafer heads, from x before it leans [rad].
    pub(crate) heading_rad: f64,
    /// Why nothing is known of how its arm droops here, so that it is told as if the arm were rigid; `null` where it is known.
    #[schema(required = true)]
    pub(crate) droop_unknown: Option<String>,
}

/// A wafer as seen from a slot, and what it would teach.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct FromSlotDocument {
    /// Name of the station.
    pub(crate) station: String,
    /// Number of the slot.
    pub(crate) slot: usize,
    /// R: how much farther from the axis that the arm turns about than the slot [m].
    pub(crate) radial_m: f64,
    /// T: angle about that axis from the slot [rad].
    pub(crate) turn_rad: f64,
    /// Z: height over the plane that wafers rest on in the slot [m].
    pub(crate) height_m: f64,
    /// Where it heads, from the slot's inward direction [rad].
    pub(crate) yaw_rad: f64,
    /// Where the station would stand if the wafer lay in the slot.
    pub(crate) station_if_here: StationPose,
}

/// Where a station stands, as its file says it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StationPose {
    /// Where the centre of the lowest wafer would rest, the station leaning as it does [m].
    pub(crate) point_m: Triple,
    /// The same, the station leaning as the wafer does [m].
    pub(crate) position_m: Triple,
    /// Its turn about the vertical [rad].
    pub(crate) yaw_rad: f64,
    /// Azimuth toward which it leans [rad].
    pub(crate) tilt_yaw_rad: f64,
    /// How far it leans [rad].
    pub(crate) tilt_pitch_rad: f64,
}

/// A way to hold the wafer where it is.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BranchDocument {
    /// How the arm is bent.
    pub(crate) name: String,
    /// Whether the robot is in it, and why not.
    pub(crate) selection: SelectionName,
    /// The same in words and numbers.
    pub(crate) says: String,
    /// Positions of all axes, rods first [m or rad].
    pub(crate) positions: Vec<f64>,
}

/// Why a way is taken, or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SelectionName {
    /// The robot is in it.
    Chosen,
    /// It breaks limits.
    BreaksLimits,
    /// The arm would have to pass its stretched or folded position.
    OtherElbow,
    /// Another one is nearer.
    NotNearest,
}

/// What stopped the robot.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StoppedDocument {
    /// What sort of thing.
    pub(crate) kind: StoppedKind,
    /// Axes at whose limits it stopped.
    pub(crate) axes: Vec<String>,
    /// What stopped it: one line for each limit, or for each way that the arm could be bent.
    pub(crate) says: Vec<String>,
    /// Names of the two that would touch farther on; none where it is no contact that stopped it.
    pub(crate) touching: Vec<String>,
}

/// What sort of thing stopped the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StoppedKind {
    /// Limits of axes.
    AxisLimit,
    /// The platform would have to lean too far.
    TiltLimit,
    /// The links are too short, or cannot fold that far.
    OutOfReach,
    /// Nothing is known of how the arm droops there, or it cannot be made up for.
    Droop,
    /// No positions were found.
    NoWay,
    /// Two bodies would touch.
    Contact,
}

/// A frame that moves.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct FrameDocument {
    /// What it is called.
    pub(crate) name: String,
    /// Its origin in the frame that it moves with [m].
    pub(crate) origin_m: Triple,
    /// Its unit quaternion x, y, z, w in that frame.
    #[schema(min_items = 4, max_items = 4)]
    pub(crate) quaternion: Vec<f64>,
}

impl From<Frame> for FrameDocument {
    fn from(frame: Frame) -> Self {
        Self { name: frame.name, origin_m: Triple(frame.place), quaternion: frame.turn.to_vec() }
    }
}

impl BranchDocument {
    pub(crate) fn new(cell: &Cell, branch: &Branch) -> Self {
        Self {
            name: branch.configuration.to_string(),
            selection: match branch.selection {
                BranchSelection::Chosen => SelectionName::Chosen,
                BranchSelection::BreaksLimits => SelectionName::BreaksLimits,
                BranchSelection::OtherElbow => SelectionName::OtherElbow,
                BranchSelection::NotNearest => SelectionName::NotNearest,
            },
            says: explain_branch(&cell.robot, branch),
            positions: branch.positions.to_vec(),
        }
    }
}

impl StoppedDocument {
    pub(crate) fn new(cell: &Cell, stopped: &Stopped) -> Self {
        let mut limits: Vec<&LimitViolation> = Vec::new();
        let other = match stopped {
            Stopped::Limits(broken) => {
                limits.extend(broken);
                None
            }
            Stopped::Place(Unreachable::Limits(ways)) => {
                limits.extend(ways.iter().flat_map(|way| &way.violations));
                None
            }
            Stopped::Place(Unreachable::Tilt { .. }) => Some(StoppedKind::TiltLimit),
            Stopped::Place(Unreachable::OutOfReach(_)) => Some(StoppedKind::OutOfReach),
            Stopped::Place(Unreachable::Droop(_) | Unreachable::NotConverged { .. }) => {
                Some(StoppedKind::Droop)
            }
            Stopped::Place(_) => Some(StoppedKind::NoWay),
            Stopped::Contact(_) => Some(StoppedKind::Contact),
        };
        let mut axes: Vec<String> = Vec::new();
        for limit in &limits {
            if let LimitViolation::Axis { axis, .. } = **limit {
                let name = &cell.robot.axes[axis].name;
                if !axes.contains(name) {
                    axes.push(name.clone());
                }
            }
        }
        let of_limits =
            if axes.is_empty() { StoppedKind::TiltLimit } else { StoppedKind::AxisLimit };
        let touching = match stopped {
            Stopped::Contact(pair) => pair.map(|one| cell.entity_name(one)).to_vec(),
            _ => Vec::new(),
        };
        let says = explain_stopped(cell, stopped);
        Self { kind: other.unwrap_or(of_limits), axes, says, touching }
    }
}

/// All axes where they are.
pub(crate) fn axes(cell: &Cell, positions: &[f64]) -> Vec<AxisDocument> {
    let of = |(axis, &position): (&jointplay::cell::robot::Axis, &f64)| AxisDocument {
        name: axis.name.clone(),
        kind: match axis.kind {
            robot::AxisKind::Rotary => AxisKind::Turn,
            robot::AxisKind::Linear => AxisKind::Slide,
        },
        position,
        min: axis.min,
        max: axis.max,
        home: axis.home,
    };
    cell.robot.axes.iter().zip(positions).map(of).collect()
}

/// The platform over rods.
pub(crate) fn platform(cell: &Cell, positions: &[f64]) -> PlatformDocument {
    let gpr = &cell.robot.gpr;
    let rods = [positions[0], positions[1], positions[2]];
    let tilt = gpr.plane_tilt(&rods);
    let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
    PlatformDocument {
        height_m: gpr.plane_height(&rods).0,
        about_x_rad,
        about_y_rad,
        lean_rad: tilt.pitch,
        lean_max_rad: gpr.limits().tilt_max,
    }
}

/// An effector with its wafer's frame.
pub(crate) fn effector(
    cell: &Cell,
    id: EffectorId,
    (pose, unknown): &(Pose, Option<DroopError>),
    loaded: bool,
    heading_free: bool,
) -> EffectorDocument {
    let target = WaferTarget::of(pose);
    let (about_x_rad, about_y_rad) = Tilt::from_normal(&target.normal).about_x_and_y();
    EffectorDocument {
        name: cell.robot.arms[id.arm].effectors[id.effector].name.clone(),
        loaded,
        heading_free,
        center_m: Triple(target.center.into()),
        about_x_rad,
        about_y_rad,
        heading_rad: target.heading.unwrap_or_default(),
        droop_unknown: unknown.map(|why| why.to_string()),
    }
}

/// A wafer as seen from a slot.
pub(crate) fn from_slot(
    cell: &Cell,
    slot: SlotId,
    seen: &SlotRelativePose,
    pose: &Pose,
) -> FromSlotDocument {
    let station = &cell.stations[slot.station];
    let taught = station.taught_by(slot.slot, pose);
    let lean = Tilt::from_normal(&(pose.rotation * Vector3::z()));
    let origin = station.origin_under(slot.slot, &pose.translation.vector);
    FromSlotDocument {
        station: station.name.clone(),
        slot: slot.slot,
        radial_m: seen.radial,
        turn_rad: seen.turn,
        height_m: seen.height,
        yaw_rad: seen.yaw,
        station_if_here: StationPose {
            point_m: Triple(origin.into()),
            position_m: Triple(taught.translation.vector.into()),
            yaw_rad: teach::yaw(&taught),
            tilt_yaw_rad: lean.yaw,
            tilt_pitch_rad: lean.pitch,
        },
    }
}
