//! Any answer to each question, of settings, of the estimator's long numbers and of what flows a device has; the same to the same.

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

/// A table of one kind of question: what the code asked, and the answers. The next row must be known to the checker at
/// every point that the code can reach, so a question may not depend on a branch, unless that branch returns.
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

            /// Any answer; if the code has asked the same, the code's answer.
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
    // Whoever asks the same again gets the same answer.
    (@any) => {
        fn rows(specifies: bool, asked: usize) -> (usize, usize) {
            (0, if specifies { ROWS } else { asked })
        }
    };
    // The specification's n-th question gets the code's n-th answer, if it is the same question: a solver's work for each is one
    // comparison, not one for each row. That leaves out what else is true of the answers: more is possible then, and proved, than the code can do.
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
    /// Products of settings.
    products, 16, any
);
table!(
    /// Quotients of settings.
    quotients, 12, any
);
table!(
    /// Products of numbers with 56 fractional bits.
    long_products, 12, nth
);
table!(
    /// Their quotients.
    long_quotients, 3, nth
);
table!(
    /// Ratios of two settings.
    ratios, 4, nth
);
table!(
    /// How far one moves in a time.
    reaches, 5, nth
);
table!(
    /// How far a push moves one.
    drifts, 5, nth
);
table!(
    /// Products of a weight and a part.
    weights, 10, any
);
table!(
    /// Roots.
    roots, 1, nth
);

pub(crate) fn double(x: Int) -> i64 {
    assert!(
        i64::try_from(x).is_ok(),
        "the specification asks double words"
    );
    x as i64
}

/// The known fact of a product and a quotient of settings: of arguments that are not negative they are not negative.
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

/// For `saturating_mul`, of either length.
pub fn saturating_mul<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    let (a, b) = (a.to_bits(), b.to_bits());
    FixedI64::from_bits(if Frac::U32 == 32 {
        product(a, b)
    } else {
        long_products::ask(a, b)
    })
}
/// For [`crate::spec::settings::times`].
pub fn times(a: Int, b: Int) -> Int {
    product(double(a), double(b)).into()
}
/// For [`crate::spec::estimator_settings::long_times`].
pub fn long_times(a: Int, b: Int) -> Int {
    long_products::ask(double(a), double(b)).into()
}

/// Stands for the quotient by a divisor that is meant to be positive.
pub fn over(a: Si, b: Si) -> Si {
    let answer = quotient(a.to_bits(), b.to_bits());
    if b <= Si::ZERO {
        Si::MAX
    } else {
        Si::from_bits(answer)
    }
}
/// For [`crate::spec::settings::over`].
pub fn specified_over(a: Int, b: Int) -> Int {
    let answer = quotient(double(a), double(b));
    if b <= 0 { MOST } else { answer.into() }
}
/// For `saturating_div` of settings.
pub fn saturating_div<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    assert!(b.to_bits() != 0, "nothing is divided by zero");
    FixedI64::from_bits(quotient(a.to_bits(), b.to_bits()))
}
/// Stands for `checked_div`. Its callers replace a missing answer by 0, so 0 is among the answers.
pub fn checked_div<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> Option<FixedI64<Frac>> {
    let answer = long_quotients::ask(a.to_bits(), b.to_bits());
    (b.to_bits() != 0).then_some(FixedI64::from_bits(answer))
}
/// For [`crate::spec::estimator_settings::long_over`].
pub fn long_over(a: Int, b: Int) -> Int {
    let answer = long_quotients::ask(double(a), double(b));
    if b == 0 { 0 } else { answer.into() }
}
/// For the ratio of two settings.
pub fn ratio_of_bits(a: i64, b: i64) -> Exact {
    Exact::from_bits(ratios::ask(a, b))
}
/// For [`crate::spec::estimator_settings::ratio`].
pub fn specified_ratio(a: Int, b: Int) -> Int {
    ratios::ask(double(a), double(b)).into()
}
/// For [`DeviceInTicks::integrals`].
pub fn integrals(device: &DeviceInTicks, time: Exact) -> (Exact, Exact) {
    let (loss, time) = (device.loss.to_bits(), time.to_bits());
    let (reach, drift) = (reaches::ask(loss, time), drifts::ask(loss, time));
    (Exact::from_bits(reach), Exact::from_bits(drift))
}
/// For [`crate::spec::estimator_settings::integrals`].
pub fn specified_integrals(loss: Int, time: Int) -> (Int, Int) {
    let (loss, time) = (double(loss), double(time));
    (
        reaches::ask(loss, time).into(),
        drifts::ask(loss, time).into(),
    )
}
/// A flow of a device, or its correction: any words, or none; of the same device the specification's are the code's.
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
    /// The property over a tick.
    over_ticks, 9
);
flows!(
    /// Coefficients of the motion ahead.
    aheads, 7
);
flows!(
    /// Answers for the correction.
    corrections, 3
);
fn told_of(device: &DeviceInTicks) -> [i64; 3] {
    [device.loss, device.per_torque, device.delay].map(Exact::to_bits)
}
fn specified_of(device: &Device) -> [i64; 3] {
    [device.loss, device.per_torque, device.delay].map(double)
}
/// The low half of each number is a word, any.
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
/// For [`DeviceInTicks::tick`].
pub fn over_a_tick<N: Number>(device: &DeviceInTicks) -> Option<Flow<N, TAPS>> {
    over_ticks::ask(told_of(device)).map(|words| of_words(&words))
}
/// For [`crate::spec::estimator_settings::over_a_tick`].
pub fn specified_over_a_tick(device: &Device) -> Option<estimator::Flow<3>> {
    over_ticks::ask(specified_of(device)).map(|words| specified_of_words(&words))
}
/// For [`DeviceInTicks::ahead`].
pub fn ahead<N: Number>(device: &DeviceInTicks) -> Option<Flow<N, UNDER_WAY>> {
    aheads::ask(told_of(device)).map(|words| of_words(&words))
}
/// For [`crate::spec::estimator_settings::ahead`].
pub fn specified_ahead(device: &Device) -> Option<estimator::Flow<2>> {
    aheads::ask(specified_of(device)).map(|words| specified_of_words(&words))
}
/// For [`DeviceInTicks::correction`], which has nothing to do with torques and delays.
pub fn correction<N: Number>(device: &DeviceInTicks, angle: Exact) -> Option<[Weight<N>; 3]> {
    let told = [device.loss.to_bits(), angle.to_bits(), 0];
    corrections::ask(told).map(|words| {
        let flow: Flow<N, 0> = of_words(&words);
        [flow.reach, flow.drift, flow.loss]
    })
}
/// For [`crate::spec::estimator_settings::Device::correction`].
pub fn specified_correction(device: &Device, angle: Int) -> Option<[Int; 3]> {
    let told = [double(device.loss), double(angle), 0];
    corrections::ask(told).map(|words| words.map(|word| Int::from(word as i32)))
}
/// For [`EstimatorSettings::validate`]: whatever it accepts.
pub fn accepted(_: &EstimatorSettings, _: u32, _: Si) -> Result<(), SettingsError> {
    Ok(())
}
/// For the code's product of weight and part, of two words.
pub fn weighed(weight: i32, part: i32) -> Wide64 {
    Wide64(at_limit(weight, part.into()))
}
/// For [`crate::estimator::times`].
pub fn at_limit(weight: i32, limit: i64) -> i64 {
    let answer = signed(weight.into(), limit, weights::ask(weight.into(), limit));
    // Of two words.
    kani::assume(answer.unsigned_abs() <= 1 << 62);
    answer
}
/// Stands for [`Estimator::is_bounded`]: any answer; `estimator::p8_estimator_bounded32` is about the true one.
pub fn bounded<N: Number>(_: &Estimator<N>) -> bool {
    true
}
/// For [`crate::spec::estimator_settings::bounded`].
pub fn specified_bounded(_: &crate::spec::estimator::Estimator) -> bool {
    true
}
