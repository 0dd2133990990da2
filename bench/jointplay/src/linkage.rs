//! Positions of catalogue mechanisms along a drive, each from the position before it.

use std::f64::consts::TAU;

use jointplay::bulk::Status;
use jointplay::format::{catalogue, mechanism as file};
use jointplay::mechanism::{
    Kinematics, Mechanism, MechanismSystem, PositionSolver, ReliefSolver, assemble, guess,
};
use jointplay::nalgebra::DVector;

use crate::tree::Tree;
use crate::work::Work;

/// Positions along the drive.
const STEPS: usize = 200;
/// Largest gap that counts as solved, of a point (m) and of the direction of an axis.
const GAP: f64 = 1e-13;

/// Mechanisms that every program can model, and the displacement of their drives in either direction (m or rad).
pub(crate) const MECHANISMS: [(&str, f64); 6] = [
    ("four-bar", 0.6),
    ("bennett", 0.5),
    ("sarrus", 0.3),
    ("3-rps", 0.03),
    ("hexapod", 0.03),
    ("delta", 0.2),
];

/// A mechanism, the values of its drives, and the configurations that they lead to.
pub(crate) struct Linkage {
    mechanism: Mechanism,
    driven: Vec<usize>,
    solver: PositionSolver,
    /// Where each position is searched from: the one before, with the drives moved on.
    guesses: Vec<DVector<f64>>,
    answers: Vec<Option<DVector<f64>>>,
}

impl Linkage {
    pub(crate) fn new(name: &str) -> Option<Self> {
        let (_, reach) = MECHANISMS.into_iter().find(|(known, _)| *known == name)?;
        let mechanism = file::parse(catalogue::find(name)?.text).ok()?.mechanism;
        let kinematics = Kinematics::new(&mechanism);
        let driven: Vec<usize> = (0..mechanism.joints().len())
            .filter(|&joint| mechanism.joints()[joint].actuated)
            .flat_map(|joint| kinematics.coordinates_of(joint))
            .collect();
        let mut here =
            assemble(&mechanism, &guess(&mechanism), &driven, 0).expect("it closes").coordinates;
        let start: Vec<f64> = driven.iter().map(|&k| here[k]).collect();
        let mut guesses = Vec::with_capacity(STEPS);
        for step in 1..=STEPS {
            for (drive, &k) in driven.iter().enumerate() {
                let [turn, lag] = [step as f64 / STEPS as f64, drive as f64 / driven.len() as f64];
                here[k] = start[drive] + reach * ((TAU * (turn + lag)).sin() - (TAU * lag).sin());
            }
            guesses.push(here.clone());
            here = assemble(&mechanism, &here, &driven, 0).expect("it closes").coordinates;
        }
        let system = MechanismSystem::new(&mechanism, guesses[0].clone()).ok()?;
        let solver = PositionSolver::new(&system, &driven).ok()?;
        Some(Self { mechanism, driven, solver, guesses, answers: Vec::new() })
    }

    /// All positions at a time, from the same guesses.
    pub(crate) fn many(name: &str) -> Option<Many> {
        let Self { mechanism, solver, guesses, .. } = Self::new(name)?;
        let guesses: Vec<f64> = guesses.iter().flat_map(|guess| guess.iter().copied()).collect();
        let rows = guesses.clone();
        let (residuals, status) = (vec![0.0; STEPS], vec![Status::Solved; STEPS]);
        Some(Many { mechanism, solver, guesses, rows, residuals, status })
    }

    /// The work as text.
    pub(crate) fn text(&self) -> String {
        Tree::of(&self.mechanism).text(&self.driven, GAP, &self.guesses)
    }
}

/// A mechanism, and rows of coordinates that are solved together.
pub(crate) struct Many {
    mechanism: Mechanism,
    solver: PositionSolver,
    guesses: Vec<f64>,
    rows: Vec<f64>,
    residuals: Vec<f64>,
    status: Vec<Status>,
}

impl Work for Many {
    fn solve(&mut self) -> usize {
        self.rows.copy_from_slice(&self.guesses);
        let Self { solver, rows, residuals, status, .. } = self;
        let done = solver.solve_many(rows, ReliefSolver::Newton, residuals, status);
        done.map_or(0, |tally| tally.poses() - tally.failed())
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        let tree = Tree::of(&self.mechanism);
        let rows = self.rows.chunks_exact(self.rows.len() / STEPS).zip(&self.status);
        let answer = |(row, status): (&[f64], &Status)| {
            let solved = *status == Status::Solved;
            solved.then(|| tree.values(&DVector::from_column_slice(row)))
        };
        rows.map(answer).collect()
    }
}

impl Work for Linkage {
    fn solve(&mut self) -> usize {
        self.answers.clear();
        self.answers.extend(self.guesses.iter().map(|guess| {
            let mut coordinates = guess.clone();
            self.solver.solve(coordinates.as_mut_slice(), ReliefSolver::Newton).ok()?;
            Some(coordinates)
        }));
        self.answers.iter().flatten().count()
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        let tree = Tree::of(&self.mechanism);
        self.answers.iter().map(|answer| Some(tree.values(answer.as_ref()?))).collect()
    }
}
