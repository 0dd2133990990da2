//! Description of a station.

use std::f64::consts::FRAC_PI_2;

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

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

impl Station {
    /// The frame that the station would have if a wafer lay in one of its slots like this, headed inward.
    ///
    /// ```text
    ///    base_from_station  =  base_from_wafer · wafer_from_slot · slot_from_station      wafer's x along y of the slot
    /// ```
    #[must_use]
    pub fn taught_by(&self, slot: usize, base_from_wafer: &Pose) -> Pose {
        let inward = Rotation3::from_axis_angle(&Vector3::z_axis(), -FRAC_PI_2);
        let station_from_slot = self.base_from_station.inverse() * self.slot_frame(slot);
        base_from_wafer * inward * station_from_slot.inverse()
    }

    /// Where the origin of the station would be if a wafer's centre lay in one of its slots here, its lean and yaw as they are, in the base frame [m].
    #[must_use]
    pub fn origin_under(&self, slot: usize, center: &Vector3<f64>) -> Vector3<f64> {
        let beside =
            self.slot_frame(slot).translation.vector - self.base_from_station.translation.vector;
        center - beside
    }
}

/// What a station's frame comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// As drawn.
    Nominal,
    /// The nominal place and yaw, laid into the plane of taught points.
    Taught(super::teach::PlaneFit),
    /// The places of the first and the last slot.
    Drift(super::teach::Drift),
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
