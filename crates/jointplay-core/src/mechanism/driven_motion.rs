//! The motion of a mechanism along a path of its drives.

use nalgebra::DVector;

/// A configuration on the path.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Share of the path that is done, 0 to 1.
    pub share: f64,
    /// (f + M) coordinates (m, rad).
    pub coordinates: DVector<f64>,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Instantaneous mobility with the drives held.
    pub free_mobility: usize,
    /// The least singular value that the start has, as a share of the largest: tends to zero at a singular configuration.
    pub least_singular_value: f64,
}

/// A configuration on the path where constraints become dependent.
#[derive(Debug, Clone, PartialEq)]
pub struct SingularConfiguration {
    /// Share of the path that is done there, 0 to 1.
    pub share: f64,
    /// (f + M) coordinates (m, rad).
    pub coordinates: DVector<f64>,
    /// Instantaneous mobility there, drives free.
    pub instantaneous_mobility: usize,
    /// The least singular value found there, as a share of the largest.
    pub least_singular_value: f64,
    /// How many branches of the motion meet there: 1 where no branches cross, `None` where second order does not decide.
    pub branches: Option<usize>,
    /// Whether the drives reverse on the only branch, as at a dead point, or continue; `None` where several branches meet, or it is not decided.
    pub drives_reverse: Option<bool>,
}

/// Why a motion stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The drives cannot go on: a dead point, where the motion would turn back; the last waypoint is that point.
    Locked,
    /// The start is singular, and no branch was found that leads on from it.
    SingularStart {
        /// Instantaneous mobility there with the drives held.
        free_mobility: usize,
    },
    /// The loops do not stay closed: the drives pull against each other or against redundant constraints.
    Incompatible,
    /// The loops can be closed, but the least displacement of virtual joints, or the configuration nearest home, was not found.
    NotLeast,
    /// A joint coordinate would have to leave its limits.
    BeyondLimits {
        /// Index of the coordinate.
        coordinate: usize,
    },
}

/// A motion up to its end, or to where it stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenMotion {
    /// One configuration for each step asked for, the start first.
    pub waypoints: Vec<Waypoint>,
    /// Singular configurations on the path.
    pub singular: Vec<SingularConfiguration>,
    /// Why it stopped before its end; `None` if it did not.
    pub stopped: Option<Stop>,
    /// Steps done, the shortened ones among them.
    pub steps: usize,
}
