//! Tests every control law with every option at the most extreme positions of each number format, in every order. The force stays
//! within its limit, nothing overflows (the tests are built with overflow checks), and the floating-point formats never give a NaN.

use touchstone_control::{
    Controller, Fixed8, Fixed16, Fixed32, Force, Number, Position, Reported, Settings, Si,
};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;
use touchstone_tests::variants::all;

/// Number of positions in a sequence. Every sequence of the positions in `worst` is tried.
const LENGTH: u32 = 6;

/// Extreme measured positions: the ends of the number format, and positions next to the wall's surface.
fn worst<N: Reported>() -> [Position<N>; 6] {
    [
        Position::from_f64(-1e9),
        -Position::quantum(),
        Position::zero(),
        Position::quantum(),
        Position::from_f64(0.01),
        Position::from_f64(1e9),
    ]
}

/// The default settings, and settings at the ends of the ranges that the settings' check accepts; each with a name.
fn settings() -> Vec<(String, Settings)> {
    let usual = Settings::thesis();
    let mut hard = Settings {
        k_desired: si("500000"),
        step_of_ideal: Si::ONE,
        limit_of_force: Si::ONE,
        limit_of_penetration: Si::ONE,
        energy_credit: si("1000"),
        force_limit: si("100"),
        ..usual
    };
    hard.filter.mass = si("0.2");
    [("usual", usual), ("hard", hard)]
        .into_iter()
        .flat_map(|(base, settings)| {
            all(&settings)
                .into_iter()
                .map(move |(name, settings)| (format!("{base} {name}"), settings))
        })
        .collect()
}

/// The walls whose coefficients the number format can hold, each with its name and force limit.
fn walls<N: Reported>() -> Vec<(String, Force<N>, Controller<N>)> {
    settings()
        .into_iter()
        .filter_map(|(name, settings)| {
            let limit = Force(N::signal(settings.force_limit)?);
            Some((name, limit, Controller::new(&settings).ok()?))
        })
        .collect()
}

/// Whether a force is within ±`limit`. A NaN is not, because comparisons with it are false.
fn is_within<N: Reported>(f: Force<N>, limit: Force<N>) -> bool {
    f <= limit && f >= -limit
}

fn sequences<N: Reported>(at_least: usize) {
    let worst = worst::<N>();
    let walls = walls::<N>();
    assert!(walls.len() >= at_least, "{} walls only", walls.len());
    for (name, limit, fresh) in walls {
        for code in 0..worst.len().pow(LENGTH) {
            let mut wall = fresh;
            let mut rest = code;
            for _ in 0..LENGTH {
                let e = worst[rest % worst.len()];
                rest /= worst.len();
                let f = wall.tick(e);
                assert!(
                    is_within(f, limit),
                    "{name}, sequence {code}: {f:?} at {e:?}"
                );
            }
        }
    }
}

#[test]
fn in_fixed32() {
    sequences::<Fixed32>(80);
}

#[test]
fn in_fixed16() {
    sequences::<Fixed16>(40);
}

#[test]
fn in_f32() {
    sequences::<f32>(80);
}

#[test]
fn in_f64() {
    sequences::<f64>(80);
}

type Signal8 = <Fixed8 as Number>::Signal;

#[test]
fn every_position_after_every_other_in_eight_bits() {
    // Coefficients that eight bits hold (gains below 16, ratios below 1), for the laws that need no small ones.
    let base = Settings {
        k_desired: si("5"),
        k_soft: si("2"),
        device_damping: si("0.0015"),
        filter: touchstone_control::FilterSettings {
            mass: si("0.000001"),
            stiffness: si("3"),
            damping: si("0.0005"),
            ground_damping: si("0.001"),
        },
        ..Settings::thesis()
    };
    let mut random = Random::new(9);
    let mut laws = 0;
    for (name, settings) in all(&base) {
        let Ok(fresh) = Controller::<Fixed8>::new(&settings) else {
            continue;
        };
        laws += 1;
        let limit = Force(Fixed8::signal(settings.force_limit).unwrap());
        for first in i8::MIN..=i8::MAX {
            for second in i8::MIN..=i8::MAX {
                let mut wall = fresh;
                let rest = [(); 6].map(|()| random.bits() as i8);
                for bits in [first, second].into_iter().chain(rest) {
                    let f = wall.tick(Position(Signal8::from_bits(bits)));
                    assert!(
                        is_within(f, limit),
                        "{name}: {first}, {second}, {rest:?}: {f:?}"
                    );
                }
            }
        }
    }
    assert!(laws >= 30, "{laws} laws only fit eight bits");
}

#[test]
fn a_position_that_is_no_number_or_infinite_makes_no_nan() {
    fn check<N: Reported>() {
        let odd = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
        ];
        for (name, limit, mut wall) in walls::<N>() {
            for round in 0..25 {
                for e in [odd[round % 5], 0.01, odd[round / 5], 0.02, 0.015] {
                    let f = wall.tick(Position::from_f64(e));
                    assert!(is_within(f, limit), "{}: {name} at {e}: {f:?}", N::NAME);
                }
            }
        }
    }
    check::<Fixed32>();
    check::<Fixed16>();
    check::<f64>();
    check::<f32>();
}
