//! FMI's functions for what these FMUs do not have: other types of variables, saved states, events, derivatives, other kinds of
//! simulation. `modelDescription.xml` says so; each call returns an error.

use crate::calls::on;
use crate::fmi3Status;
use core::ffi::{c_char, c_void};

/// Exports functions that only report that they are not supported.
macro_rules! unsupported {
    ($($name:ident($($kind:ty),*);)*) => {
        $(
            #[doc = concat!("Not supported: `", stringify!($name), "`.")]
            #[unsafe(no_mangle)]
            #[allow(unsafe_code)]
            #[allow(clippy::too_many_arguments)]
            pub extern "C" fn $name(instance: *mut c_void, $(_: $kind),*) -> fmi3Status {
                on(instance, |instance| {
                    let problem = concat!(stringify!($name), ": this FMU does not support it; see modelDescription.xml");
                    instance.log.say(fmi3Status::Error, problem)
                })
            }
        )*
    };
}

/// An array of value references.
type References = *const u32;

unsupported! {
    fmi3EnterEventMode();
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3EnterContinuousTimeMode();
    fmi3EnterStepMode();
    fmi3EvaluateDiscreteStates();
    fmi3GetFloat32(References, usize, *mut f32, usize);
    fmi3GetInt8(References, usize, *mut i8, usize);
    fmi3GetUInt8(References, usize, *mut u8, usize);
    fmi3GetInt16(References, usize, *mut i16, usize);
    fmi3GetUInt16(References, usize, *mut u16, usize);
    fmi3GetInt32(References, usize, *mut i32, usize);
    fmi3GetUInt32(References, usize, *mut u32, usize);
    fmi3GetInt64(References, usize, *mut i64, usize);
    fmi3GetUInt64(References, usize, *mut u64, usize);
    fmi3GetString(References, usize, *mut *const c_char, usize);
    fmi3GetBinary(References, usize, *mut usize, *mut *const u8, usize);
    fmi3GetClock(References, usize, *mut bool);
    fmi3SetFloat32(References, usize, *const f32, usize);
    fmi3SetInt8(References, usize, *const i8, usize);
    fmi3SetUInt8(References, usize, *const u8, usize);
    fmi3SetInt16(References, usize, *const i16, usize);
    fmi3SetUInt16(References, usize, *const u16, usize);
    fmi3SetInt32(References, usize, *const i32, usize);
    fmi3SetUInt32(References, usize, *const u32, usize);
    fmi3SetInt64(References, usize, *const i64, usize);
    fmi3SetUInt64(References, usize, *const u64, usize);
    fmi3SetBoolean(References, usize, *const bool, usize);
    fmi3SetString(References, usize, *const *const c_char, usize);
    fmi3SetBinary(References, usize, *const usize, *const *const u8, usize);
    fmi3SetClock(References, usize, *const bool);
    fmi3GetNumberOfVariableDependencies(u32, *mut usize);
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut i32, usize);
    fmi3GetFMUState(*mut *mut c_void);
    fmi3SetFMUState(*mut c_void);
    fmi3FreeFMUState(*mut *mut c_void);
    fmi3SerializedFMUStateSize(*mut c_void, *mut usize);
    fmi3SerializeFMUState(*mut c_void, *mut u8, usize);
    fmi3DeserializeFMUState(*const u8, usize, *mut *mut c_void);
    fmi3GetDirectionalDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize);
    fmi3GetAdjointDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize);
    fmi3GetIntervalDecimal(References, usize, *mut f64, *mut i32);
    fmi3GetIntervalFraction(References, usize, *mut u64, *mut u64, *mut i32);
    fmi3GetShiftDecimal(References, usize, *mut f64);
    fmi3GetShiftFraction(References, usize, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(References, usize, *const f64);
    fmi3SetIntervalFraction(References, usize, *const u64, *const u64);
    fmi3SetShiftDecimal(References, usize, *const f64);
    fmi3SetShiftFraction(References, usize, *const u64, *const u64);
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
    fmi3GetOutputDerivatives(References, usize, *const i32, *mut f64, usize);
    fmi3ActivateModelPartition(u32, f64);
}

/// Returns null: these FMUs are for co-simulation.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _environment: *mut c_void,
    _log: *const c_void,
) -> *mut c_void {
    core::ptr::null_mut()
}

/// Returns null: these FMUs are for co-simulation.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
#[allow(clippy::too_many_arguments)]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _environment: *mut c_void,
    _log: *const c_void,
    _clock: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> *mut c_void {
    core::ptr::null_mut()
}
