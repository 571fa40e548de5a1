//! P8 (settings): settings that `AnyLaw::new` accepts satisfy what the properties of the laws assume. This holds for all settings,
//! by the code that computes the law's coefficients.
//!
//! The code multiplies and divides settings in 128 bits, which no solver follows to the end. The assumptions need only signs, sums
//! and shifts, and solvers follow those for any values of the products. That every setting is in its range is proved once
//! (`p8_validated`), not again for each law. Assumptions that need products are in `set.rs`.

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{assume, cover, property, settings_property};
#[cfg(kani)]
use touchstone_control::SettingsError;
use touchstone_control::{
    AnyLaw, Compliance, Energy, FilterSettings, FirstContact, Fixed32, Force, IdealStep, LawKind,
    Number, ObserverForm, OffsetUpdate, Ratio, Regulate, Settings, Si, Stiffness,
    quotient::quotient,
};

type N = Fixed32;

/// Any number as a setting. In random tests it is mostly the thesis' value `base` or a fraction of it; otherwise hardly any
/// settings would be accepted.
fn value<S: Source>(s: &mut S, base: Si) -> Si {
    let bits = s.i64();
    Si::from_bits(if s.shortcut() {
        base.to_bits() >> (bits & 7)
    } else {
        bits
    })
}

pub(crate) fn any_law<S: Source>(s: &mut S) -> LawKind {
    match s.u8() & 7 {
        0 => LawKind::Spring,
        1 => LawKind::SpringDamper,
        2 => LawKind::Tdpa,
        3 => LawKind::Fba,
        4 => LawKind::Sfa,
        5 => LawKind::SfaContinuous,
        _ => LawKind::EnhancedSfa,
    }
}

/// Any settings of one control law; energy guard and state estimator are off.
pub(crate) fn any_settings<S: Source>(s: &mut S, law: LawKind) -> Settings {
    let base = Settings::thesis();
    let rate_hz = s.u32();
    Settings {
        law,
        rate_hz: if s.shortcut() {
            1 + rate_hz % 4000
        } else {
            rate_hz
        },
        k_desired: value(s, base.k_desired),
        k_soft: value(s, base.k_soft),
        device_damping: value(s, base.device_damping),
        virtual_damping: value(s, base.virtual_damping),
        observer: if s.bool() {
            ObserverForm::Exact
        } else {
            ObserverForm::Thesis
        },
        count_device_damping: s.bool(),
        first_contact: if s.bool() {
            FirstContact::KeepForce
        } else {
            FirstContact::ZeroOffset
        },
        regulate: match s.u8() & 3 {
            0 => Regulate::Mass,
            1 => Regulate::MassCompensated,
            _ => Regulate::Hip,
        },
        offset_update: match s.u8() & 3 {
            0 => OffsetUpdate::TurnInward,
            1 => OffsetUpdate::Inward,
            _ => OffsetUpdate::EveryTick,
        },
        ideal_step: if s.bool() {
            IdealStep::Position
        } else {
            IdealStep::Force
        },
        step_of_ideal: value(s, base.step_of_ideal),
        limit_of_force: value(s, base.limit_of_force),
        limit_of_penetration: value(s, base.limit_of_penetration),
        filter: FilterSettings {
            mass: value(s, base.filter.mass),
            stiffness: value(s, base.filter.stiffness),
            damping: value(s, base.filter.damping),
            ground_damping: value(s, base.filter.ground_damping),
        },
        energy_credit: value(s, base.energy_credit),
        force_limit: value(s, base.force_limit),
        ..base
    }
}

/// The ranges that `Settings::validate` guarantees and that the laws' coefficients need.
pub(crate) fn in_ranges(settings: &Settings) -> bool {
    let filter = &settings.filter;
    let not_negative = |value: Si| value >= Si::ZERO;
    let compensated = settings.law == LawKind::EnhancedSfa
        && settings.k_desired > settings.k_soft
        && settings.regulate == Regulate::MassCompensated;
    not_negative(settings.k_desired)
        && not_negative(settings.device_damping)
        && not_negative(settings.virtual_damping)
        && not_negative(settings.step_of_ideal)
        && not_negative(settings.limit_of_force)
        && not_negative(settings.limit_of_penetration)
        && not_negative(settings.energy_credit)
        && not_negative(filter.mass)
        && not_negative(filter.damping)
        && not_negative(filter.ground_damping)
        && settings.k_soft > Si::ZERO
        && filter.stiffness > Si::ZERO
        // The smallest force that the 32-bit format can hold.
        && settings.force_limit >= Si::from_bits(1 << 8)
        && settings.rate_hz > 0
        && (!compensated || settings.k_desired < filter.stiffness)
}

/// Replaces `Settings::validate` when the model checker runs. It may refuse any settings, and accepts only settings that satisfy
/// the conditions which `p8_validated` proves.
#[cfg(kani)]
pub fn validated(settings: &Settings) -> Result<(), SettingsError> {
    if kani::any() && in_ranges(settings) {
        Ok(())
    } else {
        Err(SettingsError::TooCoarse {
            count: Si::ZERO,
            coarsest: Si::ZERO,
        })
    }
}

property! {
    /// P8 (settings): settings that validation accepts are in the ranges that the laws' coefficients need. If the law compensates
    /// for its virtual mass, the desired stiffness is also below the coupling stiffness.
    equation "accepted  =>  k, c, b, shares, mass, credit >= 0, k_v, k_f, rate > 0, limit >= 2^-24, k_de < k_f"
    over "setting of any law"
    by cadical fn p8_validated(s) {
        let law = any_law(s);
        let settings = any_settings(s, law);
        let accepted = settings.validate().is_ok();
        assert!(!accepted || in_ranges(&settings));
        let compensates = settings.regulate == Regulate::MassCompensated;
        cover!(s, accepted & compensates, "accepted");
        cover!(s, !accepted & in_ranges(&settings), "refused, above a range");
    }
}
property! {
    /// P8 (settings): a quotient of settings that are not negative is not negative.
    equation "a >= 0, b > 0  =>  a/b >= 0"
    over "number, number above 0"
    by kissat fn p8_quotient_sign64(s) {
        let (a, b) = (Si::from_bits(s.i64()), Si::from_bits(s.i64()));
        assume!(s, a >= Si::ZERO && b > Si::ZERO, "case; nothing is said of others");
        let found = quotient(a, b);
        assert!(found >= Si::ZERO);
        cover!(s, found > Si::ONE, "more than one");
        cover!(s, found == Si::MAX, "saturated");
    }
}
property! {
    /// P8 (settings): a product of settings that are not negative is not negative, and twice a setting equals its sum with itself.
    equation "a >= 0, b >= 0  =>  a b >= 0;  2 a = a + a"
    over "two numbers"
    by minisat fn p8_product64(s) {
        let two = Si::const_from_int(2);
        let (a, any) = (Si::from_bits(s.i64()), Si::from_bits(s.i64()));
        let b = if s.bool() { two } else { any };
        assume!(s, a >= Si::ZERO && b >= Si::ZERO, "case; nothing is said of others");
        let found = a.saturating_mul(b);
        assert!(found >= Si::ZERO && (b != two || found == a.saturating_add(a)));
        cover!(s, found > Si::ONE && found < Si::MAX, "more than one");
        cover!(s, found == Si::MAX, "saturated");
    }
}
settings_property! {
    /// P8 (settings): settings that validation accepts give a spring with damping whose coefficients and memory satisfy what the
    /// spring's properties assume.
    equation "accepted  =>  k, b >= 0, limit > 0, invariant"
    over "setting of the law"
    by cadical fn p8_spring_accepted32(s) {
        let settings = any_settings(s, LawKind::SpringDamper);
        let accepted = AnyLaw::<N>::new(&settings);
        let Ok(AnyLaw::Spring(law, state)) = accepted else {
            assert!(accepted.is_err());
            cover!(s, true, "refused");
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        cover!(s, true, "accepted");
    }
}
settings_property! {
    /// P8 (settings): settings that validation accepts give a TDPA law (time-domain passivity) whose coefficients and memory
    /// satisfy what the law's properties assume.
    equation "accepted  =>  k, c >= 0, limit > 0, cap, invariant"
    over "setting of the law"
    by cadical fn p8_tdpa_accepted32(s) {
        let settings = any_settings(s, LawKind::Tdpa);
        let accepted = AnyLaw::<N>::new(&settings);
        let Ok(AnyLaw::Tdpa(law, state)) = accepted else {
            assert_reached!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
        assert!(settings.count_device_damping || law.device_damping == Stiffness::zero());
        cover!(s, true, "accepted");
    }
}
settings_property! {
    /// P8 (settings): settings that validation accepts give a force bounding law whose coefficients and memory satisfy what the
    /// law's properties assume.
    equation "accepted  =>  k, c, bound >= 0, limit > 0, cap, invariant"
    over "setting of the law"
    by cadical fn p8_fba_accepted32(s) {
        let settings = any_settings(s, LawKind::Fba);
        let accepted = AnyLaw::<N>::new(&settings);
        let Ok(AnyLaw::Fba(law, state)) = accepted else {
            assert_reached!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
        cover!(s, true, "accepted");
    }
}
/// Checks that settings that validation accepts give an SFA law (successive force augmentation) that satisfies what its properties
/// assume. The variant of the law is fixed, so that the model checker follows no other law.
fn sfa_is_valid<S: Source>(s: &mut S, kind: LawKind) {
    let settings = any_settings(s, kind);
    let accepted = AnyLaw::<N>::new(&settings);
    let Ok(AnyLaw::Sfa(law, state)) = accepted else {
        assert_reached!(accepted.is_err());
        return;
    };
    assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
    assert!(law.gain >= Ratio::zero() && law.compliance >= Compliance::zero());
    let update = match kind {
        LawKind::Sfa => OffsetUpdate::TurnInward,
        _ => OffsetUpdate::Inward,
    };
    assert!(law.update == update && law.first_contact == settings.first_contact);
    assert!(
        Some(law.soft.0) == N::gain(settings.k_soft)
            && Some(law.desired.0) == N::gain(settings.k_desired)
    );
    cover!(s, true, "accepted");
}
settings_property! {
    /// P8 (settings): settings that validation accepts give an original SFA law (successive force augmentation) that satisfies what
    /// the law's properties assume.
    equation "accepted  =>  k, k_v as set, gain, 1/k_v >= 0, limit > 0, invariant"
    over "setting of the law"
    by cadical fn p8_sfa_accepted32(s) {
        sfa_is_valid(s, LawKind::Sfa);
    }
}
settings_property! {
    /// P8 (settings): settings that validation accepts give a continuous SFA law (successive force augmentation) that satisfies
    /// what the law's properties assume.
    equation "accepted  =>  k, k_v as set, gain, 1/k_v >= 0, limit > 0, invariant"
    over "setting of the law"
    by cadical fn p8_sfa_continuous_accepted32(s) {
        sfa_is_valid(s, LawKind::SfaContinuous);
    }
}
settings_property! {
    /// P8 (settings), enhanced law: inertia, stiffness and damping of the virtual mass are together at most their stored sum, and
    /// twice that sum fits the number format. The energy lent to a contact is at most the energy cap.
    equation "accepted  =>  k, k_v as set, M + k_f + C <= D <= 2^30, k_f > 0, 0 <= credit <= cap, shares >= 0"
    over "setting of the law"
    by cadical fn p8_enhanced_accepted32(s) {
        let settings = any_settings(s, LawKind::EnhancedSfa);
        let accepted = AnyLaw::<N>::new(&settings);
        let Ok(AnyLaw::Enhanced(law, state)) = accepted else {
            assert_reached!(!matches!(accepted, Ok(AnyLaw::Tdpa(..) | AnyLaw::Fba(..) | AnyLaw::Sfa(..))));
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
        assert!(law.update == settings.offset_update && law.first_contact == settings.first_contact);
        assert!(Some(law.soft.0) == N::gain(settings.k_soft) && Some(law.desired.0) == N::gain(settings.k_desired));
        assert!(law.mass.stiffness > Stiffness::zero() && law.compliance >= Compliance::zero());
        cover!(s, law.credit > Energy::zero(), "accepted, with a loan");
    }
}
