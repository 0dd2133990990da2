//! Where wafers are put.

pub mod teach;
mod waypoints;

pub use waypoints::Waypoints;

use jointplay_core::spatial::Pose;

use crate::robot::EffectorId;

/// How a wafer enters a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Approach {
    /// Along the line from the robot's axis through the slot, as an arm extends.
    Radial,
    /// Along the y axis of the station frame, whose origin the wafer comes to.
    Line,
}

/// A place for wafers: load port, aligner, process station.
///
/// Its frame has the origin at the centre of the lowest slot's wafer, in the plane that the wafer's lower face rests on; z normal to that plane, y inward.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// What it is called in programs.
    pub name: String,
    /// Where it is.
    pub base_from_station: Pose,
    /// What is known of where it is.
    pub origin: Origin,
    /// How many slots it has, from the lowest.
    pub slots: usize,
    /// From slot to slot, along z of its frame [m]; of no meaning with one slot.
    pub pitch: f64,
    /// Where it may be entered below the resting plane, and how far above it is left; each counts along z of its frame [m].
    pub stroke: Stroke,
    /// Added to the wafer's place in the station frame [m].
    pub offset: [f64; 3],
    /// Distance of the wafer centre from the robot's axis where the arm counts as retracted for this station [m].
    pub retract_reach: f64,
    /// Wafer centres passed between retract position and station, in the station frame [m], outermost first.
    pub via: Vec<[f64; 3]>,
    /// How it is entered.
    pub approach: Approach,
    /// Effectors that may use it.
    pub effectors: Vec<EffectorId>,
    /// Seconds that it works on a wafer before giving it back [s].
    pub process_time: f64,
}

/// What a station's frame comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// As drawn.
    Nominal,
    /// The nominal place and yaw, laid into the plane of taught points.
    Taught(teach::PlaneFit),
    /// The places of the first and the last slot.
    Drift(teach::Drift),
}

/// Heights of handing over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// How far below the resting plane an empty effector enters [m].
    pub below: f64,
    /// How far above the resting plane a loaded effector leaves [m].
    pub above: f64,
    /// Speed of lifting and lowering [m/s].
    pub speed: f64,
}

/// A slot of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SlotId {
    /// Index of the station.
    pub station: usize,
    /// Counted from 1, the lowest.
    pub slot: usize,
}
