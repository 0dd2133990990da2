//! Stations: places for wafers, the poses in front of and in their slots, and their frames from taught points.

mod cache_key;
mod description;
mod leveling;
mod margin;
mod postures;
mod rules;
pub mod teach;
mod validate;
mod waypoints;

pub use description::{Approach, Origin, SlotId, Station, Stroke};
pub use postures::{InfeasibleLine, LineRemedy};
pub(crate) use postures::{LinePoint, PostureOptions, StationPostures};
pub use rules::{DwellLimits, VisitRule, WaferRules};
pub use validate::MAX_SLOTS;
pub use waypoints::Waypoints;
