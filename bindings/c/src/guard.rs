//! The energy guard for C programs. It bounds the energy that a hand can get out of a device, whatever force the control law
//! requests.

use crate::memory::{self, Object, assert_room};
use crate::message::Words;
use crate::status::ts_status;
use crate::{ts_energy, ts_force, ts_position, ts_si};
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::{
    ChangeOfForce, Fixed32, Force, Guard, GuardSettings, Guarded, GuardedDevice, Number as _,
    Position, SettingsError, Si,
};

/// Size of a `ts_guard` in 64-bit words.
pub const TS_GUARD_WORDS: usize = 24;

/// An energy guard: coefficients and state. It bounds the energy that a hand can get out of a device. Initialise it with
/// `ts_guard_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_guard {
    memory: [u64; TS_GUARD_WORDS],
}

/// An energy guard and the force limit to which a requested force is cut before the guard gets it. The guard's own limit follows
/// from its account, and may be larger.
#[derive(Clone, Copy)]
pub struct Limited {
    guard: Guarded<Fixed32>,
    limit: Force<Fixed32>,
    /// Whether the guard's coefficients need the displacement before the change of force in every tick.
    change_is_measured: bool,
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_guard {
    type Value = Limited;
    const MARK: u64 = 0x7473_6775_6172_6431;
}
assert_room!(ts_guard);

/// Properties of the device that the energy guard relies on, and the guard's energy limits. Units in brackets are for a linear
/// device. Start from `ts_guard_defaults`.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_guard_config {
    /// Control periods (calls of `ts_guard_tick`) per second, 1 to 100,000.
    pub rate_hz: u32,
    /// Largest force that the energy guard lets through, N·m (N). Where its account allows less, the guard lets less through.
    pub force_limit: ts_si,
    /// Step of one encoder count, or twice the largest error of a measured position, in rad (m), at most 0.1.
    pub count: ts_si,
    /// Measured damping of the device alone, without a hand, N·m·s/rad (N·s/m).
    pub damping: ts_si,
    /// Fraction (0 to 1) of the measured damping that the energy guard relies on.
    pub share_of_damping: ts_si,
    /// Most energy that the energy guard's account holds, in J, at most 16. It is the most that a hand can get out at once.
    pub capacity: ts_si,
    /// Power that refills the energy guard's account, in W, at most 1. It is the most that a hand can get out in the long run.
    pub refill: ts_si,
    /// Largest speed at which the energy bound holds, rad/s (m/s). Above it the guard allows no force until `ts_guard_resume`.
    pub overspeed: ts_si,
    /// Time from reading the position until the force computed from it begins to act, in s, at most one control period.
    pub delay: ts_si,
    /// Mean delay of the current loop's step response, in s, counted from the moment at which a force begins to act. `delay` and
    /// `lag` together are at most one control period.
    pub lag: ts_si,
    /// 1 if the position is read a second time when the commanded force changes: call `ts_guard_tick_with_change` in every tick.
    /// 0 otherwise: call `ts_guard_tick`.
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

    fn guard(&self) -> Result<Limited, SettingsError> {
        let (settings, device) = self.settings();
        let guard = Guarded::new(Guard::new(&settings, &device)?);
        let limit = Force(Fixed32::saturating_signal(device.force_limit));
        Ok(Limited {
            guard,
            limit,
            change_is_measured: settings.change == ChangeOfForce::Measured,
        })
    }
}

/// Fills in capacity, refill, fraction of damping and largest speed with the values of Touchstone's simulated knob. Sets the
/// properties of your own device to 0 (rate, force limit, count, damping and lag), and `delay` to -1 s. `ts_guard_init` refuses this
/// rate and this delay: the energy bound fails with a wrong delay, so set the measured one.
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
            // Every delay that is assumed instead of measured can be wrong, 0 as well: the guard refuses this one.
            delay: Si::lit("-1").to_bits(),
            lag: 0,
            change_is_measured: 0,
        },
    )
}

/// Initialises an energy guard as at power-up, with a full energy account (the energy that a hand may still get out). Call it once,
/// because each call fills the account again.
///
/// Returns `TS_OUT_OF_RANGE` if a setting is refused; the guard is then not initialised, and allows no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_init(guard: *mut ts_guard, config: *const ts_guard_config) -> ts_status {
    match memory::clear(guard)
        .and_then(|()| memory::get(config))
        .map(|config| config.guard())
    {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(guard, made),
    }
}

/// Checks the configuration of an energy guard. If it is refused, `message` gets the reason in one line, with the setting's name
/// and range; `message` may be null.
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
            // Writing to a buffer cuts the text; it never fails.
            let _ = write!(words, "{problem}");
            ts_status::TS_OUT_OF_RANGE
        }
    }
}

fn tick(
    guard: *mut ts_guard,
    moved: ts_position,
    before_change: Option<ts_position>,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    let position = |digits| Position(fixed(digits));
    let (force, status) = match memory::value(guard) {
        Err(status) => (0, status),
        Ok(Limited {
            guard,
            change_is_measured,
            ..
        }) if before_change.is_some() != *change_is_measured => {
            // Without the right displacements the work of the last force is unknown. Emptying the account covers all of it.
            guard.switched_off();
            (0, ts_status::TS_WRONG_TICK)
        }
        Ok(Limited { guard, limit, .. }) => {
            let before_change = before_change.unwrap_or(0);
            let wanted = Force(fixed(wanted)).within(*limit);
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

/// Runs one control period of the energy guard. `moved` is the displacement since the last call, `wanted` the force that your
/// control law requests, and `*allowed` the force to command. A force that resists a positive `moved` is positive.
///
/// The hand gets out at most `capacity + refill * time` more energy than it put in.
///
/// Returns `TS_WRONG_TICK` if `change_is_measured` is set: the force is then 0, and the account is emptied if a force acted.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_tick(
    guard: *mut ts_guard,
    moved: ts_position,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    tick(guard, moved, None, wanted, allowed)
}

/// Displacement of a number of encoder counts, for `ts_guard_tick`: counts times the angle of one count, which `TS_POSITION` gives.
///
/// Give the guard displacements made of counts, not of a rounded angle: these add up exactly, at every turn. A jump beyond the range
/// of `ts_position` gives the end of the range, which the guard takes as over-speed.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_moved(counts: i32, count: ts_position) -> ts_position {
    counts.saturating_mul(count)
}

/// Same as `ts_guard_tick`, for an encoder that is read a second time, at the moment at which the last commanded force begins to
/// act. `before_change` is the part of `moved` before this second reading.
///
/// Returns `TS_WRONG_TICK` if `change_is_measured` is 0: the force is then 0, and the account is emptied if a force acted.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_tick_with_change(
    guard: *mut ts_guard,
    moved: ts_position,
    before_change: ts_position,
    wanted: ts_force,
    allowed: *mut ts_force,
) -> ts_status {
    tick(guard, moved, Some(before_change), wanted, allowed)
}

/// Reports to the energy guard that your program commanded a smaller force than the allowed one. A larger force counts as the
/// allowed one.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_commanded(guard: *mut ts_guard, force: ts_force) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |Limited { guard, .. }| {
            guard.commanded(Force(fixed(force)));
            ts_status::TS_OK
        },
    )
}

/// Reports to the guard that the motor was switched off and that no call of `ts_guard_tick` follows until `ts_guard_resume`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_switched_off(guard: *mut ts_guard) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |Limited { guard, .. }| {
            guard.switched_off();
            ts_status::TS_OK
        },
    )
}

/// Resumes an energy guard after the motor was switched off, or after the device was faster than `overspeed`. The energy account
/// keeps its level: switching on again does not fill it.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_resume(guard: *mut ts_guard) -> ts_status {
    memory::value(guard).map_or_else(
        |status| status,
        |Limited { guard, .. }| {
            let before = *guard;
            *guard = Guarded::new(before.guard).resumed(&before);
            ts_status::TS_OK
        },
    )
}

/// Reads the energy guard's account, the energy that the hand may still get out, in J times 2^48. It is negative after an
/// over-speed, until the refilling power and the device's damping have made up for the difference.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_guard_account(guard: *mut ts_guard, account: *mut ts_energy) -> ts_status {
    match memory::value(guard) {
        Ok(Limited { guard, .. }) => memory::put(account, guard.account().0.to_bits()),
        Err(status) => {
            memory::put(account, 0);
            status
        }
    }
}
