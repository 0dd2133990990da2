//! Entries of FMI 2.0 for co-simulation, with the names and arguments of the standard.
//!
//! # Safety
//! As the standard asks of callers: instances and states come from this library and are not used after they are freed, one thread uses an instance at a time, and the count of an array is that of its entries.
#![allow(non_snake_case, reason = "the names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the same for all, above")]

use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::ptr::null_mut;

use super::instance::{Instance, Refusal, Saved, call, copy, free_state, instantiate, read};
use super::log::{Log, Logger2};
use super::place::path_of_location;
use crate::catch::value;
use crate::pointer::{many, object, take, text};

/// Functions of the simulator.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Callbacks {
    /// Takes messages.
    pub logger: Logger2,
    /// Not used.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: steps are synchronous.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    /// Passed to the logger.
    pub environment: *mut c_void,
}

/// The kind of unit that is offered.
const CO_SIMULATION: c_int = 1;
/// The kind of status that is a time.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// The kind of status that is whether the unit asks for an end.
const TERMINATED: c_int = 3;

/// Types of the platform.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Accepts any choice: only errors are logged, and always.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: *mut Instance,
    _logging_on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| Ok(())) }
}

/// Makes an instance; NULL after an error, which is logged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    functions: *const Callbacks,
    _visible: c_int,
    _logging_on: c_int,
) -> *mut Instance {
    // SAFETY: the caller promises NULL or functions.
    let Some(callbacks) = (unsafe { functions.as_ref() }) else { return null_mut() };
    let (logger, environment) = (callbacks.logger, callbacks.environment);
    // SAFETY: the caller promises the NUL.
    let name = unsafe { text(name, "instanceName") }.unwrap_or("");
    let name = CString::new(name).unwrap_or_default();
    instantiate(Log::V2 { logger, environment, name }, || {
        if kind != CO_SIMULATION {
            return Err("the unit is for co-simulation only".to_owned());
        }
        // SAFETY: the caller promises the NUL.
        let guid = unsafe { text(guid, "fmuGUID") }.map_err(|failure| failure.text)?;
        // SAFETY: the caller promises the NUL.
        let place = unsafe { text(resources, "fmuResourceLocation") };
        read(&path_of_location(place.map_err(|failure| failure.text)?)?, guid)
    })
}

/// Frees an instance; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: *mut Instance) {
    // SAFETY: the caller's promise.
    value((), || unsafe { take(c) });
}

/// Sets the start time (s); the unit has no other use for the experiment.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: *mut Instance,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start: f64,
    _stop_defined: c_int,
    _stop: f64,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |one| one.setup(start)) }
}

/// Begins the initialization.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, Instance::enter_initialization) }
}

/// Closes the loops for the initial values of the inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, Instance::exit_initialization) }
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, Instance::terminate) }
}

/// Returns to the initial configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe {
        call(c, |one| {
            one.reset();
            Ok(())
        })
    }
}

/// Copies values of variables (m, rad).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: *mut Instance,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
) -> c_int {
    // SAFETY: the caller promises an instance, and arrays of `count` entries.
    unsafe { call(c, |one| one.get((references, count), values)) }
}

/// Sets inputs (m, rad), all or none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: *mut Instance,
    references: *const c_uint,
    count: usize,
    values: *const f64,
) -> c_int {
    // SAFETY: the caller promises an instance, and arrays of `count` entries.
    unsafe { call(c, |one| one.set((references, count), values)) }
}

/// Refuses variables of a type that no variable has.
unsafe fn no_variables(c: *mut Instance, count: usize, kind: &str) -> c_int {
    let refusal = || Refusal::error(format!("the unit has no variables of type {kind}"));
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| if count == 0 { Ok(()) } else { Err(refusal()) }) }
}

macro_rules! without_variables {
    ($($name:ident $values:ty, $kind:literal;)*) => {$(
        /// Refuses: no variable has this type.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            c: *mut Instance,
            _references: *const c_uint,
            count: usize,
            _values: $values,
        ) -> c_int {
            // SAFETY: the caller promises an instance.
            unsafe { no_variables(c, count, $kind) }
        }
    )*};
}

without_variables! {
    fmi2GetInteger *mut c_int, "Integer";
    fmi2GetBoolean *mut c_int, "Boolean";
    fmi2GetString *mut *const c_char, "String";
    fmi2SetInteger *const c_int, "Integer";
    fmi2SetBoolean *const c_int, "Boolean";
    fmi2SetString *const *const c_char, "String";
}

/// Saves the state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: *mut Instance, state: *mut *mut Saved) -> c_int {
    // SAFETY: the caller promises an instance, and NULL or a state.
    unsafe { call(c, |one| one.save(state)) }
}

/// Returns to a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: *mut Instance, state: *mut Saved) -> c_int {
    // SAFETY: the caller promises an instance and a state.
    unsafe { call(c, |one| one.restore(object(state, "FMUstate")?)) }
}

/// Frees a state; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: *mut Instance, state: *mut *mut Saved) -> c_int {
    // SAFETY: the caller promises an instance, and NULL or a state.
    unsafe {
        call(c, |_| {
            free_state(state);
            Ok(())
        })
    }
}

/// Number of the bytes of a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: *mut Instance,
    state: *mut Saved,
    size: *mut usize,
) -> c_int {
    // SAFETY: the caller promises an instance, a state, and room for a number.
    unsafe { call(c, |_| copy(&[object(state, "FMUstate")?.byte_count()], size, "size")) }
}

/// Copies the bytes of a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: *mut Instance,
    state: *mut Saved,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    // SAFETY: the caller promises an instance, a state, and room for `size` bytes.
    unsafe { call(c, |_| object(state, "FMUstate")?.copy(bytes, size)) }
}

/// Makes a state of its bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: *mut Instance,
    bytes: *const u8,
    size: usize,
    state: *mut *mut Saved,
) -> c_int {
    // SAFETY: the caller promises an instance, `size` bytes, and NULL or a state.
    unsafe { call(c, |one| one.load(&many(bytes, size, "serializedState")?, state)) }
}

/// Copies directional derivatives of outputs by inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: *mut Instance,
    unknowns: *const c_uint,
    unknown_count: usize,
    knowns: *const c_uint,
    known_count: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> c_int {
    let (unknowns, knowns) = ((unknowns, unknown_count), (knowns, known_count));
    // SAFETY: the caller promises an instance, and arrays of as many entries.
    unsafe { call(c, |one| one.rates(unknowns, knowns, seed, sensitivity)) }
}

macro_rules! without_derivatives {
    ($($name:ident $values:ty;)*) => {$(
        /// Refuses: the unit does not interpolate.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            c: *mut Instance,
            _references: *const c_uint,
            _count: usize,
            _orders: *const c_int,
            _values: $values,
        ) -> c_int {
            // SAFETY: the caller promises an instance.
            unsafe { call(c, |_| Err(Refusal::error("the unit does not interpolate"))) }
        }
    )*};
}

without_derivatives! {
    fmi2SetRealInputDerivatives *const f64;
    fmi2GetRealOutputDerivatives *mut f64;
}

/// Computes the outputs for the inputs; a step without a solution is discarded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    c: *mut Instance,
    time: f64,
    step: f64,
    _no_set_state_before: c_int,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |one| one.step(time, step)) }
}

/// Refuses: steps are synchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| Err(Refusal::error("no step is running"))) }
}

/// A kind of status that there is not.
fn no_status(kind: c_int) -> Refusal {
    Refusal::error(format!("there is no status of the kind {kind}"))
}

/// Refuses: steps are synchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: *mut Instance, kind: c_int, _value: *mut c_int) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| Err(no_status(kind))) }
}

/// Time of the last step that was done (s).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    c: *mut Instance,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    let asked = kind == LAST_SUCCESSFUL_TIME;
    // SAFETY: the caller promises an instance, and room for a number.
    unsafe {
        call(
            c,
            |one| if asked { copy(&[one.time()], value, "value") } else { Err(no_status(kind)) },
        )
    }
}

/// Refuses: there is no status of this type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    c: *mut Instance,
    kind: c_int,
    _value: *mut c_int,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| Err(no_status(kind))) }
}

/// Whether the unit asks for an end: never.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: *mut Instance,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    let asked = kind == TERMINATED;
    // SAFETY: the caller promises an instance, and room for a number.
    unsafe { call(c, |_| if asked { copy(&[0], value, "value") } else { Err(no_status(kind)) }) }
}

/// Refuses: there is no status of this type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    c: *mut Instance,
    kind: c_int,
    _value: *mut *const c_char,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(c, |_| Err(no_status(kind))) }
}
