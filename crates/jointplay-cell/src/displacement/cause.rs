//! Causes of a displacement of a wafer, and what is known about them.

/// Cause of a displacement of a wafer, or of its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// Rotation of the wafer about the intersection of the platform plane with the base axis: lever times tilt.
    Lever,
    /// Position of the platform in its plane, which the virtualization determines.
    PlatformModel,
    /// Droop of the loaded arm.
    Droop,
    /// Sag of the wafer between its supports.
    Sag,
    /// Distance from the slot that compensation leaves.
    Compensation,
    /// Resolution of the axes.
    AxisResolution,
    /// Tolerances of rods, guides and sockets.
    PlatformTolerances,
    /// Tolerances of mounts, links and joint zeros of the arm.
    ArmTolerances,
    /// Uncertainty of the station's frame: taught or stated.
    Station,
}

/// Basis of a contribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Geometry and mechanics of known bodies.
    Physics,
    /// An assumption about play that kinematics cannot decide.
    Model,
    /// Statistics of measurements.
    Measurement,
    /// Largest deviations of dimensions and positions.
    Tolerance,
}

impl Cause {
    /// Basis of the contribution.
    #[must_use]
    pub fn basis(self) -> Basis {
        match self {
            Self::Lever | Self::Droop | Self::Sag | Self::Compensation => Basis::Physics,
            Self::PlatformModel => Basis::Model,
            Self::Station => Basis::Measurement,
            Self::AxisResolution | Self::PlatformTolerances | Self::ArmTolerances => {
                Basis::Tolerance
            }
        }
    }
}
