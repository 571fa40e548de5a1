//! Tests of what every control law with every option guarantees for any motion: no force outside the wall, never more than the
//! limit, and no pull except where a law may pull. A law also remembers nothing after leaving, and gives the same result for the
//! same input.

use touchstone_control::law::Contact;
use touchstone_control::{Controller, Force, LawKind, Position, Reported, Settings};
use touchstone_tests::random::Random;
use touchstone_tests::variants::all;

fn walls<N: Reported>() -> Vec<(String, Settings, Controller<N>)> {
    all(&Settings::thesis())
        .into_iter()
        .map(|(name, settings)| {
            let wall = Controller::new(&settings).unwrap_or_else(|e| panic!("{name}: {e}"));
            (name, settings, wall)
        })
        .collect()
}

/// Positions of a random walk around the wall's surface, with jumps and rests.
fn walk<N: Reported>(random: &mut Random, ticks: usize) -> Vec<Position<N>> {
    let mut e = 0.0_f64;
    (0..ticks)
        .map(|_| {
            match random.bits() % 64 {
                0 => e = 1.5 * random.real(),
                1..=8 => {}
                9..=24 => e += 1e-4 * random.real(),
                _ => e += 5e-3 * random.real(),
            }
            e = e.clamp(-1.5, 1.5);
            Position::from_f64(e)
        })
        .collect()
}

fn limit_of<N: Reported>(settings: &Settings) -> Force<N> {
    Force(N::signal(settings.force_limit).unwrap())
}

fn assert_within<N: Reported>(name: &str, f: Force<N>, limit: Force<N>) {
    assert!(f <= limit && f >= -limit, "{name}: {f:?}, limit {limit:?}");
}

fn a_wall_not_touched_gives_no_force<N: Reported>() {
    let mut random = Random::new(3);
    for (name, _, mut wall) in walls::<N>() {
        let fresh = wall.view();
        for _ in 0..1000 {
            let e = Position::<N>::from_f64(-1.5 * random.real().abs());
            assert_eq!(wall.tick(e), Force::zero(), "{name} at {e:?}");
        }
        assert_eq!(wall.tick(Position::zero()), Force::zero(), "{name}");
        assert_eq!(wall.tick(-Position::quantum()), Force::zero(), "{name}");
        assert_eq!(wall.view(), fresh, "{name}");
    }
}

fn the_force_stays_within_its_limit<N: Reported>() {
    let mut random = Random::new(4);
    let path = walk::<N>(&mut random, 20_000);
    for (name, settings, mut wall) in walls::<N>() {
        let limit = limit_of::<N>(&settings);
        let mut touched = false;
        for &e in &path {
            let f = wall.tick(e);
            assert_within(&name, f, limit);
            touched |= f != Force::zero();
        }
        assert!(touched, "{name}: no force at all");
    }
}

/// Checks that forces push outwards. Only two control laws may pull, and only inside the wall: TDPA (time-domain passivity) with
/// the exact energy observer, against an energy deficit, and the enhanced law, with its virtual mass.
fn a_wall_pushes<N: Reported>() {
    let mut random = Random::new(7);
    let path = walk::<N>(&mut random, 20_000);
    for (name, settings, mut wall) in walls::<N>() {
        let may_pull = matches!(settings.law, LawKind::Tdpa | LawKind::EnhancedSfa);
        for &e in &path {
            let f = wall.tick(e);
            assert!(
                f >= Force::zero() || may_pull && e > Position::zero(),
                "{name}: {f:?} at {e:?}"
            );
        }
    }
}

/// Checks that a control law that does not shift the wall's surface gives no force outside the wall. Equation (2.15) of the thesis
/// that this project implements allows the laws that shift it (by an offset) to push there.
fn laws_without_an_offset_give_no_force_outside<N: Reported>() {
    let mut random = Random::new(8);
    let path = walk::<N>(&mut random, 20_000);
    for (name, settings, mut wall) in walls::<N>() {
        let has_offset = matches!(
            settings.law,
            LawKind::Sfa | LawKind::SfaContinuous | LawKind::EnhancedSfa
        );
        for &e in path.iter().filter(|_| !has_offset) {
            let f = wall.tick(e);
            assert!(
                e > Position::zero() || f == Force::zero(),
                "{name}: {f:?} at {e:?}"
            );
        }
    }
}

fn the_same_input_gives_the_same_force<N: Reported>() {
    let mut random = Random::new(5);
    let path = walk::<N>(&mut random, 4_000);
    for (name, _, wall) in walls::<N>() {
        let (mut first, mut second) = (wall, wall);
        for (tick, &e) in path.iter().enumerate() {
            assert_eq!(first.tick(e), second.tick(e), "{name}, tick {tick}");
            if tick == 2_000 {
                // The memory is complete: a copy of it continues as the original.
                second = first;
            }
        }
        assert_eq!(first, second, "{name}");
    }
}

/// Checks that a control law clears its memory outside the wall, farther out than it can shift the wall's surface.
fn leaving_clears_the_memory<N: Reported>() {
    let mut random = Random::new(6);
    for (name, _, fresh) in walls::<N>() {
        let mut used = fresh;
        for round in 0..50 {
            for e in walk::<N>(&mut random, 200) {
                used.tick(e);
            }
            let out = [-1.2, -1.2, -1.3].map(Position::<N>::from_f64);
            let mut clean = fresh;
            let forces = out.map(|e| {
                clean.tick(e);
                used.tick(e)
            });
            assert_eq!(forces[2], Force::zero(), "{name}, round {round}");
            assert_eq!(used.view().contact, Contact::Free, "{name}");
            assert_eq!(used, clean, "{name}, round {round}: remembers something");
        }
    }
}

macro_rules! for_formats {
    ($($claim:ident),+ $(,)?) => {
        $(mod $claim {
            #[test]
            fn in_fixed32() { super::$claim::<touchstone_control::Fixed32>(); }
            #[test]
            fn in_fixed16() { super::$claim::<touchstone_control::Fixed16>(); }
            #[test]
            fn in_f32() { super::$claim::<f32>(); }
            #[test]
            fn in_f64() { super::$claim::<f64>(); }
        })+
    };
}

for_formats!(
    a_wall_not_touched_gives_no_force,
    the_force_stays_within_its_limit,
    a_wall_pushes,
    laws_without_an_offset_give_no_force_outside,
    the_same_input_gives_the_same_force,
    leaving_clears_the_memory,
);
