//! Kinds of violations.

use std::fmt;

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
