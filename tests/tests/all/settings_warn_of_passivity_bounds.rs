//! Tests the warnings on passivity bounds from both sides: the last setting without a warning, and the named warning for the next
//! one. A law warns only of settings that it uses.

use touchstone_control::{
    Choice as _, Field, LawKind, ObserverForm, Settings, Si, StatesKind, Warning,
};
use touchstone_tests::si::{assert_one_line, next, si};

fn warns(settings: &Settings, is: fn(&Warning) -> bool) -> bool {
    for warning in settings.warnings() {
        assert_one_line(&warning.to_string());
    }
    settings.warnings().any(|warning| is(&warning))
}

/// Settings in which every passivity bound is a sum of powers of two. The smallest change of a setting then crosses its bound
/// exactly.
fn dyadic() -> Settings {
    let mut settings = Settings {
        rate_hz: 1024,
        k_soft: si("0.75"),
        device_damping: si("0.0009765625"), // 2^-10: k_c = 2 N·m/rad
        energy_credit: Si::ZERO,
        ..Settings::thesis()
    };
    settings.filter.damping = si("0.00048828125"); // 2^-11: 2 (c_i - c_f)/T = 1 N·m/rad
    settings.filter.stiffness = Si::ONE;
    settings.filter.ground_damping = si("0.0003662109375"); // k_v T/2
    settings
}

#[test]
fn settings_on_every_bound_are_passive_and_say_nothing() {
    let settings = dyadic();
    let on_the_soft_bound = Settings {
        k_soft: si("2"),
        ..settings
    };
    assert_eq!(settings.warnings().count(), 0);
    assert!(!warns(&on_the_soft_bound, |w| matches!(
        w,
        Warning::SoftAboveCritical { .. }
    )));
}

#[test]
fn a_soft_spring_above_the_critical_stiffness_is_warned_about() {
    let is = |w: &Warning| matches!(w, Warning::SoftAboveCritical { .. });
    for law in [LawKind::Sfa, LawKind::SfaContinuous, LawKind::EnhancedSfa] {
        let at = |k_soft| Settings {
            law,
            k_soft,
            ..dyadic()
        };
        assert!(!warns(&at(si("2")), is), "{law:?}");
        assert!(warns(&at(next(si("2"), true)), is), "{law:?}");
    }
    let above = next(si("2"), true);
    let settings = Settings {
        k_soft: above,
        ..dyadic()
    };
    let expected = Warning::SoftAboveCritical {
        k_soft: above,
        k_critical: si("2"),
    };
    assert!(settings.warnings().any(|w| w == expected));
    assert_eq!(expected.field(), Field::KSoft);
    // No warning for laws without the soft spring, or for a desired stiffness that does not exceed the soft spring's.
    for law in [
        LawKind::Spring,
        LawKind::SpringDamper,
        LawKind::Tdpa,
        LawKind::Fba,
    ] {
        assert!(!warns(&Settings { law, ..settings }, is), "{law:?}");
    }
    assert!(!warns(
        &Settings {
            k_desired: above,
            ..settings
        },
        is
    ));
}

#[test]
fn a_coupling_above_its_sampling_bound_is_warned_about() {
    let is = |w: &Warning| matches!(w, Warning::CouplingAboveBound { .. });
    let mut settings = dyadic();
    assert!(!warns(&settings, is));
    settings.filter.stiffness = next(Si::ONE, true);
    assert!(warns(&settings, is));
    let expected = Warning::CouplingAboveBound {
        k_filter: settings.filter.stiffness,
        bound: Si::ONE,
    };
    assert!(settings.warnings().any(|w| w == expected));
    assert_eq!(expected.field(), Field::FilterStiffness);
    // The bound `2 (c_i - c_f)/T` also falls below the coupling's stiffness if the filter's damping `c_f` rises or the device's
    // damping `c_i` falls.
    settings = dyadic();
    settings.filter.damping = next(settings.filter.damping, true);
    assert!(warns(&settings, is));
    settings = dyadic();
    settings.device_damping = next(settings.device_damping, false);
    assert!(warns(&settings, is));
    settings.law = LawKind::Sfa;
    assert!(!warns(&settings, is));
}

#[test]
fn ground_damping_below_half_the_soft_spring_is_warned_about() {
    let is = |w: &Warning| matches!(w, Warning::GroundDampingBelowBound { .. });
    let mut settings = dyadic();
    assert!(!warns(&settings, is));
    settings.filter.ground_damping = next(settings.filter.ground_damping, false);
    assert!(warns(&settings, is));
    let expected = Warning::GroundDampingBelowBound {
        ground_damping_per_tick: settings.derived().ground_damping_per_tick,
        bound: si("0.375"),
    };
    assert!(settings.warnings().any(|w| w == expected));
    assert_eq!(expected.field(), Field::FilterGroundDamping);
    settings.law = LawKind::Tdpa;
    assert!(!warns(&settings, is));
}

#[test]
fn an_observer_of_estimates_is_warned_about() {
    let is = |w: &Warning| matches!(w, Warning::ObservesEstimates);
    for &law in LawKind::ALL {
        for &states in StatesKind::ALL {
            let settings = Settings {
                law,
                states,
                ..Settings::default()
            };
            let expected = law == LawKind::Tdpa && states == StatesKind::Estimated;
            assert_eq!(warns(&settings, is), expected, "{law:?} {states:?}");
        }
    }
    assert_eq!(Warning::ObservesEstimates.field(), Field::States);
    assert!(!Warning::ObservesEstimates.is_answered_by_guard());
}

#[test]
fn the_thesis_observer_and_a_credit_are_warned_about_where_they_are_used() {
    let thesis = |w: &Warning| matches!(w, Warning::ThesisObserver);
    let credit = |w: &Warning| matches!(w, Warning::EnergyCredit { .. });
    let exact = dyadic();
    let by_thesis = Settings {
        observer: ObserverForm::Thesis,
        ..exact
    };
    assert!(!warns(&exact, thesis) && warns(&by_thesis, thesis));
    assert!(warns(
        &Settings {
            law: LawKind::Tdpa,
            ..by_thesis
        },
        thesis
    ));
    assert!(!warns(
        &Settings {
            law: LawKind::Fba,
            ..by_thesis
        },
        thesis
    ));
    let lent = Settings {
        energy_credit: Si::DELTA,
        ..exact
    };
    assert!(!warns(&exact, credit) && warns(&lent, credit));
    assert!(!warns(
        &Settings {
            law: LawKind::Tdpa,
            ..lent
        },
        credit
    ));
    assert_eq!(Warning::ThesisObserver.field(), Field::Observer);
    assert_eq!(
        Warning::EnergyCredit { credit: Si::DELTA }.field(),
        Field::EnergyCredit
    );
}
