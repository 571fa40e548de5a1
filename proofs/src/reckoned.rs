//! Products and quotients of settings for the checker: one answer for one question (`answers.rs`); and what stands in the place of
//! validation (`stand_ins.rs`).
//!
//! What a coefficient is made of does not depend on what its products and quotients are. A `reckoned_property!` puts any number in the
//! place of each, and whoever asks the same question again, the code or its specification, gets the same answer (of the estimator's long
//! numbers, whose order is the same, the specification's n-th question the code's n-th). Of the numbers of the
//! estimator, of 56 fractional bits, nothing else is known; of an answer in settings is:
//!
//! ```text
//! a, b >= 0  =>  a b >= 0, a / b >= 0     accepted::p8_product64, p8_quotient_sign64
//! ```

/// A property of settings and their coefficients, in which this file's products and quotients replace the code's. `and
/// [..]` names further pairs.
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

/// Properties of the guard's coefficients, for all settings that validation accepts.
#[macro_export]
macro_rules! validated_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::GuardSettings::validate, $crate::reckoned::guard_accepted)]
            $($property)*
        }
    };
}
/// A property of what is built from guards; each guard only holds its arguments.
#[macro_export]
macro_rules! guarded_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::Guard::new, $crate::reckoned::told)]
            $($property)*
        }
    };
}
/// The same for the coefficients of a law, which may use prepared divisors and a root. The settings are in the ranges
/// that validation guarantees. The values that follow from several settings come first, and whether the enhanced law
/// is a spring for them; `p11_derived64` shows that these equal the specification's.
#[macro_export]
macro_rules! lawful_property {
    ($plain:ident $($property:tt)*) => {
        $crate::reckoned_property! {
            and [
                (touchstone_control::Settings::is_plain_spring, $crate::reckoned::$plain)
                (touchstone_control::Settings::validate, $crate::reckoned::law_accepted)
                (touchstone_control::Settings::derived, $crate::reckoned::derived)
                ($crate::spec::law_settings::derived, $crate::reckoned::specified_derived)
                (<touchstone_control::Fixed32 as touchstone_control::Number>::divisor, $crate::divided::divisor)
                (<touchstone_control::Fixed32 as touchstone_control::Number>::root_of_four, $crate::reckoned::root_of_four)
                ($crate::spec::fba::Fba::bound_of, $crate::reckoned::specified_root_of_four)
            ]
            $($property)*
        }
    };
}
/// A property of the estimator's weights at the torque limit, with its products replaced.
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
/// The same for the estimator's flows and its correction: its long products and quotients, and the device's motion
/// over a time, are replaced.
#[macro_export]
macro_rules! timed_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [
                (fixed::FixedI64::checked_div, $crate::reckoned::checked_div)
                (touchstone_control::estimator::DeviceInTicks::integrals, $crate::reckoned::integrals)
                ($crate::spec::estimator_settings::long_times, $crate::reckoned::long_times)
                ($crate::spec::estimator_settings::long_over, $crate::reckoned::long_over)
                ($crate::spec::estimator_settings::integrals, $crate::reckoned::specified_integrals)
            ]
            $($property)*
        }
    };
}
/// The same for the estimator's coefficients: its ratios, and whole flows and corrections, are replaced;
/// `timed_property!` is about those.
#[macro_export]
macro_rules! flow_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [
                (touchstone_control::estimator::settings::ratio_of_bits, $crate::reckoned::ratio_of_bits)
                (touchstone_control::estimator::DeviceInTicks::tick, $crate::reckoned::over_a_tick)
                (touchstone_control::estimator::DeviceInTicks::ahead, $crate::reckoned::ahead)
                (touchstone_control::EstimatorSettings::validate, $crate::reckoned::accepted)
                (touchstone_control::Estimator::is_bounded, $crate::reckoned::bounded)
                ($crate::spec::estimator_settings::bounded, $crate::reckoned::specified_bounded)
                (touchstone_control::estimator::DeviceInTicks::correction, $crate::reckoned::correction)
                ($crate::spec::estimator_settings::long_times, $crate::reckoned::long_times)
                ($crate::spec::estimator_settings::ratio, $crate::reckoned::specified_ratio)
                ($crate::spec::estimator_settings::Device::correction, $crate::reckoned::specified_correction)
                ($crate::spec::estimator_settings::over_a_tick, $crate::reckoned::specified_over_a_tick)
                ($crate::spec::estimator_settings::ahead, $crate::reckoned::specified_ahead)
            ]
            $($property)*
        }
    };
}

/// Marks that the following calls come from the specification.
#[cfg(not(kani))]
mod questions {
    /// For sampled properties, which need no distinction.
    pub fn of_specification() {}
}
#[cfg(not(kani))]
pub use questions::of_specification;

#[cfg(kani)]
pub use crate::{answers::*, stand_ins::*};
