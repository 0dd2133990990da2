//! Documents of the robot.

use jointplay::format::robot::{Mesh, MeshFormat, Robot};
use jointplay::gpr::Gpr;
use jointplay::virtualization::{MAX_VIRTUAL_JOINTS, VirtualJointKind, Virtualization, built_in};
use serde::Serialize;
use utoipa::ToSchema;

use super::{ModelChoice, Pair};

/// The parts with which a server was started.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StartedWith {
    pub(crate) cell: bool,
    pub(crate) controller: bool,
    pub(crate) mechanism: bool,
}

/// The robot of this server.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RobotDocument {
    /// Name in its file.
    pub(crate) name: String,
    /// Version of jointplay.
    pub(crate) version: &'static str,
    /// The three limbs.
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) limbs: Vec<LimbDocument>,
    /// Limits of rods and tilt.
    pub(crate) limits: LimitsDocument,
    /// Clearance of the balls, as a radius; `null` if the robot file has none (m).
    #[schema(required = true)]
    pub(crate) ball_clearance_m: Option<f64>,
    /// Axis height at which the robot works (m).
    pub(crate) working_height_m: f64,
    /// Mean of the socket radii (m).
    pub(crate) mean_socket_radius_m: f64,
    /// Mobility by the Kutzbach criterion.
    pub(crate) kutzbach_mobility: i64,
    /// Available virtualizations.
    pub(crate) virtualizations: Vec<VirtualizationDocument>,
    /// Mesh of the base; `null` if the robot file names none.
    #[schema(required = true)]
    pub(crate) base_mesh: Option<MeshDocument>,
    /// Mesh of the platform; `null` if the robot file names none.
    #[schema(required = true)]
    pub(crate) platform_mesh: Option<MeshDocument>,
    /// Default model of requests.
    pub(crate) default_model: ModelChoice,
    /// Whether this server has a work cell.
    pub(crate) cell: bool,
    /// Whether this server shows the robots of a simulated controller.
    pub(crate) controller: bool,
    /// Whether this server was started with a mechanism.
    pub(crate) mechanism: bool,
    /// File formats of time series that this build supports.
    pub(crate) series_formats: Vec<SeriesFormat>,
}

/// File format of time series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SeriesFormat {
    /// Comma-separated values, from `study.csv`.
    Csv,
    /// Apache Parquet, from `study.parquet`.
    Parquet,
}

impl SeriesFormat {
    /// The formats of this build.
    fn available() -> Vec<Self> {
        let all = [(Self::Csv, true), (Self::Parquet, cfg!(feature = "parquet"))];
        all.into_iter().filter_map(|(format, built)| built.then_some(format)).collect()
    }
}

/// A mesh.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MeshDocument {
    /// URL on this server.
    pub(crate) url: &'static str,
    /// Format.
    pub(crate) format: MeshFormatName,
}

/// Format of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MeshFormatName {
    /// STL, in mm.
    Stl,
    /// OBJ, in mm.
    Obj,
    /// glTF in one file, in m.
    Gltf,
    /// Binary glTF, in m.
    Glb,
}

impl MeshDocument {
    fn new(mesh: Option<&Mesh>, url: &'static str) -> Option<Self> {
        let format = match mesh?.format {
            MeshFormat::Stl => MeshFormatName::Stl,
            MeshFormat::Obj => MeshFormatName::Obj,
            MeshFormat::Gltf => MeshFormatName::Gltf,
            MeshFormat::Glb => MeshFormatName::Glb,
        };
        Some(Self { url, format })
    }
}

/// One limb.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct LimbDocument {
    /// Intersection of the rod axis with the base plane, in the base frame (m).
    pub(crate) base_point_m: Pair,
    /// Distance of the nominal socket from the platform centre (m).
    pub(crate) socket_radius_m: f64,
    /// Direction of the nominal socket, from x toward y of the platform (rad).
    pub(crate) socket_angle_rad: f64,
    /// The nominal socket in the platform frame (m).
    pub(crate) socket_m: Pair,
}

/// Limits of rods and tilt.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct LimitsDocument {
    /// Shortest rod (m).
    pub(crate) rod_min_m: f64,
    /// Longest rod (m).
    pub(crate) rod_max_m: f64,
    /// Largest tilt toward any azimuth (rad).
    pub(crate) tilt_max_rad: f64,
}

/// One virtualization.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct VirtualizationDocument {
    /// Its name.
    pub(crate) name: String,
    /// Its virtual joints, in the order of all vectors of displacements.
    pub(crate) joints: Vec<JointDocument>,
}

/// The available virtualizations of a robot.
pub(crate) fn virtualizations(gpr: &Gpr) -> Vec<VirtualizationDocument> {
    let document = |virtualization: &dyn Virtualization| VirtualizationDocument {
        name: virtualization.name().to_owned(),
        joints: joints(gpr, virtualization),
    };
    built_in().into_iter().map(document).collect()
}

/// One virtual joint.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct JointDocument {
    /// Symbol of this kind of joint, such as `phi`.
    pub(crate) symbol: &'static str,
    /// Index of its limb, from 0.
    pub(crate) limb: usize,
    /// Linear (m) or angular (rad).
    pub(crate) motion: MotionName,
    /// Nominal coordinate (m or rad).
    pub(crate) nominal: f64,
}

/// Type of a virtual joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MotionName {
    /// Its coordinate is a length.
    Linear,
    /// Its coordinate is an angle.
    Angular,
}

impl RobotDocument {
    pub(crate) fn new(robot: &Robot, parts: StartedWith) -> Self {
        let gpr = &robot.gpr;
        let limbs = gpr.limbs().into_iter().zip(gpr.platform().sockets());
        let limits = gpr.limits();
        Self {
            name: robot.name.clone(),
            version: env!("CARGO_PKG_VERSION"),
            limbs: limbs
                .map(|(limb, socket)| LimbDocument {
                    base_point_m: Pair(limb.base_point.into()),
                    socket_radius_m: limb.socket_radius,
                    socket_angle_rad: limb.socket_angle,
                    socket_m: Pair((*socket).into()),
                })
                .collect(),
            limits: LimitsDocument {
                rod_min_m: limits.rod_min,
                rod_max_m: limits.rod_max,
                tilt_max_rad: limits.tilt_max,
            },
            ball_clearance_m: gpr.ball_clearance(),
            working_height_m: gpr.working_height(),
            mean_socket_radius_m: gpr.platform().mean_radius(),
            kutzbach_mobility: gpr.kutzbach_mobility(),
            virtualizations: virtualizations(gpr),
            base_mesh: MeshDocument::new(robot.base_mesh.as_ref(), "/api/v1/meshes/base"),
            platform_mesh: MeshDocument::new(
                robot.platform_mesh.as_ref(),
                "/api/v1/meshes/platform",
            ),
            default_model: ModelChoice::default(),
            cell: parts.cell,
            controller: parts.controller,
            mechanism: parts.mechanism,
            series_formats: SeriesFormat::available(),
        }
    }
}

fn joints(gpr: &Gpr, virtualization: &dyn Virtualization) -> Vec<JointDocument> {
    let joints = virtualization.joints();
    let mut nominal = [0.0; MAX_VIRTUAL_JOINTS];
    virtualization.nominal(gpr.platform(), &mut nominal[..joints.len()]);
    let documents = joints.iter().zip(nominal).map(|(joint, nominal)| JointDocument {
        symbol: joint.symbol,
        limb: joint.limb,
        motion: match joint.motion {
            VirtualJointKind::Linear => MotionName::Linear,
            VirtualJointKind::Angular => MotionName::Angular,
        },
        nominal,
    });
    documents.collect()
}
