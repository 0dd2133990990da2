//! Kinds of violations.

use std::fmt;

/// Kinds of violations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ViolationKind {
    /// The position of an axis is out of its range.
    Position,
    /// The velocity of an axis exceeds its limit.
    Velocity,
    /// The acceleration of an axis exceeds its limit.
    Acceleration,
    /// The jerk of an axis exceeds its limit.
    Jerk,
    /// The tilt of the platform exceeds its limit.
    Tilt,
    /// The displacement of the virtual joints exceeds the play budget.
    Play,
    /// The pose of the platform is unknown.
    Platform,
    /// The droop of an arm is unknown at this reach.
    Droop,
    /// A held wafer slips.
    Slip,
    /// Two collision objects touch or penetrate.
    Collision,
    /// Two collision objects violate their clearance.
    Clearance,
    /// An end effector or its wafer violates the slot clearance of a station.
    SlotClearance,
    /// The plane of a wafer may deviate from that of its station by more than the plane budget, [`Cell::plane_threshold`](crate::workcell::Cell::plane_threshold).
    PlaneBudget,
    /// A collision object is in a keep-out zone.
    KeepOut,
    /// The centre of an end effector leaves a safe zone while the robot turns.
    SafeZone,
    /// A wafer stays at a station for longer than allowed.
    LongDwell,
    /// A wafer leaves a station earlier than allowed.
    ShortDwell,
    /// A wafer is left at the end of the program in a station that limits its stay.
    LeftInStation,
    /// The visits of a wafer violate a rule: one is missing, too late or too many.
    VisitRule,
}

/// Quantity of the value and limit of a violation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViolationQuantity {
    /// Length, or one of its time derivatives.
    Length,
    /// Angle, or one of its time derivatives.
    Angle,
    /// Specific force: force per mass (m/s²).
    SpecificForce,
    /// Time (s).
    Time,
    /// No value.
    None,
}

impl ViolationKind {
    /// Kind that represents the cause: contacts and clearances of a pair have one cause.
    pub(super) fn cause(self) -> Self {
        match self {
            Self::Clearance | Self::SlotClearance => Self::Collision,
            kind => kind,
        }
    }

    /// Rank by severity, 0 for the most severe: unknown poses, contacts, zones, clearances, slip, rules for wafers, other limits.
    #[must_use]
    pub fn severity_rank(self) -> u8 {
        match self {
            Self::Platform | Self::Droop => 0,
            Self::Collision => 1,
            Self::KeepOut => 2,
            Self::Clearance | Self::SlotClearance | Self::SafeZone => 3,
            Self::Slip => 4,
            Self::LongDwell | Self::LeftInStation | Self::ShortDwell | Self::VisitRule => 5,
            _ => 6,
        }
    }
}

impl fmt::Display for ViolationKind {
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
            Self::PlaneBudget => "plane budget",
            Self::KeepOut => "keep-out zone",
            Self::SafeZone => "safe zone",
            Self::LongDwell => "long dwell",
            Self::ShortDwell => "short dwell",
            Self::LeftInStation => "wafer left in station",
            Self::VisitRule => "visit rule",
        })
    }
}
