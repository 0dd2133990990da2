//! Parts of a program in which hand-offs repeat, and their throughput.

use std::collections::BTreeMap;
use std::ops::Range;

use super::critical_path::{CriticalPath, critical_path};
use crate::program::Handoff;
use crate::robot::EffectorId;
use crate::trajectory::Trajectory;

/// Largest number of hand-offs in a period.
const MAX_PERIOD: usize = 256;
/// Least number of periods of a part.
const MIN_CYCLES: usize = 3;
/// Largest number of parts.
const MAX_PARTS: usize = 16;

/// Part of a program in which the same effectors pick and place at the same stations, period by period.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicPart {
    /// Steps from the first hand-off to the last.
    pub steps: Range<usize>,
    /// Time of the first hand-off (s).
    pub start: f64,
    /// Time of the last hand-off (s).
    pub end: f64,
    /// Number of whole periods.
    pub cycles: usize,
    /// Number of wafers completed per period: those that are not handled again in the part; the median of all periods.
    pub wafers: usize,
    /// Median period (s).
    pub period: f64,
    /// Shortest and longest period (s).
    pub period_range: [f64; 2],
    /// Wafers per hour at the median period (1/h).
    pub wafers_per_hour: f64,
    /// What determines the duration of the part.
    pub critical_path: CriticalPath,
}

/// A hand-off: the step at whose end it occurs, its kind, and its wafer.
struct Event {
    step: usize,
    signature: (bool, EffectorId, usize),
    wafer: usize,
}

/// Run of hand-offs with a period.
#[derive(Clone)]
struct Run {
    events: Range<usize>,
    period: usize,
}

/// Periodic parts in the order of time, of three periods or more.
///
/// Two hand-offs are the same if the effector, the station and the direction are; slots may differ.
/// The longest run of equal hand-offs is taken first, with its shortest period, then the longest runs before and after it.
///
/// # Arguments
/// * `wafer_of` – the wafer of the hand-off at the end of a step
pub(super) fn periodic_parts(
    trajectory: &Trajectory,
    wafer_of: impl Fn(usize) -> Option<usize>,
) -> Vec<PeriodicPart> {
    let event = |(step, handoff): (usize, Handoff)| {
        let signature = match handoff {
            Handoff::Picked(effector, slot) => (true, effector, slot.station),
            Handoff::Placed(effector, slot) => (false, effector, slot.station),
        };
        Some(Event { step, signature, wafer: wafer_of(step)? })
    };
    let handoffs = trajectory.steps.iter().enumerate();
    let events: Vec<Event> = handoffs
        .filter_map(|(step, found)| found.handoff.map(|handoff| (step, handoff)))
        .filter_map(event)
        .collect();
    let mut runs = Vec::new();
    split(&events, 0..events.len(), &mut runs);
    runs.sort_by_key(|run| run.events.start);
    runs.iter().filter_map(|run| part(trajectory, &events, run)).collect()
}

/// Adds the longest run in a range, then those before and after it.
fn split(events: &[Event], range: Range<usize>, runs: &mut Vec<Run>) {
    if runs.len() >= MAX_PARTS {
        return;
    }
    let Some(run) = longest_run(events, range.clone()) else { return };
    let Range { start, end } = run.events.clone();
    runs.push(run);
    split(events, range.start..start, runs);
    split(events, end..range.end, runs);
}

fn longest_run(events: &[Event], range: Range<usize>) -> Option<Run> {
    let mut best: Option<Run> = None;
    let mut consider = |events: Range<usize>, period: usize| {
        let is_longer = best.as_ref().is_none_or(|best| events.len() > best.events.len());
        if events.len() >= MIN_CYCLES * period && is_longer {
            best = Some(Run { events, period });
        }
    };
    for period in 1..=MAX_PERIOD.min(range.len() / MIN_CYCLES) {
        let mut first = range.start;
        for index in range.start..range.end - period {
            if events[index].signature != events[index + period].signature {
                consider(first..index + period, period);
                first = index + 1;
            }
        }
        consider(first..range.end, period);
    }
    best
}

fn part(trajectory: &Trajectory, events: &[Event], run: &Run) -> Option<PeriodicPart> {
    let Run { events: range, period } = run;
    let time = |index: usize| trajectory.times[events[index].step + 1];
    let mut periods: Vec<f64> =
        (range.start..range.end - period).map(|index| time(index + period) - time(index)).collect();
    periods.sort_by(f64::total_cmp);
    let median = periods[periods.len() / 2];
    // Wafers that are not handled again in the part leave it.
    let mut last = BTreeMap::new();
    for index in range.clone() {
        last.insert(events[index].wafer, index);
    }
    let cycles = range.len() / period;
    let mut leaving = vec![0_usize; cycles];
    for index in last.into_values() {
        if let Some(count) = leaving.get_mut((index - range.start) / period) {
            *count += 1;
        }
    }
    leaving.sort_unstable();
    let wafers = leaving[cycles / 2];
    let steps = events[range.start].step + 1..events[range.end - 1].step + 1;
    let is_throughput = wafers > 0 && median > 0.0;
    #[expect(clippy::cast_precision_loss, reason = "a count of wafers")]
    is_throughput.then(|| PeriodicPart {
        start: time(range.start),
        end: time(range.end - 1),
        cycles,
        wafers,
        period: median,
        period_range: [periods[0], periods[periods.len() - 1]],
        wafers_per_hour: 3600.0 * wafers as f64 / median,
        critical_path: critical_path(trajectory, steps.clone()),
        steps,
    })
}
