//! How carried wafers lie over their slots: what of droop and sag is made up for, and what is left.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::{Handover, Step};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::wafer::Deflection;
use crate::workcell::Cell;

/// A wafer on its effector, by the resting plane of a slot.
///
/// ```text
///    fetched:    where the stroke has lifted it to, above the plane
///    laid down:  where it comes to rest, in the plane
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandoverDeflection {
    /// Index of the step at whose end it changes hands.
    pub step: usize,
    /// What carries it.
    pub effector: EffectorId,
    /// The slot.
    pub slot: SlotId,
    /// How the arm droops under it, all of which is made up for but what is left.
    pub deflection: Deflection,
    /// Height of its mean plane over its supports by its own sag, negative below them; made up for, too [m].
    pub sag: f64,
    /// Distance of its mean plane's centre from where it should be [m].
    pub left: f64,
    /// Angle of its mean plane to that of the slot [rad].
    pub left_tilt: f64,
    /// What no platform removes: root of the mean square of its distance from its own mean plane [m].
    pub bent: f64,
    /// Distance by which the effector moves as the arm takes the wafer's weight or gives it up, at once as far as poses are concerned [m].
    pub jump: f64,
}

/// All wafers of a program as they change hands, in order; those of arms whose droop is not known there are left out.
#[must_use]
pub fn handover_deflections(cell: &Cell, steps: &[Step]) -> Vec<HandoverDeflection> {
    let mut sags = BTreeMap::new();
    let of = |(step, it): (usize, &Step)| {
        let (effector, slot, at, lift) = match it.handover? {
            Handover::Placed(effector, slot) => (effector, slot, &it.to, 0.0),
            Handover::Picked(effector, slot) => {
                let above = cell.stations[slot.station].stroke.above;
                (effector, slot, &steps.get(step + 1)?.to, above)
            }
        };
        let sag = sags.entry(effector).or_insert_with(|| cell.sag(effector).ok());
        let sag = sag.as_ref()?;
        let (rest, deflection) = cell.wafer_pose_and_deflection(effector, at, true).ok()?;
        let slot_frame = cell.stations[slot.station].slot_frame(slot.slot);
        let (normal, wanted) = (rest.rotation * Vector3::z(), slot_frame.rotation * Vector3::z());
        let [loaded, empty] =
            [true, false].map(|loaded| cell.wafer_pose(effector, &it.to, loaded).ok());
        let jump = loaded?.translation.vector - empty?.translation.vector;
        let center = rest.translation.vector + normal * sag.plane_height;
        let place = slot_frame.translation.vector + wanted * lift;
        Some(HandoverDeflection {
            step,
            effector,
            slot,
            deflection,
            sag: sag.plane_height,
            left: (center - place).norm(),
            left_tilt: normal.cross(&wanted).norm().atan2(normal.dot(&wanted)),
            bent: sag.deviation,
            jump: jump.norm(),
        })
    };
    steps.iter().enumerate().filter_map(of).collect()
}
