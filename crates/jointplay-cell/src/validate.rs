//! Conditions that the description of a cell has to fulfil.

use std::collections::BTreeSet;

use crate::CellError;
use crate::conditions::{count, in_range, index, not_negative, pose, positive, unique};
use crate::robot::RobotPart;
use crate::station::SlotId;
use crate::workcell::{Body, Cell, ParentFrame, Zone};

/// Largest number of bodies, and of zones: all pairs are checked for collisions.
pub const MAX_BODIES: usize = 400;

/// Largest coverage factor.
pub const MAX_COVERAGE_FACTOR: f64 = 6.0;

/// Largest required clearance, slot clearance and gravitational acceleration, in SI units.
const MAX_VALUE: f64 = 1e9;

/// Part of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellPart {
    /// The cell as a whole: name, budgets, gravity.
    Cell,
    /// A part of the robot.
    Robot(RobotPart),
    /// The wafer.
    Wafer,
    /// A station, by index.
    Station(usize),
    /// A body, by index.
    Body(usize),
    /// A zone, by index.
    Zone(usize),
    /// A pair of bodies that may touch, by index.
    AllowedPair(usize),
    /// A slot with a wafer at the start, by index in [`Cell::occupied`].
    Occupied(usize),
    /// An effector with a wafer at the start, by index in [`Cell::loaded_effectors`].
    LoadedEffector(usize),
    /// The rules for the stays and visits of wafers.
    Rules,
}

/// A part of a cell that violates a condition.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct InvalidPart {
    /// The part.
    pub part: CellPart,
    /// The violated condition.
    pub error: CellError,
}

impl Cell {
    /// Checks the conditions that all other functions of a cell assume: names are unique, numbers finite and in range, indices exist, shapes have a volume, the wafer is a thin plate, and the platform can follow each station.
    ///
    /// # Errors
    /// The first violated condition of each part.
    pub fn validate(&self) -> Result<(), Vec<InvalidPart>> {
        let mut invalid = Vec::new();
        let mut add = |part, checked: Result<(), CellError>| {
            invalid.extend(checked.err().map(|error| InvalidPart { part, error }));
        };
        add(CellPart::Cell, self.check_budgets());
        let robot = self.robot.check();
        let is_robot_valid = robot.is_ok();
        if let Err((part, error)) = robot {
            add(CellPart::Robot(part), Err(*error));
        }
        add(CellPart::Wafer, self.wafer.validate());
        let names = unique("stations", self.stations.iter().map(|station| &station.name));
        if let Err((station, error)) = names {
            add(CellPart::Station(station), Err(error));
        }
        let names = unique("bodies", self.bodies.iter().map(|body| &body.name));
        if let Err((body, error)) = names {
            add(CellPart::Body(body), Err(error));
        }
        let names = unique("zones", self.zones.iter().map(|zone| &zone.name));
        if let Err((zone, error)) = names {
            add(CellPart::Zone(zone), Err(error));
        }
        if is_robot_valid {
            for (index, station) in self.stations.iter().enumerate() {
                add(CellPart::Station(index), station.validate(&self.robot));
            }
            let mut known = BTreeSet::new();
            for (index, &id) in self.loaded_effectors.iter().enumerate() {
                let checked = self.robot.check_effector(id).and_then(|()| {
                    let location = || format!("effector {}", self.effector_name(id));
                    once(known.insert(id), location)
                });
                add(CellPart::LoadedEffector(index), checked);
            }
            for (index, body) in self.bodies.iter().enumerate() {
                add(CellPart::Body(index), self.check_body(body));
            }
        }
        for (index, zone) in self.zones.iter().enumerate() {
            add(CellPart::Zone(index), check_zone(zone));
        }
        for (number, pair) in self.allowed_pairs.iter().enumerate() {
            let exists = |&body| index("an allowed pair", "body", body, self.bodies.len());
            add(CellPart::AllowedPair(number), pair.iter().try_for_each(exists));
        }
        add(CellPart::Rules, self.rules.validate(self.stations.len()));
        let mut known = BTreeSet::new();
        for (index, &slot) in self.occupied.iter().enumerate() {
            let checked = self.check_slot(slot).and_then(|()| {
                let station = || &self.stations[slot.station].name;
                once(known.insert(slot), || format!("slot {} of {}", slot.slot, station()))
            });
            add(CellPart::Occupied(index), checked);
        }
        if invalid.is_empty() { Ok(()) } else { Err(invalid) }
    }

    fn check_budgets(&self) -> Result<(), CellError> {
        if self.name.trim().is_empty() {
            return Err(CellError::NoName { what: "the cell".to_owned() });
        }
        count("bodies", self.bodies.len(), 0, MAX_BODIES)?;
        count("zones", self.zones.len(), 0, MAX_BODIES)?;
        positive("the play budget".to_owned(), self.play_budget, "m")?;
        positive("the plane threshold".to_owned(), self.plane_threshold, "rad")?;
        in_range(
            "the coverage factor".to_owned(),
            self.coverage_factor,
            0.0,
            MAX_COVERAGE_FACTOR,
            "",
        )?;
        for (what, value, unit) in [
            ("the clearance", self.clearance, "m"),
            ("the slot clearance", self.slot_clearance, "m"),
            ("the gravitational acceleration", self.gravity, "m/s²"),
        ] {
            not_negative(what.to_owned(), value, unit)?;
            in_range(what.to_owned(), value, 0.0, MAX_VALUE, unit)?;
        }
        Ok(())
    }

    fn check_slot(&self, SlotId { station, slot }: SlotId) -> Result<(), CellError> {
        let slots = self.stations.get(station).map_or(0, |station| station.slots);
        if (1..=slots).contains(&slot) {
            return Ok(());
        }
        Err(CellError::NoSuchSlot { station, slot })
    }

    fn check_body(&self, body: &Body) -> Result<(), CellError> {
        let of = format!("body {}", body.name);
        if let ParentFrame::Link { arm, link } = body.parent {
            index(&of, "arm", arm, self.robot.arms.len())?;
            index(&of, "link", link, self.robot.arms[arm].joints.len())?;
        }
        if let Some(station) = body.station {
            index(&of, "station", station, self.stations.len())?;
        }
        pose(&of, &body.parent_from_shape)?;
        body.shape.validate()
    }
}

fn check_zone(zone: &Zone) -> Result<(), CellError> {
    pose(&format!("zone {}", zone.name), &zone.base_from_shape)?;
    zone.shape.validate()
}

fn once(is_first: bool, location: impl FnOnce() -> String) -> Result<(), CellError> {
    if is_first { Ok(()) } else { Err(CellError::SeveralWafers { location: location() }) }
}
