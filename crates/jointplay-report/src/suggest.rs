//! Report on suggested virtual joints.

use jointplay_core::mechanism::{Suggestion, Suggestions, VirtualMotion};
use nalgebra::DVector;

use crate::beyond::beyond_limits;
use crate::limits::LimitReport;
use crate::mechanism::{ByName, by_name};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;

/// Result of `suggest`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SuggestReport {
    /// Name of the mechanism.
    pub name: String,
    /// Names of the commanded coordinates.
    pub commanded: Vec<String>,
    /// Commanded values, one entry per command, in the units of the file.
    pub commands: Vec<Vec<f64>>,
    /// Whether the commands require play.
    pub play_needed: bool,
    /// Whether the mechanism has no loops, so that no command can require play.
    pub open_chain: bool,
    /// Joint coordinates for each command, in the units of the file, if no play is required.
    pub without_play: Vec<ByName<f64>>,
    /// Joint coordinates that exceed their limits in these configurations.
    pub limits_broken: Vec<LimitReport>,
    /// Number of candidate joints and directions.
    pub candidates: usize,
    /// Number of compared sets.
    pub sets_compared: usize,
    /// Whether the search stopped at its limit.
    pub cut_short: bool,
    /// Number of sets that may be possible but were not evaluated with the whole kinematics.
    pub sets_untried: usize,
    /// Sufficient sets of virtual joints, those within joint limits first, then by the least displacement; no set contains another.
    pub sets: Vec<SetReport>,
}

/// One set of virtual joints.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SetReport {
    /// Largest displacement over the commands, with rotations multiplied by the characteristic length (mm).
    pub size_mm: f64,
    /// Whether every symmetry of the mechanism maps the set onto itself; `false` without symmetries.
    pub symmetric: bool,
    /// Its virtual joints.
    pub virtual_joints: Vec<SuggestedJoint>,
    /// Joint coordinates for each command, in the units of the file.
    pub configurations: Vec<ByName<f64>>,
    /// Joint coordinates that exceed their limits for a command.
    pub limits_broken: Vec<LimitReport>,
}

/// One virtual joint of a set.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SuggestedJoint {
    /// Description of the virtual joint.
    pub name: String,
    /// Name of the joint that receives the play.
    pub joint: String,
    /// `slide` or `turn`.
    pub motion: &'static str,
    /// Direction in the frame of the link that carries the virtual joint.
    pub direction: [f64; 3],
    /// Largest displacement over the commands: µm for a slide, mrad for a turn.
    pub largest: f64,
    /// `um` or `mrad`.
    pub unit: &'static str,
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
        open_chain: mechanism.loops() == 0,
        without_play: named(&found.without_play),
        limits_broken: beyond_limits(&coordinates, &found.beyond_limits),
        candidates: found.candidates,
        sets_compared: found.compared,
        cut_short: found.cut_short,
        sets_untried: found.untried,
        sets: found.sets.iter().map(|set| set_report(file, &coordinates, set)).collect(),
    }
}

fn set_report(file: &MechanismFile, coordinates: &Coordinates, set: &Suggestion) -> SetReport {
    let joints = set.virtual_joints.iter().zip(&set.largest);
    SetReport {
        size_mm: set.size * 1e3,
        symmetric: set.symmetric,
        configurations: set.configurations.iter().map(|at| by_name(coordinates, at)).collect(),
        limits_broken: beyond_limits(coordinates, &set.beyond_limits),
        virtual_joints: joints
            .map(|(joint, largest)| {
                let (motion, direction, scale, unit) = match joint.motion {
                    VirtualMotion::Slide(direction) => ("slide", direction, 1e6, "um"),
                    VirtualMotion::Turn { axis, .. } => ("turn", axis, 1e3, "mrad"),
                };
                SuggestedJoint {
                    name: joint.name.clone(),
                    joint: file.mechanism.joints()[joint.joint].name.clone(),
                    motion,
                    direction: (*direction.as_ref()).into(),
                    largest: largest * scale,
                    unit,
                }
            })
            .collect(),
    }
}
