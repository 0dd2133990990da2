//! Orders of hand-offs with a short duration, by beam search.

use std::collections::{BTreeMap, BTreeSet};

use super::flow::{RoutedHandoff, WaferFlow};
use super::timing_model::{Signature, TimingModel};
use crate::program::Handoff;
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// State of the cell after some hand-offs, by the timing model.
#[derive(Clone)]
struct State {
    /// Time of the last hand-off (s).
    time: f64,
    /// Estimate of the duration of the whole program (s).
    estimate: f64,
    /// Number of hand-offs of each route: even in a slot, odd on an effector.
    progress: Vec<u16>,
    /// Route of the wafer on each effector.
    holds: Vec<Option<usize>>,
    /// Time of the last placement of each route (s).
    placed: Vec<f64>,
    last: Option<Signature>,
    /// Index in the history of the last hand-off.
    history: Option<usize>,
}

/// Hand-off with the one before it.
struct HistoryNode {
    before: Option<usize>,
    made: RoutedHandoff,
}

/// Key by which states are compared: those with equal keys continue alike.
type Key = (Vec<u16>, Vec<Option<usize>>, Option<Signature>);

pub(super) struct BeamSearch<'a> {
    cell: &'a Cell,
    flow: &'a WaferFlow,
    model: &'a TimingModel,
    effectors: Vec<EffectorId>,
    /// Mean time of the motions to a hand-off (s).
    mean_travel: f64,
    /// Hand-offs of all states that the beam has had.
    history: Vec<HistoryNode>,
}

impl<'a> BeamSearch<'a> {
    pub(super) fn new(cell: &'a Cell, flow: &'a WaferFlow, model: &'a TimingModel) -> Self {
        let effectors = cell.robot.effectors().collect();
        let mean_travel = model.mean_travel();
        Self { cell, flow, model, effectors, mean_travel, history: Vec::new() }
    }

    /// Orders of all hand-offs, the shortest first; different ones, at most as many as the beam is wide.
    pub(super) fn orders(mut self, width: usize) -> Vec<Vec<RoutedHandoff>> {
        let routes = self.flow.routes.len();
        let mut beam = vec![State {
            time: 0.0,
            estimate: 0.0,
            progress: vec![0; routes],
            holds: vec![None; self.effectors.len()],
            placed: vec![0.0; routes],
            last: None,
            history: None,
        }];
        let handoffs: usize =
            self.flow.routes.iter().map(|route| 2 * (route.slots.len() - 1)).sum();
        for done in 1..=handoffs {
            let mut next: BTreeMap<Key, (State, RoutedHandoff)> = BTreeMap::new();
            for state in &beam {
                for made in self.moves(state) {
                    let Some(reached) = self.after(state, made, handoffs - done) else { continue };
                    let key = (reached.progress.clone(), reached.holds.clone(), reached.last);
                    let known = next.get(&key);
                    if known.is_none_or(|(known, _)| reached.time < known.time) {
                        next.insert(key, (reached, made));
                    }
                }
            }
            let mut reached: Vec<(State, RoutedHandoff)> = next.into_values().collect();
            // A stable sort of an ordered map: the result does not depend on anything else.
            reached.sort_by(|(one, _), (other, _)| one.estimate.total_cmp(&other.estimate));
            reached.truncate(width);
            beam.clear();
            for (mut state, made) in reached {
                self.history.push(HistoryNode { before: state.history, made });
                state.history = Some(self.history.len() - 1);
                beam.push(state);
            }
        }
        beam.iter().map(|state| self.order_of(state)).collect()
    }

    fn order_of(&self, state: &State) -> Vec<RoutedHandoff> {
        let mut order = Vec::new();
        let mut at = state.history;
        while let Some(index) = at {
            order.push(self.history[index].made);
            at = self.history[index].before;
        }
        order.reverse();
        order
    }

    /// Possible next hand-offs: of each station the wafer that the program picks first, with each free effector; and each held wafer into its next slot.
    fn moves(&self, state: &State) -> Vec<RoutedHandoff> {
        let routes = &self.flow.routes;
        let mut first: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        let mut occupied: BTreeSet<SlotId> = self.flow.blocked.clone();
        for (index, route) in routes.iter().enumerate() {
            let progress = usize::from(state.progress[index]);
            if !progress.is_multiple_of(2) {
                continue;
            }
            let leg = progress / 2;
            let slot = route.slots[leg];
            occupied.insert(slot);
            if let Some(&rank) = route.rank.get(leg) {
                let known = first.entry(slot.station).or_insert((rank, index));
                *known = (*known).min((rank, index));
            }
        }
        let mut moves = Vec::new();
        for &(_, route) in first.values() {
            let leg = usize::from(state.progress[route]) / 2;
            let [from, to] = [routes[route].slots[leg], routes[route].slots[leg + 1]];
            for (index, &id) in self.effectors.iter().enumerate() {
                let may = [from, to]
                    .iter()
                    .all(|slot| self.cell.stations[slot.station].effectors.contains(&id));
                if may && state.holds[index].is_none() {
                    moves.push(RoutedHandoff { route, handoff: Handoff::Picked(id, from) });
                }
            }
        }
        for (index, &id) in self.effectors.iter().enumerate() {
            let Some(route) = state.holds[index] else { continue };
            let to = routes[route].slots[usize::from(state.progress[route]).div_ceil(2)];
            if !occupied.contains(&to) {
                moves.push(RoutedHandoff { route, handoff: Handoff::Placed(id, to) });
            }
        }
        moves
    }

    /// State after a hand-off; `None` where the stay of the wafer is out of its limits.
    fn after(&self, state: &State, made: RoutedHandoff, left: usize) -> Option<State> {
        let RoutedHandoff { route, handoff } = made;
        let signature = Signature::of(handoff);
        let [travel, in_station] = self.model.times(state.last, signature);
        let in_front = state.time + (travel - in_station);
        let (Handoff::Picked(id, slot) | Handoff::Placed(id, slot)) = handoff;
        let effector = self.effectors.iter().position(|&known| known == id)?;
        let mut next = state.clone();
        if signature.picks {
            let station = &self.cell.stations[slot.station];
            let is_placed = state.progress[route] > 0;
            let ready = if is_placed { state.placed[route] + station.process_time } else { 0.0 };
            next.time = in_front.max(ready) + in_station;
            let stay = next.time - state.placed[route];
            if let Some(limits) = self.cell.rules.dwell_at(slot.station)
                && (limits.max.is_some_and(|max| stay > max) || (is_placed && stay < limits.min))
            {
                return None;
            }
            next.holds[effector] = Some(route);
        } else {
            next.time = in_front + in_station;
            next.holds[effector] = None;
            next.placed[route] = next.time;
        }
        next.progress[route] += 1;
        next.last = Some(signature);
        next.estimate = self.estimate(&next, left);
        Some(next)
    }

    /// Estimate of the duration: remaining hand-offs one after the other, and remaining processes of each station with the hand-offs between them.
    fn estimate(&self, state: &State, left: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of hand-offs")]
        let mut estimate = state.time + left as f64 * self.mean_travel;
        let mut ends = vec![state.time; self.cell.stations.len()];
        for (index, route) in self.flow.routes.iter().enumerate() {
            let progress = usize::from(state.progress[index]);
            for (leg, slot) in route.slots.iter().enumerate().skip(1) {
                let process = self.cell.stations[slot.station].process_time;
                if process == 0.0 || progress > 2 * leg {
                    continue;
                }
                let end = &mut ends[slot.station];
                if progress == 2 * leg {
                    *end += (state.placed[index] + process - state.time).max(0.0);
                } else {
                    *end += process + 2.0 * self.mean_travel;
                }
            }
        }
        for (station, end) in self.cell.stations.iter().zip(ends) {
            // Slots of a station work at the same time.
            #[expect(clippy::cast_precision_loss, reason = "a count of slots")]
            let slots = station.slots as f64;
            estimate = f64::max(estimate, state.time + (end - state.time) / slots);
        }
        estimate
    }
}
