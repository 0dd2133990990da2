//! Studies of any function of varied values, such as the check of a program in a work cell.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::block::{Block, Outcome, Portions, SampleLimit};
use super::grid::{self, Grid};
use super::quantiles::chosen;
use super::random::SWEEP_STREAMS;
use super::study::{self, Study};
use super::variation::Variation;
use crate::Error;

/// Computes a sample from its values into the row of its numbers, which are NaN before, and returns its outcome.
///
/// It may reuse work of the sample before, as long as the numbers are the same to the bit.
pub type SampleFunction = Box<dyn FnMut(&[f64], &mut [f64]) -> Outcome>;

/// A value that a sweep varies.
#[derive(Debug, Clone, PartialEq)]
pub struct SweptValue {
    /// Number that chooses its random numbers, below 2³².
    pub number: u32,
    /// Its values.
    pub values: Variation,
}

/// Definition of a study of a function of varied values.
///
/// Lists of values make a grid: every value with every other, the last running fastest.
/// Each draw of what is random runs through the whole grid.
///
/// # Example
/// ```
/// use std::sync::Arc;
/// use jointplay_study::plan::{Outcome, Portions, ProgramOutcome, Study, SweepPlan, SweptValue, Variation};
///
/// let side = SweptValue { number: 0, values: Variation::Values(vec![1.0, 2.0, 3.0]) };
/// let area = |values: &[f64], row: &mut [f64]| {
///     row[0] = values[0] * values[0];
///     Outcome::Program(ProgramOutcome::Passed)
/// };
/// let plan = SweepPlan::new(vec![side], 1, 0, 1, "area".to_owned(), Portions::SLOW, Arc::new(move || Box::new(area)));
/// assert_eq!(plan.compute(&[0, 2])?.columns, [vec![1.0, 3.0], vec![1.0, 9.0]]);
/// # Ok::<(), jointplay_study::Error>(())
/// ```
pub struct SweepPlan {
    values: Vec<SweptValue>,
    draws: u64,
    seed: u64,
    numbers: usize,
    computed: String,
    portions: Portions,
    function: Arc<dyn Fn() -> SampleFunction + Send + Sync>,
    /// Samples that quantiles are taken from.
    chosen: OnceLock<Vec<u64>>,
    /// Those of them that were computed: they take long, and quantiles compute them again.
    known: Mutex<BTreeMap<u64, Known>>,
}

/// A computed sample.
#[derive(Clone)]
struct Known {
    outcome: Outcome,
    row: Vec<f64>,
}

impl SweepPlan {
    /// A sweep; the columns of its blocks are the values, then the numbers of the function.
    ///
    /// # Arguments
    /// * `values` – what varies, the last running fastest
    /// * `draws` – number of draws of the random values; 1 where nothing is random
    /// * `seed` – of the random draws
    /// * `numbers` – how many numbers the function computes
    /// * `computed` – name of what is computed, with which outcomes are reported
    /// * `function` – makes a function for samples that are computed one after the other
    #[must_use]
    pub fn new(
        values: Vec<SweptValue>,
        draws: u64,
        seed: u64,
        numbers: usize,
        computed: String,
        portions: Portions,
        function: Arc<dyn Fn() -> SampleFunction + Send + Sync>,
    ) -> Self {
        let (chosen, known) = (OnceLock::new(), Mutex::default());
        Self { values, draws, seed, numbers, computed, portions, function, chosen, known }
    }

    /// All that varies, the last running fastest, with the numbers of the random streams.
    fn varied(&self) -> impl Iterator<Item = (&Variation, u64)> + Clone {
        self.values.iter().map(|one| (&one.values, SWEEP_STREAMS + u64::from(one.number)))
    }

    fn known(&self, sample: u64) -> Option<Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&sample).cloned()
    }

    fn remember(&self, sample: u64, known: Known) -> Result<(), Error> {
        let chosen = match self.chosen.get() {
            Some(chosen) => chosen,
            None => {
                let chosen = chosen(self)?;
                self.chosen.get_or_init(|| chosen)
            }
        };
        if chosen.binary_search(&sample).is_ok() {
            self.known.lock().unwrap_or_else(PoisonError::into_inner).insert(sample, known);
        }
        Ok(())
    }
}

impl Study for SweepPlan {
    fn samples(&self) -> Result<u64, Error> {
        grid::samples(self.varied().map(|(one, _)| one), self.draws)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn columns(&self) -> usize {
        self.values.len() + self.numbers
    }

    fn solved_for(&self) -> Vec<String> {
        vec![self.computed.clone()]
    }

    fn limits(&self) -> &'static [SampleLimit] {
        &[]
    }

    fn depends_on_processor(&self) -> bool {
        true
    }

    fn portions(&self) -> Portions {
        self.portions
    }

    fn compute(&self, samples: &[u64]) -> Result<Block, Error> {
        study::check(self, samples)?;
        let grid = Grid::new(self.varied(), self.draws, self.seed)?;
        let mut function = (self.function)();
        let mut numbered = samples.iter();
        grid.compute(samples, self.columns(), |values, row| {
            let (given, row) = row.split_at_mut(values.len());
            given.copy_from_slice(values);
            let sample = *numbered.next().expect("a row for each sample");
            if let Some(known) = self.known(sample) {
                row.copy_from_slice(&known.row);
                return Ok((known.outcome, false));
            }
            let outcome = function(values, row);
            self.remember(sample, Known { outcome, row: row.to_vec() })?;
            Ok((outcome, false))
        })
    }
}
