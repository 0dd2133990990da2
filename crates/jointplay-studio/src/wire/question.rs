//! Requests that correspond to commands of the command line, in SI units.

use serde::Deserialize;
use utoipa::ToSchema;

use super::model::{MetricName, SolverName};
use super::robot_file::RobotSource;
use super::{CommandFields, ModelChoice, Rods, TiltAngle, VirtualizationName};

/// Maximum number of tilt angles of a comparison.
pub(crate) const MAX_TILTS: usize = 10_000;

/// Request of the pose for given rod lengths.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ForwardRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// q_1, q_2, q_3 (m).
    pub(crate) rods_m: Rods,
    /// The model.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) model: ModelChoice,
    /// Whether to ignore the limits of the robot; violated limits are listed.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// A command and the model.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CommandRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// Command of the robot.
    pub(crate) command: CommandFields,
    /// The model.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) model: ModelChoice,
    /// Whether to ignore the limits of the robot; violated limits are listed.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// Request of the mobility.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MobilityRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// q_1, q_2, q_3; default: all at the working height of the robot (m).
    pub(crate) rods_m: Option<Rods>,
    /// Virtualization whose mobility with free virtual joints is added.
    pub(crate) virtualization: Option<VirtualizationName>,
    /// Whether to ignore the limits of the robot; violated limits are listed.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// Request of a comparison of all models over a range of tilts.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompareRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// Azimuth of all tilts (rad).
    #[serde(default)]
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) azimuth_rad: f64,
    /// The tilts (rad).
    #[schema(value_type = Vec<TiltAngle>, min_items = 1, max_items = 10000)]
    pub(crate) tilts_rad: Vec<f64>,
    /// Axis height of all tilts; default: the working height of the robot (m).
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) axis_height_m: Option<f64>,
    /// Solver of the virtual displacements.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) solver: SolverName,
    /// Weight of angles relative to lengths.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) metric: MetricName,
    /// Characteristic length instead of that of the metric (m).
    #[schema(minimum = 1e-12, maximum = 1e6)]
    pub(crate) characteristic_length_m: Option<f64>,
    /// Whether to ignore the limits of the robot; violated limits are listed.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

impl CompareRequest {
    /// Solver and metric, as for any virtualization.
    pub(crate) fn choice(&self) -> ModelChoice {
        ModelChoice {
            solver: self.solver,
            metric: self.metric,
            characteristic_length_m: self.characteristic_length_m,
            ..ModelChoice::default()
        }
    }
}
