//! Instances of functional mock-up units, common to both versions of the interface.

use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use jointplay::interop::fmu::{Error, Fmu, State};

use super::log::{DISCARD, ERROR, FATAL, Log, OK};
use super::place;
use crate::catch::message;
use crate::pointer::many;

/// An instance of a unit. One thread at a time uses it.
pub struct Instance {
    fmu: Fmu,
    mode: Mode,
    log: Log,
}

/// Where the simulation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Instantiated,
    Initialization,
    Step,
    Terminated,
    /// After a panic.
    Broken,
}

const MODES: [Mode; 4] = [Mode::Instantiated, Mode::Initialization, Mode::Step, Mode::Terminated];

/// Everything that changes in an instance.
pub struct Saved {
    mode: Mode,
    state: State,
}

/// Why a call is refused.
pub(super) struct Refusal {
    status: c_int,
    text: String,
}

impl Refusal {
    pub(super) fn error(text: impl Into<String>) -> Self {
        Self { status: ERROR, text: text.into() }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let status = if error.is_infeasible() { DISCARD } else { ERROR };
        Self { status, text: error.to_string() }
    }
}

impl From<crate::catch::Failure> for Refusal {
    fn from(failure: crate::catch::Failure) -> Self {
        Self::error(failure.text)
    }
}

/// Makes an instance; NULL after an error, which is logged.
pub(super) fn instantiate(log: Log, make: impl FnOnce() -> Result<Fmu, String>) -> *mut Instance {
    let made = catch_unwind(AssertUnwindSafe(make));
    let (status, text) = match made {
        Ok(Ok(fmu)) => {
            return Box::into_raw(Box::new(Instance { fmu, mode: Mode::Instantiated, log }));
        }
        Ok(Err(text)) => (ERROR, text),
        Err(panic) => (FATAL, message(&*panic)),
    };
    // The message may panic no more than the logger does, which is foreign.
    let _ = catch_unwind(AssertUnwindSafe(|| log.write(status, &text)));
    std::ptr::null_mut()
}

/// Reads the model of a unit, and compares it with the token of the description.
pub(super) fn read(folder: &Path, token: &str) -> Result<Fmu, String> {
    let resources = place::read(folder)?;
    let own = resources.token();
    if token.trim() != own {
        return Err(format!(
            "the description has the token {token:?}, but resources and library have {own:?}: export the unit again"
        ));
    }
    Fmu::new(&resources).map_err(|error| error.to_string())
}

/// Runs the work of an entry, and logs why it is refused.
///
/// # Safety
/// The pointer is NULL or an instance, which no other thread uses.
pub(super) unsafe fn call(
    instance: *mut Instance,
    work: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> c_int {
    // SAFETY: the caller's promise.
    let Some(instance) = (unsafe { instance.as_mut() }) else { return ERROR };
    let done = catch_unwind(AssertUnwindSafe(|| {
        if instance.mode == Mode::Broken {
            return Err(Refusal { status: FATAL, text: "the instance is broken".to_owned() });
        }
        work(instance)
    }));
    let refusal = match done {
        Ok(Ok(())) => return OK,
        Ok(Err(refusal)) => refusal,
        Err(panic) => {
            instance.mode = Mode::Broken;
            Refusal { status: FATAL, text: message(&*panic) }
        }
    };
    let _ = catch_unwind(AssertUnwindSafe(|| instance.log.write(refusal.status, &refusal.text)));
    refusal.status
}

impl Instance {
    /// Refuses a call in another mode.
    fn require(&self, mode: Mode) -> Result<(), Refusal> {
        if self.mode == mode {
            return Ok(());
        }
        Err(Refusal::error(format!("the call needs mode {mode:?}, but it is {:?}", self.mode)))
    }

    /// Sets the time before the initialization (s).
    pub(super) fn setup(&mut self, start: f64) -> Result<(), Refusal> {
        self.require(Mode::Instantiated)?;
        if !start.is_finite() {
            return Err(Refusal::error(format!("the start time is {start}")));
        }
        self.fmu.set_time(start);
        Ok(())
    }

    pub(super) fn enter_initialization(&mut self) -> Result<(), Refusal> {
        self.require(Mode::Instantiated)?;
        self.mode = Mode::Initialization;
        Ok(())
    }

    pub(super) fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.require(Mode::Initialization)?;
        self.initialize()?;
        self.mode = Mode::Step;
        Ok(())
    }

    /// The initial configuration; there is no earlier one to return to, so that nothing is discarded.
    fn initialize(&mut self) -> Result<(), Refusal> {
        self.fmu.initialize().map_err(|error| Refusal::error(error.to_string()))
    }

    pub(super) fn terminate(&mut self) -> Result<(), Refusal> {
        self.require(Mode::Step)?;
        self.mode = Mode::Terminated;
        Ok(())
    }

    pub(super) fn reset(&mut self) {
        self.fmu.reset();
        self.mode = Mode::Instantiated;
    }

    /// Computes the outputs for the inputs that were set before.
    pub(super) fn step(&mut self, time: f64, step: f64) -> Result<(), Refusal> {
        self.require(Mode::Step)?;
        if !time.is_finite() || !step.is_finite() || step <= 0.0 {
            let text =
                format!("the step from {time} s by {step} s: it has to be positive and finite");
            return Err(Refusal::error(text));
        }
        self.fmu.update()?;
        self.fmu.set_time(time + step);
        Ok(())
    }

    /// Time of the last step that was done (s).
    pub(super) fn time(&self) -> f64 {
        self.fmu.time()
    }

    /// Copies values of variables.
    ///
    /// # Safety
    /// Each pointer is NULL or has as many numbers as its count.
    pub(super) unsafe fn get(
        &mut self,
        (references, count): (*const u32, usize),
        values: *mut f64,
    ) -> Result<(), Refusal> {
        // SAFETY: the caller's promise.
        let references = unsafe { many(references, count, "value references") }?;
        if self.mode == Mode::Initialization {
            self.initialize()?;
        }
        let found = references.iter().map(|&one| self.fmu.value(one));
        let found: Vec<f64> = found.collect::<Result<_, _>>()?;
        // SAFETY: the caller's promise.
        unsafe { copy(&found, values, "values") }
    }

    /// Sets inputs, all or none.
    ///
    /// # Safety
    /// Each pointer is NULL or has as many numbers as its count.
    pub(super) unsafe fn set(
        &mut self,
        (references, count): (*const u32, usize),
        values: *const f64,
    ) -> Result<(), Refusal> {
        if self.mode == Mode::Terminated {
            return Err(Refusal::error("the simulation is terminated"));
        }
        // SAFETY: the caller's promise.
        let references = unsafe { many(references, count, "value references") }?;
        // SAFETY: the caller's promise.
        let values = unsafe { many(values, count, "values") }?;
        let pairs: Vec<(u32, f64)> = references.into_iter().zip(values).collect();
        Ok(self.fmu.set(&pairs)?)
    }

    /// Copies directional derivatives.
    ///
    /// # Safety
    /// Each pointer is NULL or has as many numbers as its count.
    pub(super) unsafe fn rates(
        &mut self,
        (unknowns, unknown_count): (*const u32, usize),
        (knowns, known_count): (*const u32, usize),
        seed: *const f64,
        sensitivity: *mut f64,
    ) -> Result<(), Refusal> {
        // SAFETY: the caller's promise.
        let unknowns = unsafe { many(unknowns, unknown_count, "unknowns") }?;
        // SAFETY: the caller's promise.
        let knowns = unsafe { many(knowns, known_count, "knowns") }?;
        // SAFETY: the caller's promise.
        let seed = unsafe { many(seed, known_count, "seed") }?;
        if self.mode == Mode::Initialization {
            self.initialize()?;
        }
        let direction: Vec<(u32, f64)> = knowns.into_iter().zip(seed).collect();
        // Drives that do not determine the motion here, as at a dead point, are no error of the caller.
        let found = self.fmu.rates(&unknowns, &direction)?;
        // SAFETY: the caller's promise.
        unsafe { copy(&found, sensitivity, "sensitivity") }
    }

    /// Saves the state, in place of another one if there is one.
    ///
    /// # Safety
    /// `to` is NULL, or has NULL or a state of this library.
    pub(super) unsafe fn save(&self, to: *mut *mut Saved) -> Result<(), Refusal> {
        let saved = Saved { mode: self.mode, state: self.fmu.state() };
        // SAFETY: the caller's promise.
        unsafe { put(saved, to) }
    }

    pub(super) fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        self.fmu.set_state(&saved.state)?;
        self.mode = saved.mode;
        Ok(())
    }

    /// A state of its bytes, in place of another one if there is one.
    ///
    /// # Safety
    /// As [`save`](Self::save).
    pub(super) unsafe fn load(&self, bytes: &[u8], to: *mut *mut Saved) -> Result<(), Refusal> {
        let (mode, bytes) =
            bytes.split_first().ok_or_else(|| Refusal::error("the state has no bytes"))?;
        let mode = MODES.get(usize::from(*mode)).copied();
        let mode = mode.ok_or_else(|| Refusal::error("the state is not one of this unit"))?;
        let saved = Saved { mode, state: self.fmu.state_from_bytes(bytes)? };
        // SAFETY: the caller's promise.
        unsafe { put(saved, to) }
    }
}

impl Saved {
    pub(super) fn byte_count(&self) -> usize {
        1 + self.state.byte_count()
    }

    fn bytes(&self) -> Vec<u8> {
        let mode =
            MODES.iter().position(|&mode| mode == self.mode).and_then(|k| u8::try_from(k).ok());
        let mut bytes = vec![mode.unwrap_or(0)];
        bytes.extend(self.state.to_bytes());
        bytes
    }

    /// Copies the bytes.
    ///
    /// # Safety
    /// `to` is NULL or has room for `size` bytes.
    pub(super) unsafe fn copy(&self, to: *mut u8, size: usize) -> Result<(), Refusal> {
        let bytes = self.bytes();
        if size < bytes.len() {
            let text = format!("the state has {} bytes, but there is room for {size}", bytes.len());
            return Err(Refusal::error(text));
        }
        // SAFETY: the caller's promise.
        unsafe { copy(&bytes, to, "serializedState") }
    }
}

/// Writes numbers to a pointer that must not be NULL if there are any.
///
/// # Safety
/// The pointer is NULL or has room for them.
pub(super) unsafe fn copy<T: Copy>(from: &[T], to: *mut T, what: &str) -> Result<(), Refusal> {
    if !from.is_empty() {
        crate::pointer::writable(to, what)?;
    }
    // SAFETY: the caller's promise.
    unsafe { crate::pointer::write(to, from) };
    Ok(())
}

/// Stores a state in place of another one, or as a new one.
///
/// # Safety
/// `to` is NULL, or has NULL or a state of this library.
unsafe fn put(saved: Saved, to: *mut *mut Saved) -> Result<(), Refusal> {
    crate::pointer::writable(to, "FMUState")?;
    // SAFETY: not NULL, and the caller promises a pointer.
    match unsafe { (*to).as_mut() } {
        Some(old) => *old = saved,
        // SAFETY: not NULL, and the caller promises room.
        None => unsafe { crate::pointer::give(to, saved) },
    }
    Ok(())
}

/// Frees a state, and clears its pointer.
///
/// # Safety
/// As [`put`].
pub(super) unsafe fn free_state(state: *mut *mut Saved) {
    // SAFETY: the caller's promise.
    if let Some(place) = unsafe { state.as_mut() } {
        // SAFETY: the caller's promise.
        unsafe { crate::pointer::take(*place) };
        *place = std::ptr::null_mut();
    }
}
