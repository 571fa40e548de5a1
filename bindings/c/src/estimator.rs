//! The state estimator for C programs: position and velocity of a device, from measured positions and commanded forces.

use crate::memory::{self, Object, assert_room};
use crate::settings::ts_settings;
use crate::status::ts_status;
use crate::{ts_force, ts_position};
use touchstone_control::estimator::EstimatorState;
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{Estimator, Fixed32, Force, Position};

/// Size of a `ts_estimator` in 64-bit words.
pub const TS_ESTIMATOR_WORDS: usize = 24;

/// A state estimator: coefficients and state. A `ts_wall` has one of its own. Initialise it with `ts_estimator_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_estimator {
    memory: [u64; TS_ESTIMATOR_WORDS],
}

/// The coefficients of a state estimator and its memory.
#[derive(Clone, Copy)]
pub struct Estimating {
    estimator: Estimator<Fixed32>,
    state: EstimatorState<Fixed32>,
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_estimator {
    type Value = Estimating;
    const MARK: u64 = 0x7473_6573_7469_6d31;
}
assert_room!(ts_estimator);

/// Initialises a state estimator with the settings `timing.rate_hz`, `law.force_limit_n_m` and `law.estimator`. Call it again to
/// forget all motion. Returns `TS_OUT_OF_RANGE` if a setting is refused; the estimator is then not initialised.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_estimator_init(
    estimator: *mut ts_estimator,
    settings: *mut ts_settings,
) -> ts_status {
    let made = memory::clear(estimator)
        .and_then(|()| memory::value(settings))
        .map(|it| it.estimator.estimator(it.rate_hz, it.force_limit));
    match made {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(
            estimator,
            Estimating {
                estimator: made,
                state: EstimatorState::default(),
            },
        ),
    }
}

/// Runs one control period: takes the measured position, and gives the position and the displacement per control period that are
/// expected when the next command begins to act. Displacement times rate is the speed. Call `ts_estimator_commanded` next.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_estimator_tick(
    estimator: *mut ts_estimator,
    measured: ts_position,
    position: *mut ts_position,
    moved: *mut ts_position,
) -> ts_status {
    let is_null = position.is_null() || moved.is_null();
    let (answers, status) = match memory::value(estimator) {
        Err(status) => ([0, 0], status),
        Ok(_) if is_null => ([0, 0], ts_status::TS_NULL_POINTER),
        Ok(Estimating { estimator, state }) => {
            let sample = estimator.tick(state, Position(I8F24::from_bits(measured)));
            let answers = [sample.e, sample.moved].map(|it| it.0.to_bits());
            (answers, ts_status::TS_OK)
        }
    };
    let [expected, per_tick] = answers;
    match (
        memory::put(position, expected),
        memory::put(moved, per_tick),
    ) {
        (ts_status::TS_OK, ts_status::TS_OK) => status,
        (null, ts_status::TS_OK) | (_, null) => null,
    }
}

/// Reports to the estimator the force that was commanded after `ts_estimator_tick`. It is positive against a positive motion, like
/// the force of a wall.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_estimator_commanded(
    estimator: *mut ts_estimator,
    force: ts_force,
) -> ts_status {
    memory::value(estimator).map_or_else(
        |status| status,
        |Estimating { estimator, state }| {
            estimator.commanded(state, Force(I8F24::from_bits(force)));
            ts_status::TS_OK
        },
    )
}
