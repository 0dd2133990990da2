//! Where a mechanism would have to have play.

use jointplay_core::mechanism::{Mechanism, Suggestion, Suggestions, VirtualMotion};

/// What `suggest` answers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SuggestReport {
    /// The mechanism.
    pub name: String,
    /// Names of the commanded coordinates.
    pub commanded: Vec<String>,
    /// Values that they were commanded to, an entry for each command, in the units of the file.
    pub commands: Vec<Vec<f64>>,
    /// Whether any play is needed at all.
    pub play_needed: bool,
    /// Places and directions that were considered.
    pub candidates: usize,
    /// Sets that were compared.
    pub sets_compared: usize,
    /// Whether the search stopped at its limit.
    pub cut_short: bool,
    /// Sets of virtual joints, least displacement first; none holds another that is enough.
    pub sets: Vec<SetReport>,
}

/// One set of virtual joints.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SetReport {
    /// Largest displacement over the commands, turns weighed by the characteristic length [mm].
    pub size_mm: f64,
    /// Whether the same motion stands at every joint of the same kind and place.
    pub symmetric: bool,
    /// Its virtual joints.
    pub virtual_joints: Vec<SuggestedJoint>,
}

/// One virtual joint of a set.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SuggestedJoint {
    /// What it is, in words.
    pub name: String,
    /// The joint that would have it.
    pub joint: String,
    /// `slide` or `turn`.
    pub motion: &'static str,
    /// Its direction in the frame of the link that carries it.
    pub direction: [f64; 3],
    /// How far it goes at most over the commands: µm for a slide, mrad for a turn.
    pub largest: f64,
    /// `um` or `mrad`.
    pub unit: &'static str,
}

/// Reports suggestions.
///
/// # Arguments
/// * `commands` – in the units of the file
#[must_use]
pub fn suggestions(
    mechanism: &Mechanism,
    commanded: Vec<String>,
    commands: Vec<Vec<f64>>,
    found: &Suggestions,
) -> SuggestReport {
    SuggestReport {
        name: mechanism.name().to_owned(),
        commanded,
        commands,
        play_needed: found.needed,
        candidates: found.candidates,
        sets_compared: found.compared,
        cut_short: found.cut_short,
        sets: found.sets.iter().map(|set| set_report(mechanism, set)).collect(),
    }
}

fn set_report(mechanism: &Mechanism, set: &Suggestion) -> SetReport {
    let joints = set.virtual_joints.iter().zip(&set.largest);
    SetReport {
        size_mm: set.size * 1e3,
        symmetric: set.symmetric,
        virtual_joints: joints
            .map(|(joint, largest)| {
                let (motion, direction, scale, unit) = match joint.motion {
                    VirtualMotion::Slide(direction) => ("slide", direction, 1e6, "um"),
                    VirtualMotion::Turn { axis, .. } => ("turn", axis, 1e3, "mrad"),
                };
                SuggestedJoint {
                    name: joint.name.clone(),
                    joint: mechanism.joints()[joint.joint].name.clone(),
                    motion,
                    direction: (*direction.as_ref()).into(),
                    largest: largest * scale,
                    unit,
                }
            })
            .collect(),
    }
}
