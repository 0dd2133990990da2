//! Report on the schedule of a program.

use std::collections::BTreeMap;

use jointplay_cell::program::WaferLocation;
use jointplay_cell::schedule::{CriticalPath, PeriodicPart, Resource, Schedule, TimedStay};
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;
use serde::Serialize;

/// Schedule of a program: use of robot and stations, what determines the duration, the throughput of its periodic parts, and the stays of the wafers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ScheduleReport {
    /// Use of the robot.
    pub robot: RobotUseReport,
    /// Use of the stations, in the order of the cell.
    pub stations: Vec<StationUseReport>,
    /// What determines the duration of the steady state, or of the whole program without one.
    pub bottleneck: Option<BottleneckReport>,
    /// Times on the critical path of the whole program, longest first; their sum is the duration.
    pub critical_path: Vec<CriticalTimeReport>,
    /// Wafers per hour of the longest periodic part; none where hand-offs do not repeat.
    pub steady_wafers_per_hour: Option<f64>,
    /// Parts in which hand-offs repeat three times or more, in the order of time.
    pub periodic_parts: Vec<PeriodicPartReport>,
    /// Stays of the wafers that the program moves, in the order of time.
    pub wafers: Vec<WaferStaysReport>,
}

/// Use of the robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RobotUseReport {
    /// Time in motion.
    pub moving_s: f64,
    /// Time of waits.
    pub waiting_s: f64,
    /// Share of the time in motion.
    pub busy_share: f64,
    /// Time of WAIT commands.
    pub commanded_waits_s: f64,
    /// Waits for processes.
    pub process_waits: Vec<ProcessWaitReport>,
}

/// Waits of the robot for a process.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ProcessWaitReport {
    /// Name of the station.
    pub station: String,
    /// Time in which the robot waits.
    pub waiting_s: f64,
}

/// Use of a station.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StationUseReport {
    /// Name of the station.
    pub name: String,
    /// Number of stays of wafers that the program places or picks.
    pub visits: usize,
    /// Time with one wafer or more.
    pub occupied_s: f64,
    /// Share of the time with one wafer or more.
    pub occupied_share: f64,
    /// Time in which a process runs.
    pub processing_s: f64,
    /// Share of the time in which a process runs.
    pub busy_share: f64,
    /// Time in which the robot waits for the process.
    pub robot_waits_s: f64,
    /// Shortest dwell of a wafer that is placed and picked.
    pub shortest_dwell_s: Option<f64>,
    /// Longest dwell of a wafer that is placed or picked.
    pub longest_dwell_s: Option<f64>,
    /// Shortest allowed dwell.
    pub min_dwell_s: Option<f64>,
    /// Longest allowed dwell.
    pub max_dwell_s: Option<f64>,
}

/// Resource with the longest time on the critical path.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BottleneckReport {
    /// `robot`, `process` or `wait command`.
    pub kind: &'static str,
    /// Name of the station for a process, else of the robot.
    pub name: String,
    /// Share of the critical path: the relative decrease of the duration for a relative decrease of the times of this resource.
    pub share: f64,
}

/// Time of a resource on the critical path.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CriticalTimeReport {
    /// `robot`, `process` or `wait command`.
    pub kind: &'static str,
    /// Name of the station for a process, else of the robot.
    pub name: String,
    /// Time on the critical path.
    pub time_s: f64,
    /// Share of the critical path.
    pub share: f64,
}

/// Part of a program in which hand-offs repeat.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PeriodicPartReport {
    /// Lines of the program with its first and last motion.
    pub lines: [usize; 2],
    /// Start time.
    pub start_s: f64,
    /// End time.
    pub end_s: f64,
    /// Number of whole periods.
    pub cycles: usize,
    /// Number of wafers that leave the part in a period.
    pub wafers_per_cycle: usize,
    /// Median period.
    pub period_s: f64,
    /// Shortest period.
    pub shortest_period_s: f64,
    /// Longest period.
    pub longest_period_s: f64,
    /// Wafers per hour at the median period.
    pub wafers_per_hour: f64,
    /// Times on the critical path of the part, longest first.
    pub critical_path: Vec<CriticalTimeReport>,
}

/// Stays of a wafer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct WaferStaysReport {
    /// Name of the wafer: its slot or effector at the start.
    pub wafer: String,
    /// Its stays in the order of time.
    pub stays: Vec<StayReport>,
}

/// Stay of a wafer in a slot or on an effector.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StayReport {
    /// Name of the station or effector.
    pub place: String,
    /// Number of the slot, for a station.
    pub slot: Option<usize>,
    /// Start time.
    pub start_s: f64,
    /// End time.
    pub end_s: f64,
    /// Length of the stay.
    pub dwell_s: f64,
}

/// Reports a schedule.
///
/// # Arguments
/// * `motion` – the trajectory of the schedule, for program lines
#[must_use]
pub fn schedule_report(cell: &Cell, motion: &Trajectory, schedule: &Schedule) -> ScheduleReport {
    let duration = schedule.duration;
    let share = |time: f64| if duration > 0.0 { time / duration } else { 0.0 };
    let robot = &schedule.robot;
    let process_waits = cell.stations.iter().zip(&robot.process_waits);
    let process_waits =
        process_waits.filter(|&(_, &waiting_s)| waiting_s > 0.0).map(|(station, &waiting_s)| {
            ProcessWaitReport { station: station.name.clone(), waiting_s }
        });
    let stations = cell.stations.iter().zip(&schedule.stations).enumerate();
    let stations = stations.map(|(index, (station, used))| {
        let limits = cell.rules.dwell_at(index);
        StationUseReport {
            name: station.name.clone(),
            visits: used.visits,
            occupied_s: used.occupied,
            occupied_share: share(used.occupied),
            processing_s: used.processing,
            busy_share: share(used.processing),
            robot_waits_s: used.robot_waits,
            shortest_dwell_s: used.shortest_dwell,
            longest_dwell_s: used.longest_dwell,
            min_dwell_s: limits.map(|limits| limits.min).filter(|&min| min > 0.0),
            max_dwell_s: limits.and_then(|limits| limits.max),
        }
    });
    let steady = schedule.steady_state();
    let path = steady.map_or(&schedule.critical_path, |part| &part.critical_path);
    let bottleneck = critical_times(cell, path).into_iter().next();
    ScheduleReport {
        robot: RobotUseReport {
            moving_s: robot.moving,
            waiting_s: robot.waiting(),
            busy_share: share(robot.moving),
            commanded_waits_s: robot.commanded_waits,
            process_waits: process_waits.collect(),
        },
        stations: stations.collect(),
        bottleneck: bottleneck.map(|CriticalTimeReport { kind, name, share, .. }| {
            BottleneckReport { kind, name, share }
        }),
        critical_path: critical_times(cell, &schedule.critical_path),
        steady_wafers_per_hour: steady.map(|part| part.wafers_per_hour),
        periodic_parts: schedule
            .periodic_parts
            .iter()
            .map(|part| periodic_part(cell, motion, part))
            .collect(),
        wafers: wafers(cell, schedule),
    }
}

fn critical_times(cell: &Cell, path: &CriticalPath) -> Vec<CriticalTimeReport> {
    let all = path.duration();
    let report = |&(resource, time_s): &(Resource, f64)| {
        let (kind, name) = match resource {
            Resource::Robot => ("robot", cell.robot.name.clone()),
            Resource::Station(station) => ("process", cell.stations[station].name.clone()),
            Resource::Program => ("wait command", cell.robot.name.clone()),
        };
        CriticalTimeReport { kind, name, time_s, share: time_s / all }
    };
    path.times.iter().map(report).collect()
}

fn periodic_part(cell: &Cell, motion: &Trajectory, part: &PeriodicPart) -> PeriodicPartReport {
    let lines = motion.steps[part.steps.clone()].iter().map(|step| step.place.line);
    let (first, last) =
        lines.fold((usize::MAX, 0), |(first, last), line| (first.min(line), last.max(line)));
    PeriodicPartReport {
        lines: [first, last],
        start_s: part.start,
        end_s: part.end,
        cycles: part.cycles,
        wafers_per_cycle: part.wafers,
        period_s: part.period,
        shortest_period_s: part.period_range[0],
        longest_period_s: part.period_range[1],
        wafers_per_hour: part.wafers_per_hour,
        critical_path: critical_times(cell, &part.critical_path),
    }
}

fn wafers(cell: &Cell, schedule: &Schedule) -> Vec<WaferStaysReport> {
    let mut found: BTreeMap<usize, Vec<StayReport>> = BTreeMap::new();
    for stay in schedule.stays.iter().filter(|stay| stay.is_touched()) {
        found.entry(stay.wafer).or_default().push(stay_report(cell, stay));
    }
    let report = |(wafer, stays): (usize, Vec<StayReport>)| WaferStaysReport {
        wafer: cell.entity_name(schedule.wafers[wafer]),
        stays,
    };
    found.into_iter().map(report).collect()
}

fn stay_report(cell: &Cell, stay: &TimedStay) -> StayReport {
    let (place, slot) = match stay.location() {
        WaferLocation::Slot(slot) => (cell.stations[slot.station].name.clone(), Some(slot.slot)),
        WaferLocation::Effector(id) => (cell.effector_name(id).to_owned(), None),
    };
    StayReport { place, slot, start_s: stay.start, end_s: stay.end, dwell_s: stay.duration() }
}
