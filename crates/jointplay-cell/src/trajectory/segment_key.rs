//! Cache keys of segments.

use crate::incremental::CacheKey;
use crate::program::{LinePostures, Path, Step};
use crate::workcell::Cell;

use super::options::TrajectoryOptions;

/// Cache key of the inputs that all segments of a trajectory share.
pub(super) fn shared_key(cell: &Cell, options: &TrajectoryOptions) -> CacheKey {
    let TrajectoryOptions { max_line_deviation } = options;
    let mut inputs = CacheKey::default();
    inputs.add(&cell.robot).add(&cell.wafer).add(&cell.gravity).add(max_line_deviation);
    inputs
}

/// Cache key of the inputs that are particular to the segment of a moving step.
pub(super) fn segment_key(step: &Step) -> CacheKey {
    let effector = match step.path {
        Path::Line(effector) => Some(effector),
        _ => None,
    };
    let mut inputs = CacheKey::default();
    inputs.add(&effector).add(&step.from).add(&step.to);
    inputs.add(&step.speed_scaling).add(&step.line_speed).add(&step.loaded);
    inputs.add(&step.postures.is_some());
    if let Some(LinePostures { path, fractions, prescribes_heading }) = &step.postures {
        inputs.add(path.as_ref()).add(fractions).add(prescribes_heading);
    }
    inputs
}

/// Whether a step moves axes: its segment does not depend on the segments before it.
pub(super) fn moves(step: &Step) -> bool {
    matches!(step.path, Path::PointToPoint | Path::Line(_))
}
