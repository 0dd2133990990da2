//! Documents of the view of mechanisms: the mechanism, its configurations, its analyses.

use std::collections::BTreeMap;

use jointplay::report::{
    FirstBeyondReport, LimitReport, MechanismMobilityReport, SingularReport, SparseMobilityReport,
    SuggestReport,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::Triple;
use super::pose::PlacedDocument;

/// A mechanism as text.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MechanismSource {
    /// Text of a mechanism or three-rod robot file (TOML), or of a model of another program (MJCF, SDF, URDF).
    pub(crate) text: String,
    /// Text of the file that closes the loops of a model (TOML or YAML).
    #[serde(default)]
    pub(crate) loops: Option<String>,
    /// Values of parameters in place of those of the file, in its units.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) parameters: BTreeMap<String, f64>,
}

/// Request of a mechanism with its configuration.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpenRequest {
    /// The mechanism.
    pub(crate) mechanism: MechanismSource,
    /// Coordinates near which the loops are closed (m, rad); without them, or if that fails, the guess of the file.
    #[serde(default)]
    pub(crate) from: Option<Vec<f64>>,
    /// Play scale of the poses.
    #[serde(default = "one")]
    #[schema(required = false, minimum = 1, maximum = 1e9)]
    pub(crate) play_scale: f64,
}

/// Request of a motion of some joints.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DriveRequest {
    /// The mechanism.
    pub(crate) mechanism: MechanismSource,
    /// Coordinates of the closed configuration where the motion begins (m, rad).
    pub(crate) from: Vec<f64>,
    /// Values of driven joint coordinates by name: expressions in the units of the file, such as `30`, `1/3` or `2 mm`. They move together in a straight line; other actuated joints are held.
    pub(crate) to: BTreeMap<String, String>,
    /// Play scale of the poses.
    #[serde(default = "one")]
    #[schema(required = false, minimum = 1, maximum = 1e9)]
    pub(crate) play_scale: f64,
}

/// Request of an analysis of a configuration.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConfigurationRequest {
    /// The mechanism.
    pub(crate) mechanism: MechanismSource,
    /// Coordinates of a closed configuration (m, rad).
    pub(crate) coordinates: Vec<f64>,
    /// Play scale of the poses.
    #[serde(default = "one")]
    #[schema(required = false, minimum = 1, maximum = 1e9)]
    pub(crate) play_scale: f64,
}

fn one() -> f64 {
    1.0
}

/// Kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FileKindName {
    /// A mechanism file.
    Mechanism,
    /// A model of another program.
    Model,
    /// A three-rod robot.
    ThreeRods,
    /// A robot with arms.
    Arms,
    /// A work cell.
    Cell,
    /// A study.
    Study,
    /// Loops that close a model.
    Loops,
    /// A program of a work cell.
    Program,
    /// A text that declares no known kind.
    Unknown,
}

/// An opened text.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct OpenedDocument {
    /// What the text is.
    pub(crate) kind: FileKindName,
    /// What was converted or ignored, or how a file of another kind is opened.
    #[schema(required = true)]
    pub(crate) note: Option<String>,
    /// Text of the mechanism as a mechanism file: the given one, or the converted model or robot.
    pub(crate) text: String,
    /// Errors of the text; the mechanism is `null` if there are any.
    pub(crate) diagnostics: Vec<MechanismDiagnostic>,
    /// The mechanism; `null` for files of other kinds and with errors.
    #[schema(required = true)]
    pub(crate) mechanism: Option<MechanismDocument>,
}

/// An error in a text, with its position.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismDiagnostic {
    /// Whether it is in the file of loops instead of the model.
    pub(crate) in_loops: bool,
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column, from 1.
    pub(crate) column: usize,
    /// Number of characters.
    pub(crate) width: usize,
    /// The error.
    pub(crate) message: String,
}

/// A mechanism: links, joints, coordinates, and shapes to draw it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismDocument {
    /// Name of the mechanism.
    pub(crate) name: String,
    /// Source of the mechanism, from its file.
    #[schema(required = true)]
    pub(crate) source: Option<String>,
    /// Unit of lengths of the file.
    pub(crate) length_unit: &'static str,
    /// Unit of angles of the file.
    pub(crate) angle_unit: &'static str,
    /// Links; the first is the base.
    pub(crate) links: Vec<LinkDocument>,
    /// Joints.
    pub(crate) joints: Vec<MechanismJoint>,
    /// Virtual joints.
    pub(crate) virtual_joints: Vec<VirtualJointDocument>,
    /// Coordinates of the joints, then of the virtual joints.
    pub(crate) coordinates: Vec<CoordinateInfo>,
    /// Parameters of the file with their values.
    pub(crate) parameters: Vec<MechanismParameter>,
    /// Half of the largest extent (m).
    pub(crate) size_m: f64,
    /// Unit vector to the viewer in the view that separates the joints best, in the frame of the base.
    #[schema(required = true)]
    pub(crate) view_direction: Option<Triple>,
    /// Radius of the bars of links (m).
    pub(crate) bar_radius_m: f64,
    /// Radius of joints (m).
    pub(crate) joint_radius_m: f64,
    /// The closed configuration; `null` if the loops cannot be closed.
    #[schema(required = true)]
    pub(crate) configuration: Option<ConfigurationDocument>,
    /// Why the loops cannot be closed.
    #[schema(required = true)]
    pub(crate) problem: Option<String>,
}

/// A link.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct LinkDocument {
    /// Name of the link.
    pub(crate) name: String,
    /// Bars that draw the link, in its frame.
    pub(crate) bars: Vec<BarDocument>,
}

/// A bar between two points.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BarDocument {
    /// One end (m).
    pub(crate) from_m: Triple,
    /// The other end (m).
    pub(crate) to_m: Triple,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismJoint {
    /// Name of the joint.
    pub(crate) name: String,
    /// Kind, as in files.
    pub(crate) kind: &'static str,
    /// Indices of its links.
    pub(crate) links: [usize; 2],
    /// The joint frame in the frame of each link; the z axis is the axis of the joint.
    #[schema(min_items = 2, max_items = 2)]
    pub(crate) frames: [PlacedDocument; 2],
    /// Whether a motor drives it.
    pub(crate) actuated: bool,
}

/// A virtual joint.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct VirtualJointDocument {
    /// Name of the virtual joint.
    pub(crate) name: String,
    /// Index of the joint that has it.
    pub(crate) joint: usize,
    /// Index of the link that carries it.
    pub(crate) link: usize,
    /// `slide` or `turn`.
    pub(crate) motion: &'static str,
    /// Its direction, in the frame of the link that carries it.
    pub(crate) direction: Triple,
}

/// A coordinate of a joint or virtual joint.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CoordinateInfo {
    /// Name of the joint, with an index if it has several freedoms.
    pub(crate) name: String,
    /// Name of the joint or virtual joint.
    pub(crate) joint: String,
    /// Unit of its values.
    pub(crate) unit: &'static str,
    /// Digits after the decimal point that are of interest.
    pub(crate) decimals: usize,
    /// Whether a motor drives it.
    pub(crate) actuated: bool,
    /// Whether it is that of a virtual joint.
    pub(crate) virtual_joint: bool,
    /// Least and greatest allowed value, in `unit`: limits of the joint, or the clearance of the virtual joint; `null` at an end without limit.
    #[schema(required = true, min_items = 2, max_items = 2)]
    pub(crate) limits: Option<[Option<f64>; 2]>,
    /// Range of a slider, in `unit`: the limits, or a half turn or one size to the side of the configuration where there is none.
    #[schema(required = true, min_items = 2, max_items = 2)]
    pub(crate) range: Option<[f64; 2]>,
}

/// A parameter of a file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismParameter {
    /// Its name.
    pub(crate) name: String,
    /// Its value, in the units of the file.
    pub(crate) value: f64,
}

/// A closed configuration with the poses of the links.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ConfigurationDocument {
    /// Coordinates from which motions continue (m, rad).
    pub(crate) coordinates: Vec<f64>,
    /// The same coordinates in the units of the file.
    pub(crate) values: Vec<f64>,
    /// Poses of the links in the frame of the base, with exaggerated play.
    pub(crate) poses: Vec<PlacedDocument>,
    /// Largest closure residual of a loop, in radians and characteristic lengths.
    pub(crate) residual: f64,
    /// Whether virtual joints are displaced.
    pub(crate) displaced: bool,
    /// Coordinates beyond their limits or clearances.
    pub(crate) limits_broken: Vec<LimitReport>,
    /// How the configuration differs from the requested one; `null` if it does not.
    #[schema(required = true)]
    pub(crate) note: Option<String>,
}

/// A motion of some joints up to its end, or to where it stopped.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct DriveDocument {
    /// The last configuration.
    pub(crate) configuration: ConfigurationDocument,
    /// `locked`, `singular_start` or `incompatible`; `null` if the motion is complete.
    #[schema(required = true)]
    pub(crate) stopped: Option<&'static str>,
    /// Why and where it stopped.
    #[schema(required = true)]
    pub(crate) message: Option<String>,
    /// Singular configurations during the motion.
    pub(crate) singular: Vec<SingularReport>,
    /// The first configuration beyond limits or clearances.
    #[schema(required = true)]
    pub(crate) first_beyond_limits: Option<FirstBeyondReport>,
    /// Actuated joint coordinates that were held.
    pub(crate) held: Vec<String>,
}

/// Request to move a point of a link.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReachRequest {
    /// The mechanism.
    pub(crate) mechanism: MechanismSource,
    /// Coordinates of the closed configuration where the motion begins (m, rad).
    pub(crate) from: Vec<f64>,
    /// Name of the link.
    pub(crate) link: String,
    /// The point, in the frame of the link (m).
    pub(crate) point_m: Triple,
    /// The wanted position, in the frame of the base (m); without it, nothing moves.
    #[serde(default)]
    pub(crate) to_m: Option<Triple>,
    /// Whether the wanted position is that of the point as drawn, with exaggerated play.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) as_drawn: bool,
    /// Play scale of the poses.
    #[serde(default = "one")]
    #[schema(required = false, minimum = 1, maximum = 1e9)]
    pub(crate) play_scale: f64,
}

/// The reachable configuration in which a point is nearest to a wanted position.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ReachedDocument {
    /// The configuration.
    pub(crate) configuration: ConfigurationDocument,
    /// Position of the point, without exaggerated play (m).
    pub(crate) position_m: Triple,
    /// Distance of the point from the wanted position (m).
    pub(crate) distance_m: f64,
    /// Joint coordinates whose limits keep the point from being nearer.
    pub(crate) at_limits: Vec<String>,
    /// The same distance and limits as text; `null` if the position is reached.
    #[schema(required = true)]
    pub(crate) message: Option<String>,
}

/// Request of a motion of one joint as a file.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MechanismExportRequest {
    /// The mechanism.
    pub(crate) mechanism: MechanismSource,
    /// Coordinates of the closed configuration before the motion (m, rad); without them, that of the file.
    #[serde(default)]
    pub(crate) at: Option<Vec<f64>>,
    /// Name of the driven joint coordinate.
    pub(crate) drive: String,
    /// Its value at the start: an expression in the units of the file. The joint is driven there first.
    pub(crate) from: String,
    /// Its value at the end.
    pub(crate) to: String,
    /// Number of steps.
    #[serde(default = "default_steps")]
    #[schema(required = false, default = 60, minimum = 1, maximum = 20000)]
    pub(crate) steps: usize,
    /// Format of the file.
    pub(crate) format: MechanismExportFormat,
    /// Factor of the displacements of virtual joints in scenes.
    #[serde(default = "one")]
    #[schema(required = false, minimum = 1, maximum = 1e9)]
    pub(crate) play_scale: f64,
}

/// Format of a motion of a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MechanismExportFormat {
    /// All coordinates at each step as comma-separated values, as from `jointplay move --to csv`.
    Csv,
    /// Animated 3D scene of 4 s as binary glTF, as from `jointplay move --to gltf`.
    Gltf,
}

fn default_steps() -> usize {
    jointplay::mechanism::DEFAULT_STEPS
}

/// The mobility of a mechanism.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MobilityOfMechanism {
    /// By dense algebra; `null` for a mechanism with many loops.
    #[schema(required = true)]
    pub(crate) dense: Option<MechanismMobilityReport>,
    /// By sparse algebra, without the quantities that need dense matrices; `null` for other mechanisms.
    #[schema(required = true)]
    pub(crate) sparse: Option<SparseMobilityReport>,
}

/// The mechanism that this server was started with.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismFileDocument {
    /// Name of the file or catalogue entry.
    pub(crate) name: String,
    /// Whether it can be saved: it is a mechanism file on disk.
    pub(crate) writable: bool,
    /// Its text.
    pub(crate) text: String,
    /// Text of the file that closes the loops of a model.
    #[schema(required = true)]
    pub(crate) loops: Option<String>,
    /// Hash of the text.
    pub(crate) version: String,
}

/// Text of a mechanism file to save.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveMechanismRequest {
    /// The text.
    pub(crate) text: String,
    /// Version of the text on disk that it replaces; without it, any.
    #[serde(default)]
    pub(crate) replaces: Option<String>,
}

/// An entry of the catalogue.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CatalogueEntry {
    /// Name of the entry.
    pub(crate) name: String,
    /// Name of the mechanism.
    pub(crate) title: String,
    /// Text of the file (TOML).
    pub(crate) text: String,
}

/// Request of virtual joints that make a motion possible.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SuggestRequest {
    /// The mechanism; its virtual joints are replaced.
    pub(crate) mechanism: MechanismSource,
    /// Commanded joint coordinates by name: expressions in the units of the file. Without any, each actuated joint is displaced by a small amount.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) command: BTreeMap<String, String>,
}

/// Virtual joints that make a motion possible.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct SuggestDocument {
    /// The sets of virtual joints.
    pub(crate) report: SuggestReport,
    /// Text of the mechanism file with the virtual joints of each of the first ten sets.
    pub(crate) texts: Vec<String>,
}

/// The instantaneous motions of a mechanism.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MotionsDocument {
    /// Instantaneous mobility.
    pub(crate) mobility: usize,
    /// One for each dimension of the instantaneous mobility, a basis of independent motions; of mechanisms with very many links and motions the first ones.
    pub(crate) motions: Vec<MotionDocument>,
}

/// An instantaneous motion as poses, from one side through the configuration to the other.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MotionDocument {
    /// Poses of all links at each step.
    pub(crate) steps: Vec<Vec<PlacedDocument>>,
}

/// The assembly modes of a mechanism.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct BranchesDocument {
    /// Actuated joint coordinates that have the same values in all of them.
    pub(crate) held: Vec<String>,
    /// The closed configurations, the one nearest the request first.
    pub(crate) branches: Vec<ConfigurationDocument>,
}
