//! What the commands of the command line are asked, in SI.

use serde::Deserialize;
use utoipa::ToSchema;

use super::model::{MetricName, SolverName};
use super::{CommandFields, ModelChoice, Pitch, Rods, VirtualizationName};
use crate::strict;

/// The most pitches that one comparison may have.
pub(crate) const MOST_PITCHES: usize = 10_000;

/// Where the platform is for given rods.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ForwardRequest {
    /// q_1, q_2, q_3 [m].
    pub(crate) rods_m: Rods,
    /// Which model is to answer.
    #[serde(default, deserialize_with = "strict::object")]
    #[schema(required = false)]
    pub(crate) model: ModelChoice,
    /// Compute past the robot's limits, and say so.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// A command, and which model is to answer.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CommandRequest {
    /// What the robot is told to do.
    pub(crate) command: CommandFields,
    /// Which model is to answer.
    #[serde(default, deserialize_with = "strict::object")]
    #[schema(required = false)]
    pub(crate) model: ModelChoice,
    /// Compute past the robot's limits, and say so.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// What can move.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MobilityRequest {
    /// q_1, q_2, q_3; without them, all at the robot's working height [m].
    pub(crate) rods_m: Option<Rods>,
    /// Also the mobility with these virtual joints free.
    pub(crate) virtualization: Option<VirtualizationName>,
    /// Compute past the robot's limits, and say so.
    #[serde(default)]
    pub(crate) ignore_limits: bool,
}

/// What every model says of a range of tilts.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompareRequest {
    /// Azimuth of all tilts [rad].
    #[serde(default)]
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) yaw_rad: f64,
    /// The tilts [rad].
    #[schema(value_type = Vec<Pitch>, min_items = 1, max_items = 10000)]
    pub(crate) pitches_rad: Vec<f64>,
    /// Axis height of all tilts; without it, the robot's working height [m].
    #[schema(minimum = -1000, maximum = 1000)]
    pub(crate) axis_height_m: Option<f64>,
    /// How the virtual displacements are found.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) solver: SolverName,
    /// How angles weigh against lengths.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) metric: MetricName,
    /// A characteristic length instead of the metric's [m].
    #[schema(minimum = 1e-12, maximum = 1e6)]
    pub(crate) characteristic_length_m: Option<f64>,
    /// Compute past the robot's limits, and say so.
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
