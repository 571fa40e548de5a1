//! Everything to touch on one axis, for C programs: walls, detents, a spring to a centre, friction, clicks and a drawn torque
//! profile, behind one energy guard.

use crate::memory::{self, Object, assert_room};
use crate::message::Words;
use crate::parts::{EMPTY, ts_feel_config};
use crate::settings::{self, ts_settings};
use crate::status::ts_status;
use crate::{ts_energy, ts_force};
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::environment::{Counted, Refused};
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{
    CountScale, Environment, Fixed32, Force, PositionSettings, Settings, SettingsError, Si,
};

/// Size of a `ts_feel` in 64-bit words.
pub const TS_FEEL_WORDS: usize = 480;
/// Walls, detents, spring, friction, clicks and torque profile, and the energy guard behind them. Initialise it with
/// `ts_feel_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_feel {
    memory: [u64; TS_FEEL_WORDS],
}

/// An environment (walls and other parts), and the scale of its encoder.
type Felt = (Environment<Fixed32>, CountScale);

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_feel {
    type Value = Felt;
    const MARK: u64 = 0x7473_6665_656c_5f31;
}
assert_room!(ts_feel);

/// Why a feel is refused.
enum No {
    CountsPerRev,
    /// The guard relies on a second position in each tick, which a feel does not get.
    SecondReading,
    /// A wall, by its index in the configuration.
    Wall(usize, SettingsError),
    Part(Refused),
}

impl No {
    fn of(refused: Refused, config: &ts_feel_config) -> Self {
        match refused {
            Refused::Wall(place, problem) => Self::Wall(config.index_of(place), problem),
            refused => Self::Part(refused),
        }
    }
}

/// Returns the settings with the encoder resolution of the feel's configuration.
fn with_encoder(settings: &Settings, config: &ts_feel_config) -> Settings {
    Settings {
        position: PositionSettings::of_counts_per_rev(config.counts_per_rev),
        ..*settings
    }
}

/// Makes an environment of the feel's walls and detents.
#[inline(always)]
fn made(settings: &Settings, config: &ts_feel_config) -> Result<Environment<Fixed32>, Refused> {
    let (walls, used) = config.solid();
    let walls = walls.get(..used).unwrap_or_default();
    Environment::new(settings, walls, config.detents.settings().as_ref())
}

/// Writes walls and detents into a C object's memory. This function and the next two are not inlined: each needs kilobytes of
/// stack, and inlined they would need them all at the same time.
#[inline(never)]
fn begin(feel: *mut ts_feel, settings: &Settings, config: &ts_feel_config) -> Result<(), No> {
    let scale = CountScale::new(config.counts_per_rev, Si::ZERO).ok_or(No::CountsPerRev)?;
    match made(settings, config) {
        Ok(environment) => memory::initialise_pair(feel, environment, scale),
        Err(refused) => return Err(No::of(refused, config)),
    };
    Ok(())
}

/// Adds spring, damper, dry friction, click and inertia.
#[inline(never)]
fn add_parts(felt: &mut Felt, settings: &Settings, config: &ts_feel_config) -> Result<(), No> {
    match felt.0.with_feel(&config.parts(), settings) {
        Ok(environment) => felt.0 = environment,
        Err(refused) => return Err(No::Part(refused)),
    }
    Ok(())
}

/// Adds the torque profile.
#[inline(never)]
fn add_profile(felt: &mut Felt, settings: &Settings, config: &ts_feel_config) -> Result<(), No> {
    let Some(profile) = config.profile.settings().map_err(No::Part)? else {
        return Ok(());
    };
    match felt.0.with_profile(&profile, settings.force_limit) {
        Ok(environment) => felt.0 = environment,
        Err(refused) => return Err(No::Part(refused)),
    }
    Ok(())
}

/// Checks all parts of a feel in the order in which `ts_feel_init` makes them.
fn check(settings: &Settings, config: &ts_feel_config) -> Result<(), No> {
    if config.counts_per_rev == 0 {
        return Err(No::CountsPerRev);
    }
    if let Err(refused) = made(settings, config) {
        return Err(No::of(refused, config));
    }
    let parts = config.parts().feel::<Fixed32>(settings);
    parts.map_err(No::Part)?;
    if settings::lacks_second_reading(settings) {
        return Err(No::SecondReading);
    }
    if let Some(profile) = config.profile.settings().map_err(No::Part)? {
        let profile = profile.profile::<Fixed32>(settings.force_limit);
        profile.map_err(No::Part)?;
    }
    Ok(())
}

/// Sets a feel to no part at all, and the counts of the encoder to 0, which `ts_feel_init` refuses.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_defaults(config: *mut ts_feel_config) -> ts_status {
    memory::put(config, EMPTY)
}

/// Initialises a feel as at power-up, with a full energy account. Law, device and guard are those of the settings; the guard's
/// count follows from `counts_per_rev`. Call it once, because each call fills the account again. It needs 12 KB of stack, `ts_feel_tick`
/// 0.4 KB.
///
/// Returns `TS_OUT_OF_RANGE` if a value is refused, also a guard with `law.guard.change = measured`, because a feel gets one count a
/// tick; the feel is then not initialised, and gives no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_init(
    feel: *mut ts_feel,
    settings: *mut ts_settings,
    config: *const ts_feel_config,
) -> ts_status {
    let (settings, config) = match memory::clear(feel)
        .and_then(|()| Ok((settings::of_one_reading(settings)?, memory::borrow(config)?)))
    {
        Err(status) => return status,
        Ok((settings, config)) => (with_encoder(settings, config), config),
    };
    let made = begin(feel, &settings, config).and_then(|()| match memory::value(feel) {
        Ok(felt) => {
            add_parts(felt, &settings, config)?;
            add_profile(felt, &settings, config)
        }
        Err(_) => Err(No::CountsPerRev),
    });
    if made.is_err() {
        let _ = memory::clear(feel);
        return ts_status::TS_OUT_OF_RANGE;
    }
    ts_status::TS_OK
}

/// Checks a feel. If it is refused, `message` gets the reason in one line; `message` may be null.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_check(
    settings: *mut ts_settings,
    config: *const ts_feel_config,
    message: *mut c_char,
    length: usize,
) -> ts_status {
    let mut words = Words::new(memory::buffer(message, length));
    let made = memory::value(settings).and_then(|settings| {
        let config = memory::borrow(config)?;
        Ok(check(&with_encoder(settings, config), config))
    });
    // Writing to a buffer cuts the text; it never fails.
    match made {
        Err(status) => return status,
        Ok(Ok(())) => return ts_status::TS_OK,
        Ok(Err(No::CountsPerRev)) => {
            let _ = write!(
                words,
                "counts_per_rev = 0: give the encoder's counts per turn"
            );
        }
        Ok(Err(No::SecondReading)) => settings::explain_second_reading(&mut words),
        Ok(Err(No::Wall(index, problem))) => {
            let _ = write!(words, "walls[{index}]: {problem}");
        }
        Ok(Err(No::Part(problem))) => {
            let _ = write!(words, "{problem}");
        }
    }
    ts_status::TS_OUT_OF_RANGE
}

/// Runs one control period of a feel: takes the encoder's count, and gives the force against growing angles. Command the negative of
/// it along the angle, and hold it until the next call.
///
/// The hand gets out at most the guard's `capacity + refill * time` more energy than it put in, over all parts together.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_tick(feel: *mut ts_feel, count: i64, force: *mut ts_force) -> ts_status {
    let (answer, status) = match memory::value(feel) {
        Err(status) => (0, status),
        Ok((environment, scale)) => {
            let scale = *scale;
            let answer = environment.tick(&Counted { scale, count }, None);
            let status = if environment.tripped() {
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

/// Reports to estimators and guard the commanded force, if it was smaller than the force that `ts_feel_tick` gave.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_commanded(feel: *mut ts_feel, force: ts_force) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |(environment, _)| {
            environment.commanded(Force(I8F24::from_bits(force)));
            ts_status::TS_OK
        },
    )
}

/// Reports to the feel that the motor was switched off and that no call of `ts_feel_tick` follows until `ts_feel_resume`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_switched_off(feel: *mut ts_feel) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |(environment, _)| {
            environment.switched_off();
            ts_status::TS_OK
        },
    )
}

/// Resumes the feel when the motor is switched on again. All parts start anew; the energy guard's account keeps its level.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_resume(feel: *mut ts_feel) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |(environment, _)| {
            environment.begin(None);
            ts_status::TS_OK
        },
    )
}

/// Reads the energy guard's account, the energy that the hand may still get out, in J times 2^48. It is 0 without a guard
/// (`law.guard.on`).
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_account(feel: *mut ts_feel, account: *mut ts_energy) -> ts_status {
    let (energy, status) = match memory::value(feel) {
        Err(status) => (0, status),
        Ok((environment, _)) => {
            let guard = environment.guard.as_ref();
            let energy = guard.map_or(0, |guard| guard.account().0.to_bits());
            (energy, ts_status::TS_OK)
        }
    };
    match memory::put(account, energy) {
        ts_status::TS_OK => status,
        null => null,
    }
}
