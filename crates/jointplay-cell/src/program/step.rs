//! Steps: elementary moves and dwells of all axes.

use std::fmt;
use std::sync::Arc;

use super::SourceLocation;
use crate::robot::{EffectorId, PosturePath};
use crate::station::SlotId;

/// Path of the axes in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// Point to point: each axis with its own profile, all of them ending together.
    PointToPoint,
    /// A straight line of this effector's wafer centre, its plane rotating uniformly.
    Line(EffectorId),
    /// A dwell (s).
    Dwell(f64),
    /// A dwell until a station has processed its wafer; without duration where it has already.
    ProcessDwell {
        /// Index of the step at whose end the wafer was placed.
        placed_at_step: usize,
        /// Process time of the station (s).
        seconds: f64,
    },
}

/// Part of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Axes to given positions.
    Move,
    /// Retract arms that are extended.
    RetractArms,
    /// Change the posture of an arm that keeps its wafer retracted, where a turn would take the wafer outward.
    PostureChange,
    /// Turn toward the station, retracted and level.
    Turn,
    /// Move the rods to the height and tilt in front of the slot.
    Align,
    /// Extend into the station.
    Extend,
    /// Lift by the stroke: first to the wafer, then with it.
    Lift,
    /// Lower by the stroke: first with the wafer, then without.
    Lower,
    /// Retract from the station.
    Retract,
    /// Level the platform.
    Level,
    /// Dwell.
    Wait,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Phase {
    /// Name, as in exports and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::RetractArms => "retract arms",
            Self::PostureChange => "posture change",
            Self::Turn => "turn",
            Self::Align => "align",
            Self::Extend => "extend",
            Self::Lift => "lift",
            Self::Lower => "lower",
            Self::Retract => "retract",
            Self::Level => "level",
            Self::Wait => "wait",
        }
    }

    /// Whether the robot moves between stations with retracted arms: safe zones apply.
    #[must_use]
    pub fn is_in_safe_zones(self) -> bool {
        matches!(self, Self::PostureChange | Self::Turn)
    }
}

/// Hand-off of a wafer at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handoff {
    /// The effector has lifted to the resting plane, and carries the wafer of the slot from then on.
    Picked(EffectorId, SlotId),
    /// The wafer has been lowered to the resting plane, and is in the slot from then on.
    Placed(EffectorId, SlotId),
}

/// Postures that a redundant arm takes along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePostures {
    /// Positions of the arm's motors along the whole line into a station.
    pub path: Arc<PosturePath>,
    /// Fractions of that line at which the step starts and ends.
    pub fractions: [f64; 2],
    /// Whether the line prescribes the wafer's heading, which then changes uniformly; otherwise it follows from the postures.
    pub prescribes_heading: bool,
}

/// A move or dwell of all axes, with all names resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Index of the instruction in the order of execution.
    pub instruction: usize,
    /// Location of the instruction in the text.
    pub place: SourceLocation,
    /// Part of the instruction.
    pub phase: Phase,
    /// Positions of all axes at its start (m or rad).
    pub from: Vec<f64>,
    /// Positions of all axes at its end (m or rad).
    pub to: Vec<f64>,
    /// Path between them.
    pub path: Path,
    /// Factor of the limits of velocity, acceleration and jerk, above 0 and at most 1.
    pub speed_scaling: f64,
    /// Largest distance of a wafer's centre from the unblended path where this step is blended with a neighbour that allows as much; 0 brings all axes to rest (m).
    pub blend_radius: f64,
    /// Postures along a line; `None` where the positions on the line are those nearest to linear interpolation of the axes between `from` and `to`.
    pub postures: Option<LinePostures>,
    /// Largest speed of the wafer's centre along a line (m/s); `None` where only the axes limit it.
    pub line_speed: Option<f64>,
    /// Effectors that carry a wafer during the step.
    pub loaded: Vec<EffectorId>,
    /// Hand-off at the end of the step.
    pub handoff: Option<Handoff>,
    /// Slot that the effector reaches into: the step then needs the slot clearances of this station.
    pub slot: Option<SlotId>,
}
