//! Droop and sag of wafers at hand-offs: what is compensated, and what remains.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::{Handoff, Step};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::wafer::Deflection;
use crate::workcell::Cell;

/// A wafer on its effector, relative to the resting plane of a slot.
///
/// ```text
///    picked:  after the stroke has lifted it, above the plane
///    placed:  at rest, in the plane
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandoffDeflection {
    /// Index of the step at whose end the wafer changes hands.
    pub step: usize,
    /// The effector.
    pub effector: EffectorId,
    /// The slot.
    pub slot: SlotId,
    /// Deflection of the arm, compensated except for the residuals.
    pub deflection: Deflection,
    /// Height of the wafer's mean plane over its supports by its own sag, negative below them; compensated (m).
    pub sag: f64,
    /// Distance of the mean plane's centre from its target (m).
    pub position_residual: f64,
    /// Angle between the mean plane and the slot (rad).
    pub tilt_residual: f64,
    /// Root mean square distance of the wafer from its mean plane, which no tilt of the platform compensates (m).
    pub rms_flatness: f64,
    /// Distance by which the effector moves as the arm takes the wafer's weight or gives it up (m).
    pub load_displacement: f64,
}

/// Deflections of all hand-offs of a program, in order; those of arms whose droop is not known there are omitted.
#[must_use]
pub fn handoff_deflections(cell: &Cell, steps: &[Step]) -> Vec<HandoffDeflection> {
    let mut sags = BTreeMap::new();
    let of = |(step, it): (usize, &Step)| {
        let (effector, slot, at, lift) = match it.handoff? {
            Handoff::Placed(effector, slot) => (effector, slot, &it.to, 0.0),
            Handoff::Picked(effector, slot) => {
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
        let load_displacement = loaded?.translation.vector - empty?.translation.vector;
        let center = rest.translation.vector + normal * sag.plane_height;
        let target = slot_frame.translation.vector + wanted * lift;
        Some(HandoffDeflection {
            step,
            effector,
            slot,
            deflection,
            sag: sag.plane_height,
            position_residual: (center - target).norm(),
            tilt_residual: normal.cross(&wanted).norm().atan2(normal.dot(&wanted)),
            rms_flatness: sag.deviation,
            load_displacement: load_displacement.norm(),
        })
    };
    steps.iter().enumerate().filter_map(of).collect()
}
