//! Products and quotients of settings for the checker: one answer for one question.
//!
//! What a coefficient is made of does not depend on what its products and quotients are. A `reckoned_property!` puts any number in the
//! place of each, and whoever asks the same question again, the code or its specification, gets the same answer. Of an answer is known:
//!
//! ```text
//! a, b >= 0  =>  a b >= 0, a / b >= 0     accepted::p8_product64, p8_quotient_sign64
//! ```

/// A property of settings and what they become, with the products and quotients of this file. `and [..]` names further pairs.
#[macro_export]
macro_rules! reckoned_property {
    (and [$($pair:tt)*] $($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::quotient::over, $crate::reckoned::over)
            (fixed::FixedI64::saturating_div, $crate::reckoned::saturating_div)
            (fixed::FixedI64::saturating_mul, $crate::reckoned::saturating_mul)
            ($crate::spec::settings::times, $crate::reckoned::times)
            ($crate::spec::settings::over, $crate::reckoned::specified_over)
            $($pair)*]
            $($property)*
        }
    };
    ($($property:tt)*) => {
        $crate::reckoned_property!(and [] $($property)*);
    };
}

/// The same of the guard's coefficients: of settings that validation lets through, whatever it does.
#[macro_export]
macro_rules! validated_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::GuardSettings::validate, $crate::reckoned::guard_accepted)]
            $($property)*
        }
    };
}
/// A property of what is made of guards, of which each is what it was told.
#[macro_export]
macro_rules! guarded_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::Guard::new, $crate::reckoned::told)]
            $($property)*
        }
    };
}
/// A property of what the estimator's weights take at the limit, with its products.
#[macro_export]
macro_rules! limited_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::number::Wide64 as touchstone_control::number::Wide>::product, $crate::reckoned::weighed)
            ($crate::estimator::times, $crate::reckoned::at_limit)]
            $($property)*
        }
    };
}
/// The same of the estimator's coefficients: further with their long numbers, and with how far a device moves in a time.
#[macro_export]
macro_rules! flow_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [
                (fixed::FixedI64::checked_div, $crate::reckoned::checked_div)
                (touchstone_control::estimator::settings::ratio_of_bits, $crate::reckoned::ratio_of_bits)
                (touchstone_control::estimator::DeviceInTicks::integrals, $crate::reckoned::integrals)
                (touchstone_control::EstimatorSettings::validate, $crate::reckoned::accepted)
                (touchstone_control::Estimator::is_bounded, $crate::reckoned::bounded)
                ($crate::spec::estimator_settings::bounded, $crate::reckoned::specified_bounded)
                ($crate::spec::estimator_settings::long_times, $crate::reckoned::long_times)
                ($crate::spec::estimator_settings::long_over, $crate::reckoned::long_over)
                ($crate::spec::estimator_settings::ratio, $crate::reckoned::specified_ratio)
                ($crate::spec::estimator_settings::integrals, $crate::reckoned::specified_integrals)
            ]
            $($property)*
        }
    };
}

/// From now on the specification asks.
#[cfg(not(kani))]
mod questions {
    /// For properties as they are sampled: nothing to tell apart.
    pub fn of_specification() {}
}
#[cfg(not(kani))]
pub use questions::of_specification;

#[cfg(kani)]
pub use by_one_answer::*;
#[cfg(kani)]
mod by_one_answer {
    use crate::spec::Int;
    use crate::spec::settings::MOST;
    use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
    use fixed::{FixedI64, types::extra::LeEqU64};
    use touchstone_control::estimator::DeviceInTicks;
    use touchstone_control::number::{Exact, Wide64};
    use touchstone_control::{
        Compliance, Energy, Estimator, EstimatorSettings, Guard, GuardSettings, GuardedDevice,
        Number, Position, Ratio, SettingsError, Si, Stiffness,
    };

    static SPECIFIES: AtomicUsize = AtomicUsize::new(0);

    pub fn of_specification() {
        SPECIFIES.store(1, Relaxed);
    }

    /// What the code has asked of one kind, and what it was told. Its next row is known wherever the code has not returned yet, so that a
    /// question has one place: none may depend on a case, but for one that returns.
    macro_rules! table {
        ($(#[doc = $doc:literal])* $module:ident, $rows:literal) => {
            $(#[doc = $doc])*
            mod $module {
                use super::{AtomicI64, AtomicUsize, Relaxed, SPECIFIES};

                static ASKED: AtomicUsize = AtomicUsize::new(0);
                static LEFT: [AtomicI64; $rows] = [const { AtomicI64::new(0) }; $rows];
                static RIGHT: [AtomicI64; $rows] = [const { AtomicI64::new(0) }; $rows];
                static ANSWER: [AtomicI64; $rows] = [const { AtomicI64::new(0) }; $rows];

                /// The answer: any that nothing is known against, and the one that the code was given before.
                pub fn ask(a: i64, b: i64) -> i64 {
                    let answer: i64 = kani::any();
                    kani::assume(a < 0 || b < 0 || answer >= 0);
                    let specifies = SPECIFIES.load(Relaxed) == 1;
                    let asked = ASKED.load(Relaxed);
                    let end = if specifies { $rows } else { asked };
                    let mut at = 0;
                    while at < end {
                        let same = (at < asked)
                            & (LEFT[at].load(Relaxed) == a)
                            & (RIGHT[at].load(Relaxed) == b);
                        kani::assume(!same | (ANSWER[at].load(Relaxed) == answer));
                        at += 1;
                    }
                    if !specifies {
                        assert!(asked < $rows, "there is a row for each question");
                        LEFT[asked].store(a, Relaxed);
                        RIGHT[asked].store(b, Relaxed);
                        ANSWER[asked].store(answer, Relaxed);
                        ASKED.store(asked + 1, Relaxed);
                    }
                    answer
                }
            }
        };
    }
    table!(
        /// Products of settings.
        products, 16
    );
    table!(
        /// Quotients of settings.
        quotients, 12
    );
    table!(
        /// Products of numbers with 56 fractional bits.
        long_products, 21
    );
    table!(
        /// Their quotients.
        long_quotients, 3
    );
    table!(
        /// Ratios of two settings.
        ratios, 4
    );
    table!(
        /// How far one moves in a time.
        reaches, 11
    );
    table!(
        /// How far a push moves one.
        drifts, 11
    );

    table!(
        /// Products of a weight and a part.
        weights, 10
    );

    fn double(x: Int) -> i64 {
        assert!(
            i64::try_from(x).is_ok(),
            "the specification asks double words"
        );
        x as i64
    }

    /// For `saturating_mul`, of either length.
    pub fn saturating_mul<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
        let (a, b) = (a.to_bits(), b.to_bits());
        FixedI64::from_bits(if Frac::U32 == 32 {
            products::ask(a, b)
        } else {
            long_products::ask(a, b)
        })
    }
    /// For [`crate::spec::settings::times`].
    pub fn times(a: Int, b: Int) -> Int {
        products::ask(double(a), double(b)).into()
    }
    /// For [`crate::spec::estimator_settings::long_times`].
    pub fn long_times(a: Int, b: Int) -> Int {
        long_products::ask(double(a), double(b)).into()
    }

    /// For the quotient by what is positive if it is of any use.
    pub fn over(a: Si, b: Si) -> Si {
        let answer = quotients::ask(a.to_bits(), b.to_bits());
        if b <= Si::ZERO {
            Si::MAX
        } else {
            Si::from_bits(answer)
        }
    }
    /// For [`crate::spec::settings::over`].
    pub fn specified_over(a: Int, b: Int) -> Int {
        let answer = quotients::ask(double(a), double(b));
        if b <= 0 { MOST } else { answer.into() }
    }
    /// For `saturating_div` of settings.
    pub fn saturating_div<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
        assert!(b.to_bits() != 0, "nothing is divided by zero");
        FixedI64::from_bits(quotients::ask(a.to_bits(), b.to_bits()))
    }
    /// For `checked_div`: whoever asks it takes 0 for what has no answer, so that 0 is among the answers.
    pub fn checked_div<Frac: LeEqU64>(
        a: FixedI64<Frac>,
        b: FixedI64<Frac>,
    ) -> Option<FixedI64<Frac>> {
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
        let answer = weights::ask(weight.into(), limit);
        kani::assume(answer.unsigned_abs() <= 1 << 62);
        answer
    }
    /// For [`GuardSettings::validate`]: whatever it accepts.
    pub fn guard_accepted(_: &GuardSettings, _: &GuardedDevice) -> Result<(), SettingsError> {
        Ok(())
    }
    /// For [`Guard::new`]: it refuses an odd rate, and has a word of each that it was told.
    pub fn told<N: Number>(
        settings: &GuardSettings,
        device: &GuardedDevice,
    ) -> Result<Guard<N>, SettingsError> {
        let word = N::saturating_signal;
        let ratio = |value| N::ratio(value).unwrap_or_default();
        let guard = Guard {
            capacity: Energy::zero(),
            refill: Energy::zero(),
            damping: Stiffness::zero(),
            furthest: Position(word(settings.overspeed)),
            count: Position(word(device.count)),
            late: Ratio(ratio(settings.delay)),
            stray: Compliance(ratio(settings.lag)),
            slack: Position(word(device.count)),
            per_reach: Stiffness::zero(),
            in_flight: Position(word(device.force_limit)),
            overrun: Compliance(ratio(settings.damping)),
        };
        match device.rate_hz & 1 {
            0 => Ok(guard),
            _ => Err(SettingsError::TooCoarse {
                count: device.count,
                coarsest: Si::ZERO,
            }),
        }
    }
    /// For [`Estimator::is_bounded`]: whatever is; `estimator::p8_estimator_bounded32` has what it is.
    pub fn bounded<N: Number>(_: &Estimator<N>) -> bool {
        true
    }
    /// For [`crate::spec::estimator_settings::bounded`].
    pub fn specified_bounded(_: &crate::spec::estimator::Estimator) -> bool {
        true
    }
}
