//! One pose, with all that one picture of it needs.

use jointplay::format::explain::explain_limit;
use jointplay::gpr::{
    ApproximatePose, BrokenLimit, EvaluatedBounds, Gpr, PlatformPose, TiltPlay, ball_sides,
};
use jointplay::mobility::{FiniteMobility, InstantaneousMobility};
use jointplay::spatial::{Pose, Tilt};
use jointplay::virtualization::Virtualization;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::model::SolverName;
use super::{CommandFields, ModelChoice, Pair, Rods, Triple};
use crate::strict;

/// The most models that one request may ask.
pub(crate) const MOST_MODELS: usize = 16;

/// What is asked of one pose.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseRequest {
    /// What the robot is told to do.
    pub(crate) command: CommandFields,
    /// Rods from which the robot comes: where they are within the limits and the command is not, it stops at the last pose within them on the straight way.
    /// Without them, or from beyond the limits, the command is computed past the limits.
    #[serde(default)]
    pub(crate) from_rods_m: Option<Rods>,
    /// Which models are to answer; a height of the platform's centre is that of the first of them.
    #[serde(default = "one_model", deserialize_with = "strict::objects")]
    #[schema(required = false, min_items = 1, max_items = 16)]
    pub(crate) models: Vec<ModelChoice>,
    /// Whether mobility is wanted.
    #[serde(default = "yes")]
    #[schema(required = false, default = true)]
    pub(crate) mobility: bool,
    /// Whether the bounds of sensitivity are wanted.
    #[serde(default = "yes")]
    #[schema(required = false, default = true)]
    pub(crate) bounds: bool,
}

fn yes() -> bool {
    true
}

fn one_model() -> Vec<ModelChoice> {
    vec![ModelChoice::default()]
}

/// One pose, with all that one picture of it needs.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseDocument {
    /// q_1, q_2, q_3 [m].
    pub(crate) rods_m: Triple,
    /// Tilt of the plane through the balls: geometry, the same for every model.
    pub(crate) tilt: TiltDocument,
    /// Where that plane crosses the base axis [m].
    pub(crate) axis_height_m: f64,
    /// The ball centres in the base frame [m].
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) balls_m: [Triple; 3],
    /// L_12, L_23, L_31 between the balls [m].
    pub(crate) sides_m: Triple,
    /// The limits that the pose breaks; it is computed all the same.
    pub(crate) limits_broken: Vec<BrokenLimitDocument>,
    /// The limits that the command breaks, and that stopped the robot on its way from `from_rods_m`; empty where the command was reached.
    pub(crate) stopped_by: Vec<BrokenLimitDocument>,
    /// The approximate model of the paper's Fig. 2.
    pub(crate) approximate: ApproximateDocument,
    /// What each model says, in the order asked.
    pub(crate) models: Vec<ModelDocument>,
    /// What can move with all virtual joints held; there if asked for.
    #[schema(required = true)]
    pub(crate) mobility: Option<MobilityDocument>,
}

/// A tilt, in both ways to say it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct TiltDocument {
    /// Azimuth toward which the platform leans [rad].
    pub(crate) yaw_rad: f64,
    /// How far it leans, not negative [rad].
    pub(crate) pitch_rad: f64,
    /// Turn about x [rad].
    pub(crate) about_x_rad: f64,
    /// Turn about y [rad].
    pub(crate) about_y_rad: f64,
}

/// A limit that a pose breaks.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BrokenLimitDocument {
    /// Which limb's rod, counted from 0; `null` where it is the tilt.
    #[schema(required = true)]
    pub(crate) limb: Option<usize>,
    /// What was found, in m for a rod and in rad for the tilt.
    pub(crate) found: f64,
    /// Least allowed, in the same unit.
    pub(crate) min: f64,
    /// Greatest allowed, in the same unit.
    pub(crate) max: f64,
    /// The same in words, in mm and degrees.
    pub(crate) message: String,
}

/// A pose of the platform frame in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlacedDocument {
    /// The platform's centre [m].
    pub(crate) origin_m: Triple,
    /// Rows of the rotation matrix base_from_platform.
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) rotation: [Triple; 3],
}

/// The approximate model.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ApproximateDocument {
    /// Where it puts the platform.
    pub(crate) pose: PlacedDocument,
    /// From each ball to its socket, in the base frame [m].
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) gaps_m: [Triple; 3],
}

/// What one model says of a pose.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ModelDocument {
    /// The model asked.
    pub(crate) model: ModelChoice,
    /// Its answer; `null` where it has none.
    #[schema(required = true)]
    pub(crate) answer: Option<AnswerDocument>,
    /// Why there is no answer.
    #[schema(required = true)]
    pub(crate) problem: Option<String>,
}

/// A model's answer.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AnswerDocument {
    /// Where the platform is.
    pub(crate) pose: PlacedDocument,
    /// Offset of the platform's centre from the base axis, along x and y [m].
    pub(crate) center_shift_m: Pair,
    /// Turn about the platform normal, beyond the shortest rotation to it [rad].
    pub(crate) twist_rad: f64,
    /// Displacements X of the virtual joints, in the order of the robot document, in m and rad.
    pub(crate) virtual_joints: Vec<f64>,
    /// The displaced sockets in the platform frame [m].
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) sockets_m: [Pair; 3],
    /// How far the virtual joints are from nominal, in the metric [m].
    pub(crate) displacement_m: f64,
    /// By what length angles are multiplied in the metric [m].
    pub(crate) characteristic_length_m: f64,
    /// The solver used: differs from the one asked for where a closed form does not exist.
    pub(crate) solver: SolverName,
    /// Iterations done; 0 for a closed form.
    pub(crate) iterations: usize,
    /// Largest difference between a side and its virtual length [m].
    pub(crate) residual_m: f64,
    /// The displacement from level beside its first-order bounds; there if asked for.
    #[schema(required = true)]
    pub(crate) play: Option<PlayDocument>,
    /// What can move with these virtual joints free; there if mobility is asked for.
    #[schema(required = true)]
    pub(crate) augmented: Option<AugmentedDocument>,
}

/// How far the virtual joints move from level at the same axis height, beside the first-order bounds.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PlayDocument {
    /// ‖ΔX‖ from level, in the metric, nothing neglected [m].
    pub(crate) displacement_m: f64,
    /// ‖ΔP‖ of that motion [m].
    pub(crate) motion_m: f64,
    /// The bounds with derivatives at the start, half way and at the end.
    #[schema(min_items = 3, max_items = 3)]
    pub(crate) bounds: Vec<BoundsDocument>,
    /// Share of each rod in the displacement; `null` where nothing moves.
    #[schema(required = true)]
    pub(crate) rod_shares: Option<Vec<f64>>,
    /// Share of each side 12, 23, 31; `null` where nothing moves.
    #[schema(required = true)]
    pub(crate) side_shares: Option<Vec<f64>>,
}

/// First-order bounds of the displacement.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BoundsDocument {
    /// Where the derivatives are taken.
    pub(crate) derivatives_at: PlaceOnWay,
    /// σ_min ‖V₃ᵀΔP‖ [m].
    pub(crate) lower_m: f64,
    /// σ_max ‖V₃ᵀΔP‖ [m].
    pub(crate) upper_m: f64,
    /// ‖∂X/∂P ΔP‖ [m].
    pub(crate) linear_m: f64,
    /// Whether the displacement lies between the bounds.
    pub(crate) held: bool,
}

/// A place on the way from level to the pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PlaceOnWay {
    /// Level.
    Start,
    /// Half way.
    Midpoint,
    /// The pose.
    End,
}

/// What can move with the virtual joints free.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct AugmentedDocument {
    /// Freedoms.
    pub(crate) mobility: usize,
    /// Independent constraints.
    pub(crate) rank: usize,
    /// Singular values of the scaled Jacobian, largest first.
    pub(crate) singular_values: Vec<f64>,
    /// Values at or below it count as zero.
    pub(crate) threshold: f64,
}

/// What can move with all virtual joints held.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MobilityDocument {
    /// Freedoms by the Kutzbach count.
    pub(crate) counted: i64,
    /// Freedoms to first order.
    pub(crate) instantaneous: usize,
    /// Freedoms for real; `null` where undecided.
    #[schema(required = true)]
    pub(crate) finite: Option<usize>,
    /// Independent constraints.
    pub(crate) rank: usize,
    /// Constraints that say nothing new.
    pub(crate) redundancy: usize,
    /// Singular values of the scaled constraint Jacobian, largest first.
    pub(crate) singular_values: Vec<f64>,
    /// Values at or below it count as zero.
    pub(crate) threshold: f64,
}

impl TiltDocument {
    pub(crate) fn new(tilt: Tilt) -> Self {
        let (about_x_rad, about_y_rad) = tilt.about_x_and_y();
        Self { yaw_rad: tilt.yaw, pitch_rad: tilt.pitch, about_x_rad, about_y_rad }
    }
}

impl From<&BrokenLimit> for BrokenLimitDocument {
    fn from(broken: &BrokenLimit) -> Self {
        let message = explain_limit(broken);
        match *broken {
            BrokenLimit::Rod { limb, length, min, max } => {
                Self { limb: Some(limb - 1), found: length, min, max, message }
            }
            BrokenLimit::Tilt { pitch, max } => {
                Self { limb: None, found: pitch, min: 0.0, max, message }
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
            twist_rad: pose.twist_about_normal(),
            virtual_joints: found.virtual_joints.to_vec(),
            sockets_m: sockets.map(|socket| Pair(socket.into())),
            displacement_m: gpr.displacement(pose, virtualization),
            characteristic_length_m: found.characteristic_length,
            solver: found.solver.into(),
            iterations: found.iterations,
            residual_m: found.residual,
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
            held: found.held,
        };
        Self {
            displacement_m: play.displacement,
            motion_m: play.motion,
            bounds: vec![
                bounds(PlaceOnWay::Start, &play.at_start),
                bounds(PlaceOnWay::Midpoint, &play.at_midpoint),
                bounds(PlaceOnWay::End, &play.at_end),
            ],
            rod_shares: play.limb_shares.clone(),
            side_shares: play.side_shares.clone(),
        }
    }
}

impl MobilityDocument {
    pub(crate) fn new(counted: i64, found: &FiniteMobility) -> Self {
        let first = &found.instantaneous;
        Self {
            counted,
            instantaneous: first.mobility,
            finite: found.mobility,
            rank: first.rank,
            redundancy: first.redundancy,
            singular_values: first.singular_values.iter().copied().collect(),
            threshold: first.threshold,
        }
    }
}
