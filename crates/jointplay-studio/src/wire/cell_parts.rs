//! What a cell is made of: robot, stations, wafers, bodies, zones.

use jointplay::cell::EntityId;
use jointplay::cell::geometry::Shape;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::station::{Origin, Station, teach};
use jointplay::cell::workcell::{Body, Carrier, Cell, Zone, ZoneRule};
use jointplay::interop::export::wafers_at_start;
use jointplay::nalgebra::Vector3;
use jointplay::report::{self, StationReport};
use jointplay::spatial::{Pose, Tilt};
use serde::Serialize;
use utoipa::ToSchema;

use super::Triple;
use super::cell_chain::HeldDocument;
use super::cell_jogged::{AxisDocument, axes};

/// What the robot is made of.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RobotParts {
    /// What it is called.
    pub(crate) name: String,
    /// How far it may lean [rad].
    pub(crate) lean_max_rad: f64,
    /// All axes at home, rods first.
    pub(crate) axes: Vec<AxisDocument>,
    /// Its arms.
    pub(crate) arms: Vec<ArmParts>,
}

/// An arm.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ArmParts {
    /// What it is called.
    pub(crate) name: String,
    /// Its links, as frames that move are called.
    pub(crate) links: Vec<String>,
    /// Its effectors.
    pub(crate) effectors: Vec<String>,
}

/// A station, and what of it can be moved.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct StationDocument {
    #[serde(flatten)]
    pub(crate) report: StationReport,
    /// How many slots it has.
    pub(crate) slots: usize,
    /// Effectors that may use it.
    pub(crate) effectors: Vec<String>,
    /// Its turn about the vertical [rad].
    pub(crate) yaw_rad: f64,
    /// How it leans: turn about x [rad].
    pub(crate) about_x_rad: f64,
    /// How it leans: turn about y [rad].
    pub(crate) about_y_rad: f64,
    /// Points that its plane was taught by [m].
    pub(crate) taught_m: Vec<Triple>,
    /// In which ways it can be moved, as far as taught points of its plane leave it free.
    pub(crate) freedoms: Vec<FreedomName>,
}

/// Something of a station that can be moved by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FreedomName {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Up and down.
    Height,
    /// About the vertical.
    Yaw,
    /// Its lean about x.
    AboutX,
    /// Its lean about y.
    AboutY,
}

/// A wafer.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct WaferDocument {
    /// What it is called, as the frames that move are.
    pub(crate) name: String,
    /// Where it is at the start.
    pub(crate) starts: String,
    /// The same as a frame.
    pub(crate) held: HeldDocument,
}

/// A region with a rule.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ZoneDocument {
    /// What it is called.
    pub(crate) name: String,
    /// What it asks.
    pub(crate) rule: RuleName,
    /// Its shape.
    pub(crate) shape: ShapeDocument,
    /// Where the shape's own origin is, in the base frame [m].
    pub(crate) origin_m: Triple,
}

/// What a zone asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RuleName {
    /// Nothing of the robot may enter.
    KeepOut,
    /// Wafers stay within while the robot turns.
    Safe,
}

/// Something that may be run into.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BodyDocument {
    /// What it is called.
    pub(crate) name: String,
    /// What it moves with: `base`, `platform`, or a link as frames that move are called.
    pub(crate) moves_with: String,
    /// The station that it belongs to, in whose frame its place is told; `null` where it belongs to none.
    #[schema(required = true)]
    pub(crate) station: Option<String>,
    /// Its shape.
    pub(crate) shape: ShapeDocument,
    /// Where the shape's own origin is, in the frame of its station, else in that of what it moves with [m].
    pub(crate) origin_m: Triple,
}

/// A shape, as its file says it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum ShapeDocument {
    /// A box.
    Box {
        /// Half of its sides [m].
        half_m: Triple,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its radius [m].
        radius_m: f64,
        /// Half of its height [m].
        half_height_m: f64,
    },
    /// All points no farther from a segment than a radius.
    Capsule {
        /// Its radius [m].
        radius_m: f64,
    },
    /// The least convex body about points.
    Convex {
        /// How many.
        points: usize,
    },
    /// A surface of triangles.
    Mesh {
        /// How many.
        triangles: usize,
    },
}

impl From<&Shape> for ShapeDocument {
    fn from(shape: &Shape) -> Self {
        match shape {
            Shape::Box { half } => Self::Box { half_m: Triple(*half) },
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
    pub(crate) fn new(cell: &Cell) -> Self {
        let robot = &cell.robot;
        let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
        let arms = robot.arms.iter().enumerate().map(|(k, arm)| ArmParts {
            name: arm.name.clone(),
            links: (0..arm.joints.len()).map(|link| link_name(cell, k, link)).collect(),
            effectors: arm.effectors.iter().map(|effector| effector.name.clone()).collect(),
        });
        Self {
            name: robot.name.clone(),
            lean_max_rad: robot.gpr.limits().tilt_max,
            axes: axes(cell, &home),
            arms: arms.collect(),
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
    let told = report::teach(cell, None).stations;
    let of = |(station, report): (&Station, StationReport)| {
        use FreedomName::{AboutX, AboutY, Height, X, Y, Yaw};
        let frame = &station.base_from_station;
        let tilt = Tilt::from_normal(&(frame.rotation * Vector3::z()));
        let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
        let (freedoms, points) = match &station.origin {
            Origin::Nominal | Origin::Drift(_) => {
                (vec![X, Y, Height, Yaw, AboutX, AboutY], Vec::new())
            }
            Origin::Taught(fit) => (vec![X, Y, Yaw], fit.points.clone()),
        };
        StationDocument {
            slots: station.slots,
            effectors: station.effectors.iter().map(|id| effector_name(cell, id)).collect(),
            yaw_rad: teach::yaw(frame),
            about_x_rad,
            about_y_rad,
            taught_m: points.into_iter().map(|point| Triple(point.into())).collect(),
            freedoms,
            report,
        }
    };
    cell.stations.iter().zip(told).map(of).collect()
}

/// All wafers.
pub(crate) fn wafers(cell: &Cell) -> Vec<WaferDocument> {
    let in_slots = cell.occupied.iter().map(|slot| {
        let station = &cell.stations[slot.station].name;
        (cell.entity_name(EntityId::Wafer(*slot)), format!("{station}, slot {}", slot.slot))
    });
    let carried = cell.carried.iter().map(|id| {
        let effector = effector_name(cell, id);
        (cell.entity_name(EntityId::HeldWafer(*id)), format!("on {effector}"))
    });
    let told = in_slots.chain(carried).zip(wafers_at_start(cell));
    let of = |((name, starts), held)| WaferDocument {
        name,
        starts,
        held: HeldDocument::new(cell, &held),
    };
    told.map(of).collect()
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
        moves_with: match body.carrier {
            Carrier::World => "base".to_owned(),
            Carrier::Platform => "platform".to_owned(),
            Carrier::Link { arm, link } => link_name(cell, arm, link),
        },
        shape: (&body.shape).into(),
        origin_m: {
            let station = body.station.map(|k| cell.stations[k].base_from_station.inverse());
            let place = station.unwrap_or(Pose::identity()) * body.carrier_from_shape;
            Triple(place.translation.vector.into())
        },
        station: body.station.map(|k| cell.stations[k].name.clone()),
    };
    cell.bodies.iter().map(of).collect()
}
