//! Violations of limits over an interval of time.

use super::kind::{Kind, Unit};
use crate::EntityId;
use crate::program::{Phase, Place};
use crate::workcell::Cell;

/// A stretch of time in which one thing is broken without a break, within one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// What is broken.
    pub kind: Kind,
    /// Entities concerned: an axis, an effector, an effector and a zone, or two collision objects; empty for the platform.
    pub entities: Vec<EntityId>,
    /// Index of the instruction in the order of running.
    pub instruction: usize,
    /// Where that is written.
    pub place: Place,
    /// Index of the step at the worst time.
    pub step: usize,
    /// What part of the instruction that step is.
    pub phase: Phase,
    /// First time at which it is broken [s].
    pub start: f64,
    /// Last time at which it is broken [s].
    pub end: f64,
    /// SampleTime it is worst [s].
    pub worst_time: f64,
    /// The worst value, in the unit of `unit`; a distance below zero is a depth.
    pub worst: f64,
    /// What is allowed, in the unit of `unit`.
    pub limit: f64,
    /// What `worst` and `limit` count in.
    pub unit: Unit,
    /// Further facts, where there are some.
    pub detail: String,
}

impl Violation {
    /// Unit of `worst` and `limit` in SI, empty where they count nothing.
    #[must_use]
    pub fn symbol(&self) -> &'static str {
        match (self.unit, self.kind) {
            (Unit::None, _) => "",
            (Unit::Acceleration, _) => "m/s²",
            (Unit::Length, Kind::Velocity) => "m/s",
            (Unit::Length, Kind::Acceleration) => "m/s²",
            (Unit::Length, Kind::Jerk) => "m/s³",
            (Unit::Length, _) => "m",
            (Unit::Angle, Kind::Velocity) => "rad/s",
            (Unit::Angle, Kind::Acceleration) => "rad/s²",
            (Unit::Angle, Kind::Jerk) => "rad/s³",
            (Unit::Angle, _) => "rad",
        }
    }

    /// Line, times, kind and [`Self::message`] on one line.
    #[must_use]
    pub fn describe(&self, cell: &Cell) -> String {
        let (line, message) = (self.place.line, self.message(cell));
        format!("line {line}, {:.3} s to {:.3} s, {}: {message}", self.start, self.end, self.kind)
    }

    /// Message in SI units, without time and line.
    #[must_use]
    pub fn message(&self, cell: &Cell) -> String {
        let name =
            |k: usize| self.entities.get(k).map_or_else(String::new, |&one| cell.entity_name(one));
        let (unit, worst, limit) = (self.symbol(), self.worst, self.limit);
        match self.kind {
            Kind::Position => {
                format!(
                    "axis {} comes to {worst:.6} {unit}, beyond its limit of {limit:.6} {unit}",
                    name(0)
                )
            }
            Kind::Velocity => {
                format!(
                    "axis {} runs at {worst:.4} {unit}, its limit is {limit:.4} {unit}",
                    name(0)
                )
            }
            Kind::Acceleration => format!(
                "axis {} accelerates by {worst:.4} {unit}, its limit is {limit:.4} {unit}",
                name(0)
            ),
            Kind::Jerk => {
                format!(
                    "axis {} jerks by {worst:.3} {unit}, its limit is {limit:.3} {unit}",
                    name(0)
                )
            }
            Kind::Tilt => {
                format!("the platform leans by {worst:.6} rad, its limit is {limit:.6} rad")
            }
            Kind::Play => format!(
                "the virtual joints move by {worst:.3e} m, the play budget is {limit:.3e} m"
            ),
            Kind::Platform | Kind::Droop => self.detail.clone(),
            Kind::Slip if worst.is_infinite() => {
                format!("the wafer on {} lifts off what it rests on", name(0))
            }
            Kind::Slip => format!(
                "the wafer on {} slips: {worst:.3} m/s² of friction are needed to hold and turn it, there are {limit:.3} m/s²",
                name(0)
            ),
            Kind::Collision if worst < 0.0 => {
                format!("{} and {} collide, {:.6} m deep", name(0), name(1), -worst)
            }
            Kind::Collision => format!("{} and {} touch", name(0), name(1)),
            Kind::Clearance => {
                let [worst, limit] = told_apart(worst, limit);
                format!(
                    "{} comes within {worst} m of {}, {limit} m are asked for",
                    name(0),
                    name(1)
                )
            }
            Kind::SlotClearance => {
                let [worst, limit] = told_apart(worst, limit);
                format!(
                    "{} comes within {worst} m of {}, the slots ask for {limit} m",
                    name(0),
                    name(1)
                )
            }
            Kind::KeepOut if worst < 0.0 => {
                format!("{} is in keep-out zone {}, {:.6} m deep", name(0), name(1), -worst)
            }
            Kind::KeepOut => format!("{} touches keep-out zone {}", name(0), name(1)),
            Kind::SafeZone => format!(
                "the wafer centre of {} is {worst:.6} m outside safe zone {} while the robot turns",
                name(0),
                name(1)
            ),
        }
    }
}

/// Two lengths in m with six decimals, or with as many more as they need to differ.
fn told_apart(one: f64, other: f64) -> [String; 2] {
    let with = |decimals: usize| [one, other].map(|length| format!("{length:.decimals$}"));
    (6..12).map(with).find(|[one, other]| one != other).unwrap_or_else(|| with(12))
}
