//! Simple bodies of a mechanism, for viewers that draw them themselves.

use jointplay_core::mechanism::Mechanism;
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use super::joint_points::{BAR, JOINT, bars, drawn_points, joint_points, size};

/// Bars that draw the links, with sizes that fit the mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismShapes {
    /// Half of the largest extent of the joints (m).
    pub size: f64,
    /// Radius of a bar (m).
    pub bar_radius: f64,
    /// Radius of a joint (m).
    pub joint_radius: f64,
    /// Ends of the bars of each link, in its frame (m).
    pub bars: Vec<Vec<[Vector3<f64>; 2]>>,
}

impl MechanismShapes {
    /// The shapes of a mechanism, those of its 3D scenes for other viewers.
    ///
    /// # Arguments
    /// * `poses` – of the links, in a configuration that determines the sizes (m)
    #[must_use]
    pub fn of(mechanism: &Mechanism, poses: &[Pose]) -> Self {
        let points = joint_points(mechanism);
        let size = size(&points, poses);
        let points = drawn_points(mechanism, points, size);
        let bars: Vec<_> = points.iter().map(|points| bars(points, JOINT * size)).collect();
        // Joints of many short links would cover them.
        let thickness = size.min(LARGEST_JOINT / JOINT * median_length(&bars));
        Self { size, bar_radius: BAR * thickness, joint_radius: JOINT * thickness, bars }
    }
}

/// Largest radius of a joint, in median lengths of bars.
const LARGEST_JOINT: f64 = 0.13;

/// Median length of the bars (m); infinite without bars.
fn median_length(bars: &[Vec<[Vector3<f64>; 2]>]) -> f64 {
    let mut lengths: Vec<f64> =
        bars.iter().flatten().map(|[from, to]| (to - from).norm()).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(f64::INFINITY)
}
