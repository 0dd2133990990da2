//! The critical path: the chain of motions and processes without gaps that determines a duration.

use std::ops::Range;

use crate::program::{Handoff, Path, Step};
use crate::trajectory::Trajectory;

/// Resource that takes time on the critical path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Resource {
    /// Motions of the robot.
    Robot,
    /// Process of a station, by index.
    Station(usize),
    /// WAIT commands of the program.
    Program,
}

/// Times on the critical path; their sum is the duration of the interval.
///
/// A dwell that waits for a process ends when the process ends: from its end, the path leads back through the process to the hand-off that started it, and from there along the motions of the robot.
/// The time of a resource divided by the duration is the elasticity of the duration: its relative decrease per relative decrease of the times of that resource, as long as the path stays the same.
///
/// # Source
/// \[Kelley\]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CriticalPath {
    /// Time of each resource, the longest first (s).
    pub times: Vec<(Resource, f64)>,
}

impl CriticalPath {
    /// Sum of all times (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.iter().map(|(_, time)| time).sum()
    }

    /// Resource with the longest time; `None` for an empty path.
    #[must_use]
    pub fn bottleneck(&self) -> Option<Resource> {
        self.times.first().map(|&(resource, _)| resource)
    }

    fn add(&mut self, resource: Resource, time: f64) {
        if time <= 0.0 {
            return;
        }
        match self.times.iter_mut().find(|(known, _)| *known == resource) {
            Some((_, known)) => *known += time,
            None => self.times.push((resource, time)),
        }
    }
}

/// Station whose process a step waits for, and the step at whose end the process starts.
pub(super) fn awaited_process(steps: &[Step], step: usize) -> Option<(usize, usize)> {
    let Path::ProcessDwell { placed_at_step, .. } = steps[step].path else { return None };
    match steps.get(placed_at_step)?.handoff? {
        Handoff::Placed(_, slot) => Some((slot.station, placed_at_step)),
        Handoff::Picked(..) => None,
    }
}

/// The critical path from the start of the first to the end of the last of some steps.
pub(super) fn critical_path(trajectory: &Trajectory, steps: Range<usize>) -> CriticalPath {
    let mut path = CriticalPath::default();
    let start = trajectory.times[steps.start];
    let mut next = steps.end;
    while next > steps.start {
        let step = next - 1;
        let end = trajectory.times[next];
        let duration = trajectory.step_duration(step);
        match (awaited_process(&trajectory.steps, step), trajectory.steps[step].path) {
            (Some((station, placed)), _) if trajectory.has_duration(step) => {
                let from = trajectory.times[placed + 1].max(start);
                path.add(Resource::Station(station), end - from);
                next = (placed + 1).max(steps.start);
                continue;
            }
            (_, Path::Dwell(_)) => path.add(Resource::Program, duration),
            _ => path.add(Resource::Robot, duration),
        }
        next = step;
    }
    path.times.sort_by(|(a, one), (b, other)| other.total_cmp(one).then(a.cmp(b)));
    path
}
