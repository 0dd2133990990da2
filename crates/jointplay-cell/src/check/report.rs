//! What a check finds.

use std::fmt;

use crate::program::{Phase, Place};

/// What a motion may break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// An axis is beyond its least or largest position.
    Position,
    /// An axis is too fast.
    Velocity,
    /// An axis accelerates too much.
    Acceleration,
    /// The acceleration of an axis changes too fast.
    Jerk,
    /// The platform leans too far.
    Tilt,
    /// The virtual joints move further than the mechanism has play for.
    Play,
    /// The platform cannot be placed over its rods.
    Platform,
    /// Nothing is known of how the arm droops there.
    Droop,
    /// A wafer slips on its effector.
    Slip,
    /// Two bodies touch.
    Collision,
    /// Two bodies come too near.
    Clearance,
    /// A wafer, or what carries one, comes too near to the wafers of a station it reaches into.
    SlotClearance,
    /// A body is where none may be.
    KeepOut,
    /// A wafer's centre leaves the zone it has to stay in while the robot turns.
    SafeZone,
}

/// What a number counts in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Metres, or a derivative of them by time.
    Length,
    /// Radians, or a derivative of them by time.
    Angle,
    /// Accelerations [m/s²].
    Acceleration,
    /// Nothing: the number says no more than that something is broken.
    None,
}

/// A stretch of time in which one thing is broken without a break, within one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// What is broken.
    pub kind: Kind,
    /// What it is about: an axis, an effector, a body and another.
    pub names: Vec<String>,
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
    /// When it is worst [s].
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

/// Whether a motion may be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is broken.
    Sound,
    /// Something is.
    Broken,
}

/// How near a limit something comes, as a share of it: above 1 it is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Of which axis, effector or body, as an index into what is asked about.
    pub of: usize,
    /// Largest share.
    pub share: f64,
    /// When [s].
    pub time: f64,
}

/// How near two bodies come.
#[derive(Debug, Clone, PartialEq)]
pub struct PairDistance {
    /// Names of both.
    pub names: [String; 2],
    /// Least distance found at a sample [m].
    pub distance: f64,
    /// How much less it may have been at samples that were passed over [m].
    pub within: f64,
    /// When [s].
    pub time: f64,
    /// Index of the step then.
    pub step: usize,
}

/// What is known of one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct InstructionRow {
    /// Its index in the order of running.
    pub instruction: usize,
    /// Where it is written.
    pub place: Place,
    /// Indices of its steps.
    pub steps: std::ops::Range<usize>,
    /// When it starts [s].
    pub start: f64,
    /// How long it takes [s].
    pub duration: f64,
    /// How long each axis moves in it [s].
    pub moving: Vec<f64>,
    /// Axis that comes nearest to its speed limit.
    pub velocity: Option<Share>,
    /// Axis that comes nearest to its acceleration limit.
    pub acceleration: Option<Share>,
    /// Axis that comes nearest to its jerk limit.
    pub jerk: Option<Share>,
    /// Share of the tilt limit.
    pub tilt: f64,
    /// Share of the play budget.
    pub play: f64,
    /// Effector whose wafer comes nearest to slipping, by index among all effectors; other samples may have had as much as 0.0001 more, unless it slips.
    pub slip: Option<Share>,
    /// The two bodies that come nearest; `None` where all stay farther than distances are followed.
    pub nearest: Option<PairDistance>,
    /// How many violations begin in it.
    pub violations: usize,
}

/// What a check finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Whether the motion may be run.
    pub verdict: Verdict,
    /// All that is broken, by time.
    pub violations: Vec<Violation>,
    /// A row for each instruction.
    pub by_instruction: Vec<InstructionRow>,
    /// How near bodies come, nearest first; pairs that stay farther than distances are followed are left out.
    pub distances: Vec<PairDistance>,
    /// How long each axis moves [s].
    pub moving: Vec<f64>,
    /// How long the motion takes [s].
    pub duration: f64,
    /// Different wafers that are laid into a slot.
    pub wafers: usize,
    /// Wafers an hour where the program is repeated: those wafers by the duration; `None` where there are none.
    pub wafers_per_hour: Option<f64>,
    /// Samples that were looked at.
    pub samples: usize,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position limit",
            Self::Velocity => "speed limit",
            Self::Acceleration => "acceleration limit",
            Self::Jerk => "jerk limit",
            Self::Tilt => "tilt limit",
            Self::Play => "play budget",
            Self::Platform => "platform",
            Self::Droop => "droop",
            Self::Slip => "slip",
            Self::Collision => "collision",
            Self::Clearance => "clearance",
            Self::SlotClearance => "slot clearance",
            Self::KeepOut => "keep-out zone",
            Self::SafeZone => "safe zone",
        })
    }
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

    /// What is wrong, without its time and line.
    #[must_use]
    pub fn message(&self) -> String {
        let name = |k: usize| self.names.get(k).map_or("", String::as_str);
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

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "line {}, {:.3} s to {:.3} s, {}: {}",
            self.place.line,
            self.start,
            self.end,
            self.kind,
            self.message()
        )
    }
}
