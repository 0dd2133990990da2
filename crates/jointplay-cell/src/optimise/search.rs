//! Rounds of proposals and evaluations.

use std::collections::VecDeque;

use super::beam_search::BeamSearch;
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
        }
    }
}

/// A program that the search proposes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Order of its hand-offs; 0 is that of the program.
    pub order: usize,
    /// Share of the limits.
    pub speed: f64,
    /// Blend radius (m).
    pub blend_radius: f64,
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
    /// Blends and speeds.
    Variation,
}

/// Search for programs with the same wafer flow that are better in throughput, clearance or slip margin.
///
/// In each round, a beam search over the hand-offs proposes orders that are short by the times measured so far; they are evaluated at full speed without blends, which corrects the times.
/// Blends and speeds are then varied on a grid for the order of the program and the fastest ones.
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
}

impl<'c> Search<'c> {
    /// A search that begins with the order of the program.
    #[must_use]
    pub fn new(cell: &'c Cell, flow: &'c WaferFlow, options: OptimiseOptions) -> Self {
        let first = Candidate { order: 0, speed: 1.0, blend_radius: 0.0 };
        Self {
            cell,
            flow,
            options,
            model: TimingModel::default(),
            orders: vec![flow.order.clone()],
            pending: VecDeque::from([first]),
            evaluated: Vec::new(),
            stage: Stage::Orders(0),
        }
    }

    /// The next candidate; `None` at the end of the search.
    pub fn next_candidate(&mut self) -> Option<Candidate> {
        while self.pending.is_empty() {
            let Stage::Orders(rounds) = self.stage else { return None };
            if rounds < self.options.rounds && self.propose() {
                self.stage = Stage::Orders(rounds + 1);
            } else {
                self.vary();
                self.stage = Stage::Variation;
            }
        }
        self.pending.front().copied()
    }

    /// The program of a candidate.
    ///
    /// # Panics
    /// If another search has proposed it.
    #[must_use]
    pub fn program(&self, candidate: &Candidate) -> Program {
        let Candidate { order, speed, blend_radius } = *candidate;
        order_program(self.cell, &self.orders[order], speed, blend_radius)
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
            .filter_map(|(candidate, evaluation)| Some((*candidate, evaluation.objectives?)))
            .collect();
        let objectives: Vec<Objectives> = sound.iter().map(|(_, objectives)| *objectives).collect();
        pareto_front(&objectives).into_iter().map(|index| sound[index]).collect()
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
                self.pending.push_back(Candidate { order, speed: 1.0, blend_radius: 0.0 });
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
                    let candidate = Candidate { order, speed, blend_radius };
                    if !self.evaluated.iter().any(|(known, _)| *known == candidate) {
                        self.pending.push_back(candidate);
                    }
                }
            }
        }
    }
}
