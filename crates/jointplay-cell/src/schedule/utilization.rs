//! Use of robot and stations.

use super::critical_path::awaited_process;
use super::stays::TimedStay;
use crate::program::Path;
use crate::trajectory::Trajectory;
use crate::workcell::Cell;

/// Use of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotUtilization {
    /// Time in motion (s).
    pub moving: f64,
    /// Time in which the robot waits for the process of each station, by index (s).
    pub process_waits: Vec<f64>,
    /// Time of WAIT commands (s).
    pub commanded_waits: f64,
}

/// Use of a station.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StationUtilization {
    /// Number of stays of wafers that the program places or picks.
    pub visits: usize,
    /// Time with one wafer or more (s).
    pub occupied: f64,
    /// Time in which a process runs; zero without a process time (s).
    pub processing: f64,
    /// Time in which the robot waits for the process (s).
    pub robot_waits: f64,
    /// Shortest dwell of a wafer that is placed and picked (s).
    pub shortest_dwell: Option<f64>,
    /// Longest dwell of a wafer that is placed or picked (s).
    pub longest_dwell: Option<f64>,
}

impl RobotUtilization {
    pub(super) fn new(cell: &Cell, trajectory: &Trajectory) -> Self {
        let process_waits = vec![0.0; cell.stations.len()];
        let mut robot = Self { moving: 0.0, process_waits, commanded_waits: 0.0 };
        for (index, step) in trajectory.steps.iter().enumerate() {
            let duration = trajectory.step_duration(index);
            match (awaited_process(&trajectory.steps, index), step.path) {
                (Some((station, _)), _) => robot.process_waits[station] += duration,
                (None, Path::Dwell(_)) => robot.commanded_waits += duration,
                (None, _) => robot.moving += duration,
            }
        }
        robot
    }

    /// Time in which the robot waits (s).
    #[must_use]
    pub fn waiting(&self) -> f64 {
        self.commanded_waits + self.process_waits.iter().sum::<f64>()
    }
}

/// Use of each station, by index.
pub(super) fn station_utilizations(
    cell: &Cell,
    stays: &[TimedStay],
    robot: &RobotUtilization,
) -> Vec<StationUtilization> {
    let mut found = vec![StationUtilization::default(); cell.stations.len()];
    let mut occupied: Vec<Vec<[f64; 2]>> = vec![Vec::new(); cell.stations.len()];
    let mut processing = occupied.clone();
    for stay in stays {
        let Some(station) = stay.station() else { continue };
        occupied[station].push([stay.start, stay.end]);
        let process_time = cell.stations[station].process_time;
        if process_time > 0.0 && stay.stay.arrival_step.is_some() {
            processing[station].push([stay.start, stay.end.min(stay.start + process_time)]);
        }
        if !stay.is_touched() {
            continue;
        }
        let (use_of, duration) = (&mut found[station], stay.duration());
        use_of.visits += 1;
        use_of.longest_dwell =
            Some(use_of.longest_dwell.map_or(duration, |most| most.max(duration)));
        if stay.stay.arrival_step.is_some() && stay.stay.departure_step.is_some() {
            let shortest = use_of.shortest_dwell.map_or(duration, |least| least.min(duration));
            use_of.shortest_dwell = Some(shortest);
        }
    }
    for (station, use_of) in found.iter_mut().enumerate() {
        use_of.occupied = union_length(&mut occupied[station]);
        use_of.processing = union_length(&mut processing[station]);
        use_of.robot_waits = robot.process_waits[station];
    }
    found
}

/// Length of the union of intervals.
fn union_length(intervals: &mut [[f64; 2]]) -> f64 {
    intervals.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let (mut length, mut covered) = (0.0, f64::NEG_INFINITY);
    for &[start, end] in intervals.iter() {
        length += (end - start.max(covered)).max(0.0);
        covered = covered.max(end);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_union_counts_overlaps_once() {
        let mut intervals = [[4.0, 5.0], [0.0, 2.0], [1.0, 3.0], [1.5, 1.6]];
        assert_eq!(union_length(&mut intervals), 4.0);
        assert_eq!(union_length(&mut []), 0.0);
    }
}
