//! Tests that the control laws follow equations of the thesis that this project implements, in places that are easily got wrong.

use touchstone_control::law::{Contact, EnhancedState, Law, Sample, Sfa, SfaState};
use touchstone_control::{
    AnyLaw, Controller, FirstContact, Fixed32, Force, LawKind, ObserverForm, Position, Settings, Si,
};
use touchstone_tests::random::Random;

fn si(text: &str) -> Si {
    Si::from_str(text).unwrap()
}

fn sfa(update: LawKind, first_contact: FirstContact) -> Sfa<f64> {
    let settings = Settings {
        law: update,
        first_contact,
        ..Settings::thesis()
    };
    let AnyLaw::Sfa(law, _) = Controller::<f64>::new(&settings).unwrap().law else {
        panic!("not that law");
    };
    law
}

/// Checks equations (2.16) and (2.17) of the thesis that this project implements, for the control law SFA. The first contact phase,
/// while the wall is soft, ends in control period `n_r`, with the force that the desired stiffness `k_de` gives in that period, not
/// in the one before.
#[test]
fn the_first_contact_hands_over_the_force_of_its_own_tick() {
    let law = sfa(LawKind::Sfa, FirstContact::KeepForce);
    let mut state = SfaState::default();
    let mut last = 0.0;
    let mut at = |state: &mut SfaState<f64>, e: f64| {
        let force = law.tick(state, Sample::measured(Position(e), Position(last)));
        last = e;
        force.0
    };
    at(&mut state, 0.010);
    at(&mut state, 0.012);
    let force = at(&mut state, 0.011);
    assert_eq!(state.contact, Contact::Augmenting);
    // 1/k_v has steps of 2^-32, and is multiplied by k_v f.
    let step = 0.8 * 0.055 * 2f64.powi(-32);
    assert!((force - 5.0 * 0.011).abs() < step, "{force}");
    let offset = 5.0 * 0.011 / 0.8 - 0.011;
    assert!((state.offset.0 - offset).abs() < 1e-8, "{:?}", state.offset);
}

/// Checks equation (2.14c), third line from below, of the thesis that this project implements, for the control law SFA. If the
/// displayed stiffness is the desired one, the law does not shift the wall's surface.
#[test]
fn the_offset_stays_where_the_stiffness_is_right() {
    for kind in [LawKind::Sfa, LawKind::SfaContinuous] {
        let law = sfa(kind, FirstContact::ZeroOffset);
        let held = SfaState {
            contact: Contact::Augmenting,
            last: Position(0.01),
            before_last: Position(0.0101),
            offset: Position(0.05),
            force: Force(law.desired.0 * 0.01),
        };
        let mut state = held;
        law.tick(
            &mut state,
            Sample {
                e: Position(0.0101),
                moved: Position(1e-4),
            },
        );
        assert_eq!(state.offset, held.offset, "{kind:?}");
    }
    // The enhanced law's ideal step is the remaining difference, which is 0.
    let AnyLaw::Enhanced(law, mut state) = Controller::<f64>::new(&Settings::thesis()).unwrap().law
    else {
        panic!("not that law");
    };
    state.contact = Contact::Augmenting;
    state.force = Force(law.desired.0 * 0.01);
    state.augmented.offset = Position(0.05);
    assert_eq!(law.offset(&state, Position(0.01)), Position(0.05));
}

/// Checks that the offset by which the control law SFA shifts the wall's surface does not grow while a hand presses at the force
/// limit and trembles there for a minute.
#[test]
fn leaning_at_the_force_limit_winds_up_no_offset() {
    for kind in [LawKind::Sfa, LawKind::SfaContinuous] {
        let law = Sfa {
            limit: Force(0.3),
            ..sfa(kind, FirstContact::ZeroOffset)
        };
        let mut state = SfaState::default();
        let mut last = 0.0;
        let mut tick = |state: &mut SfaState<f64>, e: f64| {
            let force = law.tick(state, Sample::measured(Position(e), Position(last)));
            last = e;
            force.0
        };
        // k_de would give 0.5 N·m at 0.1 rad. The hand trembles there for a minute.
        let trembling = |n: u32| 0.1 + 1e-3 * f64::from(n % 2);
        let mut after_ten_seconds = Position(0.0);
        for n in 0..60_000 {
            tick(&mut state, trembling(n));
            if n == 10_000 {
                after_ten_seconds = state.offset;
            }
        }
        assert_eq!(state.force, law.limit, "{kind:?}");
        assert_eq!(state.offset, after_ten_seconds, "{kind:?}");
        // At the force limit, the soft spring's force `k_v (e + O)` at the penetration `e` and the offset `O` equals the limit,
        // except for the offset's last step.
        assert!(
            state.offset.0 <= 0.3 / law.soft.0 - 0.1 + 1e-3,
            "{kind:?}: {:?}",
            state.offset
        );
    }
}

/// Checks that the enhanced control law never pulls inside the wall, however fast the hand leaves the law's virtual mass behind.
/// The energy of this mass, including the energy that the law may lend, grows by no more than the work of the force on it.
#[test]
fn the_enhanced_law_never_pulls_inside_the_wall() {
    let stiff = Settings {
        k_desired: si("20"),
        k_soft: si("17"),
        filter: touchstone_control::FilterSettings {
            mass: si("0.000002"),
            stiffness: si("75"),
            damping: si("0.0014"),
            ground_damping: si("0.1"),
        },
        ..Settings::thesis()
    };
    let mut random = Random::new(7);
    for settings in [Settings::thesis(), stiff] {
        let AnyLaw::Enhanced(law, mut state) = Controller::<Fixed32>::new(&settings).unwrap().law
        else {
            panic!("not that law");
        };
        let (mut x, mut v, mut pushes, mut idle) = (-0.01, 0.0, 0, 0);
        let mut last = Position::from_f64(x);
        for n in 0..200_000 {
            if n % 40 == 0 {
                v = 0.012 * random.real();
            }
            x = (x + v).clamp(-0.005, 0.08);
            let e = Position::from_f64(x);
            let before: EnhancedState<Fixed32> = state;
            let force = law.tick(&mut state, Sample::measured(e, last));
            last = e;
            assert!(
                force >= Force::zero() || e <= Position::zero(),
                "{n}: {force:?} at {e:?}"
            );
            pushes += u32::from(force > Force::zero());
            if before.contact == Contact::Augmenting && state.contact == Contact::Augmenting {
                idle += u32::from(force == Force::zero());
                let work = state.augmented.at_mass * state.augmented.mass.moved;
                let mut books = (before.energy + work).min(law.energy_cap);
                if work < touchstone_control::Energy::zero() && books != state.energy {
                    // If the mass retreats less than the law wanted, energy may be left over, but never more than before.
                    books = books.max(state.energy).min(before.energy);
                }
                assert!(state.energy <= books, "{n}: {:?} {books:?}", state.energy);
            }
        }
        assert!(pushes > 10_000 && idle > 10, "{pushes} {idle}");
    }
}

/// Checks that the enhanced control law lends the hand no energy if it uses the energy observer in the thesis' form.
#[test]
fn the_published_observer_has_no_loan() {
    for (observer, lent) in [(ObserverForm::Thesis, false), (ObserverForm::Exact, true)] {
        let settings = Settings {
            observer,
            ..Settings::thesis()
        };
        let mut wall = Controller::<Fixed32>::new(&settings).unwrap();
        wall.tick(Position::from_f64(0.001));
        let AnyLaw::Enhanced(_, state) = wall.law else {
            panic!("not that law");
        };
        assert_eq!(state.energy.to_f64() > 0.0, lent, "{observer:?}");
    }
}
