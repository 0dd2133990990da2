//! Violations of limits over an interval of time.

use super::kind::{ViolationKind, ViolationQuantity};
use crate::EntityId;
use crate::program::{Phase, SourceLocation};
use crate::workcell::Cell;

/// Violation of one limit over an interval of time, within one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// Kind of the violation.
    pub kind: ViolationKind,
    /// Entities concerned: an axis, an effector, an effector and a zone, two collision objects, or a wafer and a station; empty for the platform.
    pub entities: Vec<EntityId>,
    /// Index of the instruction in the order of execution.
    pub instruction: usize,
    /// Location of the instruction in the program text.
    pub place: SourceLocation,
    /// Index of the step at the worst time.
    pub step: usize,
    /// Phase of that step.
    pub phase: Phase,
    /// Start of the interval (s).
    pub start: f64,
    /// End of the interval (s).
    pub end: f64,
    /// Time of the worst value (s).
    pub worst_time: f64,
    /// Worst value in SI units; a negative distance is a penetration depth.
    pub worst: f64,
    /// Limit in SI units; of a collision the required clearance.
    pub limit: f64,
    /// Quantity of `worst` and `limit`.
    pub quantity: ViolationQuantity,
    /// Reason, where a pose is unknown or a visit rule is violated.
    pub detail: String,
}

impl Violation {
    /// Symbol of the SI unit of `worst` and `limit`; empty where they have no value.
    #[must_use]
    pub fn symbol(&self) -> &'static str {
        match (self.quantity, self.kind) {
            (ViolationQuantity::None, _) => "",
            (ViolationQuantity::SpecificForce, _) => "m/s²",
            (ViolationQuantity::Time, _) => "s",
            (ViolationQuantity::Length, ViolationKind::Velocity) => "m/s",
            (ViolationQuantity::Length, ViolationKind::Acceleration) => "m/s²",
            (ViolationQuantity::Length, ViolationKind::Jerk) => "m/s³",
            (ViolationQuantity::Length, _) => "m",
            (ViolationQuantity::Angle, ViolationKind::Velocity) => "rad/s",
            (ViolationQuantity::Angle, ViolationKind::Acceleration) => "rad/s²",
            (ViolationQuantity::Angle, ViolationKind::Jerk) => "rad/s³",
            (ViolationQuantity::Angle, _) => "rad",
        }
    }

    /// Line, phase, times, kind and [`Self::message`] on one line.
    #[must_use]
    pub fn describe(&self, cell: &Cell) -> String {
        let (line, phase, message) = (self.place.line, self.phase, self.message(cell));
        let (start, end, kind) = (self.start, self.end, self.kind);
        format!("line {line}, {phase}, {start:.3} s to {end:.3} s, {kind}: {message}")
    }

    /// Message in SI units, without time and line.
    #[must_use]
    pub fn message(&self, cell: &Cell) -> String {
        let name =
            |k: usize| self.entities.get(k).map_or_else(String::new, |&one| cell.entity_name(one));
        let (unit, worst, limit) = (self.symbol(), self.worst, self.limit);
        match self.kind {
            ViolationKind::Position => {
                format!(
                    "axis {} reaches {worst:.6} {unit}, its limit is {limit:.6} {unit}",
                    name(0)
                )
            }
            ViolationKind::Velocity => {
                format!(
                    "axis {} moves at {worst:.4} {unit}, its limit is {limit:.4} {unit}",
                    name(0)
                )
            }
            ViolationKind::Acceleration => format!(
                "axis {} accelerates at {worst:.4} {unit}, its limit is {limit:.4} {unit}",
                name(0)
            ),
            ViolationKind::Jerk => {
                format!(
                    "axis {} has a jerk of {worst:.3} {unit}, its limit is {limit:.3} {unit}",
                    name(0)
                )
            }
            ViolationKind::Tilt => {
                format!("the platform tilts by {worst:.6} rad, its limit is {limit:.6} rad")
            }
            ViolationKind::Play => format!(
                "the virtual joints are displaced by {worst:.3e} m, the play budget is {limit:.3e} m"
            ),
            ViolationKind::Platform | ViolationKind::Droop | ViolationKind::VisitRule => {
                self.detail.clone()
            }
            ViolationKind::Slip if worst.is_infinite() => {
                format!("the wafer on {} lifts off its supports", name(0))
            }
            ViolationKind::Slip => format!(
                "the wafer on {} slips: it requires friction of {worst:.3} m/s², available are {limit:.3} m/s²",
                name(0)
            ),
            ViolationKind::Collision if worst < 0.0 => {
                format!(
                    "{} and {} collide with a penetration depth of {:.6} m",
                    name(0),
                    name(1),
                    -worst
                )
            }
            ViolationKind::Collision => format!("{} and {} touch", name(0), name(1)),
            ViolationKind::Clearance => {
                let [worst, limit] = distinguishable(worst, limit);
                format!(
                    "{} comes within {worst} m of {}; the required clearance is {limit} m",
                    name(0),
                    name(1)
                )
            }
            ViolationKind::SlotClearance => {
                let [worst, limit] = distinguishable(worst, limit);
                format!(
                    "{} comes within {worst} m of {}; the required slot clearance is {limit} m",
                    name(0),
                    name(1)
                )
            }
            ViolationKind::PlaneBudget => format!(
                "the plane of the wafer on {} may deviate by {worst:.3e} rad from that of {}, with the uncertainty of the station; {limit:.3e} rad are allowed",
                name(0),
                name(1)
            ),
            ViolationKind::KeepOut if worst < 0.0 => {
                format!(
                    "{} is in keep-out zone {} with a penetration depth of {:.6} m",
                    name(0),
                    name(1),
                    -worst
                )
            }
            ViolationKind::KeepOut => format!("{} touches keep-out zone {}", name(0), name(1)),
            ViolationKind::LongDwell => format!(
                "{} dwells in {} for {worst:.3} s, allowed are {limit:.3} s",
                name(0),
                name(1)
            ),
            ViolationKind::ShortDwell => format!(
                "{} dwells in {} for {worst:.3} s, required are {limit:.3} s",
                name(0),
                name(1)
            ),
            ViolationKind::LeftInStation => format!(
                "{} is left in {} at the end, where it may stay for {limit:.3} s",
                name(0),
                name(1)
            ),
            ViolationKind::SafeZone => format!(
                "the wafer centre of {} is {worst:.6} m outside safe zone {} while the robot rotates",
                name(0),
                name(1)
            ),
        }
    }
}

/// Two lengths with six decimals, or with as many as they need to differ (m).
fn distinguishable(one: f64, other: f64) -> [String; 2] {
    let with = |decimals: usize| [one, other].map(|length| format!("{length:.decimals$}"));
    (6..12).map(with).find(|[one, other]| one != other).unwrap_or_else(|| with(12))
}
