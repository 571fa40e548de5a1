//! A whole virtual wall for C programs, from penetration to force: velocity estimator, control law and energy guard.

use crate::memory::{self, Object, assert_room};
use crate::settings::{self, ts_settings};
use crate::status::ts_status;
use crate::{ts_force, ts_position, ts_si};
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Position, Si};

/// Size of a `ts_wall` in 64-bit words.
pub const TS_WALL_WORDS: usize = 160;

/// A virtual wall: coefficients and state of velocity estimator, control law and energy guard. Initialise it with `ts_wall_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_wall {
    memory: [u64; TS_WALL_WORDS],
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_wall {
    type Value = Controller<Fixed32>;
    const MARK: u64 = 0x7473_7761_6c6c_5f31;
}
assert_room!(ts_wall);

/// Initialises a virtual wall as at power-up. Returns `TS_OUT_OF_RANGE` if the settings are refused, also for a guard with
/// `law.guard.change = measured`: the wall gets one position a tick. The wall is then not initialised, and gives no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_init(wall: *mut ts_wall, settings: *mut ts_settings) -> ts_status {
    match memory::clear(wall)
        .and_then(|()| settings::of_one_reading(settings))
        .map(|settings| Controller::new(settings))
    {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(wall, made),
    }
}

/// Runs one control period of a virtual wall: takes the penetration, positive inside the wall, and gives the force that pushes out.
/// Command the negative of the force along the angle, and hold it until the next call.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_tick(
    wall: *mut ts_wall,
    penetration: ts_position,
    force: *mut ts_force,
) -> ts_status {
    let (answer, status) = match memory::value(wall) {
        Err(status) => (0, status),
        Ok(wall) => {
            let answer = wall.tick(Position(I8F24::from_bits(penetration)));
            let status = if wall.tripped() {
                ts_status::TS_OVERSPEED
            } else {
                ts_status::TS_OK
            };
            (answer.0.to_bits(), status)
        }
    };
    match memory::put(force, answer) {
        ts_status::TS_OK => status,
        null => null,
    }
}

/// Reports to the wall's estimator and energy guard the commanded force, if it was smaller than the force that `ts_wall_tick` gave.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_commanded(wall: *mut ts_wall, force: ts_force) -> ts_status {
    memory::value(wall).map_or_else(
        |status| status,
        |wall| {
            wall.commanded(Force(I8F24::from_bits(force)));
            ts_status::TS_OK
        },
    )
}

/// Reports to the wall that the motor was switched off and that no call of `ts_wall_tick` follows until `ts_wall_resume`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_switched_off(wall: *mut ts_wall) -> ts_status {
    memory::value(wall).map_or_else(
        |status| status,
        |wall| {
            wall.switched_off();
            ts_status::TS_OK
        },
    )
}

/// Resumes the wall when the motor is switched on again, with the same settings or changed ones. Estimator and control law start
/// anew; the energy guard's account keeps its level. Refuses the same settings as `ts_wall_init`; nothing is then resumed.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_resume(wall: *mut ts_wall, settings: *mut ts_settings) -> ts_status {
    let (wall, settings) = match (memory::value(wall), settings::of_one_reading(settings)) {
        (Ok(wall), Ok(settings)) => (wall, settings),
        (Err(status), _) | (_, Err(status)) => return status,
    };
    match Controller::new(settings) {
        Err(_) => ts_status::TS_OUT_OF_RANGE,
        Ok(fresh) => {
            wall.resume(&fresh);
            ts_status::TS_OK
        }
    }
}

/// Penetration into a wall whose surface is at the angle `surface` (rad): `2 pi count / counts_per_rev - surface`, limited to the
/// range of `ts_position`. It is 0 if `counts_per_rev` is 0.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_penetration(count: i64, counts_per_rev: u32, surface: ts_si) -> ts_position {
    CountScale::new(counts_per_rev, Si::from_bits(surface)).map_or(0, |scale| {
        let penetration: Position<Fixed32> = scale.penetration(count);
        penetration.0.to_bits()
    })
}
