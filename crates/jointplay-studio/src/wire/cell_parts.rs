//! Documents of the parts of a cell: robot, stations, wafers, bodies, zones.

use jointplay::cell::EntityId;
use jointplay::cell::geometry::Shape;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::station::{Origin, Station};
use jointplay::cell::workcell::{Body, Cell, ParentFrame, Zone, ZoneRule};
use jointplay::format::cell::ArmEdits;
use jointplay::interop::export::wafers_at_start;
use jointplay::nalgebra::Vector3;
use jointplay::report::{self, StationReport};
use jointplay::spatial::{Pose, Tilt, heading};
use serde::Serialize;
use utoipa::ToSchema;

use super::Triple;
use super::cell_chain::HeldDocument;
use super::cell_jogged::{AxisDocument, axes};
use super::robot::{VirtualizationDocument, virtualizations};

/// The parts of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RobotParts {
    /// Name.
    pub(crate) name: String,
    /// Tilt limit of the platform (rad).
    pub(crate) tilt_max_rad: f64,
    /// All axes at the home position, rods first.
    pub(crate) axes: Vec<AxisDocument>,
    /// Its arms.
    pub(crate) arms: Vec<ArmParts>,
    /// Reason why no arm can be added or duplicated in the text of the cell; `null` if one can.
    #[schema(required = true)]
    pub(crate) add_refusal: Option<String>,
    /// Reason why no arm can be removed; `null` if one can.
    #[schema(required = true)]
    pub(crate) remove_refusal: Option<String>,
    /// Available virtualizations of its platform.
    pub(crate) virtualizations: Vec<VirtualizationDocument>,
}

/// An arm.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ArmParts {
    /// Name.
    pub(crate) name: String,
    /// Frame names of its links.
    pub(crate) links: Vec<String>,
    /// Its effectors.
    pub(crate) effectors: Vec<String>,
    /// Reason why no effector can be added or duplicated in the text of the cell; `null` if one can.
    #[schema(required = true)]
    pub(crate) add_refusal: Option<String>,
    /// Reason why no effector can be removed; `null` if one can.
    #[schema(required = true)]
    pub(crate) remove_refusal: Option<String>,
}

/// A station with its degrees of freedom for dragging.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StationDocument {
    #[serde(flatten)]
    pub(crate) report: StationReport,
    /// Number of slots.
    pub(crate) slots: usize,
    /// Names of the effectors that may use it.
    pub(crate) effectors: Vec<String>,
    /// Heading (rad).
    pub(crate) heading_rad: f64,
    /// Tilt: component about x (rad).
    pub(crate) about_x_rad: f64,
    /// Tilt: component about y (rad).
    pub(crate) about_y_rad: f64,
    /// Taught points of its plane (m).
    pub(crate) taught_m: Vec<Triple>,
    /// Its degrees of freedom, without those that taught points determine.
    pub(crate) freedoms: Vec<FreedomName>,
}

/// A degree of freedom of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FreedomName {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Height,
    /// Heading.
    Heading,
    /// Tilt about x.
    AboutX,
    /// Tilt about y.
    AboutY,
}

/// A wafer.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct WaferDocument {
    /// Frame name.
    pub(crate) name: String,
    /// Location at the start of the program, in words.
    pub(crate) initial_location: String,
    /// Location at the start of the program.
    pub(crate) held: HeldDocument,
}

/// A zone.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ZoneDocument {
    /// Name.
    pub(crate) name: String,
    /// Its rule.
    pub(crate) rule: RuleName,
    /// Its shape.
    pub(crate) shape: ShapeDocument,
    /// Origin of the shape in the base frame (m).
    pub(crate) origin_m: Triple,
}

/// The rule of a zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RuleName {
    /// No part of the robot and no wafer enters the zone.
    KeepOut,
    /// Wafers stay inside the zone while the robot rotates.
    Safe,
}

/// A collision body.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BodyDocument {
    /// Name.
    pub(crate) name: String,
    /// Parent frame: `base`, `platform`, or the frame name of a link.
    pub(crate) attached_to: String,
    /// The station whose frame is the parent frame; `null` for other bodies.
    #[schema(required = true)]
    pub(crate) station: Option<String>,
    /// Its shape.
    pub(crate) shape: ShapeDocument,
    /// Origin of the shape in the parent frame (m).
    pub(crate) origin_m: Triple,
}

/// A shape.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum ShapeDocument {
    /// A box.
    Box {
        /// Half edge lengths (m).
        half_m: Triple,
    },
    /// A box with openings.
    Boxes {
        /// Number of boxes of which it is the union.
        boxes: usize,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius (m).
        radius_m: f64,
        /// Half height (m).
        half_height_m: f64,
    },
    /// A capsule: all points within a radius of a line segment.
    Capsule {
        /// Radius (m).
        radius_m: f64,
    },
    /// The convex hull of points.
    Convex {
        /// Number.
        points: usize,
    },
    /// A triangle mesh.
    Mesh {
        /// Number.
        triangles: usize,
    },
}

impl From<&Shape> for ShapeDocument {
    fn from(shape: &Shape) -> Self {
        match shape {
            Shape::Box { half } => Self::Box { half_m: Triple(*half) },
            Shape::Boxes { boxes } => Self::Boxes { boxes: boxes.len() },
            Shape::Cylinder { radius, half_height } => {
                Self::Cylinder { radius_m: *radius, half_height_m: *half_height }
            }
            Shape::Capsule { radius, .. } => Self::Capsule { radius_m: *radius },
            Shape::Convex { points } => Self::Convex { points: points.len() },
            Shape::Mesh { triangles, .. } => Self::Mesh { triangles: triangles.len() },
        }
    }
}

impl RobotParts {
    /// The robot of a cell and of its text.
    pub(crate) fn new(cell: &Cell, text: &str) -> Self {
        let robot = &cell.robot;
        let edits = ArmEdits::new(text, robot);
        let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
        let arms = robot.arms.iter().enumerate().map(|(k, arm)| ArmParts {
            name: arm.name.clone(),
            links: (0..arm.joints.len()).map(|link| link_name(cell, k, link)).collect(),
            effectors: arm.effectors.iter().map(|effector| effector.name.clone()).collect(),
            add_refusal: edits.add_effector[k].clone(),
            remove_refusal: edits.remove_effector[k].clone(),
        });
        Self {
            name: robot.name.clone(),
            tilt_max_rad: robot.gpr.limits().tilt_max,
            axes: axes(cell, &home),
            arms: arms.collect(),
            add_refusal: edits.add_arm.clone(),
            remove_refusal: edits.remove_arm.clone(),
            virtualizations: virtualizations(&robot.gpr),
        }
    }
}

fn link_name(cell: &Cell, arm: usize, link: usize) -> String {
    cell.entity_name(EntityId::Link { arm, link })
}

fn effector_name(cell: &Cell, id: &EffectorId) -> String {
    cell.effector_name(*id).to_owned()
}

/// All stations.
pub(crate) fn stations(cell: &Cell) -> Vec<StationDocument> {
    let reports = report::teach(cell, None).stations;
    let of = |(station, report): (&Station, StationReport)| {
        use FreedomName::{AboutX, AboutY, Heading, Height, X, Y};
        let frame = &station.base_from_station;
        let tilt = Tilt::from_normal(&(frame.rotation * Vector3::z()));
        let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
        let (freedoms, points) = match &station.origin {
            Origin::Nominal | Origin::CarrierAxis(_) => {
                (vec![X, Y, Height, Heading, AboutX, AboutY], Vec::new())
            }
            Origin::Taught(taught) => {
                let plane = taught.plane.as_ref();
                let turn = taught.references.as_ref().map(|references| references.turn);
                let mut freedoms = match turn {
                    None => vec![X, Y, Heading],
                    Some(None) => vec![Heading],
                    Some(Some(_)) => Vec::new(),
                };
                if plane.is_none() {
                    freedoms.extend([Height, AboutX, AboutY]);
                }
                (freedoms, plane.map_or_else(Vec::new, |plane| plane.points.clone()))
            }
        };
        StationDocument {
            slots: station.slots,
            effectors: station.effectors.iter().map(|id| effector_name(cell, id)).collect(),
            heading_rad: heading(frame),
            about_x_rad,
            about_y_rad,
            taught_m: points.into_iter().map(|point| Triple(point.into())).collect(),
            freedoms,
            report,
        }
    };
    cell.stations.iter().zip(reports).map(of).collect()
}

/// All wafers.
pub(crate) fn wafers(cell: &Cell) -> Vec<WaferDocument> {
    let in_slots = cell.occupied.iter().map(|slot| {
        let station = &cell.stations[slot.station].name;
        (cell.entity_name(EntityId::Wafer(*slot)), format!("{station}, slot {}", slot.slot))
    });
    let carried = cell.loaded_effectors.iter().map(|id| {
        let effector = effector_name(cell, id);
        (cell.entity_name(EntityId::HeldWafer(*id)), format!("on {effector}"))
    });
    let wafers = in_slots.chain(carried).zip(wafers_at_start(cell));
    let of = |((name, initial_location), held)| WaferDocument {
        name,
        initial_location,
        held: HeldDocument::new(cell, &held),
    };
    wafers.map(of).collect()
}

/// All zones.
pub(crate) fn zones(cell: &Cell) -> Vec<ZoneDocument> {
    let of = |zone: &Zone| ZoneDocument {
        name: zone.name.clone(),
        rule: match zone.rule {
            ZoneRule::KeepOut => RuleName::KeepOut,
            ZoneRule::Safe => RuleName::Safe,
        },
        shape: (&zone.shape).into(),
        origin_m: Triple(zone.base_from_shape.translation.vector.into()),
    };
    cell.zones.iter().map(of).collect()
}

/// All bodies.
pub(crate) fn bodies(cell: &Cell) -> Vec<BodyDocument> {
    let of = |body: &Body| BodyDocument {
        name: body.name.clone(),
        attached_to: match body.parent {
            ParentFrame::World => "base".to_owned(),
            ParentFrame::Platform => "platform".to_owned(),
            ParentFrame::Link { arm, link } => link_name(cell, arm, link),
        },
        shape: (&body.shape).into(),
        origin_m: {
            let station = body.station.map(|k| cell.stations[k].base_from_station.inverse());
            let place = station.unwrap_or(Pose::identity()) * body.parent_from_shape;
            Triple(place.translation.vector.into())
        },
        station: body.station.map(|k| cell.stations[k].name.clone()),
    };
    cell.bodies.iter().map(of).collect()
}
