//! P8: what `AnyLaw::new` accepts is what the properties of the laws assume: for all settings, by the code that builds the law.
//!
//! Settings are multiplied and divided in 128 bits on the way, which no solver follows to the end; what is assumed of the result
//! rests on signs, sums and shifts, and these it does follow, whatever the products are. The guard's and the estimator's
//! coefficients rest on products: they are sampled (`guard.rs`, `settings.rs`).

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{cover, property};
use touchstone_control::{
    AnyLaw, Compliance, FilterSettings, FirstContact, Fixed32, Force, IdealStep, LawKind,
    ObserverForm, OffsetUpdate, Ratio, Regulate, Settings, Si, Stiffness,
};

type N = Fixed32;

/// Any number; on samples mostly the thesis' or a part of it, or hardly any would be accepted.
fn value<S: Source>(s: &mut S, base: Si) -> Si {
    let bits = s.i64();
    Si::from_bits(if s.shortcut() {
        base.to_bits() >> (bits & 7)
    } else {
        bits
    })
}

/// Any settings of a law; guard and estimator off.
fn any_settings<S: Source>(s: &mut S, law: LawKind) -> Settings {
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
        regulate: if s.bool() {
            Regulate::Mass
        } else {
            Regulate::Hip
        },
        offset_update: if s.bool() {
            OffsetUpdate::TurnInward
        } else {
            OffsetUpdate::EveryTick
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

property! {
    /// P8, spring with damping.
    equation "accepted  =>  k, b >= 0, limit > 0, invariant"
    over "setting of the law"
    by kissat fn p8_spring_accepted32(s) {
        let settings = any_settings(s, LawKind::SpringDamper);
        let accepted = AnyLaw::<N>::new(&settings);
        cover!(s, accepted.is_ok(), "accepted");
        cover!(s, accepted.is_err(), "refused");
        let Ok(AnyLaw::Spring(law, state)) = accepted else {
            assert!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
    }
}
property! {
    /// P8, TDPA.
    equation "accepted  =>  k, c >= 0, limit > 0, cap, invariant"
    over "setting of the law"
    by kissat fn p8_tdpa_accepted32(s) {
        let settings = any_settings(s, LawKind::Tdpa);
        let accepted = AnyLaw::<N>::new(&settings);
        cover!(s, accepted.is_ok(), "accepted");
        let Ok(AnyLaw::Tdpa(law, state)) = accepted else {
            assert!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
        assert!(settings.count_device_damping || law.device_damping == Stiffness::zero());
    }
}
property! {
    /// P8, force bounding.
    equation "accepted  =>  k, c, bound >= 0, limit > 0, cap, invariant"
    over "setting of the law"
    by kissat fn p8_fba_accepted32(s) {
        let settings = any_settings(s, LawKind::Fba);
        let accepted = AnyLaw::<N>::new(&settings);
        cover!(s, accepted.is_ok(), "accepted");
        let Ok(AnyLaw::Fba(law, state)) = accepted else {
            assert!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
    }
}
property! {
    /// P8, SFA, original and continuous.
    equation "accepted  =>  k, k_v, gain, 1/k_v >= 0, limit > 0, invariant"
    over "setting of the law"
    by kissat fn p8_sfa_accepted32(s) {
        let kind = if s.bool() { LawKind::Sfa } else { LawKind::SfaContinuous };
        let settings = any_settings(s, kind);
        let accepted = AnyLaw::<N>::new(&settings);
        cover!(s, accepted.is_ok(), "accepted");
        let Ok(AnyLaw::Sfa(law, state)) = accepted else {
            assert!(accepted.is_err());
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.gain >= Ratio::zero() && law.compliance >= Compliance::zero());
    }
}
property! {
    /// P8, enhanced law: the parts of the mass are no more than their sum, of which twice fits; the loan is within the cap.
    equation "accepted  =>  M + k_f + C <= D <= 2^30, k_f > 0, 0 <= credit <= cap, shares >= 0"
    over "setting of the law"
    by kissat fn p8_enhanced_accepted32(s) {
        let settings = any_settings(s, LawKind::EnhancedSfa);
        let accepted = AnyLaw::<N>::new(&settings);
        cover!(s, matches!(accepted, Ok(AnyLaw::Enhanced(..))), "accepted");
        let Ok(AnyLaw::Enhanced(law, state)) = accepted else {
            assert!(!matches!(accepted, Ok(AnyLaw::Tdpa(..) | AnyLaw::Fba(..) | AnyLaw::Sfa(..))));
            return;
        };
        assert!(law.valid() && law.holds(&state) && law.limit > Force::zero());
        assert!(law.energy_cap == N::energy_cap());
        assert!(law.mass.stiffness > Stiffness::zero() && law.compliance >= Compliance::zero());
    }
}
