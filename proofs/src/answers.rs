//! Arithmetic for the model checker, replaced by tables of recorded results. An operation (on settings, on the estimator's 56-bit
//! numbers, or a prediction of a device) returns any result, and the same result for equal arguments.

use crate::spec::estimator_settings::Device;
use crate::spec::settings::MOST;
use crate::spec::{Int, estimator};
use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
use fixed::FixedI64;
use fixed::types::extra::LeEqU64;
use touchstone_control::estimator::{DeviceInTicks, Flow, TAPS, UNDER_WAY, Weight};
use touchstone_control::number::{Exact, Wide, Wide64};
use touchstone_control::{Estimator, EstimatorSettings, Number, SettingsError, Si};

static SPECIFIES: AtomicUsize = AtomicUsize::new(0);

pub fn of_specification() {
    SPECIFIES.store(1, Relaxed);
}

/// Defines the table of one replaced operation: the arguments and the result of each call. At every point that the code can reach,
/// the model checker must know the next free row. So no call may depend on a branch, unless the branch returns.
macro_rules! table {
    ($(#[doc = $doc:literal])* $module:ident, $rows:literal, $row:ident) => {
        $(#[doc = $doc])*
        pub(crate) mod $module {
            use super::{AtomicI64, AtomicUsize, Relaxed, SPECIFIES};

            const ROWS: usize = $rows;
            static ASKED: AtomicUsize = AtomicUsize::new(0);
            static LEFT: [AtomicI64; ROWS] = [const { AtomicI64::new(0) }; ROWS];
            static RIGHT: [AtomicI64; ROWS] = [const { AtomicI64::new(0) }; ROWS];
            static ANSWER: [AtomicI64; ROWS] = [const { AtomicI64::new(0) }; ROWS];

            /// The result of a replaced operation: the recorded one if the code has called it with equal arguments, otherwise any.
            pub fn ask(a: i64, b: i64) -> i64 {
                let answer: i64 = kani::any();
                let specifies = SPECIFIES.load(Relaxed) == 1;
                let asked = ASKED.load(Relaxed);
                let (mut at, end) = rows(specifies, asked);
                while at < end {
                    let same = (at < asked)
                        & (LEFT[at].load(Relaxed) == a)
                        & (RIGHT[at].load(Relaxed) == b);
                    kani::assume(!same | (ANSWER[at].load(Relaxed) == answer));
                    at += 1;
                }
                if !specifies {
                    assert!(asked < ROWS, "there is a row for each question");
                    LEFT[asked].store(a, Relaxed);
                    RIGHT[asked].store(b, Relaxed);
                    ANSWER[asked].store(answer, Relaxed);
                    ASKED.store(asked + 1, Relaxed);
                }
                answer
            }

            table! { @$row }
        }
    };
    // Equal arguments get equal results, in any order of calls.
    (@any) => {
        fn rows(specifies: bool, asked: usize) -> (usize, usize) {
            (0, if specifies { ROWS } else { asked })
        }
    };
    // The specification's n-th call gets the result of the code's n-th call, if the arguments are equal. The solver then compares
    // one pair of calls, not each pair. Less is known of the results, so the proof still covers all that the code can do.
    (@nth) => {
        static AGAIN: AtomicUsize = AtomicUsize::new(0);

        fn rows(specifies: bool, _: usize) -> (usize, usize) {
            if !specifies {
                return (0, 0);
            }
            let at = AGAIN.load(Relaxed);
            AGAIN.store(at + 1, Relaxed);
            (at, (at + 1).min(ROWS))
        }
    };
}
table!(
    /// The table that replaces products of settings when the model checker runs. It records the results that the code got, so that
    /// the specification gets the same.
    products, 16, any
);
table!(
    /// The table that replaces quotients of settings when the model checker runs. It records the results that the code got, so that
    /// the specification gets the same.
    quotients, 12, any
);
table!(
    /// The table that replaces products of numbers with 56 fractional bits when the model checker runs. It records the results that
    /// the code got, so that the specification gets the same.
    long_products, 12, nth
);
table!(
    /// The table that replaces quotients of numbers with 56 fractional bits when the model checker runs. It records the results
    /// that the code got, so that the specification gets the same.
    long_quotients, 3, nth
);
table!(
    /// The table that replaces ratios of two settings when the model checker runs. It records the results that the code got, so
    /// that the specification gets the same.
    ratios, 4, nth
);
table!(
    /// The table that replaces a sum when the model checker runs: how far a device with a displacement of 1 per tick moves in a
    /// time (`V`). It records the results that the code got, so that the specification gets the same.
    reaches, 5, nth
);
table!(
    /// The table that replaces a sum when the model checker runs: how far a push (acceleration) of 1 per tick² moves a device in a
    /// time (`X`). It records the results that the code got, so that the specification gets the same.
    drifts, 5, nth
);
table!(
    /// The table that replaces products of a weight (coefficient) and a part (the leading digits) of a state when the model checker
    /// runs. It records the results that the code got, so that the specification gets the same.
    weights, 10, any
);
table!(
    /// The table that replaces square roots when the model checker runs. It records the results that the code got, so that the
    /// specification gets the same.
    roots, 1, nth
);

pub(crate) fn double(x: Int) -> i64 {
    assert!(
        i64::try_from(x).is_ok(),
        "the specification asks double words"
    );
    x as i64
}

/// Assumes one fact of the result of a replaced product or quotient of settings: if both arguments are not negative, neither is the
/// result.
fn signed(a: i64, b: i64, answer: i64) -> i64 {
    kani::assume(a < 0 || b < 0 || answer >= 0);
    answer
}
fn product(a: i64, b: i64) -> i64 {
    signed(a, b, products::ask(a, b))
}
fn quotient(a: i64, b: i64) -> i64 {
    signed(a, b, quotients::ask(a, b))
}

/// Replaces `saturating_mul` of settings and of 56-bit numbers when the model checker runs: any result, and the same one for equal
/// arguments.
pub fn saturating_mul<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    let (a, b) = (a.to_bits(), b.to_bits());
    FixedI64::from_bits(if Frac::U32 == 32 {
        product(a, b)
    } else {
        long_products::ask(a, b)
    })
}
/// Replaces [`crate::spec::settings::times`] when the model checker runs the specification: returns the value that the code got for
/// equal arguments.
pub fn times(a: Int, b: Int) -> Int {
    product(double(a), double(b)).into()
}
/// Replaces [`crate::spec::estimator_settings::long_times`] when the model checker runs the specification: returns the value that
/// the code got for equal arguments.
pub fn long_times(a: Int, b: Int) -> Int {
    long_products::ask(double(a), double(b)).into()
}

/// Replaces the quotient of settings when the model checker runs: any number, and the same one for equal arguments; the largest
/// setting if the divisor is not positive.
pub fn over(a: Si, b: Si) -> Si {
    let answer = quotient(a.to_bits(), b.to_bits());
    if b <= Si::ZERO {
        Si::MAX
    } else {
        Si::from_bits(answer)
    }
}
/// Replaces [`crate::spec::settings::over`] when the model checker runs the specification: returns the value that the code got for
/// equal arguments.
pub fn specified_over(a: Int, b: Int) -> Int {
    let answer = quotient(double(a), double(b));
    if b <= 0 { MOST } else { answer.into() }
}
/// Replaces `saturating_div` of settings when the model checker runs the code: returns any value, and the same value for equal
/// arguments.
pub fn saturating_div<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    assert!(b.to_bits() != 0, "nothing is divided by zero");
    FixedI64::from_bits(quotient(a.to_bits(), b.to_bits()))
}
/// Replaces `checked_div` when the model checker runs: any number, and `None` only for a division by 0. If a quotient does not fit,
/// the real function gives `None` too and the code then uses 0, which is one of these numbers.
pub fn checked_div<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> Option<FixedI64<Frac>> {
    let answer = long_quotients::ask(a.to_bits(), b.to_bits());
    (b.to_bits() != 0).then_some(FixedI64::from_bits(answer))
}
/// Replaces [`crate::spec::estimator_settings::long_over`] when the model checker runs the specification: returns the value that
/// the code got for equal arguments.
pub fn long_over(a: Int, b: Int) -> Int {
    let answer = long_quotients::ask(double(a), double(b));
    if b == 0 { 0 } else { answer.into() }
}
/// Replaces the ratio of two settings when the model checker runs the code: any value, and the same value for equal arguments.
pub fn ratio_of_bits(a: i64, b: i64) -> Exact {
    Exact::from_bits(ratios::ask(a, b))
}
/// Replaces [`crate::spec::estimator_settings::ratio`] when the model checker runs the specification: returns the value that the
/// code got for equal arguments.
pub fn specified_ratio(a: Int, b: Int) -> Int {
    ratios::ask(double(a), double(b)).into()
}
/// Replaces [`DeviceInTicks::integrals`] when the model checker runs the code: returns any value, and the same value for equal
/// arguments.
pub fn integrals(device: &DeviceInTicks, time: Exact) -> (Exact, Exact) {
    let (loss, time) = (device.loss.to_bits(), time.to_bits());
    let (reach, drift) = (reaches::ask(loss, time), drifts::ask(loss, time));
    (Exact::from_bits(reach), Exact::from_bits(drift))
}
/// Replaces [`crate::spec::estimator_settings::integrals`] when the model checker runs the specification: returns the value that
/// the code got for equal arguments.
pub fn specified_integrals(loss: Int, time: Int) -> (Int, Int) {
    let (loss, time) = (double(loss), double(time));
    (
        reaches::ask(loss, time).into(),
        drifts::ask(loss, time).into(),
    )
}
/// Defines the replacement of a prediction of a device's motion, or of the estimator's gains: any numbers, or `None`. The
/// specification gets the code's answer if it passes an equal device.
macro_rules! flows {
    ($(#[doc = $doc:literal])* $module:ident, $words:literal) => {
        $(#[doc = $doc])*
        mod $module {
            use super::{AtomicI64, AtomicUsize, Relaxed, SPECIFIES};

            static FITS: AtomicUsize = AtomicUsize::new(0);
            static TOLD: [AtomicI64; 3] = [const { AtomicI64::new(0) }; 3];
            static WORDS: [AtomicI64; $words] = [const { AtomicI64::new(0) }; $words];

            pub fn ask(device: [i64; 3]) -> Option<[i64; $words]> {
                let (fits, words): (bool, [i64; $words]) = (kani::any(), kani::any());
                if SPECIFIES.load(Relaxed) == 0 {
                    FITS.store(usize::from(fits), Relaxed);
                    for (told, value) in TOLD.iter().zip(device) {
                        told.store(value, Relaxed);
                    }
                    for (word, value) in WORDS.iter().zip(words) {
                        word.store(value, Relaxed);
                    }
                    return fits.then_some(words);
                }
                let mut same = true;
                for (told, value) in TOLD.iter().zip(device) {
                    same &= told.load(Relaxed) == value;
                }
                let code = core::array::from_fn(|i| WORDS[i].load(Relaxed));
                let (fits, words) = if same {
                    (FITS.load(Relaxed) == 1, code)
                } else {
                    (fits, words)
                };
                fits.then_some(words)
            }
        }
    };
}
flows!(
    /// The table that replaces the estimator's predictions (state transitions) over one tick when the model checker runs. It
    /// records the results that the code got, so that the specification gets the same.
    over_ticks, 9
);
flows!(
    /// The table that replaces the estimator's predictions (state transitions) from a sample to the time when the next command acts
    /// when the model checker runs. It records the results that the code got, so that the specification gets the same.
    aheads, 7
);
flows!(
    /// The table that replaces the estimator's correction gains when the model checker runs. It records the results that the code
    /// got, so that the specification gets the same.
    corrections, 3
);
fn told_of(device: &DeviceInTicks) -> [i64; 3] {
    [device.loss, device.per_torque, device.delay].map(Exact::to_bits)
}
fn specified_of(device: &Device) -> [i64; 3] {
    [device.loss, device.per_torque, device.delay].map(double)
}
/// A prediction (state transition) with any coefficients: each is the low half of a given number.
fn of_words<N: Number, const COMMANDS: usize>(words: &[i64]) -> Flow<N, COMMANDS> {
    let weight = |i: usize| {
        let long = Exact::from_bits(i64::from(words[i] as i32) << 30);
        <N::Wide as Wide>::weight(long).unwrap_or_default()
    };
    let of_torque = |i: usize| {
        let long = Exact::from_bits(i64::from(words[i] as i32) << 26);
        <N::Wide as Wide>::torque_weight(long).unwrap_or_default()
    };
    Flow {
        reach: weight(0),
        drift: weight(1),
        loss: weight(2),
        commands: core::array::from_fn(|i| [of_torque(3 + 2 * i), of_torque(4 + 2 * i)]),
    }
}
fn specified_of_words<const COMMANDS: usize>(words: &[i64]) -> estimator::Flow<COMMANDS> {
    let word = |i: usize| Int::from(words[i] as i32);
    estimator::Flow {
        reach: word(0),
        drift: word(1),
        loss: word(2),
        commands: core::array::from_fn(|i| [word(3 + 2 * i), word(4 + 2 * i)]),
    }
}
/// Replaces [`DeviceInTicks::tick`] when the model checker runs the code: returns any value, and the same value for equal
/// arguments.
pub fn over_a_tick<N: Number>(device: &DeviceInTicks) -> Option<Flow<N, TAPS>> {
    over_ticks::ask(told_of(device)).map(|words| of_words(&words))
}
/// Replaces [`crate::spec::estimator_settings::over_a_tick`] when the model checker runs the specification: returns the value that
/// the code got for equal arguments.
pub fn specified_over_a_tick(device: &Device) -> Option<estimator::Flow<3>> {
    over_ticks::ask(specified_of(device)).map(|words| specified_of_words(&words))
}
/// Replaces [`DeviceInTicks::ahead`] when the model checker runs the code: returns any value, and the same value for equal
/// arguments.
pub fn ahead<N: Number>(device: &DeviceInTicks) -> Option<Flow<N, UNDER_WAY>> {
    aheads::ask(told_of(device)).map(|words| of_words(&words))
}
/// Replaces [`crate::spec::estimator_settings::ahead`] when the model checker runs the specification: returns the value that the
/// code got for equal arguments.
pub fn specified_ahead(device: &Device) -> Option<estimator::Flow<2>> {
    aheads::ask(specified_of(device)).map(|words| specified_of_words(&words))
}
/// Replaces [`DeviceInTicks::correction`] when the model checker runs: any gains, the same for an equal loss and angle. The
/// gains do not depend on torques and delays.
pub fn correction<N: Number>(device: &DeviceInTicks, angle: Exact) -> Option<[Weight<N>; 3]> {
    let told = [device.loss.to_bits(), angle.to_bits(), 0];
    corrections::ask(told).map(|words| {
        let flow: Flow<N, 0> = of_words(&words);
        [flow.reach, flow.drift, flow.loss]
    })
}
/// Replaces [`crate::spec::estimator_settings::Device::correction`] when the model checker runs the specification: returns the
/// value that the code got for equal arguments.
pub fn specified_correction(device: &Device, angle: Int) -> Option<[Int; 3]> {
    let told = [double(device.loss), double(angle), 0];
    corrections::ask(told).map(|words| words.map(|word| Int::from(word as i32)))
}
/// Replaces [`EstimatorSettings::validate`] when the model checker runs: it accepts all settings.
pub fn accepted(_: &EstimatorSettings, _: u32, _: Si) -> Result<(), SettingsError> {
    Ok(())
}
/// Replaces the code's product of a weight and a part of a state (two 32-bit words) when the model checker runs.
pub fn weighed(weight: i32, part: i32) -> Wide64 {
    Wide64(at_limit(weight, part.into()))
}
/// Replaces [`crate::estimator::times`] when the model checker runs the code: returns any value, and the same value for equal
/// arguments.
pub fn at_limit(weight: i32, limit: i64) -> i64 {
    let answer = signed(weight.into(), limit, weights::ask(weight.into(), limit));
    // The product of two words is at most this.
    kani::assume(answer.unsigned_abs() <= 1 << 62);
    answer
}
/// Replaces [`Estimator::is_bounded`] when the model checker runs: always `true`. `estimator::p8_estimator_bounded32` proves what
/// the real function checks.
pub fn bounded<N: Number>(_: &Estimator<N>) -> bool {
    true
}
/// Replaces [`crate::spec::estimator_settings::bounded`] when the model checker runs the specification: always `true`, as in the
/// code.
pub fn specified_bounded(_: &crate::spec::estimator::Estimator) -> bool {
    true
}
