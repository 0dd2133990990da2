//! Options of trajectories.

/// Options of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryOptions {
    /// Largest distance of a wafer's centre from a Cartesian line (m).
    pub max_line_deviation: f64,
}

impl Default for TrajectoryOptions {
    fn default() -> Self {
        Self { max_line_deviation: 1e-6 }
    }
}
