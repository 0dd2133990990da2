//! Description of a station.

use std::f64::consts::FRAC_PI_2;

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

use super::teach::{CarrierAxis, FrameUncertainty, TaughtFrame};
use crate::robot::EffectorId;

/// Direction in which a wafer enters a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Approach {
    /// Along the line from the axis of the arm's first joint through the slot, as an arm extends.
    Radial,
    /// Along the y axis of the station frame.
    Line,
}

/// A place for wafers: load port, aligner, process station.
///
/// Its frame has the origin at the nominal resting position in the lowest slot, before [`offset`](Self::offset): the centre of the wafer's lower face; z is normal to that face, y points inward.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Name in programs.
    pub name: String,
    /// Frame of the station.
    pub base_from_station: Pose,
    /// Source of the frame.
    pub origin: Origin,
    /// Uncertainty of the frame.
    pub uncertainty: FrameUncertainty,
    /// Number of slots, from the lowest.
    pub slots: usize,
    /// Distance between slots along z of the station frame (m); without meaning for one slot.
    pub pitch: f64,
    /// Displacement of each slot against the slot below, along x and y of the station frame, in addition to the pitch (m).
    pub slot_step: [f64; 2],
    /// Heights at which the effector passes below and above the resting plane, along z of the station frame (m).
    pub stroke: Stroke,
    /// Offset of all resting positions, in the station frame (m): the wafer in the lowest slot rests at this offset from the origin.
    pub offset: [f64; 3],
    /// Distance of the wafer centre from the axis of the arm's first joint, in the plane of the slot, at which the arm counts as retracted for this station (m).
    pub retract_reach: f64,
    /// Via points: wafer centres in the order from the retracted pose to the slot, in the frame of the slot (m).
    pub via: Vec<[f64; 3]>,
    /// Approach.
    pub approach: Approach,
    /// Effectors that may use it.
    pub effectors: Vec<EffectorId>,
    /// Process time: how long the station works on a wafer before it may be picked (s).
    pub process_time: f64,
}

impl Station {
    /// Frame of the station if a wafer in one of its slots had this pose, its heading inward.
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

    /// Origin of the station if the centre of a wafer in one of its slots were here, the tilt and heading of the frame unchanged, in the base frame (m).
    #[must_use]
    pub fn origin_under(&self, slot: usize, center: &Vector3<f64>) -> Vector3<f64> {
        let offset =
            self.slot_frame(slot).translation.vector - self.base_from_station.translation.vector;
        center - offset
    }
}

/// Source of a station's frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// Nominal, from the drawing.
    Nominal,
    /// Fitted to taught points; the parts that they do not determine are nominal.
    Taught(Box<TaughtFrame>),
    /// Positions of the first and the last slot.
    CarrierAxis(CarrierAxis),
}

/// Stroke of a hand-off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Distance below the resting plane at which an empty effector enters (m).
    pub below: f64,
    /// Distance above the resting plane at which a loaded effector leaves (m).
    pub above: f64,
    /// Speed of lifting and lowering (m/s).
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
