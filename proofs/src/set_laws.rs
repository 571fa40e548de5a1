//! P11 (refinement): the coefficients of a law follow from settings as their specification says, at 32 bits.
//!
//! ```text
//! settings.derived() = spec(settings)                              p11_derived64
//! AnyLaw::new(settings) = spec(settings)
//!     spring, damped, and the enhanced law up to k_v                p11_spring_settings32, p11_damped_settings32, p11_soft_settings32
//!     TDPA, force bounding                                          p11_tdpa_settings32, p11_fba_settings32
//!     SFA, original and continuous                                  p11_sfa_settings32, p11_sfa_continuous_settings32
//!     enhanced                                                      p11_enhanced_settings32
//! ```
//!
//! `k_v` is the soft stiffness. The settings are accepted ones, in the ranges that `accepted::p8_validated` proves.

use crate::accepted::{any_settings, in_ranges};
use crate::set::bits;
use crate::source::Source;
use crate::spec::law_settings::{self as of_law, Damped, Regulated, Spring};
use crate::spec::sfa::Update;
use crate::specified::at32::{energy, force, gain};
use crate::{assume, cover, lawful_property, reckoned, reckoned_property, spec, specified};
use touchstone_control::{
    AnyLaw, FirstContact, Fixed32, IdealStep, LawKind, Number, ObserverForm, OffsetUpdate,
    Regulate, Settings,
};

type N = Fixed32;

fn told(settings: &Settings) -> of_law::Settings {
    of_law::Settings {
        rate: settings.rate_hz.into(),
        desired: bits(settings.k_desired),
        soft: bits(settings.k_soft),
        device_damping: bits(settings.device_damping),
        virtual_damping: bits(settings.virtual_damping),
        exact: settings.observer == ObserverForm::Exact,
        counts_damping: settings.count_device_damping,
        keep_force: settings.first_contact == FirstContact::KeepForce,
        regulated: match settings.regulate {
            Regulate::Mass => Regulated::Mass,
            Regulate::MassCompensated => Regulated::MassCompensated,
            Regulate::Hip => Regulated::Hip,
        },
        update: match settings.offset_update {
            OffsetUpdate::TurnInward => Update::TurnInward,
            OffsetUpdate::Inward => Update::Inward,
            OffsetUpdate::EveryTick => Update::EveryTick,
        },
        force_stays: settings.ideal_step == IdealStep::Force,
        step_of_ideal: bits(settings.step_of_ideal),
        limit_of_force: bits(settings.limit_of_force),
        limit_of_penetration: bits(settings.limit_of_penetration),
        mass: bits(settings.filter.mass),
        coupling: bits(settings.filter.stiffness),
        filter_damping: bits(settings.filter.damping),
        ground_damping: bits(settings.filter.ground_damping),
        credit: bits(settings.energy_credit),
        limit: bits(settings.force_limit),
    }
}

/// The law that the code makes of the settings; `None` if they are refused.
fn made(settings: &Settings) -> Option<AnyLaw<N>> {
    let found = AnyLaw::new(settings).ok();
    reckoned::of_specification();
    found
}
reckoned_property! {
    /// P11 (refinement): damping and inertia per tick equal the specification's, and so does the decision whether the enhanced law
    /// is a plain spring.
    equation "2 c_i/T, m/T², c_f/T, c_env/T, c_i/T, b/T;  k_de <= k_v"
    over "settings of the law"
    by minisat fn p11_derived64(s) {
        let settings = any_settings(s, LawKind::EnhancedSfa);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        let found = settings.derived();
        reckoned::of_specification();
        let expected = of_law::derived(&told(&settings));
        assert!(bits(found.k_critical) == expected.critical);
        assert!(bits(found.mass_per_tick2) == expected.inertia);
        assert!(bits(found.filter_damping_per_tick) == expected.filter_damping);
        assert!(bits(found.ground_damping_per_tick) == expected.ground_damping);
        assert!(bits(found.device_damping_per_tick) == expected.device_damping);
        assert!(bits(found.virtual_damping_per_tick) == expected.virtual_damping);
        assert!(settings.is_plain_spring() == told(&settings).is_plain());
        cover!(s, found.mass_per_tick2 > settings.filter.mass, "a mass");
    }
}
/// Checks that the spring that the code makes of the settings equals the specification's.
fn spring_is_specified<S: Source>(s: &mut S, settings: &Settings) {
    let accepted = settings.validate().is_ok();
    let found = made(settings);
    let damped = match settings.law {
        LawKind::Spring => Damped::Not,
        LawKind::SpringDamper => Damped::Fully,
        _ => Damped::InProportion,
    };
    let expected = if accepted {
        told(settings).spring(damped)
    } else {
        None
    };
    let as_one = match &found {
        Some(AnyLaw::Spring(law, _)) => Some(Spring {
            desired: gain(law.desired),
            damping: gain(law.damping),
            limit: force(law.limit),
        }),
        _ => None,
    };
    assert!(as_one == expected && found.is_some() == expected.is_some());
    cover!(s, expected.is_some(), "made");
}
lawful_property! {
    not_plain
    /// P11 (refinement): the spring that the code makes of the settings, or its refusal, equals the specification's.
    equation "AnyLaw::new(settings) = spec(settings): k_de, limit"
    over "settings of the law"
    by minisat fn p11_spring_settings32(s) {
        let settings = any_settings(s, LawKind::Spring);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        spring_is_specified(s, &settings);
    }
}
lawful_property! {
    not_plain
    /// P11 (refinement): the damped spring that the code makes of the settings, or its refusal, equals the specification's.
    equation "AnyLaw::new(settings) = spec(settings): k_de, b/T, limit"
    over "settings of the law"
    by minisat fn p11_damped_settings32(s) {
        let settings = any_settings(s, LawKind::SpringDamper);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        spring_is_specified(s, &settings);
    }
}
lawful_property! {
    plain
    /// P11 (refinement): for a desired stiffness up to the soft stiffness, the enhanced law is the damped spring (§3.1 of the
    /// thesis) of the specification.
    equation "k_de <= k_v  =>  AnyLaw::new(settings) = spec(settings): k_de, (b/T) k_de/k_v, limit"
    over "settings of the law, soft"
    by minisat fn p11_soft_settings32(s) {
        let settings = any_settings(s, LawKind::EnhancedSfa);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        assume!(s, told(&settings).is_plain(), "case; the other is p11_enhanced_settings32");
        spring_is_specified(s, &settings);
    }
}
lawful_property! {
    not_plain
    /// P11 (refinement): the TDPA law (time-domain passivity) for the settings, or its refusal, equals the specification's.
    equation "AnyLaw::new(settings) = spec(settings): k_de, c_i/T, limit"
    over "settings of the law"
    by minisat fn p11_tdpa_settings32(s) {
        let settings = any_settings(s, LawKind::Tdpa);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        let accepted = settings.validate().is_ok();
        let found = made(&settings);
        let expected = if accepted { told(&settings).tdpa() } else { None };
        let as_one = match &found {
            Some(AnyLaw::Tdpa(law, _)) => {
                assert_reached!(energy(law.energy_cap) == of_law::ENERGY_CAP);
                Some(specified::at32::tdpa(law))
            }
            _ => None,
        };
        assert!(as_one == expected && found.is_some() == expected.is_some());
        cover!(s, expected.is_some_and(|law| law.device_damping > 0), "with the device's damping");
        cover!(s, expected.is_none() && accepted, "refused");
    }
}
lawful_property! {
    not_plain
    /// P11 (refinement): the force bounding law for the settings, or its refusal, equals the specification's. The factor of the
    /// force bound is calculated from the damping as stored.
    equation "AnyLaw::new(settings) = spec(settings): k_de, c_i/T, sqrt(4 c_i/T), limit"
    over "settings of the law"
    by minisat fn p11_fba_settings32(s) {
        let settings = any_settings(s, LawKind::Fba);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        let accepted = settings.validate().is_ok();
        let found = made(&settings);
        let expected = if accepted { told(&settings).fba() } else { None };
        let as_one = match &found {
            Some(AnyLaw::Fba(law, _)) => Some(spec::fba::Fba {
                desired: gain(law.desired),
                device_damping: gain(law.device_damping),
                bound: gain(law.bound),
                limit: force(law.limit),
                energy_cap: energy(law.energy_cap),
            }),
            _ => None,
        };
        assert!(as_one == expected && found.is_some() == expected.is_some());
        cover!(s, expected.is_some_and(|law| law.bound > 0), "bounded");
        cover!(s, expected.is_none() && accepted, "refused");
    }
}
/// Checks that the SFA law (successive force augmentation) that the code makes of the settings equals the specification's.
fn sfa_is_specified<S: Source>(s: &mut S, settings: &Settings, update: Update) {
    let accepted = settings.validate().is_ok();
    let found = made(settings);
    let expected = if accepted {
        told(settings).sfa(update)
    } else {
        None
    };
    let as_one = match &found {
        Some(AnyLaw::Sfa(law, _)) => Some(specified::at32::sfa(law)),
        _ => None,
    };
    assert!(as_one == expected && found.is_some() == expected.is_some());
    cover!(s, expected.is_some_and(|law| law.gain > 0), "augmenting");
    cover!(s, expected.is_none() && accepted, "refused");
}
lawful_property! {
    not_plain
    /// P11 (refinement): the original SFA law (successive force augmentation) for the settings, or its refusal, equals the
    /// specification's.
    equation "AnyLaw::new(settings) = spec(settings): k_de, k_v, k_c/k_v - 1, 1/k_v, limit"
    over "settings of the law"
    by minisat fn p11_sfa_settings32(s) {
        let settings = any_settings(s, LawKind::Sfa);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        sfa_is_specified(s, &settings, Update::TurnInward);
    }
}
lawful_property! {
    not_plain
    /// P11 (refinement): the continuous SFA law (successive force augmentation) for the settings, or its refusal, equals the
    /// specification's.
    equation "AnyLaw::new(settings) = spec(settings): k_de, k_v, k_c/k_v - 1, 1/k_v, limit"
    over "settings of the law"
    by minisat fn p11_sfa_continuous_settings32(s) {
        let settings = any_settings(s, LawKind::SfaContinuous);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        sfa_is_specified(s, &settings, Update::Inward);
    }
}

lawful_property! {
    not_plain
    /// P11 (refinement): the enhanced law that the code makes of the settings, or its refusal, equals the specification's. This
    /// includes the target stiffness of its offset (thesis 3.5) and its prepared divisors.
    equation "AnyLaw::new(settings) = spec(settings): k_de, k_de k_f/(k_f - k_de), b/T, k_v, a, b/k_v, c/k_v or c/k_de, m/T², k_f, c_f/T, their sum, k_f + k_v, credit, limit"
    over "settings of the law"
    by minisat fn p11_enhanced_settings32(s) {
        let settings = any_settings(s, LawKind::EnhancedSfa);
        assume!(s, in_ranges(&settings), "case; p8_validated has that no other is accepted");
        assume!(s, settings.k_desired > settings.k_soft, "case; the other is p11_soft_settings32");
        let accepted = settings.validate().is_ok();
        let found = made(&settings);
        let expected = if accepted { told(&settings).enhanced() } else { None };
        let as_one = match &found {
            Some(AnyLaw::Enhanced(law, _)) => {
                assert!(energy(law.energy_cap) == of_law::ENERGY_CAP);
                assert!(law.by_coupling.0 == N::divisor(law.mass.stiffness.0));
                assert_reached!(law.mass.by_total.0 == N::divisor(law.mass.total.0));
                Some(specified::at32::enhanced(law, law.series.0.divisor.into()))
            }
            _ => None,
        };
        assert!(as_one == expected && found.is_some() == expected.is_some());
        cover!(s, expected.is_some_and(|law| law.credit > 0 && law.target > law.desired), "compensated, with a loan");
        cover!(s, expected.is_none() && accepted, "refused");
    }
}
