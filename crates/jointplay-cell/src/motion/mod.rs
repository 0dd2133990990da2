//! Steps in time.

use crate::program::Step;

/// All axes at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Since the start [s].
    pub time: f64,
    /// Index of the step.
    pub step: usize,
    /// Of each axis [m or rad].
    pub positions: Vec<f64>,
    /// Of each axis [m/s or rad/s].
    pub velocities: Vec<f64>,
    /// Of each axis [m/s² or rad/s²].
    pub accelerations: Vec<f64>,
}

/// Steps with their times.
#[derive(Debug, Clone)]
pub struct Motion {
    /// In order.
    pub steps: Vec<Step>,
    /// Start of each step, and the end of the last [s].
    pub times: Vec<f64>,
}
