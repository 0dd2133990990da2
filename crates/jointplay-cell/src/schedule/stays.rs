//! Stays of wafers with their times.

use crate::program::{WaferLocation, WaferLocations, WaferStay};
use crate::trajectory::Trajectory;

/// Stay of a wafer in a slot or on an effector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedStay {
    /// Index of the wafer, as in [`WaferLocations`].
    pub wafer: usize,
    /// The location, with the steps at whose ends the wafer arrives and leaves.
    pub stay: WaferStay,
    /// Start: arrival, or start of the program (s).
    pub start: f64,
    /// End: departure, or end of the program (s).
    pub end: f64,
}

impl TimedStay {
    /// Length of the stay (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.end - self.start
    }

    /// Index of the station; `None` on an effector.
    #[must_use]
    pub fn station(&self) -> Option<usize> {
        self.stay.location.slot().map(|slot| slot.station)
    }

    /// Whether the program has placed or picked the wafer here.
    #[must_use]
    pub fn is_touched(&self) -> bool {
        self.stay.arrival_step.is_some() || self.stay.departure_step.is_some()
    }

    /// The location.
    #[must_use]
    pub fn location(&self) -> WaferLocation {
        self.stay.location
    }
}

/// Stays of all wafers, by wafer and in the order of time.
#[must_use]
pub fn timed_stays(trajectory: &Trajectory, locations: &WaferLocations) -> Vec<TimedStay> {
    let end_of = |step: usize| trajectory.times[step + 1];
    let timed = |wafer: usize, stay: &WaferStay| TimedStay {
        wafer,
        stay: *stay,
        start: stay.arrival_step.map_or(0.0, end_of),
        end: stay.departure_step.map_or(trajectory.duration(), end_of),
    };
    let of_wafer = |wafer: usize| locations.stays(wafer).iter().map(move |stay| timed(wafer, stay));
    locations.wafers().flat_map(of_wafer).collect()
}
