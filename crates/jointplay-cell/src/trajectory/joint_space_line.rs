//! A joint-space line: a step in which all axes move in proportion, for analyses that depend on the path and not on its timing.

use std::sync::Arc;

use super::cartesian_path::CartesianPath;
use super::profile::JerkLimitedProfile;
use super::segment::Segment;
use super::segment_motion::SegmentMotion;
use super::trajectory::Trajectory;
use crate::program::Step;

/// Duration of a joint-space line for each unit of its longest displacement (s/m or s/rad).
const DURATION_BY_DISPLACEMENT: f64 = 2.0;
/// Shortest and longest duration of a joint-space line (s).
const DURATION_RANGE: [f64; 2] = [0.02, 20.0];

/// Trajectory of one step in which all axes move in proportion from start to end, from rest to rest; axis limits are ignored.
pub(crate) fn joint_space_line(step: Step) -> Trajectory {
    let displacement = |(from, to): (&f64, &f64)| (to - from).abs();
    let longest = step.from.iter().zip(&step.to).map(displacement).fold(0.0, f64::max);
    let segment = if longest == 0.0 {
        Segment::dwell(0.0)
    } else {
        let [min, max] = DURATION_RANGE;
        let quarter = 0.25 * (DURATION_BY_DISPLACEMENT * longest).clamp(min, max);
        let pieces = [(quarter, 1.0), (2.0 * quarter, -1.0), (quarter, 1.0)];
        let path = CartesianPath::joint_space_line(&step.from, &step.to);
        let parameter = JerkLimitedProfile::from_pieces(0.0, 1.0, &pieces);
        Segment::new(SegmentMotion::Line { path: Arc::new(path), parameter })
    };
    let times = vec![0.0, segment.duration()];
    Trajectory { steps: vec![step], times, segments: vec![segment], blends: vec![None] }
}
