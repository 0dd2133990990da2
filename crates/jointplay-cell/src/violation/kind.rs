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
    /// A collision object is in a keep-out zone.
    KeepOut,
    /// The centre of an end effector leaves a safe zone while the robot turns.
    SafeZone,
}

/// Quantity of the value and limit of a violation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViolationQuantity {
    /// Length, or one of its derivatives by time.
    Length,
    /// Angle, or one of its derivatives by time.
    Angle,
    /// Specific force (m/s²).
    Acceleration,
    /// No value.
    None,
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
            Self::KeepOut => "keep-out zone",
            Self::SafeZone => "safe zone",
        })
    }
}
