//! What a program comes to: motions of all axes, one after the other.

use super::Place;
use crate::robot::EffectorId;
use crate::station::SlotId;

/// How axes go from one position to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// Each axis on its own way, all in the same time.
    PointToPoint,
    /// The wafer centre of this effector on a straight line, its plane turning evenly.
    Line(EffectorId),
    /// Standing still [s].
    Dwell(f64),
    /// Standing still until a station is done with its wafer; not at all where it is done already.
    ProcessDwell {
        /// Index of the step at whose end the wafer was left there.
        since: usize,
        /// How long the station works on it from then on [s].
        seconds: f64,
    },
}

/// What part of an instruction a step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Axes to where they were told.
    Move,
    /// Arms in, where they were not.
    TuckIn,
    /// Turn toward the station, retracted and level.
    Turn,
    /// To the height and the tilt of entering.
    Enter,
    /// Out into the station.
    Extend,
    /// Up by the stroke: first to the wafer, then with it.
    Lift,
    /// Down by the stroke: first with the wafer, then without.
    Lower,
    /// Out of the station.
    Retract,
    /// The platform level again.
    Level,
    /// Standing still.
    Wait,
}

/// What happens to wafers at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handover {
    /// The effector has come to the resting plane, and the wafer of the slot is on it from then on.
    Picked(EffectorId, SlotId),
    /// The wafer has come to the resting plane, and is in the slot from then on.
    Placed(EffectorId, SlotId),
}

/// One motion of all axes from one place to the next, with everything resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Index of the instruction in the order of running.
    pub instruction: usize,
    /// Where that instruction is written.
    pub place: Place,
    /// What part of it this is.
    pub phase: Phase,
    /// Positions of all axes at its start [m and rad].
    pub from: Vec<f64>,
    /// Positions of all axes at its end [m and rad].
    pub to: Vec<f64>,
    /// The way between.
    pub path: Path,
    /// Share of the limits, 0 to 1.
    pub speed: f64,
    /// How far a wafer's centre may stray from the way without blending where this step runs into one that allows as much; 0 brings all axes to rest [m].
    pub blend: f64,
    /// Largest speed of the wafer centre along a line [m/s], where the step has one.
    pub line_speed: Option<f64>,
    /// Effectors that carry a wafer during the step.
    pub loaded: Vec<EffectorId>,
    /// What happens to wafers at its end.
    pub handover: Option<Handover>,
    /// Slot that is reached into, whose own bodies and wafers are near by intent.
    pub slot: Option<SlotId>,
}
