//! Documents of the state of a jogged robot.

use jointplay::cell::jog::{SlotRelativePose, StopReason};
use jointplay::cell::robot::{
    self, Branch, BranchSelection, EffectorId, LimitViolation, WaferTarget,
};
use jointplay::cell::station::SlotId;
use jointplay::cell::wafer::{DroopError, Unreachable};
use jointplay::cell::workcell::Cell;
use jointplay::format::cell::explain::{explain_branch, explain_droop, explain_stopped};
use jointplay::interop::export::Frame;
use jointplay::nalgebra::Vector3;
use jointplay::spatial::{Pose, Tilt, heading};
use serde::Serialize;
use utoipa::ToSchema;

use super::Triple;
use super::cell_pose::PoseCheckDocument;
use super::model::VirtualizationName;
use super::pose::ModelDocument;
use crate::display::display_units;

/// State of a jogged robot.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct JogDocument {
    /// All axes, rods first.
    pub(crate) axes: Vec<AxisDocument>,
    /// The platform.
    pub(crate) platform: PlatformDocument,
    /// All effectors.
    pub(crate) effectors: Vec<EffectorDocument>,
    /// The wafer of the jogged effector relative to the slot; `null` without a slot.
    #[schema(required = true)]
    pub(crate) from_slot: Option<FromSlotDocument>,
    /// Branches of the inverse kinematics for this pose of the wafer.
    pub(crate) branches: Vec<BranchDocument>,
    /// Why the robot did not reach its target; `null` if it did.
    #[schema(required = true)]
    pub(crate) stopped: Option<StoppedDocument>,
    /// The play of the platform.
    pub(crate) play: PlatformPlayDocument,
    /// Poses of all moving frames, with the names and parents of the 3D scene.
    pub(crate) frames: Vec<FrameDocument>,
    /// Minimum distances and violations of this pose, by the rules of program checks.
    pub(crate) check: PoseCheckDocument,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AxisDocument {
    /// Name.
    pub(crate) name: String,
    /// Type.
    pub(crate) kind: AxisKind,
    /// Position (m or rad).
    pub(crate) position: f64,
    /// Lower limit (m or rad).
    pub(crate) min: f64,
    /// Upper limit (m or rad).
    pub(crate) max: f64,
    /// Home position (m or rad).
    pub(crate) home: f64,
}

/// Type of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum AxisKind {
    /// Its positions are angles.
    Revolute,
    /// Its positions are lengths.
    Prismatic,
}

/// The platform.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlatformDocument {
    /// Height at which its plane crosses the base axis (m).
    pub(crate) height_m: f64,
    /// Tilt about x (rad).
    pub(crate) about_x_rad: f64,
    /// Tilt about y (rad).
    pub(crate) about_y_rad: f64,
    /// Tilt angle (rad).
    pub(crate) tilt_rad: f64,
    /// Tilt limit (rad).
    pub(crate) tilt_max_rad: f64,
}

/// The play of the platform: the displacement of its virtual joints under all virtualizations.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlatformPlayDocument {
    /// The virtualization of the cell's robot.
    pub(crate) virtualization: VirtualizationName,
    /// Largest displacement of the virtual joints that the cell allows (m).
    pub(crate) budget_m: f64,
    /// The platform under each virtualization, with the solver and metric of the cell's robot.
    pub(crate) models: Vec<ModelDocument>,
}

/// An effector with its wafer frame, including the droop of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct EffectorDocument {
    /// Name.
    pub(crate) name: String,
    /// Whether it holds a wafer.
    pub(crate) loaded: bool,
    /// Whether the heading of the wafer is free.
    pub(crate) heading_free: bool,
    /// Centre of the lower face of the wafer (m).
    pub(crate) center_m: Triple,
    /// Tilt of the wafer about x (rad).
    pub(crate) about_x_rad: f64,
    /// Tilt of the wafer about y (rad).
    pub(crate) about_y_rad: f64,
    /// Heading of the wafer from x, before the tilt (rad).
    pub(crate) heading_rad: f64,
    /// Why the droop of the arm is unknown in this pose, so that the arm is assumed to be rigid; `null` if it is known.
    #[schema(required = true)]
    pub(crate) droop_unknown: Option<String>,
}

/// A wafer relative to a slot, and the station pose that it would teach.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct FromSlotDocument {
    /// Name of the station.
    pub(crate) station: String,
    /// Number of the slot.
    pub(crate) slot: usize,
    /// R: radial distance from the slot, about the rotation axis of the arm (m).
    pub(crate) radial_m: f64,
    /// T: angle about the rotation axis of the arm, from the slot (rad).
    pub(crate) turn_rad: f64,
    /// Z: height above the support plane of the slot (m).
    pub(crate) height_m: f64,
    /// Heading relative to the inward direction of the slot (rad).
    pub(crate) heading_rad: f64,
    /// Pose of the station for which the wafer would rest in the slot.
    pub(crate) station_if_here: StationPose,
}

/// Pose of a station, in the terms of a cell file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StationPose {
    /// Centre of the lowest wafer, for the current tilt of the station (m).
    pub(crate) point_m: Triple,
    /// Centre of the lowest wafer, for the tilt of the wafer (m).
    pub(crate) position_m: Triple,
    /// Heading (rad).
    pub(crate) heading_rad: f64,
    /// Azimuth of the tilt (rad).
    pub(crate) tilt_azimuth_rad: f64,
    /// Tilt angle (rad).
    pub(crate) tilt_angle_rad: f64,
}

/// A branch of the inverse kinematics.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BranchDocument {
    /// Name of the configuration.
    pub(crate) name: String,
    /// Whether the branch is selected, or the reason why not.
    pub(crate) selection: SelectionName,
    /// Description.
    pub(crate) description: String,
    /// Positions of all axes, rods first (m or rad).
    pub(crate) positions: Vec<f64>,
}

/// Selection of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SelectionName {
    /// The branch is selected.
    Chosen,
    /// It violates limits.
    BreaksLimits,
    /// It requires a motion through the stretched or folded arm.
    OtherElbow,
    /// Another branch is closer.
    NotNearest,
}

/// Why the robot stopped.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StoppedDocument {
    /// Kind of the reason.
    pub(crate) kind: StoppedKind,
    /// Names of the axes at their limits.
    pub(crate) axes: Vec<String>,
    /// Descriptions, one for each limit or branch.
    pub(crate) reasons: Vec<String>,
    /// Names of the two bodies that would touch; empty unless a contact is the reason.
    pub(crate) contact: Vec<String>,
}

/// Kind of the reason of a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StoppedKind {
    /// Limits of axes.
    AxisLimit,
    /// The tilt limit of the platform.
    TiltLimit,
    /// The target is out of reach of the arm.
    OutOfReach,
    /// The droop of the arm is unknown or cannot be compensated.
    Droop,
    /// The inverse kinematics has no solution.
    NoSolution,
    /// Two bodies would touch.
    Contact,
}

/// Pose of a moving frame.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct FrameDocument {
    /// Name.
    pub(crate) name: String,
    /// Origin in the parent frame (m).
    pub(crate) origin_m: Triple,
    /// Unit quaternion x, y, z, w in the parent frame.
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
                BranchSelection::OtherConfiguration => SelectionName::OtherElbow,
                BranchSelection::NotNearest => SelectionName::NotNearest,
            },
            description: explain_branch(&cell.robot, branch, display_units()),
            positions: branch.positions.to_vec(),
        }
    }
}

impl StoppedDocument {
    pub(crate) fn new(cell: &Cell, stopped: &StopReason) -> Self {
        let mut limits: Vec<&LimitViolation> = Vec::new();
        let other = match stopped {
            StopReason::Limits(broken) => {
                limits.extend(broken);
                None
            }
            StopReason::Unreachable(Unreachable::Limits(branches)) => {
                limits.extend(branches.iter().flat_map(|branch| &branch.violations));
                None
            }
            StopReason::Unreachable(Unreachable::Tilt { .. }) => Some(StoppedKind::TiltLimit),
            StopReason::Unreachable(Unreachable::OutOfReach(_)) => Some(StoppedKind::OutOfReach),
            StopReason::Unreachable(Unreachable::Droop(_) | Unreachable::NotConverged { .. }) => {
                Some(StoppedKind::Droop)
            }
            StopReason::Unreachable(_) => Some(StoppedKind::NoSolution),
            StopReason::Contact(_) => Some(StoppedKind::Contact),
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
        let contact = match stopped {
            StopReason::Contact(pair) => pair.map(|one| cell.entity_name(one)).to_vec(),
            _ => Vec::new(),
        };
        let reasons = explain_stopped(cell, stopped, display_units());
        Self { kind: other.unwrap_or(of_limits), axes, reasons, contact }
    }
}

/// All axes at given positions.
pub(crate) fn axes(cell: &Cell, positions: &[f64]) -> Vec<AxisDocument> {
    let of = |(axis, &position): (&jointplay::cell::robot::Axis, &f64)| AxisDocument {
        name: axis.name.clone(),
        kind: match axis.kind {
            robot::AxisKind::Rotary => AxisKind::Revolute,
            robot::AxisKind::Linear => AxisKind::Prismatic,
        },
        position,
        min: axis.min,
        max: axis.max,
        home: axis.home,
    };
    cell.robot.axes.iter().zip(positions).map(of).collect()
}

/// The platform at given rod lengths.
pub(crate) fn platform(cell: &Cell, positions: &[f64]) -> PlatformDocument {
    let gpr = &cell.robot.gpr;
    let rods = [positions[0], positions[1], positions[2]];
    let tilt = gpr.plane_tilt(&rods);
    let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
    PlatformDocument {
        height_m: gpr.plane_height(&rods).0,
        about_x_rad,
        about_y_rad,
        tilt_rad: tilt.angle,
        tilt_max_rad: gpr.limits().tilt_max,
    }
}

/// An effector with its wafer frame.
pub(crate) fn effector(
    cell: &Cell,
    id: EffectorId,
    (pose, unknown): &(Pose, Option<DroopError>),
    loaded: bool,
    heading_free: bool,
) -> EffectorDocument {
    let target = WaferTarget::from_pose(pose);
    let (about_x_rad, about_y_rad) = Tilt::from_normal(&target.normal).about_x_and_y();
    EffectorDocument {
        name: cell.robot.arms[id.arm].effectors[id.effector].name.clone(),
        loaded,
        heading_free,
        center_m: Triple(target.center.into()),
        about_x_rad,
        about_y_rad,
        heading_rad: target.heading.unwrap_or_default(),
        droop_unknown: unknown.as_ref().map(|error| explain_droop(error, display_units())),
    }
}

/// A wafer relative to a slot.
pub(crate) fn from_slot(
    cell: &Cell,
    slot: SlotId,
    seen: &SlotRelativePose,
    pose: &Pose,
) -> FromSlotDocument {
    let station = &cell.stations[slot.station];
    let taught = station.taught_by(slot.slot, pose);
    let tilt = Tilt::from_normal(&(pose.rotation * Vector3::z()));
    let origin = station.origin_under(slot.slot, &pose.translation.vector);
    FromSlotDocument {
        station: station.name.clone(),
        slot: slot.slot,
        radial_m: seen.radial,
        turn_rad: seen.turn,
        height_m: seen.height,
        heading_rad: seen.heading,
        station_if_here: StationPose {
            point_m: Triple(origin.into()),
            position_m: Triple(taught.translation.vector.into()),
            heading_rad: heading(&taught),
            tilt_azimuth_rad: tilt.azimuth,
            tilt_angle_rad: tilt.angle,
        },
    }
}
