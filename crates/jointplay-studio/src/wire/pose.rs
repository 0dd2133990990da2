//! One pose, with all values of its display.

use jointplay::format::explain::explain_limit;
use jointplay::gpr::{
    ApproximatePose, BallClearance, BrokenLimit, EvaluatedBounds, Gpr, PlatformPose, TiltPlay,
    ball_sides,
};
use jointplay::mobility::{FiniteMobility, InstantaneousMobility};
use jointplay::spatial::{Pose, Tilt};
use jointplay::virtualization::Virtualization;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::model::SolverName;
use super::robot_file::RobotSource;
use super::{CommandFields, ModelChoice, Pair, Rods, Triple};
use crate::display::display_units;

/// Maximum number of models in a request.
pub(crate) const MAX_MODELS: usize = 16;

/// Request of one pose.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// Command of the robot.
    pub(crate) command: CommandFields,
    /// Rod lengths at the start of the motion. If they are within the limits and the command is not, the robot stops at the last pose within the limits on a straight line in rod space.
    /// Without them, or from a start beyond the limits, the limits are ignored.
    #[serde(default)]
    pub(crate) from_rods_m: Option<Rods>,
    /// What happens to a command beyond the limits.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) at_limits: AtLimits,
    /// The models; a height of the platform centre refers to the first one.
    #[serde(default = "one_model")]
    #[schema(required = false, min_items = 1, max_items = 16)]
    pub(crate) models: Vec<ModelChoice>,
    /// Whether to compute the mobility.
    #[serde(default = "yes")]
    #[schema(required = false, default = true)]
    pub(crate) mobility: bool,
    /// Whether to compute the bounds of the sensitivity.
    #[serde(default = "yes")]
    #[schema(required = false, default = true)]
    pub(crate) bounds: bool,
}

/// What happens to a command beyond the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum AtLimits {
    /// A motion from `from_rods_m` stops; other poses are computed beyond the limits.
    #[default]
    Stop,
    /// The robot has the nearest rods within the limits, by the distance of rod lengths: it slides along the limits.
    Slide,
}

fn yes() -> bool {
    true
}

fn one_model() -> Vec<ModelChoice> {
    vec![ModelChoice::default()]
}

/// One pose, with all values of its display.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseDocument {
    /// q_1, q_2, q_3 (m).
    pub(crate) rods_m: Triple,
    /// Tilt of the plane through the balls, which does not depend on the model.
    pub(crate) tilt: TiltDocument,
    /// Height at which the plane through the balls crosses the base axis (m).
    pub(crate) axis_height_m: f64,
    /// The ball centres in the base frame (m).
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) balls_m: [Triple; 3],
    /// L_12, L_23, L_31 between the balls (m).
    pub(crate) sides_m: Triple,
    /// Limits that the pose violates.
    pub(crate) limits_broken: Vec<BrokenLimitDocument>,
    /// Limits that stopped the motion from `from_rods_m`, or at which the nearest rods are; empty if the command was reached.
    pub(crate) stopped_by: Vec<BrokenLimitDocument>,
    /// The approximate model of the paper's Fig. 2.
    pub(crate) approximate: ApproximateDocument,
    /// Results of the models, in the order of the request.
    pub(crate) models: Vec<ModelDocument>,
    /// Mobility with locked virtual joints, if requested.
    #[schema(required = true)]
    pub(crate) mobility: Option<MobilityDocument>,
}

/// A tilt by azimuth and angle, and as rotation vector.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct TiltDocument {
    /// Azimuth of the tilt (rad).
    pub(crate) azimuth_rad: f64,
    /// Angle of the tilt, not negative (rad).
    pub(crate) angle_rad: f64,
    /// Component about x (rad).
    pub(crate) about_x_rad: f64,
    /// Component about y (rad).
    pub(crate) about_y_rad: f64,
}

/// A violated limit.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BrokenLimitDocument {
    /// Index of the limb whose rod violates its limit, from 0; `null` for the tilt limit.
    #[schema(required = true)]
    pub(crate) limb: Option<usize>,
    /// Value, in m for a rod and in rad for the tilt.
    pub(crate) found: f64,
    /// Lower limit (m or rad).
    pub(crate) min: f64,
    /// Upper limit (m or rad).
    pub(crate) max: f64,
    /// Description, in mm and degrees.
    pub(crate) message: String,
}

/// A pose of the platform frame in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlacedDocument {
    /// Platform centre (m).
    pub(crate) origin_m: Triple,
    /// Rows of the rotation matrix base_from_platform.
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) rotation: [Triple; 3],
}

/// The approximate model.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ApproximateDocument {
    /// Pose of the platform.
    pub(crate) pose: PlacedDocument,
    /// Vectors from each ball to its socket in the base frame (m).
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) gaps_m: [Triple; 3],
}

/// Result of one model.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ModelDocument {
    /// The model.
    pub(crate) model: ModelChoice,
    /// The solution; `null` if there is none.
    #[schema(required = true)]
    pub(crate) answer: Option<AnswerDocument>,
    /// Why there is no solution.
    #[schema(required = true)]
    pub(crate) problem: Option<String>,
}

/// Solution of a model.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AnswerDocument {
    /// Pose of the platform.
    pub(crate) pose: PlacedDocument,
    /// Offset of the platform centre from the base axis, x and y (m).
    pub(crate) center_shift_m: Pair,
    /// Torsion about the platform normal, beyond the shortest rotation to the normal (rad).
    pub(crate) torsion_rad: f64,
    /// Displacements X of the virtual joints, in the order of the robot document, in m and rad.
    pub(crate) virtual_joints: Vec<f64>,
    /// The displaced sockets in the platform frame (m).
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) sockets_m: [Pair; 3],
    /// Norm of the displacement of the virtual joints, in the metric (m).
    pub(crate) displacement_m: f64,
    /// Characteristic length of the metric (m).
    pub(crate) characteristic_length_m: f64,
    /// The solver used; it differs from the requested one if there is no closed form.
    pub(crate) solver: SolverName,
    /// Number of iterations; 0 for a closed form.
    pub(crate) iterations: usize,
    /// Largest difference between a side and its virtual length (m).
    pub(crate) residual_m: f64,
    /// Clearance of the balls that the pose needs.
    pub(crate) clearance: ClearanceDocument,
    /// Displacement from the level pose with its first-order bounds, if requested.
    #[schema(required = true)]
    pub(crate) play: Option<PlayDocument>,
    /// Mobility with free virtual joints, if requested.
    #[schema(required = true)]
    pub(crate) augmented: Option<AugmentedDocument>,
}

/// Clearance of the balls that a pose needs, as radii, for rigid parts.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ClearanceDocument {
    /// Distance of each ball from the centre of its nominal socket (m).
    pub(crate) displacements_m: Triple,
    /// Least clearance that the pose needs, wherever the platform settles (m).
    pub(crate) lower_bound_m: f64,
    /// Clearance at which the pose is possible (m).
    pub(crate) upper_bound_m: f64,
    /// Clearance in the robot file; `null` without one (m).
    #[schema(required = true)]
    pub(crate) available_m: Option<f64>,
    /// Whether it is sufficient; `null` where it is unknown, or between the bounds.
    #[schema(required = true)]
    pub(crate) is_sufficient: Option<bool>,
}

impl From<&BallClearance> for ClearanceDocument {
    fn from(needed: &BallClearance) -> Self {
        Self {
            displacements_m: Triple(needed.displacements),
            lower_bound_m: needed.lower_bound,
            upper_bound_m: needed.upper_bound(),
            available_m: needed.available,
            is_sufficient: needed.is_sufficient(),
        }
    }
}

/// Displacement of the virtual joints from the level pose at the same axis height, with its first-order bounds.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlayDocument {
    /// Exact ‖ΔX‖ from the level pose, in the metric (m).
    pub(crate) displacement_m: f64,
    /// ‖ΔP‖ of that motion (m).
    pub(crate) motion_m: f64,
    /// Bounds with derivatives at the start, the midpoint and the end of the motion.
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) bounds: Vec<BoundsDocument>,
    /// Share of each rod in the displacement; `null` without a displacement.
    #[schema(required = true)]
    pub(crate) rod_shares: Option<Vec<f64>>,
    /// Share of each side 12, 23, 31 in the displacement; `null` without a displacement.
    #[schema(required = true)]
    pub(crate) side_shares: Option<Vec<f64>>,
}

/// First-order bounds of the displacement.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BoundsDocument {
    /// Where the derivatives are taken.
    pub(crate) derivatives_at: DerivativePoint,
    /// σ_min ‖V₃ᵀΔP‖ (m).
    pub(crate) lower_m: f64,
    /// σ_max ‖V₃ᵀΔP‖ (m).
    pub(crate) upper_m: f64,
    /// ‖∂X/∂P ΔP‖ (m).
    pub(crate) linear_m: f64,
    /// Whether the displacement lies between the bounds.
    pub(crate) holds: bool,
}

/// Point of the motion from the level pose at which derivatives are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DerivativePoint {
    /// The level pose.
    Start,
    /// The midpoint.
    Midpoint,
    /// The pose.
    End,
}

/// Mobility with free virtual joints.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AugmentedDocument {
    /// Mobility.
    pub(crate) mobility: usize,
    /// Independent constraints.
    pub(crate) rank: usize,
    /// Singular values of the scaled Jacobian, largest first.
    pub(crate) singular_values: Vec<f64>,
    /// Threshold: singular values up to it count as zero.
    pub(crate) threshold: f64,
}

/// Mobility with locked virtual joints.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MobilityDocument {
    /// Mobility by the Kutzbach criterion.
    pub(crate) kutzbach: i64,
    /// Instantaneous mobility.
    pub(crate) instantaneous: usize,
    /// Finite mobility; `null` if undecided.
    #[schema(required = true)]
    pub(crate) finite: Option<usize>,
    /// Independent constraints.
    pub(crate) rank: usize,
    /// Number of redundant constraints.
    pub(crate) redundancy: usize,
    /// Singular values of the scaled constraint Jacobian, largest first.
    pub(crate) singular_values: Vec<f64>,
    /// Threshold: singular values up to it count as zero.
    pub(crate) threshold: f64,
}

impl TiltDocument {
    pub(crate) fn new(tilt: Tilt) -> Self {
        let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
        Self { azimuth_rad: tilt.azimuth, angle_rad: tilt.angle, about_x_rad, about_y_rad }
    }
}

impl From<&BrokenLimit> for BrokenLimitDocument {
    fn from(broken: &BrokenLimit) -> Self {
        let message = explain_limit(broken, display_units());
        match *broken {
            BrokenLimit::Rod { limb, length, min, max } => {
                Self { limb: Some(limb - 1), found: length, min, max, message }
            }
            BrokenLimit::Tilt { angle: tilt_angle, max } => {
                Self { limb: None, found: tilt_angle, min: 0.0, max, message }
            }
        }
    }
}

impl From<&Pose> for PlacedDocument {
    fn from(pose: &Pose) -> Self {
        let rotation = pose.rotation.matrix();
        Self {
            origin_m: Triple(pose.translation.vector.into()),
            rotation: [0, 1, 2].map(|i| Triple([0, 1, 2].map(|j| rotation[(i, j)]))),
        }
    }
}

impl From<&ApproximatePose> for ApproximateDocument {
    fn from(found: &ApproximatePose) -> Self {
        Self {
            pose: (&found.base_from_platform).into(),
            gaps_m: found.gaps.map(|gap| Triple(gap.into())),
        }
    }
}

impl PoseDocument {
    /// The geometry of a pose; models and mobility are still to come.
    pub(crate) fn new(
        gpr: &Gpr,
        rods: [f64; 3],
        broken: &[BrokenLimit],
        stopped_by: &[BrokenLimit],
        approximate: &ApproximatePose,
    ) -> Self {
        let balls = gpr.ball_centers(&rods);
        Self {
            rods_m: Triple(rods),
            tilt: TiltDocument::new(gpr.plane_tilt(&rods)),
            axis_height_m: gpr.plane_height(&rods).0,
            balls_m: balls.map(|ball| Triple(ball.into())),
            sides_m: Triple(ball_sides(&balls)),
            limits_broken: broken.iter().map(Into::into).collect(),
            stopped_by: stopped_by.iter().map(Into::into).collect(),
            approximate: approximate.into(),
            models: Vec::new(),
            mobility: None,
        }
    }
}

impl AnswerDocument {
    pub(crate) fn new(
        gpr: &Gpr,
        pose: &PlatformPose,
        virtualization: &(dyn Virtualization + Sync),
        play: Option<&TiltPlay>,
        augmented: Option<&InstantaneousMobility>,
    ) -> Self {
        let found = &pose.solution;
        let sockets = virtualization.sockets(gpr.platform(), &found.virtual_joints);
        Self {
            pose: (&pose.base_from_platform).into(),
            center_shift_m: Pair(pose.center_shift().into()),
            torsion_rad: pose.torsion(),
            virtual_joints: found.virtual_joints.to_vec(),
            sockets_m: sockets.map(|socket| Pair(socket.into())),
            displacement_m: gpr.displacement(pose, virtualization),
            characteristic_length_m: found.characteristic_length,
            solver: found.solver.into(),
            iterations: found.iterations,
            residual_m: found.residual,
            clearance: (&gpr.needed_clearance(pose, virtualization)).into(),
            play: play.map(Into::into),
            augmented: augmented.map(|found| AugmentedDocument {
                mobility: found.mobility,
                rank: found.rank,
                singular_values: found.singular_values.iter().copied().collect(),
                threshold: found.threshold,
            }),
        }
    }
}

impl From<&TiltPlay> for PlayDocument {
    fn from(play: &TiltPlay) -> Self {
        let bounds = |derivatives_at, found: &EvaluatedBounds| BoundsDocument {
            derivatives_at,
            lower_m: found.bounds.lower,
            upper_m: found.bounds.upper,
            linear_m: found.bounds.linear,
            holds: found.held,
        };
        Self {
            displacement_m: play.displacement,
            motion_m: play.motion,
            bounds: vec![
                bounds(DerivativePoint::Start, &play.at_start),
                bounds(DerivativePoint::Midpoint, &play.at_midpoint),
                bounds(DerivativePoint::End, &play.at_end),
            ],
            rod_shares: play.limb_shares.clone(),
            side_shares: play.side_shares.clone(),
        }
    }
}

impl MobilityDocument {
    pub(crate) fn new(kutzbach: i64, found: &FiniteMobility) -> Self {
        let first = &found.instantaneous;
        Self {
            kutzbach,
            instantaneous: first.mobility,
            finite: found.mobility,
            rank: first.rank,
            redundancy: first.redundancy,
            singular_values: first.singular_values.iter().copied().collect(),
            threshold: first.threshold,
        }
    }
}
