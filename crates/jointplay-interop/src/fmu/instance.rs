//! One instance of a unit.

use super::error::Error;
use super::model::Model;
use super::resources::Resources;
use super::solved::Solved;
use super::state::State;
use super::variable::{Causality, Variable};

/// One instance of a unit: values of drives in, poses and displacements of virtual joints out.
///
/// The outputs are a function of the drives and, where several configurations have the same drives, of the configuration before.
/// After an error the instance is as before the call.
#[derive(Debug, Clone)]
pub struct Fmu {
    model: Model,
    variables: Vec<Variable>,
    token: String,
    inputs: usize,
    /// Values set by the environment (m, rad).
    drives: Vec<f64>,
    time: f64,
    solved: Solved,
    initial: Solved,
}

impl Fmu {
    /// An instance at the initial configuration.
    ///
    /// # Errors
    /// [`Error`]: an invalid file, no drives, an initial configuration that does not close or is beyond limits, drives that do not determine the motion or hinder each other.
    pub fn new(resources: &Resources) -> Result<Self, Error> {
        let (model, variables, solved) = Model::new(resources)?;
        let variables = variables.0;
        let inputs = variables.iter().filter(|one| one.causality == Causality::Input).count();
        Ok(Self {
            model,
            variables,
            token: resources.token(),
            inputs,
            drives: solved.drives.clone(),
            time: 0.0,
            initial: solved.clone(),
            solved,
        })
    }

    /// All variables but the time, inputs first, in the order of their value references.
    #[must_use]
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Token of the files of the instance.
    #[must_use]
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Time of the instance (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets the time (s), on which no output depends.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Value of a variable (m, rad): of an input as it was set, of an output as it was computed last; of the reference 0 the time (s).
    ///
    /// # Errors
    /// [`Error::NoVariable`].
    pub fn value(&self, reference: u32) -> Result<f64, Error> {
        if reference == 0 {
            return Ok(self.time);
        }
        let k = self.index(reference)?;
        Ok(k.checked_sub(self.inputs).map_or_else(|| self.drives[k], |k| self.solved.outputs[k]))
    }

    /// Sets values of inputs (m, rad), all or none.
    ///
    /// # Errors
    /// [`Error::NoVariable`], [`Error::NotInput`], [`Error::NotFinite`].
    pub fn set(&mut self, values: &[(u32, f64)]) -> Result<(), Error> {
        let mut drives = self.drives.clone();
        for &(reference, value) in values {
            let k = self.input(reference)?;
            if !value.is_finite() {
                let variable = self.variables[k].name.clone();
                return Err(Error::NotFinite { variable, value });
            }
            drives[k] = value;
        }
        self.drives = drives;
        Ok(())
    }

    /// Computes the outputs for the inputs, from the configuration before.
    ///
    /// # Errors
    /// [`Error::TooFar`], [`Error::BeyondLimits`], [`Error::Core`].
    pub fn update(&mut self) -> Result<(), Error> {
        if self.is_stale() {
            self.solved = self.model.solve(&self.drives, &self.solved)?;
        }
        Ok(())
    }

    /// Computes the outputs for the inputs, by a search where they are far from the configuration before.
    ///
    /// # Errors
    /// Those of [`update`](Self::update).
    pub fn initialize(&mut self) -> Result<(), Error> {
        if self.is_stale() {
            self.solved = self.model.initialize(&self.drives, &self.solved)?;
        }
        Ok(())
    }

    /// Whether inputs differ from those of the outputs.
    fn is_stale(&self) -> bool {
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        !self.drives.iter().zip(&self.solved.drives).all(same)
    }

    /// Directional derivatives of outputs by inputs, at the configuration computed last.
    ///
    /// # Arguments
    /// * `outputs` – value references
    /// * `direction` – value references of inputs with their rates (m, rad)
    ///
    /// # Errors
    /// [`Error::NoVariable`], [`Error::NotInput`], [`Error::NotOutput`], [`Error::NotFinite`]; [`Error::Core`] where drives do not determine the motion.
    pub fn rates(&mut self, outputs: &[u32], direction: &[(u32, f64)]) -> Result<Vec<f64>, Error> {
        let mut drives = vec![0.0; self.inputs];
        for &(reference, rate) in direction {
            let k = self.input(reference)?;
            if !rate.is_finite() {
                let variable = self.variables[k].name.clone();
                return Err(Error::NotFinite { variable, value: rate });
            }
            drives[k] = rate;
        }
        let place = |&reference: &u32| {
            let k = self.index(reference)?;
            k.checked_sub(self.inputs).ok_or_else(|| {
                let variable = self.variables[k].name.clone();
                Error::NotOutput { variable }
            })
        };
        let places: Vec<usize> = outputs.iter().map(place).collect::<Result<_, _>>()?;
        let all = self.model.rates(&self.solved, &drives)?;
        Ok(places.into_iter().map(|k| all[k]).collect())
    }

    /// Returns to the initial configuration and the time 0.
    pub fn reset(&mut self) {
        self.solved = self.initial.clone();
        self.drives.clone_from(&self.solved.drives);
        self.time = 0.0;
    }

    /// A copy of everything that changes.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            token: self.token.clone(),
            time: self.time,
            drives: self.drives.clone(),
            solved: self.solved.clone(),
        }
    }

    /// Returns to a state; what follows is the same to the bit.
    ///
    /// # Errors
    /// [`Error::State`] for a state of another unit.
    pub fn set_state(&mut self, state: &State) -> Result<(), Error> {
        state.check(&self.token, &self.solved)?;
        self.time = state.time;
        self.drives.clone_from(&state.drives);
        self.solved = state.solved.clone();
        Ok(())
    }

    /// The state in bytes of [`State::to_bytes`].
    ///
    /// # Errors
    /// [`Error::State`] for bytes that are not those of a state of this unit.
    pub fn state_from_bytes(&self, bytes: &[u8]) -> Result<State, Error> {
        State::from_bytes(bytes, &self.token, &self.solved)
    }

    fn index(&self, reference: u32) -> Result<usize, Error> {
        let found = usize::try_from(reference).ok().and_then(|one| one.checked_sub(1));
        let found = found.filter(|&k| k < self.variables.len());
        found.ok_or(Error::NoVariable { reference })
    }

    fn input(&self, reference: u32) -> Result<usize, Error> {
        if reference == 0 {
            return Err(Error::NotInput { variable: "time".to_owned() });
        }
        let k = self.index(reference)?;
        if k >= self.inputs {
            return Err(Error::NotInput { variable: self.variables[k].name.clone() });
        }
        Ok(k)
    }
}
