//! Report on suggested virtual joints.

use jointplay_core::constraint::CLOSURE_TOLERANCE;
use jointplay_core::mechanism::{
    Carrier, SingleCommand, Suggestion, Suggestions, VirtualJoint, VirtualMotion,
};
use nalgebra::DVector;

use crate::beyond::beyond_limits;
use crate::limits::LimitReport;
use crate::mechanism::{ByName, by_name};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;

/// Result of `suggest`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SuggestReport {
    /// Name of the mechanism.
    pub name: String,
    /// Names of the commanded coordinates.
    pub commanded: Vec<String>,
    /// Commanded values, one entry per command, in the units of the file.
    pub commands: Vec<Vec<f64>>,
    /// Whether the commands require play.
    pub play_needed: bool,
    /// Largest mismatch of the rigid links in the configuration from which the search starts, in radians and characteristic lengths, if they do not close there; every set then closes them too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub home_residual: Option<f64>,
    /// Whether the mechanism has no loops, so that no command can require play.
    pub open_chain: bool,
    /// Joint coordinates for each command, in the units of the file, if no play is required.
    #[cfg_attr(feature = "schema", schema(value_type = Vec<std::collections::BTreeMap<String, f64>>))]
    pub without_play: Vec<ByName<f64>>,
    /// Joint coordinates that exceed their limits in these configurations.
    pub limits_broken: Vec<LimitReport>,
    /// Number of candidate joints and directions.
    pub candidates: usize,
    /// Number of compared sets.
    pub sets_compared: usize,
    /// Number of sets in the class that was searched, compared or not.
    pub sets_in_class: f64,
    /// Lower bound of the displacement of any set of the candidates (mm).
    pub lower_bound_mm: f64,
    /// Lower bound of the elastic energy of any set of the candidates (mJ); `None` unless ranked by stiffness.
    pub lower_bound_mj: Option<f64>,
    /// Whether the search stopped at its limit.
    pub cut_short: bool,
    /// Number of sets that may be possible but were not evaluated with the whole kinematics.
    pub sets_untried: usize,
    /// Sufficient sets of virtual joints, those within joint limits and clearances first, then by their rank. A symmetric set contains no smaller symmetric set that is sufficient, any other set no smaller set at all.
    pub sets: Vec<SetReport>,
    /// The file with the virtual joints of one set, if it was written.
    pub written: Option<WrittenSet>,
}

/// A mechanism file with the virtual joints of one set.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct WrittenSet {
    /// Name of the file.
    pub file: String,
    /// Number of the set, from 1.
    pub set: usize,
    /// Number of virtual joints of the original file that were removed.
    pub replaced: usize,
}

/// One set of virtual joints.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SetReport {
    /// Largest displacement over the commands, with rotations multiplied by the characteristic length (mm).
    pub size_mm: f64,
    /// Largest elastic energy over the commands (mJ), which the displacement makes least; `None` unless ranked by stiffness.
    pub energy_mj: Option<f64>,
    /// Whether every symmetry of the mechanism maps the set onto itself; `false` without symmetries.
    pub symmetric: bool,
    /// Whether every symmetry of the mechanism that maps the commands onto each other maps the set onto itself; `false` without such symmetries.
    pub symmetric_for_commands: bool,
    /// Whether the configurations of all commands are within the joint limits of the file; `None` for a file without limits.
    pub within_limits: Option<bool>,
    /// Displacements of single motors to either side that the set makes possible or not; `None` if they were not computed.
    pub single_commands: Option<Vec<SingleCommandReport>>,
    /// Its virtual joints.
    pub virtual_joints: Vec<SuggestedJoint>,
    /// Joint coordinates for each command, in the units of the file.
    #[cfg_attr(feature = "schema", schema(value_type = Vec<std::collections::BTreeMap<String, f64>>))]
    pub configurations: Vec<ByName<f64>>,
    /// Joint coordinates that exceed their limits for a command.
    pub limits_broken: Vec<LimitReport>,
}

/// A displacement of one coordinate to either side of its start, with the other motors or commanded coordinates held.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SingleCommandReport {
    /// Name of the coordinate.
    pub coordinate: String,
    /// Displacement to either side, in the units of the file.
    pub by: f64,
    /// Displacement of the virtual joints (mm); `None` if the set does not make it possible.
    pub size_mm: Option<f64>,
}

/// Adds to each set the displacements of single coordinates that it makes possible.
///
/// # Arguments
/// * `single` – for each set, from the first
pub fn add_single_commands(
    report: &mut SuggestReport,
    file: &MechanismFile,
    single: &[Vec<SingleCommand>],
) {
    let coordinates = Coordinates::of(file);
    for (set, commands) in report.sets.iter_mut().zip(single) {
        let listed = commands.iter().map(|one| SingleCommandReport {
            coordinate: coordinates.all()[one.coordinate].name.clone(),
            by: coordinates.from_si(one.coordinate, one.by),
            size_mm: one.size.map(|size| size * 1e3),
        });
        set.single_commands = Some(listed.collect());
    }
}

/// One virtual joint of a set, with all that its table in a mechanism file has.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SuggestedJoint {
    /// The virtual joint.
    #[serde(flatten)]
    pub virtual_joint: SuggestedTable,
    /// Largest displacement over the commands: µm for a slide, mrad for a turn.
    pub largest: f64,
    /// `um` or `mrad`.
    pub unit: &'static str,
    /// Whether it exceeds the clearance of the joint; `None` if the file has none.
    pub exceeds_clearance: Option<bool>,
    /// Other virtual joints of the same leg that relieve the same instantaneous motion.
    pub alternatives: Vec<SuggestedTable>,
}

/// The keys of a virtual joint in a mechanism file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SuggestedTable {
    /// Description of the virtual joint.
    pub name: String,
    /// Name of the joint that receives the play.
    pub joint: String,
    /// Name of the link that carries the virtual joint, the key `on` of the file.
    pub on: String,
    /// `slide` or `turn`: the key of the direction in the file.
    pub motion: &'static str,
    /// Direction in the frame of the link that carries the virtual joint.
    pub direction: [f64; 3],
    /// For a turn, a point of its axis in the same frame, in the units of the file.
    pub about: Option<[f64; 3]>,
    /// Clearance of the joint in this direction, in the units of the file.
    pub clearance: Option<f64>,
    /// Stiffness (N/m or N m/rad); `None` unless ranked by stiffness.
    pub stiffness: Option<f64>,
}

/// Reports suggested virtual joints.
///
/// # Arguments
/// * `commands` – in the units of the file
#[must_use]
pub fn suggestions(
    file: &MechanismFile,
    commanded: Vec<String>,
    commands: Vec<Vec<f64>>,
    found: &Suggestions,
) -> SuggestReport {
    let (mechanism, coordinates) = (&file.mechanism, Coordinates::of(file));
    let named = |all: &[DVector<f64>]| all.iter().map(|at| by_name(&coordinates, at)).collect();
    SuggestReport {
        name: mechanism.name().to_owned(),
        commanded,
        commands,
        play_needed: found.needed,
        home_residual: (found.home_residual > CLOSURE_TOLERANCE).then_some(found.home_residual),
        open_chain: mechanism.constraints() == 0,
        without_play: named(&found.without_play),
        limits_broken: beyond_limits(&coordinates, &found.beyond_limits),
        candidates: found.candidates,
        sets_compared: found.compared,
        sets_in_class: found.in_class,
        lower_bound_mm: found.lower_bound * 1e3,
        lower_bound_mj: found.least_energy.map(|energy| energy * 1e3),
        cut_short: found.cut_short,
        sets_untried: found.untried,
        sets: found.sets.iter().map(|set| set_report(file, &coordinates, set)).collect(),
        written: None,
    }
}

fn set_report(file: &MechanismFile, coordinates: &Coordinates, set: &Suggestion) -> SetReport {
    let joints = set.virtual_joints.iter().zip(&set.largest).zip(&set.alternatives);
    let has_limits = file.mechanism.joints().iter().any(|joint| !joint.limits.is_empty());
    SetReport {
        size_mm: set.size * 1e3,
        energy_mj: set.energy.map(|energy| energy * 1e3),
        symmetric: set.symmetric,
        symmetric_for_commands: set.symmetric_for_commands,
        within_limits: has_limits.then_some(set.beyond_limits.is_empty()),
        single_commands: None,
        configurations: set.configurations.iter().map(|at| by_name(coordinates, at)).collect(),
        limits_broken: beyond_limits(coordinates, &set.beyond_limits),
        virtual_joints: joints
            .map(|((joint, largest), alternatives)| {
                let (scale, unit) = match joint.motion {
                    VirtualMotion::Slide(_) => (1e6, "um"),
                    VirtualMotion::Turn { .. } => (1e3, "mrad"),
                };
                SuggestedJoint {
                    virtual_joint: table(file, joint),
                    largest: largest * scale,
                    exceeds_clearance: joint.clearance.map(|most| *largest > most),
                    unit,
                    alternatives: alternatives.iter().map(|one| table(file, one)).collect(),
                }
            })
            .collect(),
    }
}

/// The keys of a virtual joint in the file.
fn table(file: &MechanismFile, joint: &VirtualJoint) -> SuggestedTable {
    let units = file.units;
    let (motion, direction, about) = match joint.motion {
        VirtualMotion::Slide(direction) => ("slide", direction, None),
        VirtualMotion::Turn { axis, point } => {
            ("turn", axis, Some(point.map(|x| units.length.from_meters(x)).into()))
        }
    };
    let side = usize::from(joint.carrier == Carrier::Second);
    let at = &file.mechanism.joints()[joint.joint];
    SuggestedTable {
        name: joint.name.clone(),
        joint: at.name.clone(),
        on: file.mechanism.links()[at.links[side]].clone(),
        motion,
        direction: (*direction.as_ref()).into(),
        about,
        clearance: joint.clearance.map(|value| units.of_motion(joint.motion, value)),
        stiffness: joint.stiffness,
    }
}
