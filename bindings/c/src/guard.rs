//! The guard: a bound on what any hand can get out of a device, whatever force stands before it.

use crate::memory::{self, Object, assert_room};
use crate::status::{Words, ts_status};
use crate::{ts_energy, ts_force, ts_position, ts_si};
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::{
    ChangeOfForce, Fixed32, Force, Guard, GuardSettings, Guarded, GuardedDevice, Position,
    SettingsError, Si,
};

/// Words of a guard's memory.
pub const TS_GUARD_WORDS: usize = 24;

/// A guard: coefficients and memory. Initialise it by `ts_guard_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_guard {
    memory: [u64; TS_GUARD_WORDS],
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_guard {
    type Value = Guarded<Fixed32>;
    const MARK: u64 = 0x7473_6775_6172_6431;
}
assert_room!(ts_guard);

/// Properties of the device that the guard needs, and the size of its promise. Start from `ts_guard_defaults`.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_guard_config {
    /// Ticks a second, 1 to 100,000.
    pub rate_hz: u32,
    /// Largest force ever commanded, N·m (N).
    pub force_limit: ts_si,
    /// A count of the encoder, or twice the largest error of a measured position, rad (m), at most 0.1.
    pub count: ts_si,
    /// Damping of the device alone, without a hand, as measured, N·m·s/rad (N·s/m).
    pub damping: ts_si,
    /// Share of that damping that is sure to be there, 0 to 1.
    pub share_of_damping: ts_si,
    /// Energy that a hand may get out at once, J, at most 16.
    pub capacity: ts_si,
    /// Power that a hand may get out again and again, W, at most 1.
    pub refill: ts_si,
    /// Speed up to which every displacement is answered for, rad/s (m/s); above it the force goes off and stays off.
    pub overspeed: ts_si,
    /// Time from a sample until its force begins to act, s, at most a tick.
    pub delay: ts_si,
    /// Time from there until the force is there, as the mean of the current loop's step response, s; with the delay at most a tick.
    pub lag: ts_si,
    /// 1 where the position is also read when the force changes, for `ts_guard_tick_with_change`; else 0.
    pub change_is_measured: u32,
}

impl ts_guard_config {
    fn settings(&self) -> (GuardSettings, GuardedDevice) {
        let si = Si::from_bits;
        let change = if self.change_is_measured == 0 {
            ChangeOfForce::Estimated
        } else {
            ChangeOfForce::Measured
        };
        let settings = GuardSettings {
            on: true,
            capacity: si(self.capacity),
            refill: si(self.refill),
            damping: si(self.damping),
            share_of_damping: si(self.share_of_damping),
            overspeed: si(self.overspeed),
            delay: si(self.delay),
            lag: si(self.lag),
            change,
        };
        let device = GuardedDevice {
            rate_hz: self.rate_hz,
            force_limit: si(self.force_limit),
            count: si(self.count),
        };
        (settings, device)
    }

    fn guard(&self) -> Result<Guard<Fixed32>, SettingsError> {
        let (settings, device) = self.settings();
        Guard::new(&settings, &device)
    }
}

/// Fills in capacity, refill, share of damping and overspeed as Touchstone's knob has them, and 0 for all that only you know of your device.
/// Rate, force limit, count and damping, delay and lag. `ts_guard_init` refuses a rate of 0.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_defaults(config: *mut ts_guard_config) -> ts_status {
    let shipped = GuardSettings::default();
    memory::put(
        config,
        ts_guard_config {
            rate_hz: 0,
            force_limit: 0,
            count: 0,
            damping: 0,
            share_of_damping: shipped.share_of_damping.to_bits(),
            capacity: shipped.capacity.to_bits(),
            refill: shipped.refill.to_bits(),
            overspeed: shipped.overspeed.to_bits(),
            delay: 0,
            lag: 0,
            change_is_measured: 0,
        },
    )
}

/// A guard at power-up, with a full account. Call it once: a full account is a promise spent once.
///
/// Answers `TS_OUT_OF_RANGE` where a setting is refused; the guard then counts as not initialised, and allows no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_init(guard: *mut ts_guard, config: *const ts_guard_config) -> ts_status {
    match memory::clear(guard)
        .and_then(|()| memory::get(config))
        .map(|config| config.guard())
    {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(guard, Guarded::new(made)),
    }
}

/// Whether a configuration is accepted, and why not, in one line with the setting's name and range. `message` may be null.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_check(
    config: *const ts_guard_config,
    message: *mut c_char,
    length: usize,
) -> ts_status {
    let mut words = Words::new(memory::buffer(message, length));
    match memory::get(config).map(|config| config.guard()) {
        Err(status) => status,
        Ok(Ok(_)) => ts_status::TS_OK,
        Ok(Err(problem)) => {
            // A buffer cuts a text; it never fails.
            let _ = write!(words, "{problem}");
            ts_status::TS_OUT_OF_RANGE
        }
    }
}

fn tick(
    guard: *mut ts_guard,
    moved: ts_position,
    before_change: ts_position,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    let position = |digits| Position(fixed(digits));
    let (force, status) = match memory::value(guard) {
        Err(status) => (0, status),
        Ok(guard) => {
            let wanted = Force(fixed(wanted));
            let force = guard.moved(position(moved), position(before_change), wanted);
            let status = if guard.tripped {
                ts_status::TS_OVERSPEED
            } else {
                ts_status::TS_OK
            };
            (force.0.to_bits(), status)
        }
    };
    match memory::put(allowed, force) {
        ts_status::TS_OK => status,
        null => null,
    }
}

fn fixed(digits: i32) -> touchstone_control::fixed::types::I8F24 {
    touchstone_control::fixed::types::I8F24::from_bits(digits)
}

/// Runs one control period. `moved` is the displacement since the last tick, `wanted` the force of your law,
/// `*allowed` the force to command; a force that resists a positive `moved` is positive. At most `capacity + refill *
/// time` ever reaches the hand beyond what it put in.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_tick(
    guard: *mut ts_guard,
    moved: ts_position,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    tick(guard, moved, 0, wanted, allowed)
}

/// As `ts_guard_tick`, where the encoder was also read when the last force took effect: `before_change` is the part of
/// `moved` that came before.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_tick_with_change(
    guard: *mut ts_guard,
    moved: ts_position,
    before_change: ts_position,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    tick(guard, moved, before_change, wanted, allowed)
}

/// Tells the guard that a smaller force than allowed was commanded. A larger force counts as the allowed one.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_commanded(guard: *mut ts_guard, force: ts_force) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |guard| {
            guard.commanded(Force(fixed(force)));
            ts_status::TS_OK
        },
    )
}

/// Tells the guard that the motor was switched off and that no tick follows until `ts_guard_resume`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_switched_off(guard: *mut ts_guard) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |guard| {
            guard.switched_off();
            ts_status::TS_OK
        },
    )
}

/// Takes a switched-off or tripped guard up again, with the account that it had: arming again is no reason for a full one.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_resume(guard: *mut ts_guard) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |guard| {
            let before = *guard;
            *guard = Guarded::new(before.guard).resumed(&before);
            ts_status::TS_OK
        },
    )
}

/// Energy that the hand may still get out, J times 2^48; negative after overspeed until refill and damping have made
/// up for it.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_account(guard: *mut ts_guard, account: *mut ts_energy) -> ts_status {
    match memory::value(guard) {
        Ok(guard) => memory::put(account, guard.account().0.to_bits()),
        Err(status) => {
            memory::put(account, 0);
            status
        }
    }
}
