//! Wafers on effectors and at stations over time, for the timing diagram.

use jointplay_cell::program::WaferLocation;
use jointplay_cell::schedule::{Schedule, TimedStay};
use jointplay_cell::workcell::Cell;

use super::gantt_interval::{Interval, IntervalKind};

/// Names of the effectors that carry wafers and of the stations that the program uses, and their intervals.
pub(super) fn places(cell: &Cell, schedule: &Schedule) -> (Vec<String>, Vec<Interval>) {
    let (mut names, mut intervals) = (Vec::new(), Vec::new());
    for id in cell.robot.effectors() {
        let here = |stay: &&TimedStay| stay.location() == WaferLocation::Effector(id);
        let stays: Vec<&TimedStay> = schedule.stays.iter().filter(here).collect();
        if !stays.is_empty() {
            add_occupancy(&mut intervals, names.len(), 1, &stays);
            names.push(format!("wafer on {}", cell.effector_name(id)));
        }
    }
    for (index, station) in cell.stations.iter().enumerate() {
        if schedule.stations[index].visits == 0 {
            continue;
        }
        let here = |stay: &&TimedStay| stay.station() == Some(index);
        let stays: Vec<&TimedStay> = schedule.stays.iter().filter(here).collect();
        let row = names.len();
        add_occupancy(&mut intervals, row, station.slots, &stays);
        let placed = stays.iter().filter(|stay| stay.stay.arrival_step.is_some());
        intervals.extend(placed.filter(|_| station.process_time > 0.0).map(|stay| Interval {
            from: stay.start,
            to: stay.end.min(stay.start + station.process_time),
            kind: IntervalKind::Process(row),
        }));
        names.push(station.name.clone());
    }
    (names, intervals)
}

/// Adds the number of wafers at a place, as a share of its slots, from change to change.
fn add_occupancy(intervals: &mut Vec<Interval>, row: usize, slots: usize, stays: &[&TimedStay]) {
    let mut changes: Vec<(f64, i64)> =
        stays.iter().flat_map(|stay| [(stay.start, 1), (stay.end, -1)]).collect();
    changes.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let mut wafers = 0;
    for pair in changes.windows(2) {
        wafers += pair[0].1;
        let [from, to] = [pair[0].0, pair[1].0];
        if wafers > 0 && to > from {
            #[expect(clippy::cast_precision_loss, reason = "counts of slots")]
            let share = (wafers as f64 / slots as f64).min(1.0);
            intervals.push(Interval { from, to, kind: IntervalKind::Wafers { row, share } });
        }
    }
}
