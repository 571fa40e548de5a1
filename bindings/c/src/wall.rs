//! A whole wall: estimator, law and guard, from penetration to force.

use crate::memory::{self, Object, assert_room};
use crate::settings::ts_settings;
use crate::status::ts_status;
use crate::{ts_force, ts_position, ts_si};
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Position, Si};

/// Words of a wall's memory.
pub const TS_WALL_WORDS: usize = 160;

/// A wall: coefficients and memory of estimator, law and guard. Initialise it by `ts_wall_init`.
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

/// A wall at power-up. Answers `TS_OUT_OF_RANGE` where the settings are refused; the wall then counts as not initialised, and gives no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_init(wall: *mut ts_wall, settings: *mut ts_settings) -> ts_status {
    match memory::clear(wall)
        .and_then(|()| memory::value(settings))
        .map(|settings| Controller::new(settings))
    {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(wall, made),
    }
}

/// Runs one control period: takes the depth in the wall, positive inside, gives the force that pushes out. Command the
/// motor with its negative along the angle, and hold it until the next tick.
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

/// Tells estimator and guard the commanded force, where that is smaller than the wall's.
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

/// Tells the wall that the motor was switched off and that no tick follows until `ts_wall_resume`.
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

/// Takes the wall up again for the next arming, with its settings or changed ones: all memory is new but the guard's account.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_wall_resume(wall: *mut ts_wall, settings: *mut ts_settings) -> ts_status {
    let (wall, settings) = match (memory::value(wall), memory::value(settings)) {
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

/// The penetration of an encoder's count into a wall that stands at `surface`, rad: `2 pi count / counts_per_rev - surface`,
/// saturating. 0 for an encoder without counts.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_penetration(count: i64, counts_per_rev: u32, surface: ts_si) -> ts_position {
    CountScale::new(counts_per_rev, Si::from_bits(surface)).map_or(0, |scale| {
        let penetration: Position<Fixed32> = scale.penetration(count);
        penetration.0.to_bits()
    })
}
