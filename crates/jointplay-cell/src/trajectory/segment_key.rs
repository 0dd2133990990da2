//! Fingerprints of segments.

use crate::incremental::{Key, extend};
use crate::program::{Path, Step};
use crate::workcell::Cell;

use super::options::TrajectoryOptions;

/// Fingerprint of what all segments of a trajectory depend on: numbers are printed in full, so that different inputs have different texts.
pub(super) fn shared_key(cell: &Cell, options: &TrajectoryOptions) -> String {
    format!("{:?} {:?} {:?} {:?}", cell.robot, cell.wafer, cell.gravity, options.line_deviation)
}

/// Fingerprint of what the segment of a moving step depends on besides.
pub(super) fn segment_key(step: &Step) -> Key {
    let mut key = match step.path {
        Path::Line(effector) => vec![1, effector.arm as u64, effector.effector as u64],
        _ => vec![0],
    };
    extend(&mut key, &step.from);
    extend(&mut key, &step.to);
    extend(&mut key, &[step.speed, step.line_speed.unwrap_or(f64::INFINITY)]);
    key.extend(step.loaded.iter().flat_map(|id| [id.arm as u64, id.effector as u64]));
    key
}

/// Whether a step moves axes: its segment does not depend on the segments before it.
pub(super) fn moves(step: &Step) -> bool {
    matches!(step.path, Path::PointToPoint | Path::Line(_))
}
