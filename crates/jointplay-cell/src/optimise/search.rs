//! Rounds of proposals and evaluations.

use std::collections::{BTreeSet, VecDeque};

use super::beam_search::BeamSearch;
use super::candidate::{Candidate, MotionSettings};
use super::flow::{RoutedHandoff, WaferFlow};
use super::order_program::order_program;
use super::pareto::{Objectives, pareto_front};
use super::timing_model::{TimingModel, TimingSample};
use crate::program::{Handoff, Program};
use crate::workcell::Cell;

/// Options of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimiseOptions {
    /// Number of states that the beam search keeps.
    pub beam_width: usize,
    /// Largest number of rounds of proposed orders.
    pub rounds: usize,
    /// Number of new orders in a round.
    pub orders_per_round: usize,
    /// Number of orders, besides that of the program, for which blends and speeds are varied.
    pub varied_orders: usize,
    /// Blend radii (m).
    pub blend_radii: Vec<f64>,
    /// Shares of the limits, above 0 and at most 1.
    pub speeds: Vec<f64>,
    /// Largest number of candidates with settings of their own at single stations.
    pub station_candidates: usize,
}

impl Default for OptimiseOptions {
    fn default() -> Self {
        Self {
            beam_width: 64,
            rounds: 5,
            orders_per_round: 2,
            varied_orders: 1,
            blend_radii: vec![0.0, 0.003, 0.008],
            speeds: vec![1.0, 0.9, 0.8],
            station_candidates: 24,
        }
    }
}

/// Result of planning and checking a candidate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evaluation {
    /// Objectives; `None` with violations, or where no trajectory exists.
    pub objectives: Option<Objectives>,
    /// Times between its hand-offs.
    pub timing: Vec<TimingSample>,
}

/// Stage of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Orders at full speed without blends; the number of finished rounds.
    Orders(usize),
    /// Blends and speeds of whole programs.
    Variation,
    /// Blends and speeds of single stations.
    Stations,
}

/// Search for programs with the same wafer flow that are better in throughput, clearance or slip margin.
///
/// In each round, a beam search over the hand-offs proposes orders that are short by the times measured so far; they are evaluated at full speed without blends, which corrects the times.
/// Blends and speeds are then varied on a grid for the order of the program and the fastest ones.
/// Last, each station gets other settings in turn: first in the fastest program without violations, then in the fastest one of the Pareto front for which this was not done, and so on.
/// The proposals depend on the evaluations only: a search that is repeated with the same evaluations proposes the same candidates.
pub struct Search<'c> {
    cell: &'c Cell,
    flow: &'c WaferFlow,
    options: OptimiseOptions,
    model: TimingModel,
    orders: Vec<Vec<RoutedHandoff>>,
    pending: VecDeque<Candidate>,
    evaluated: Vec<(Candidate, Evaluation)>,
    stage: Stage,
    /// Candidates of which the settings of single stations were varied.
    bases: Vec<Candidate>,
    /// Number of candidates with settings of single stations.
    station_candidates: usize,
}

impl<'c> Search<'c> {
    /// A search that begins with the order of the program.
    #[must_use]
    pub fn new(cell: &'c Cell, flow: &'c WaferFlow, options: OptimiseOptions) -> Self {
        let first = Candidate::uniform(0, MotionSettings::FULL_SPEED);
        Self {
            cell,
            flow,
            options,
            model: TimingModel::default(),
            orders: vec![flow.order.clone()],
            pending: VecDeque::from([first]),
            evaluated: Vec::new(),
            stage: Stage::Orders(0),
            bases: Vec::new(),
            station_candidates: 0,
        }
    }

    /// The next candidate; `None` at the end of the search.
    pub fn next_candidate(&mut self) -> Option<Candidate> {
        while self.pending.is_empty() {
            let stage = self.stage;
            self.stage = match stage {
                Stage::Orders(rounds) if rounds < self.options.rounds && self.propose() => {
                    Stage::Orders(rounds + 1)
                }
                Stage::Orders(_) => {
                    self.vary();
                    Stage::Variation
                }
                Stage::Variation | Stage::Stations => {
                    if !self.vary_stations() {
                        return None;
                    }
                    Stage::Stations
                }
            };
        }
        self.pending.front().cloned()
    }

    /// The program of a candidate.
    ///
    /// # Panics
    /// If another search has proposed it.
    #[must_use]
    pub fn program(&self, candidate: &Candidate) -> Program {
        order_program(self.cell, &self.orders[candidate.order], candidate)
    }

    /// The hand-offs of a candidate.
    ///
    /// # Panics
    /// If another search has proposed it.
    #[must_use]
    pub fn order(&self, candidate: &Candidate) -> Vec<Handoff> {
        self.orders[candidate.order].iter().map(|made| made.handoff).collect()
    }

    /// Records the evaluation of the next candidate.
    pub fn record(&mut self, evaluation: Evaluation) {
        let Some(candidate) = self.pending.pop_front() else { return };
        if matches!(self.stage, Stage::Orders(_)) {
            self.model.learn(&evaluation.timing);
        }
        self.evaluated.push((candidate, evaluation));
    }

    /// Evaluated candidates in the order of evaluation.
    #[must_use]
    pub fn evaluated(&self) -> &[(Candidate, Evaluation)] {
        &self.evaluated
    }

    /// Candidates without violations that no others dominate, by decreasing throughput.
    #[must_use]
    pub fn front(&self) -> Vec<(Candidate, Objectives)> {
        let sound: Vec<(Candidate, Objectives)> = self
            .evaluated
            .iter()
            .filter_map(|(candidate, evaluation)| Some((candidate.clone(), evaluation.objectives?)))
            .collect();
        let objectives: Vec<Objectives> = sound.iter().map(|(_, objectives)| *objectives).collect();
        pareto_front(&objectives).into_iter().map(|index| sound[index].clone()).collect()
    }

    /// Adds new orders; false if there are none.
    fn propose(&mut self) -> bool {
        let found =
            BeamSearch::new(self.cell, self.flow, &self.model).orders(self.options.beam_width);
        let mut added = 0;
        for order in found {
            if added < self.options.orders_per_round && !self.orders.contains(&order) {
                self.orders.push(order);
                added += 1;
                let order = self.orders.len() - 1;
                self.pending.push_back(Candidate::uniform(order, MotionSettings::FULL_SPEED));
            }
        }
        added > 0
    }

    /// Adds blends and speeds for the order of the program and the fastest ones.
    fn vary(&mut self) {
        let mut fastest: Vec<(f64, usize)> = self
            .evaluated
            .iter()
            .filter_map(|(candidate, evaluation)| {
                Some((evaluation.objectives?.wafers_per_hour, candidate.order))
            })
            .filter(|&(_, order)| order > 0)
            .collect();
        fastest.sort_by(|one, other| other.0.total_cmp(&one.0).then(one.1.cmp(&other.1)));
        let varied = fastest.iter().take(self.options.varied_orders).map(|&(_, order)| order);
        for order in std::iter::once(0).chain(varied) {
            for &speed in &self.options.speeds {
                for &blend_radius in &self.options.blend_radii {
                    let settings = MotionSettings { speed, blend_radius };
                    let candidate = Candidate::uniform(order, settings);
                    if !self.evaluated.iter().any(|(known, _)| *known == candidate) {
                        self.pending.push_back(candidate);
                    }
                }
            }
        }
    }

    /// Adds candidates that differ from the fastest one of the front by the settings of one station; false if there are none.
    fn vary_stations(&mut self) -> bool {
        let stations: BTreeSet<usize> =
            self.orders[0].iter().map(|made| made.handoff.slot().station).collect();
        for (base, _) in self.front() {
            if self.bases.contains(&base) {
                continue;
            }
            for &station in &stations {
                let own = base.settings_at(station);
                let speeds = self.options.speeds.iter();
                let speeds = speeds.map(|&speed| MotionSettings { speed, ..own });
                let blends = self.options.blend_radii.iter();
                let blends = blends.map(|&blend_radius| MotionSettings { blend_radius, ..own });
                for settings in speeds.chain(blends) {
                    let mut candidate = base.clone();
                    if settings == base.settings {
                        candidate.stations.remove(&station);
                    } else {
                        candidate.stations.insert(station, settings);
                    }
                    let is_known = self.evaluated.iter().any(|(known, _)| *known == candidate)
                        || self.pending.contains(&candidate);
                    if !is_known && self.station_candidates < self.options.station_candidates {
                        self.station_candidates += 1;
                        self.pending.push_back(candidate);
                    }
                }
            }
            self.bases.push(base);
            if !self.pending.is_empty() {
                return true;
            }
        }
        false
    }
}
