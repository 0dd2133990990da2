//! Frames of all wafers during a motion.

use jointplay_cell::program::{LocationChange, WaferLocation, WaferLocations};
use jointplay_cell::robot::ChainPose;
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;

use super::error::Error;
use super::motion_export::MotionExport;
use super::samples::{loaded, placed};

/// Wafer frame in the frame of its location.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WaferFrame {
    /// Slot or effector that supports the wafer.
    pub(super) location: WaferLocation,
    /// Wafer frame in the base frame for a slot, in the wafer frame of the effector for an effector.
    pub(super) pose: Pose,
}

impl WaferFrame {
    /// Frame of a wafer before the first step.
    pub(super) fn at_start(cell: &Cell, locations: &WaferLocations, wafer: usize) -> Self {
        let location = locations.stays(wafer)[0].location;
        let pose = match location {
            WaferLocation::Slot(slot) => cell.stations[slot.station].slot_frame(slot.slot),
            WaferLocation::Effector(_) => Pose::identity(),
        };
        Self { location, pose }
    }

    /// Wafer frame in the base frame at a pose of the robot.
    pub(super) fn base_from_wafer(&self, pose: &ChainPose) -> Pose {
        match self.location {
            WaferLocation::Slot(_) => self.pose,
            WaferLocation::Effector(id) => pose.base_from_wafer[id.arm][id.effector] * self.pose,
        }
    }
}

/// Frames of all wafers at one time of a motion.
pub(super) struct WaferFrames<'a> {
    motion_export: &'a MotionExport<'a>,
    /// Locations during the whole motion.
    pub(super) locations: WaferLocations,
    /// By wafer.
    pub(super) frames: Vec<WaferFrame>,
    /// Index of the next change of a location.
    next: usize,
}

impl<'a> WaferFrames<'a> {
    /// Frames at the start.
    pub(super) fn new(motion_export: &'a MotionExport<'a>) -> Self {
        let cell = motion_export.cell;
        let locations = WaferLocations::of_steps(cell, &motion_export.motion.steps);
        let frame = |wafer| WaferFrame::at_start(cell, &locations, wafer);
        let frames = locations.wafers().map(frame).collect();
        Self { motion_export, locations, frames, next: 0 }
    }

    /// Applies all changes of locations until a time (s).
    pub(super) fn advance_to(&mut self, time: f64) -> Result<(), Error> {
        let times = &self.motion_export.motion.times;
        let changes = self.locations.location_changes();
        let until = changes.partition_point(|change| times[change.step + 1] <= time);
        while self.next < until {
            self.apply_next()?;
        }
        Ok(())
    }

    /// Applies the next change of a location: the wafer then moves with its new location, from exactly where it is.
    pub(super) fn apply_next(&mut self) -> Result<Option<LocationChange>, Error> {
        let Some(&change) = self.locations.location_changes().get(self.next) else {
            return Ok(None);
        };
        self.next += 1;
        let (motion_export, step) = (self.motion_export, change.step);
        let time = motion_export.motion.times[step + 1];
        let sample = motion_export.motion.sample_at(time);
        // Until then the arm deflects as in the step that ends.
        let pose = placed(motion_export, time, &sample.positions, loaded(motion_export, step))?;
        let base_from_wafer = self.frames[change.wafer].base_from_wafer(&pose);
        let pose = match change.to {
            WaferLocation::Slot(_) => base_from_wafer,
            WaferLocation::Effector(id) => {
                pose.base_from_wafer[id.arm][id.effector].inverse() * base_from_wafer
            }
        };
        self.frames[change.wafer] = WaferFrame { location: change.to, pose };
        Ok(Some(change))
    }
}
