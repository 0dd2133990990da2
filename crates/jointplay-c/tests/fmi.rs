//! Entries of FMI as a simulator calls them: order of calls, invalid pointers and values, states, messages.
#![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fs;
use std::path::PathBuf;
use std::ptr::{null, null_mut};

use jointplay::format::catalogue;
use jointplay::interop::fmu::{Fmu, Resources};
use jointplay_c::fmi::{Instance, Saved, v2::*, v3::*, v3_unsupported::*};

const OK: c_int = 0;
const DISCARD: c_int = 2;
const ERROR: c_int = 3;

/// A unit's resources in a folder of their own, removed at the end.
struct Unit {
    folder: PathBuf,
    resources: Resources,
}

impl Unit {
    fn new(name: &str, test: &str) -> Self {
        let folder = format!("jointplay fmi ä {test} {}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        fs::create_dir_all(&folder).unwrap();
        let resources = Resources::for_model(catalogue::find(name).unwrap().text);
        for (file, text) in resources.files() {
            fs::write(folder.join(file), text).unwrap();
        }
        Self { folder, resources }
    }

    /// As simulators write it, with what a URI escapes.
    fn location(&self) -> CString {
        let path = self.folder.display().to_string().replace(' ', "%20").replace('ä', "%C3%A4");
        CString::new(format!("file://{path}")).unwrap()
    }

    fn token(&self) -> CString {
        CString::new(self.resources.token()).unwrap()
    }

    /// An instance of FMI 3.0 and its messages.
    fn third(&self, messages: &mut Vec<String>) -> *mut Instance {
        let path = CString::new(self.folder.display().to_string()).unwrap();
        instantiate_third(path.as_ptr(), self.token().as_ptr(), messages)
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

unsafe extern "C" fn collect(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is that of `instantiate_third`, and texts are ended by NUL.
    let (messages, category, message) = unsafe {
        let text = |from| CStr::from_ptr(from).to_str().unwrap();
        (&mut *environment.cast::<Vec<String>>(), text(category), text(message))
    };
    messages.push(format!("{status} {category}: {message}"));
}

fn instantiate_third(
    resources: *const c_char,
    token: *const c_char,
    messages: &mut Vec<String>,
) -> *mut Instance {
    let environment = std::ptr::from_mut(messages).cast();
    let (name, no, logger) = (c"unit".as_ptr(), false, Some(collect as _));
    // SAFETY: texts are ended by NUL, or NULL.
    unsafe {
        fmi3InstantiateCoSimulation(
            name,
            token,
            resources,
            no,
            no,
            no,
            no,
            null(),
            0,
            environment,
            logger,
            None,
        )
    }
}

fn initialize(one: *mut Instance) {
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(one, false, 0.0, 1.5, false, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(one), OK);
    }
}

fn get(one: *mut Instance, reference: u32) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: one reference and room for one value.
    assert_eq!(unsafe { fmi3GetFloat64(one, &raw const reference, 1, &raw mut value, 1) }, OK);
    value
}

fn set(one: *mut Instance, reference: u32, value: f64) -> c_int {
    // SAFETY: one reference and one value.
    unsafe { fmi3SetFloat64(one, &raw const reference, 1, &raw const value, 1) }
}

/// A step, and the last time that it reports.
fn step(one: *mut Instance, time: f64, by: f64) -> (c_int, f64) {
    let mut last = f64::NAN;
    // SAFETY: NULL, or room for one value.
    let status = unsafe {
        fmi3DoStep(one, time, by, true, null_mut(), null_mut(), null_mut(), &raw mut last)
    };
    (status, last)
}

#[test]
fn calls_in_their_order_give_the_numbers_of_the_library() {
    let unit = Unit::new("four-bar", "order");
    let mut messages = Vec::new();
    let one = unit.third(&mut messages);
    assert!(!one.is_null(), "{messages:?}");
    let mut fmu = Fmu::new(&unit.resources).unwrap();
    let last = fmu.variables().last().unwrap().reference;
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3ExitInitializationMode(one), ERROR);
        assert_eq!(fmi3Terminate(one), ERROR);
    }
    assert_eq!(step(one, 0.0, 0.1).0, ERROR);
    assert!(messages.len() == 3 && messages[2].contains("needs mode Step"), "{messages:?}");
    initialize(one);
    assert_eq!(get(one, 0).to_bits(), 1.5_f64.to_bits());
    for k in 1..=5 {
        let value = 1.2 + 0.1 * f64::from(k);
        assert_eq!(set(one, 1, value), OK);
        let time = 1.5 + 0.1 * f64::from(k - 1);
        assert_eq!(step(one, time, 0.1), (OK, time + 0.1));
        fmu.set(&[(1, value)]).unwrap();
        fmu.update().unwrap();
        for reference in 1..=last {
            assert_eq!(get(one, reference).to_bits(), fmu.value(reference).unwrap().to_bits());
        }
    }
    for (time, by) in [(f64::NAN, 0.1), (2.0, 0.0), (2.0, -0.1), (2.0, f64::INFINITY)] {
        assert_eq!(step(one, time, by).0, ERROR, "{time}, {by}");
    }
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3Terminate(one), OK);
        assert_eq!(set(one, 1, 1.0), ERROR);
        assert_eq!(fmi3Reset(one), OK);
        initialize(one);
        fmi3FreeInstance(one);
        fmi3FreeInstance(null_mut());
        fmi2FreeInstance(null_mut());
    }
}

#[test]
fn a_discarded_step_leaves_everything_as_it_was() {
    let unit = Unit::new("gpr-mechanism", "discard");
    let mut messages = Vec::new();
    let one = unit.third(&mut messages);
    // An initial value far from the start is found by a search.
    assert_eq!(set(one, 1, 0.02), OK);
    initialize(one);
    let last = Fmu::new(&unit.resources).unwrap().variables().last().unwrap().reference;
    let all = |one| (1..=last).map(|reference| get(one, reference).to_bits()).collect::<Vec<_>>();
    assert_eq!(get(one, 1).to_bits(), 0.02_f64.to_bits());
    let before = all(one);
    assert_eq!(set(one, 1, 0.3), OK);
    let (status, time) = step(one, 1.5, 0.5);
    assert_eq!((status, time.to_bits()), (DISCARD, 1.5_f64.to_bits()));
    let message = messages.last().unwrap();
    assert!(message.starts_with("2 logStatusDiscard: limits exceeded: rod 1"), "{message}");
    assert_eq!(all(one)[1..], before[1..]);
    assert_eq!(set(one, 1, 0.02), OK);
    assert_eq!(step(one, 1.5, 0.5).0, OK);
    assert_eq!(all(one), before);
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(one) };
}

#[test]
fn invalid_pointers_and_values_are_errors() {
    let unit = Unit::new("four-bar", "pointers");
    let mut messages = Vec::new();
    let one = unit.third(&mut messages);
    initialize(one);
    let (reference, mut value) = (1_u32, 0.5);
    let (reference, place) = (&raw const reference, &raw mut value);
    // SAFETY: NULL is refused; other pointers have room.
    unsafe {
        assert_eq!(fmi3GetFloat64(null_mut(), reference, 1, place, 1), ERROR);
        for status in [
            fmi3GetFloat64(one, null(), 1, place, 1),
            fmi3GetFloat64(one, reference, 1, null_mut(), 1),
            fmi3GetFloat64(one, reference, 1, place, 2),
            fmi3SetFloat64(one, reference, 1, null(), 1),
            fmi3SetFloat64(one, reference, 1, place, 0),
            fmi3GetFMUState(one, null_mut()),
            fmi3SetFMUState(one, null_mut()),
            fmi3SerializedFMUStateSize(one, null_mut(), null_mut()),
            fmi3DeserializeFMUState(one, null(), 0, null_mut()),
            fmi3GetDirectionalDerivative(one, reference, 1, reference, 1, place, 1, place, 1),
            fmi3GetFloat32(one, reference, 1, null_mut(), 1),
            fmi3EnterEventMode(one),
            fmi3GetAdjointDerivative(one, reference, 1, reference, 1, place, 1, place, 1),
        ] {
            assert_eq!(status, ERROR);
        }
        assert_eq!(messages.len(), 13, "{messages:#?}");
        // Nothing is asked for: no pointer is needed.
        assert_eq!(fmi3GetFloat64(one, null(), 0, null_mut(), 0), OK);
        assert_eq!(fmi3GetInt32(one, null(), 0, null_mut(), 0), OK);
        assert_eq!(fmi3FreeFMUState(one, null_mut()), OK);
    }
    for (reference, value) in [(1, f64::NAN), (1, f64::INFINITY), (2, 0.0), (0, 0.0), (999, 0.0)] {
        assert_eq!(set(one, reference, value), ERROR, "{reference}: {value}");
    }
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(one) };
}

#[test]
fn states_are_saved_restored_and_serialized() {
    let unit = Unit::new("hexapod", "states");
    let mut messages = Vec::new();
    let one = unit.third(&mut messages);
    initialize(one);
    let mut state: *mut Saved = null_mut();
    let mut size = 0;
    let output = 7;
    // SAFETY: an instance, states of it, and room for all.
    unsafe {
        assert_eq!(fmi3GetFMUState(one, &raw mut state), OK);
        let first = get(one, output);
        assert_eq!(set(one, 1, get(one, 1) + 0.01), OK);
        assert_eq!(step(one, 1.5, 0.1).0, OK);
        let second = get(one, output);
        assert_ne!(first.to_bits(), second.to_bits());
        assert_eq!(fmi3SetFMUState(one, state), OK);
        assert_eq!((get(one, output).to_bits(), get(one, 0)), (first.to_bits(), 1.5));
        // The same memory is used again.
        let before = state;
        assert_eq!(fmi3GetFMUState(one, &raw mut state), OK);
        assert_eq!(state, before);
        assert_eq!(fmi3SerializedFMUStateSize(one, state, &raw mut size), OK);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi3SerializeFMUState(one, state, bytes.as_mut_ptr(), size - 1), ERROR);
        assert_eq!(fmi3SerializeFMUState(one, state, bytes.as_mut_ptr(), size), OK);
        let mut other: *mut Saved = null_mut();
        assert_eq!(fmi3DeserializeFMUState(one, bytes.as_ptr(), size, &raw mut other), OK);
        assert_eq!(fmi3SetFMUState(one, other), OK);
        assert_eq!(fmi3FreeFMUState(one, &raw mut other), OK);
        assert!(other.is_null());
        for damaged in [0, 3, 20] {
            let mut bytes = bytes.clone();
            bytes[damaged] ^= 0x55;
            let status = fmi3DeserializeFMUState(one, bytes.as_ptr(), size, &raw mut other);
            assert!(status == ERROR && other.is_null());
        }
        assert_eq!(fmi3FreeFMUState(one, &raw mut state), OK);
        fmi3FreeInstance(one);
    }
}

#[test]
fn a_unit_that_cannot_be_instantiated_has_a_reason() {
    let unit = Unit::new("four-bar", "instantiate");
    let (token, path) = (unit.token(), CString::new(unit.folder.display().to_string()).unwrap());
    let check = |resources: *const c_char, token: *const c_char, message: &str| {
        let mut messages = Vec::new();
        assert!(instantiate_third(resources, token, &mut messages).is_null());
        assert!(messages.len() == 1 && messages[0].contains(message), "{messages:?}");
    };
    check(null(), token.as_ptr(), "resourcePath is NULL");
    check(path.as_ptr(), null(), "instantiationToken is NULL");
    check(path.as_ptr(), c"{other}".as_ptr(), "export the unit again");
    check(c"/nowhere".as_ptr(), token.as_ptr(), "cannot read /nowhere/model.toml");
    fs::write(unit.folder.join("settings.toml"), "start = 3").unwrap();
    check(path.as_ptr(), token.as_ptr(), "settings.toml is invalid");
    let mut messages: Vec<String> = Vec::new();
    let environment = std::ptr::from_mut(&mut messages).cast();
    let (name, logger) = (c"unit".as_ptr(), Some(collect as _));
    let (token, path) = (token.as_ptr(), path.as_ptr());
    // SAFETY: texts are ended by NUL.
    let made = unsafe {
        fmi3InstantiateModelExchange(name, token, path, false, false, environment, logger)
    };
    assert!(made.is_null() && messages[0].contains("co-simulation only"), "{messages:?}");
}

#[test]
fn the_entries_of_fmi_2_are_those_of_fmi_3() {
    let unit = Unit::new("gpr-mechanism", "second");
    let callbacks = Callbacks {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: null_mut(),
    };
    let make = |kind, location: *const c_char| {
        let (name, token) = (c"unit".as_ptr(), unit.token());
        // SAFETY: texts are ended by NUL.
        unsafe { fmi2Instantiate(name, kind, token.as_ptr(), location, &raw const callbacks, 0, 0) }
    };
    let location = unit.location();
    assert!(make(0, location.as_ptr()).is_null(), "model exchange");
    assert!(make(1, c"http://host/resources".as_ptr()).is_null());
    assert!(make(1, null()).is_null());
    let one = make(1, location.as_ptr());
    assert!(!one.is_null());
    let mut messages = Vec::new();
    let third = unit.third(&mut messages);
    initialize(third);
    let (references, rods) = ([1_u32, 2, 3], [1e-3, -5e-4, 2e-4]);
    let mut time = f64::NAN;
    let mut flag = 7;
    // SAFETY: instances, and room for all.
    unsafe {
        assert_eq!(fmi2SetupExperiment(one, 0, 0.0, 1.5, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(one), OK);
        assert_eq!(fmi2ExitInitializationMode(one), OK);
        assert_eq!(fmi2SetReal(one, references.as_ptr(), 3, rods.as_ptr()), OK);
        assert_eq!(fmi2DoStep(one, 1.5, 0.5, 1), OK);
        assert_eq!(fmi2GetRealStatus(one, 2, &raw mut time), OK);
        assert_eq!(fmi2GetBooleanStatus(one, 3, &raw mut flag), OK);
        assert_eq!((time, flag), (2.0, 0));
        assert_eq!(fmi2GetStatus(one, 0, &raw mut flag), ERROR);
        assert_eq!(fmi2CancelStep(one), ERROR);
        assert_eq!(fmi2GetInteger(one, references.as_ptr(), 1, &raw mut flag), ERROR);
        for (reference, value) in references.into_iter().zip(rods) {
            assert_eq!(set(third, reference, value), OK);
        }
        assert_eq!(step(third, 1.5, 0.5).0, OK);
        let count = Fmu::new(&unit.resources).unwrap().variables().len();
        for reference in 1..=u32::try_from(count).unwrap() {
            let mut value = f64::NAN;
            assert_eq!(fmi2GetReal(one, &raw const reference, 1, &raw mut value), OK);
            assert_eq!(value.to_bits(), get(third, reference).to_bits());
        }
        assert_eq!(fmi2Terminate(one), OK);
        fmi2FreeInstance(one);
        fmi3FreeInstance(third);
    }
}
