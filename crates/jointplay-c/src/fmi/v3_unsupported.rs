//! Entries of FMI 3.0 for what units of jointplay do not have: other types of variables, model exchange, clocks.
//!
//! Simulators ask for every entry of the standard when they load a library.
//!
//! # Safety
//! As in [`super::v3`].
#![allow(non_snake_case, reason = "the names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the same for all, above")]

use std::ffi::{c_char, c_int};

use super::instance::{Instance, Refusal, call};

macro_rules! without_variables {
    ($($name:ident($($argument:ty),*), $kind:literal;)*) => {$(
        /// Refuses: no variable has this type.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut Instance,
            _references: *const u32,
            count: usize
            $(, _: $argument)*
        ) -> c_int {
            let refusal = || Refusal::error(concat!("the unit has no variables of type ", $kind));
            // SAFETY: the caller promises an instance.
            unsafe { call(instance, |_| if count == 0 { Ok(()) } else { Err(refusal()) }) }
        }
    )*};
}

without_variables! {
    fmi3GetFloat32(*mut f32, usize), "Float32";
    fmi3GetInt8(*mut i8, usize), "Int8";
    fmi3GetUInt8(*mut u8, usize), "UInt8";
    fmi3GetInt16(*mut i16, usize), "Int16";
    fmi3GetUInt16(*mut u16, usize), "UInt16";
    fmi3GetInt32(*mut i32, usize), "Int32";
    fmi3GetUInt32(*mut u32, usize), "UInt32";
    fmi3GetInt64(*mut i64, usize), "Int64";
    fmi3GetUInt64(*mut u64, usize), "UInt64";
    fmi3GetBoolean(*mut bool, usize), "Boolean";
    fmi3GetString(*mut *const c_char, usize), "String";
    fmi3GetBinary(*mut usize, *mut *const u8, usize), "Binary";
    fmi3GetClock(*mut bool), "Clock";
    fmi3SetFloat32(*const f32, usize), "Float32";
    fmi3SetInt8(*const i8, usize), "Int8";
    fmi3SetUInt8(*const u8, usize), "UInt8";
    fmi3SetInt16(*const i16, usize), "Int16";
    fmi3SetUInt16(*const u16, usize), "UInt16";
    fmi3SetInt32(*const i32, usize), "Int32";
    fmi3SetUInt32(*const u32, usize), "UInt32";
    fmi3SetInt64(*const i64, usize), "Int64";
    fmi3SetUInt64(*const u64, usize), "UInt64";
    fmi3SetBoolean(*const bool, usize), "Boolean";
    fmi3SetString(*const *const c_char, usize), "String";
    fmi3SetBinary(*const usize, *const *const u8, usize), "Binary";
    fmi3SetClock(*const bool), "Clock";
}

macro_rules! unsupported {
    ($($name:ident($($argument:ty),*);)*) => {$(
        /// Refuses: not for co-simulation, or declared in the description as not provided.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut Instance $(, _: $argument)*) -> c_int {
            let text = concat!(stringify!($name), " is not supported by the unit");
            // SAFETY: the caller promises an instance.
            unsafe { call(instance, |_| Err(Refusal::error(text))) }
        }
    )*};
}

unsupported! {
    fmi3EnterEventMode();
    fmi3GetNumberOfVariableDependencies(u32, *mut usize);
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize);
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut c_int);
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut c_int);
    fmi3GetShiftDecimal(*const u32, usize, *mut f64);
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(*const u32, usize, *const f64);
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
    fmi3SetShiftDecimal(*const u32, usize, *const f64);
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
    fmi3EvaluateDiscreteStates();
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
    fmi3EnterStepMode();
    fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
    fmi3ActivateModelPartition(u32, f64);
}
