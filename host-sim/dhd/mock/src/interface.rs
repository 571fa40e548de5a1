//! The mock's C functions, with the names and types that Force Dimension's headers `dhdc.h` and `drdc.h` declare.
#![allow(unsafe_code)] // `no_mangle` alone: no block in here is unsafe.
#![allow(non_snake_case)] // The vendor's names.

use crate::machine::{EXPERT_DISABLED, IN_USE, Machine, NO_DEVICE, failed, last_error, machine};
use crate::plan::{Planned, among};
use std::ffi::{c_char, c_int, c_uchar, c_ushort};
use std::ptr;
use touchstone_world::plant::OMEGA3;

const SET_FORCE: &str = "dhdSetForce";

/// A library call that needs the open device. Runs `does`, unless the fault plan makes the call fail.
fn of_device(call: &'static str, does: impl FnOnce(&mut Machine, u64) -> c_int) -> c_int {
    let mut machine = machine();
    let entered = machine.enter(call);
    match (machine.open, entered.error) {
        (false, _) => {
            machine.noted.late_forces += u64::from(call == SET_FORCE);
            failed(NO_DEVICE)
        }
        (true, Some(error)) => failed(error),
        (true, None) => does(&mut machine, entered.number),
    }
}

fn fill<T>(to: Option<&mut T>, value: T) {
    if let Some(to) = to {
        *to = value;
    }
}

fn fill_three(to: [Option<&mut f64>; 3], values: [f64; 3]) {
    for (to, value) in to.into_iter().zip(values) {
        fill(to, value);
    }
}

#[unsafe(no_mangle)]
extern "system" fn dhdErrorGetLast() -> c_int {
    machine().enter("dhdErrorGetLast");
    last_error()
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetSDKVersion(
    major: Option<&mut c_int>,
    minor: Option<&mut c_int>,
    release: Option<&mut c_int>,
    revision: Option<&mut c_int>,
) {
    fill(major, 3);
    fill(minor, 17);
    fill(release, 0);
    fill(revision, 0);
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetDeviceCount() -> c_int {
    let mut machine = machine();
    machine.enter("dhdGetDeviceCount");
    c_int::from(!machine.has(&Planned::Absent) && !machine.gone)
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetAvailableCount() -> c_int {
    let mut machine = machine();
    machine.enter("dhdGetAvailableCount");
    let there = !machine.has(&Planned::Absent) && !machine.gone;
    c_int::from(there && !machine.has(&Planned::Held))
}

#[unsafe(no_mangle)]
extern "system" fn dhdOpenID(index: c_char) -> c_int {
    let mut machine = machine();
    let entered = machine.enter("dhdOpenID");
    if machine.has(&Planned::Absent) || index != 0 {
        return failed(NO_DEVICE);
    }
    if let Some(error) = entered.error {
        return failed(error);
    }
    match machine.take() {
        true => 0,
        false => failed(IN_USE),
    }
}

#[unsafe(no_mangle)]
extern "system" fn dhdClose(_id: c_char) -> c_int {
    let mut machine = machine();
    let entered = machine.enter("dhdClose");
    if !machine.open {
        return failed(NO_DEVICE);
    }
    machine.give_back(entered.error.is_none());
    entered.error.map_or(0, failed)
}

#[unsafe(no_mangle)]
extern "system" fn dhdStop(_id: c_char) -> c_int {
    of_device("dhdStop", |machine, _| {
        machine.brake = true;
        machine.motors_off(4);
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetSystemType(_id: c_char) -> c_int {
    of_device("dhdGetSystemType", |machine, _| {
        let planned = machine.plans.iter().find_map(|planned| match planned {
            Planned::Type(number) => Some(*number),
            _ => None,
        });
        planned.unwrap_or(33)
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetSystemName(_id: c_char) -> *const c_char {
    let named = of_device("dhdGetSystemName", |_, _| 0);
    if named == 0 {
        c"omega.3 (mock)".as_ptr()
    } else {
        ptr::null()
    }
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetSerialNumber(serial: Option<&mut c_ushort>, _id: c_char) -> c_int {
    of_device("dhdGetSerialNumber", |_, _| {
        fill(serial, 42);
        0
    })
}

/// Writes as many status words as the header of this library version has. The function does not know the size of the caller's
/// array.
#[unsafe(no_mangle)]
extern "system" fn dhdGetStatus(status: Option<&mut [c_int; 32]>, _id: c_char) -> c_int {
    of_device("dhdGetStatus", |machine, number| {
        for planned in machine.plans.clone() {
            if let Planned::Off(at, cause) = planned
                && at == number
            {
                machine.motors_off(cause);
                machine.wrong();
            }
        }
        let words = machine.plans.iter().find_map(|planned| match planned {
            Planned::StatusWords(words) => Some(*words),
            _ => None,
        });
        let on = machine.motors_on && !machine.brake;
        let reset = machine.has(&Planned::Uncalibrated);
        let mut all = [0; 17];
        for (word, value) in [
            (0, true),
            (1, true),
            (2, true),
            (3, reset),
            (4, !on),
            (5, on),
            (6, machine.brake),
        ] {
            all[word] = c_int::from(value);
        }
        all[14] = machine.off_cause;
        if let Some(status) = status {
            let words = words.unwrap_or(17).min(17);
            status[..words].copy_from_slice(&all[..words]);
        }
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetPosition(
    x: Option<&mut f64>,
    y: Option<&mut f64>,
    z: Option<&mut f64>,
    _id: c_char,
) -> c_int {
    of_device("dhdGetPosition", |machine, number| {
        let (mut result, mut nan, mut old) = (0, false, false);
        for planned in machine.plans.clone() {
            match planned {
                Planned::Stale(at, times) if among(number, at, times) => (result, old) = (1, true),
                Planned::Freeze(at, times) if among(number, at, times) => old = true,
                Planned::NotANumber(at) if at == number => nan = true,
                _ => {}
            }
        }
        if !old {
            machine.read_m = machine.place_m();
        }
        if nan || old {
            machine.wrong();
        }
        let mut at = machine.read_m;
        if nan {
            at[1] = f64::NAN;
        }
        fill_three([x, y, z], at);
        result
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdSetForce(x: f64, y: f64, z: f64, _id: c_char) -> c_int {
    of_device(SET_FORCE, |machine, number| {
        let halves = machine.plans.iter().any(
            |planned| matches!(planned, Planned::Saturate(at, times) if among(number, *at, *times)),
        );
        let mut force = OMEGA3.limited([x, y, z]);
        let mut result = c_int::from(force != [x, y, z]) * 2;
        if halves {
            machine.wrong();
            force = force.map(|f| 0.5 * f);
            result = 2;
        }
        machine.force(force);
        result
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetForce(
    x: Option<&mut f64>,
    y: Option<&mut f64>,
    z: Option<&mut f64>,
    _id: c_char,
) -> c_int {
    of_device("dhdGetForce", |machine, _| {
        fill_three([x, y, z], machine.acting_n());
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdEnableForce(on: c_uchar, _id: c_char) -> c_int {
    of_device("dhdEnableForce", |machine, _| {
        machine.motors_on = on != 0;
        machine.brake = false;
        machine.off_cause = if on != 0 { 0 } else { 4 };
        machine.note_zero();
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdSetMaxForce(force_n: f64, _id: c_char) -> c_int {
    of_device("dhdSetMaxForce", |machine, _| {
        machine.max_force_n = force_n;
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetEffectorMass(mass_kg: Option<&mut f64>, _id: c_char) -> c_int {
    of_device("dhdGetEffectorMass", |_, _| {
        fill(mass_kg, 0.148);
        0
    })
}

/// Succeeds without a device and keeps the last error number, as measurements of the real library showed.
#[unsafe(no_mangle)]
extern "system" fn dhdEnableExpertMode() -> c_int {
    machine().expert = true;
    0
}

#[unsafe(no_mangle)]
extern "system" fn dhdDisableExpertMode() -> c_int {
    machine().expert = false;
    0
}

/// Movement of the effector per radian of a joint, metres. Invented, like the geometry in the functions below, because the geometry
/// of an omega.3 is not public.
const METRES_PER_RADIAN: f64 = 0.1;

#[unsafe(no_mangle)]
extern "system" fn dhdGetJointAngles(angles: Option<&mut [f64; 8]>, _id: c_char) -> c_int {
    of_device("dhdGetJointAngles", |machine, _| {
        if !machine.expert {
            return failed(EXPERT_DISABLED);
        }
        let mut all = [0.0; 8];
        for (angle, x) in all.iter_mut().zip(machine.place_m()) {
            *angle = x / METRES_PER_RADIAN;
        }
        fill(angles, all);
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdJointAnglesToInertiaMatrix(
    angles: Option<&[f64; 8]>,
    inertia: Option<&mut [[f64; 6]; 6]>,
    _id: c_char,
) -> c_int {
    of_device("dhdJointAnglesToInertiaMatrix", |machine, _| {
        if !machine.expert {
            return failed(EXPERT_DISABLED);
        }
        let mut all = [[0.0; 6]; 6];
        let angles = angles.copied().unwrap_or_default();
        for axis in 0..3 {
            all[axis][axis] = 0.148 + 0.01 * axis as f64 + 0.1 * angles[axis] * angles[axis];
        }
        fill(inertia, all);
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetDeltaJacobian(jacobian: Option<&mut [[f64; 3]; 3]>, _id: c_char) -> c_int {
    of_device("dhdGetDeltaJacobian", |machine, _| {
        if !machine.expert {
            return failed(EXPERT_DISABLED);
        }
        let mut all = [[0.0; 3]; 3];
        for (axis, row) in all.iter_mut().enumerate() {
            row[axis] = METRES_PER_RADIAN;
        }
        fill(jacobian, all);
        0
    })
}

#[unsafe(no_mangle)]
extern "system" fn dhdGetJointAngleRange(
    low: Option<&mut [f64; 8]>,
    high: Option<&mut [f64; 8]>,
    _id: c_char,
) -> c_int {
    of_device("dhdGetJointAngleRange", |machine, _| {
        if !machine.expert {
            return failed(EXPERT_DISABLED);
        }
        fill(low, [-0.8; 8]);
        fill(high, [0.8; 8]);
        0
    })
}

/// The mock's extra function for tests: takes a text padded with zeros and returns a number; NaN for an unknown text.
#[unsafe(no_mangle)]
extern "system" fn touchstone_mock(text: &[u8; crate::door::TEXT]) -> f64 {
    crate::door::answer(text)
}
