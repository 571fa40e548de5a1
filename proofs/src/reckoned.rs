//! Products and quotients of settings when the model checker runs: any result, and the same result for equal arguments
//! (`answers.rs`). Validation is replaced as well (`stand_ins.rs`).
//!
//! How coefficients follow from settings does not depend on what the products and quotients are. A `reckoned_property!` replaces
//! each by any number. Code and specification get the same result for the same arguments. For the estimator's 56-bit numbers, this
//! holds only between the n-th call of the code and the n-th call of the specification. Of a result in the format of settings one
//! fact is known:
//!
//! ```text
//! a, b >= 0  =>  a b >= 0, a / b >= 0     accepted::p8_product64, p8_quotient_sign64
//! ```

/// Defines a property of settings and their coefficients, in which this file's products and quotients replace the code's. `and
/// [..]` lists further pairs of a function and its replacement.
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

/// Defines a property of the guard's coefficients in which validation accepts all settings.
#[macro_export]
macro_rules! validated_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::GuardSettings::validate, $crate::reckoned::guard_accepted)]
            $($property)*
        }
    };
}
/// Defines a property of a type that contains guards, in which `Guard::new` is replaced: the new guard only holds its arguments.
#[macro_export]
macro_rules! guarded_property {
    ($($property:tt)*) => {
        $crate::reckoned_property! {
            and [(touchstone_control::Guard::new, $crate::reckoned::told)]
            $($property)*
        }
    };
}
/// Defines a property of a law's coefficients, in which products, quotients, prepared divisors and a root are replaced. The
/// settings are in the ranges that validation guarantees. Damping and inertia per tick are replaced as well, and so is whether the
/// enhanced law is a plain spring; `p11_derived64` proves these equal for code and specification.
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
/// Defines a property of the estimator's weights times the force limit, in which these products are replaced.
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
/// Defines a property of the estimator's predictions and correction, in which its 56-bit products and quotients and the device's
/// motion over a time are replaced.
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
/// Defines a property of the estimator's coefficients, in which its ratios, whole predictions and corrections are replaced.
/// Properties of `timed_property!` prove the replaced predictions.
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

/// Functions that mark whether code or specification multiplies and divides from now on. Without the model checker they do nothing.
#[cfg(not(kani))]
mod questions {
    /// Does nothing: random tests need not know whether code or specification calls.
    pub fn of_specification() {}
}
#[cfg(not(kani))]
pub use questions::of_specification;

#[cfg(kani)]
pub use crate::{answers::*, stand_ins::*};
