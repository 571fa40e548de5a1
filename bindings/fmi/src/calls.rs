//! FMI's functions for co-simulation: instantiate, initialise, set, step, get.

use crate::fmi3Status::{self, Error, Fatal, Ok as Done, Warning};
use crate::foreign::{self, Instance, Log, LogMessage};
use core::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use touchstone_fmu::Half;
use touchstone_fmu::model::Model;

/// Runs a call on its instance. Returns `Error` for a null pointer. A panic, which only a bug of this library causes, becomes
/// `Fatal`, because a panic must not unwind into the importing program.
pub(crate) fn on(
    pointer: *mut c_void,
    call: impl FnOnce(&mut Instance) -> fmi3Status,
) -> fmi3Status {
    let Some(instance) = foreign::instance(pointer) else {
        return Error;
    };
    let log = instance.log;
    catch_unwind(AssertUnwindSafe(|| call(instance)))
        .unwrap_or_else(|_| log.say(Fatal, "Touchstone: a mistake in this library; report it"))
}

/// The version of FMI.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Makes an instance. Returns null, after a message, if the resources are those of another FMU or the scene cannot run.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
#[allow(clippy::too_many_arguments)]
pub extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log: Option<LogMessage>,
    _update: *const c_void,
) -> *mut c_void {
    let log = Log {
        call: log,
        environment,
    };
    let (Some(token), Some(resources)) = (foreign::text(token), foreign::text(resources)) else {
        log.say(
            Error,
            "instantiationToken or resourcePath: it is no text in UTF-8; give both",
        );
        return core::ptr::null_mut();
    };
    let made = catch_unwind(|| Model::open(Path::new(resources), token));
    match made {
        Ok(Ok(model)) => foreign::give(Instance {
            model,
            is_running: false,
            is_warned: false,
            is_warned_of_change: false,
            log,
        }),
        Ok(Err(error)) => {
            log.say(Error, &error.to_string());
            core::ptr::null_mut()
        }
        Err(_) => {
            log.say(Fatal, "Touchstone: a mistake in this library; report it");
            core::ptr::null_mut()
        }
    }
}

/// Frees an instance.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    foreign::free(instance);
}

/// Accepted without effect: errors and warnings always cause a message, and nothing else does.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    _on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> fmi3Status {
    on(instance, |_| Done)
}

/// Begins the initialisation, and sets the time at which the first step begins.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: bool,
    _stop_s: f64,
) -> fmi3Status {
    on(instance, |instance| {
        let log = instance.log;
        if instance.is_running {
            return log.say(
                Error,
                "fmi3EnterInitializationMode: the instance already runs; call fmi3Reset first",
            );
        }
        match instance.model.start_at(start_s) {
            Ok(()) => Done,
            Err(error) => log.say(Error, &error.to_string()),
        }
    })
}

/// Ends the initialisation: steps may follow.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> fmi3Status {
    on(instance, |instance| {
        instance.is_running = true;
        Done
    })
}

/// Ends the simulation: no step may follow.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3Terminate(instance: *mut c_void) -> fmi3Status {
    on(instance, |instance| {
        instance.is_running = false;
        Done
    })
}

/// Returns the instance to the state after its instantiation.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3Reset(instance: *mut c_void) -> fmi3Status {
    on(instance, |instance| {
        instance.is_running = false;
        instance.is_warned = false;
        match instance.model.reset() {
            Ok(()) => Done,
            Err(error) => instance.log.say(Error, &error.to_string()),
        }
    })
}

/// Reads variables into an array. Each pair holds an array's pointer and length.
fn get<T: Copy>(
    instance: *mut c_void,
    (references, count): (*const u32, usize),
    (values, value_count): (*mut T, usize),
    read: impl Fn(&Model, u32) -> Result<T, touchstone_sim::error::Error>,
) -> fmi3Status {
    on(instance, |instance| {
        let log = instance.log;
        let Some(references) = foreign::array(references, count) else {
            return log.say(Error, NULL);
        };
        if references.len() != value_count {
            return log.say(Error, COUNTS);
        }
        for (index, reference) in references.iter().enumerate() {
            match read(&instance.model, *reference) {
                Err(error) => return log.say(Error, &error.to_string()),
                Ok(value) if foreign::put(values, index, value) => {}
                Ok(_) => return log.say(Error, NULL),
            }
        }
        Done
    })
}

/// Reads numbers.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> fmi3Status {
    get(
        instance,
        (references, count),
        (values, value_count),
        Model::number,
    )
}

/// Reads truth values.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3GetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut bool,
    value_count: usize,
) -> fmi3Status {
    get(
        instance,
        (references, count),
        (values, value_count),
        Model::truth,
    )
}

/// Sets inputs.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> fmi3Status {
    on(instance, |instance| {
        let arrays = (
            foreign::array(references, count),
            foreign::array(values, value_count),
        );
        let (Some(references), Some(values)) = arrays else {
            return instance.log.say(Error, NULL);
        };
        if references.len() != values.len() {
            return instance.log.say(Error, COUNTS);
        }
        for (reference, value) in references.iter().zip(values) {
            if let Err(error) = instance.model.set(*reference, *value) {
                return instance.log.say(Error, &error.to_string());
            }
        }
        Done
    })
}

const NULL: &str = "valueReferences or values: a pointer is null; give arrays";
const COUNTS: &str = "nValues: every variable has one value; give as many values as references";

/// Simulates one step: a control period, or several in which the inputs do not change.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
#[allow(clippy::too_many_arguments)]
pub extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    begins_s: f64,
    step_s: f64,
    _no_set_state: bool,
    event: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_s: *mut f64,
) -> fmi3Status {
    on(instance, |instance| {
        // A step always runs to its end: no event handling, no termination, no early return.
        for answer in [event, terminate, early_return] {
            foreign::put(answer, 0, false);
        }
        let log = instance.log;
        let status = if !instance.is_running {
            log.say(
                Error,
                "fmi3DoStep: the instance is not initialised, or terminated; call fmi3ExitInitializationMode first",
            )
        } else {
            match instance.model.ticks_of(begins_s, step_s) {
                Err(error) => log.say(Error, &error.to_string()),
                Ok(ticks) => {
                    if ticks > 1 && instance.model.half() == Half::Law && !instance.is_warned {
                        instance.is_warned = true;
                        log.say(Warning, &format!("fmi3DoStep: a step has {ticks} control periods, in which the law gets the same angle; give steps of one"));
                    }
                    if instance.model.lacks_change() && !instance.is_warned_of_change {
                        instance.is_warned_of_change = true;
                        log.say(Warning, "fmi3DoStep: the angle at which the torque changed was never set, so the guard's energy bound does not hold; set this input before each step, or export with law.guard.change = estimated");
                    }
                    match instance.model.step(ticks) {
                        Ok(()) => Done,
                        Err(error) => log.say(Error, &error.to_string()),
                    }
                }
            }
        };
        foreign::put(last_s, 0, instance.model.now_s());
        status
    })
}
