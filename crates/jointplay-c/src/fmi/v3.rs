//! Entries of FMI 3.0 for co-simulation, with the names and arguments of the standard.
//!
//! # Safety
//! As the standard asks of callers: instances and states come from this library and are not used after they are freed, one thread uses an instance at a time, and the count of an array is that of its entries.
#![allow(non_snake_case, reason = "the names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the same for all, above")]

use std::ffi::{c_char, c_int, c_void};
use std::path::Path;

use super::instance::{Instance, Refusal, Saved, call, copy, free_state, instantiate, read};
use super::log::{Log, Logger3};
use crate::catch::value;
use crate::pointer::{many, object, take, text};

/// A function of the simulator for inputs within steps, which is not used.
pub type IntermediateUpdate =
    Option<unsafe extern "C" fn(*mut c_void, f64, bool, bool, bool, bool, *mut bool, *mut f64)>;
/// A function of the simulator for clocks, which is not used.
pub type Callback = Option<unsafe extern "C" fn(*mut c_void)>;

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Accepts any choice: only errors are logged, and always.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut Instance,
    _logging_on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(instance, |_| Ok(())) }
}

/// Makes an instance; NULL after an error, which is logged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging_on: bool,
    event_mode: bool,
    _early_return: bool,
    _intermediate_variables: *const u32,
    intermediate_count: usize,
    environment: *mut c_void,
    logger: Logger3,
    _intermediate_update: IntermediateUpdate,
) -> *mut Instance {
    instantiate(Log::V3 { logger, environment }, || {
        if event_mode || intermediate_count > 0 {
            return Err("the unit has no events and no intermediate variables".to_owned());
        }
        // SAFETY: the caller promises the NUL.
        let token = unsafe { text(token, "instantiationToken") }.map_err(|failure| failure.text)?;
        // SAFETY: the caller promises the NUL.
        let place = unsafe { text(resources, "resourcePath") }.map_err(|failure| failure.text)?;
        read(Path::new(place), token)
    })
}

/// Refuses: the unit is for co-simulation only.
fn other_kind(logger: Logger3, environment: *mut c_void) -> *mut Instance {
    let refused = || Err("the unit is for co-simulation only".to_owned());
    instantiate(Log::V3 { logger, environment }, refused)
}

/// Refuses: the unit is for co-simulation only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging_on: bool,
    environment: *mut c_void,
    logger: Logger3,
) -> *mut Instance {
    other_kind(logger, environment)
}

/// Refuses: the unit is for co-simulation only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging_on: bool,
    environment: *mut c_void,
    logger: Logger3,
    _clock_update: Callback,
    _lock: Option<unsafe extern "C" fn()>,
    _unlock: Option<unsafe extern "C" fn()>,
) -> *mut Instance {
    other_kind(logger, environment)
}

/// Frees an instance; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut Instance) {
    // SAFETY: the caller's promise.
    value((), || unsafe { take(instance) });
}

/// Begins the initialization at a time (s).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Instance,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe {
        call(instance, |one| {
            one.setup(start)?;
            one.enter_initialization()
        })
    }
}

/// Closes the loops for the initial values of the inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(instance, Instance::exit_initialization) }
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe { call(instance, Instance::terminate) }
}

/// Returns to the initial configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut Instance) -> c_int {
    // SAFETY: the caller promises an instance.
    unsafe {
        call(instance, |one| {
            one.reset();
            Ok(())
        })
    }
}

/// Refuses arrays of different lengths: all variables are scalars.
fn same_count(references: usize, values: usize) -> Result<(), Refusal> {
    if references == values {
        return Ok(());
    }
    let text = format!("{references} value references have {values} values, but all are scalars");
    Err(Refusal::error(text))
}

/// Copies values of variables (m, rad; s).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    // SAFETY: the caller promises an instance, and arrays of as many entries.
    unsafe {
        call(instance, |one| {
            same_count(count, value_count)?;
            one.get((references, count), values)
        })
    }
}

/// Sets inputs (m, rad), all or none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> c_int {
    // SAFETY: the caller promises an instance, and arrays of as many entries.
    unsafe {
        call(instance, |one| {
            same_count(count, value_count)?;
            one.set((references, count), values)
        })
    }
}

/// Saves the state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut Instance, state: *mut *mut Saved) -> c_int {
    // SAFETY: the caller promises an instance, and NULL or a state.
    unsafe { call(instance, |one| one.save(state)) }
}

/// Returns to a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut Instance, state: *mut Saved) -> c_int {
    // SAFETY: the caller promises an instance and a state.
    unsafe { call(instance, |one| one.restore(object(state, "FMUState")?)) }
}

/// Frees a state; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: *mut Instance,
    state: *mut *mut Saved,
) -> c_int {
    // SAFETY: the caller promises an instance, and NULL or a state.
    unsafe {
        call(instance, |_| {
            free_state(state);
            Ok(())
        })
    }
}

/// Number of the bytes of a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut Instance,
    state: *mut Saved,
    size: *mut usize,
) -> c_int {
    // SAFETY: the caller promises an instance, a state, and room for a number.
    unsafe { call(instance, |_| copy(&[object(state, "FMUState")?.byte_count()], size, "size")) }
}

/// Copies the bytes of a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut Instance,
    state: *mut Saved,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    // SAFETY: the caller promises an instance, a state, and room for `size` bytes.
    unsafe { call(instance, |_| object(state, "FMUState")?.copy(bytes, size)) }
}

/// Makes a state of its bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut Instance,
    bytes: *const u8,
    size: usize,
    state: *mut *mut Saved,
) -> c_int {
    // SAFETY: the caller promises an instance, `size` bytes, and NULL or a state.
    unsafe { call(instance, |one| one.load(&many(bytes, size, "serializedState")?, state)) }
}

/// Copies directional derivatives of outputs by inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: *mut Instance,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    let (unknowns, knowns) = ((unknowns, unknown_count), (knowns, known_count));
    // SAFETY: the caller promises an instance, and arrays of as many entries.
    unsafe {
        call(instance, |one| {
            same_count(known_count, seed_count)?;
            same_count(unknown_count, sensitivity_count)?;
            one.rates(unknowns, knowns, seed, sensitivity)
        })
    }
}

/// Computes the outputs for the inputs; a step without a solution is discarded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut Instance,
    time: f64,
    step: f64,
    _no_set_state_before: bool,
    event_handling_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_successful_time: *mut f64,
) -> c_int {
    // SAFETY: the caller promises an instance, and NULL or room for each result.
    unsafe {
        call(instance, |one| {
            let done = one.step(time, step);
            for flag in [event_handling_needed, terminate, early_return] {
                crate::pointer::write(flag, &[false]);
            }
            crate::pointer::write(last_successful_time, &[one.time()]);
            done
        })
    }
}
