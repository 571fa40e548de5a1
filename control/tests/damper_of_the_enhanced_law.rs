//! Tests of the damper whose force the enhanced law adds to the wall's: what it adds, and which values it does not change.

use touchstone_control::law::{Contact, Law, Sample};
use touchstone_control::{
    AnyLaw, Controller, Fixed32, Force, LawKind, Number, Position, Settings, Si, StatesKind,
};

type N = Fixed32;

fn si(text: &str) -> Si {
    Si::from_str(text).unwrap()
}

/// Settings of the enhanced law on measured states, without a guard.
fn settings(k_desired: &str, virtual_damping: &str) -> Settings {
    let mut settings = Settings {
        law: LawKind::EnhancedSfa,
        k_desired: si(k_desired),
        // Below the desired stiffness, so that the law augments the force.
        k_soft: si("4.9"),
        virtual_damping: si(virtual_damping),
        states: StatesKind::Measured,
        ..Settings::default()
    };
    settings.guard.on = false;
    settings
}

fn law(settings: &Settings) -> AnyLaw<N> {
    Controller::<N>::new(settings).unwrap().law
}

/// A simulated hand that swings from some 20 mrad inside the wall to a few mrad outside and back in 512 ticks, with a tremor of a
/// few counts.
fn hand() -> impl Iterator<Item = Sample<N>> {
    let mut random = 1_u64;
    let mut last = Position::zero();
    (0..4096_i32).map(move |tick| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let tremor = i32::try_from(random >> 52).unwrap() - 2048;
        let slow = ((tick & 511) - 256).abs() * 1600 - 80_000;
        let e = Position(<N as Number>::Signal::from_bits(slow + 4 * tremor));
        let moved = e - last;
        last = e;
        Sample { e, moved }
    })
}

#[test]
fn the_damper_changes_no_memory_and_adds_its_force() {
    let (AnyLaw::Enhanced(damped, mut state), AnyLaw::Enhanced(bare, mut other)) =
        (law(&settings("14", "0.02")), law(&settings("14", "0")))
    else {
        panic!("not that law");
    };
    let (mut first, mut augmenting, mut held_back) = (0, 0, 0);
    for sample in hand() {
        let (force, without) = (
            damped.tick(&mut state, sample),
            bare.tick(&mut other, sample),
        );
        assert_eq!(state, other);
        // (B/T) Δe within the wall, rounded towards zero. The sum never pulls and is at most the limit.
        let inside = sample.moved.min(sample.e);
        let expected = if state.contact == Contact::Free {
            Force::zero()
        } else {
            (without + (damped.damper * inside).towards_zero())
                .max(Force::zero())
                .min(damped.limit)
        };
        assert_eq!(force, expected);
        first += u32::from(state.contact == Contact::First && force > without);
        augmenting += u32::from(state.contact == Contact::Augmenting && force != without);
        held_back += u32::from(force == Force::zero() && without > Force::zero());
    }
    assert!(
        first > 0 && augmenting > 0 && held_back > 0,
        "{first}, {augmenting}, {held_back}"
    );
}

/// Checks that the enhanced law is a damped spring for desired stiffnesses up to the soft stiffness, with a damping in proportion
/// to the stiffness.
#[test]
fn up_to_the_soft_stiffness_the_law_is_the_damped_spring() {
    let soft = settings("5", "0").k_soft;
    for (k_desired, share) in [(soft, 1), (soft / 2, 2), (soft / 4, 4)] {
        let enhanced = Settings {
            k_desired,
            ..settings("5", "0.02")
        };
        let spring = Settings {
            law: LawKind::SpringDamper,
            virtual_damping: enhanced.virtual_damping / share,
            ..enhanced
        };
        let (AnyLaw::Spring(found, _), AnyLaw::Spring(expected, _)) =
            (law(&enhanced), law(&spring))
        else {
            panic!("no spring");
        };
        assert_eq!(found.desired, expected.desired);
        // Both the share and the gain are rounded towards zero, so they may differ by one step of 2^-12 N·m/rad.
        let off = expected.damping.0.to_bits() - found.damping.0.to_bits();
        assert!((0..=1).contains(&off), "{found:?} {expected:?}");
    }
}

/// Checks that the settings of the thesis have no damper.
#[test]
fn the_thesis_law_has_no_damper() {
    assert_eq!(Settings::thesis().virtual_damping, Si::ZERO);
    let AnyLaw::Enhanced(found, _) = law(&Settings::thesis()) else {
        panic!("not that law");
    };
    assert_eq!(found.damper.0.to_bits(), 0);
}
