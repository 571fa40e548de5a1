//! Tests that the shipped energy guard and its specification agree bit for bit over millions of ticks, also with hostile hands.
//! Also tests that the coefficients of every guard that `Guard::new` accepts satisfy the conditions of the energy theorem.

use fixed::types::I8F24;
use touchstone_control::{
    ChangeOfForce, Field, Fixed32, Force, Guard, GuardSettings, GuardedDevice, Position, Settings,
    SettingsError, Si,
};
use touchstone_proofs::spec::covers::{Device, FINE};
use touchstone_proofs::spec::guard as spec;
use touchstone_proofs::spec::hands::{Random, any_settings, bits, moved};
use touchstone_proofs::specified::at32::{guard as specified, of_guard as memory};
use touchstone_proofs::valid::Valid as _;

#[test]
fn every_tick_of_the_guard_is_its_specification() {
    let mut random = Random(1);
    let (mut ticks, mut accepted) = (0_u64, 0);
    let mut reached = [
        ("overspeed", 0_u64),
        ("deficit", 0),
        ("reserve", 0),
        ("full", 0),
        ("cut", 0),
        ("told", 0),
        ("pulls", 0),
    ];
    while ticks < 4_000_000 {
        let (settings, device) = any_settings(&mut random);
        let Ok(law) = Guard::<Fixed32>::new(&settings, &device) else {
            continue;
        };
        accepted += 1;
        let (specified, mut state) = (specified(&law), law.full());
        let mut expected = memory(&state);
        assert_eq!(
            expected,
            spec::Memory {
                account: specified.capacity,
                ..Default::default()
            }
        );
        let furthest = i64::from(law.furthest.0.to_bits());
        let habit = random.any() >> 16;
        for tick in 0..400 {
            ticks += 1;
            let moved = moved(&mut random, habit, tick, &expected, furthest);
            let (moved, wanted) = (bits(moved), bits(random.signed(31)));
            let measured = settings.change == ChangeOfForce::Measured;
            let before_change = if measured {
                bits(random.signed(31 - habit % 12))
            } else {
                I8F24::ZERO
            };
            let wide = |x: I8F24| i128::from(x.to_bits());
            let before = expected;
            let (next, fine) =
                specified.tick(&before, wide(moved), wide(before_change), wide(wanted));
            expected = next;
            let answer = if measured {
                law.tick_with_change(
                    &mut state,
                    Position(moved),
                    Position(before_change),
                    Force(wanted),
                )
            } else {
                law.tick(&mut state, Position(moved), Force(wanted))
            };
            assert_eq!(
                memory(&state),
                expected,
                "{settings:?} {device:?}\n{before:?} {moved:?} {before_change:?} {wanted:?}"
            );
            assert_eq!(answer.is_ok(), fine);
            assert_eq!(answer.map_or(0, |force| wide(force.0)), expected.force);
            let told = random.below(8) == 0;
            let reserve = before.force.abs() * specified.in_flight;
            for ((_, count), now) in reached.iter_mut().zip([
                !fine && before.force != 0,
                before.account < 0 && fine,
                before.account >= 0 && fine && reserve > 0 && expected.account == reserve,
                fine && expected.account == specified.capacity && specified.capacity > 0,
                fine && expected.force != wide(wanted),
                told,
                expected.force < 0,
            ]) {
                *count += u64::from(now);
            }
            if told {
                let told = bits(random.signed(31));
                law.commanded(&mut state, Force(told));
                expected = spec::Guard::commanded(&expected, wide(told));
                assert_eq!(memory(&state), expected);
            }
        }
    }
    println!("{ticks} ticks of {accepted} guards: {reached:?}");
    assert!(
        reached.iter().all(|(_, count)| *count > 1000),
        "{reached:?}"
    );
}

/// The device that the settings describe, without rounding. Its positions are wrong by half an encoder count plus `rounded` steps
/// of the position format. `None` if the settings trust no damping although a force acts late.
fn described(settings: &GuardSettings, device: &GuardedDevice, rounded: i128) -> Option<Device> {
    let bits = |x: Si| i128::from(x.to_bits());
    let rate = i128::from(device.rate_hz);
    let s = ((bits(settings.delay) + bits(settings.lag)) * rate) << (FINE - 32);
    let one = 1_i128 << FINE;
    // 64 fractional bits.
    let c = bits(settings.share_of_damping) * bits(settings.damping) * rate;
    let split = s * (one - s).max(0);
    if split > 0 && c == 0 {
        return None;
    }
    let kappa = if split > 0 {
        (split << 24) / (4 * c) + 1
    } else {
        0
    };
    Some(Device {
        s: s.min(one),
        // From SI units with 32 fractional bits to steps of the signal's format with [`FINE`] fractional bits.
        d: (bits(settings.overspeed) << (24 + FINE - 32)) / rate + 1,
        delta: (bits(device.count) << (24 + FINE - 32)) + 2 * rounded * one,
        kappa,
    })
}

/// Checks that the coefficients of guards that `Guard::new` accepts satisfy the conditions of the energy theorem (`covers`).
#[test]
fn accepted_guards_cover_the_device_that_they_are_told() {
    let mut random = Random(7);
    let mut least: Vec<(&str, i128, i128)> = Vec::new();
    let mut accepted = 0;
    while accepted < 50_000 {
        let (settings, device) = any_settings(&mut random);
        let settings = GuardSettings {
            change: ChangeOfForce::Estimated,
            ..settings
        };
        let Ok(law) = Guard::<Fixed32>::new(&settings, &device) else {
            continue;
        };
        let specified = specified(&law);
        let c = i128::from(settings.share_of_damping.to_bits())
            * i128::from(settings.damping.to_bits())
            * i128::from(device.rate_hz);
        assert!(specified.damping << 52 <= c, "{settings:?}");
        let Some(told) = described(&settings, &device, 1) else {
            continue;
        };
        accepted += 1;
        for (index, (name, room)) in specified.room(&told).into_iter().enumerate() {
            // The margin in steps of the signal's format; for `reach`, in steps of its reciprocal.
            let scale = if name == "reach" {
                specified.per_reach.max(1) << FINE
            } else {
                1 << FINE
            };
            let thousandths = room.saturating_mul(1000) / scale;
            if least.len() <= index {
                least.push((name, i128::MAX, 0));
            }
            let entry = &mut least[index];
            entry.1 = entry.1.min(thousandths);
            entry.2 += i128::from(room < 0);
        }
    }
    println!("{least:?} of {accepted}");
    assert!(least.iter().all(|(_, _, short)| *short == 0), "{least:?}");
}

/// Checks that the guards in `proofs/coq/Shipped.v`, which the energy theorem is about, are those of the default settings, at each
/// of the theorem's delays.
#[test]
fn the_theorem_is_about_the_shipped_guards() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/coq/Shipped.v");
    let text = std::fs::read_to_string(path).expect("readable");
    let defaults = Settings::default();
    for (name, delay) in [
        ("at_once", "0"),
        ("tenth", "0.0001"),
        ("half", "0.0005"),
        ("whole", "0.001"),
    ] {
        let settings = GuardSettings {
            delay: Si::from_str(delay).expect("a number"),
            ..defaults.guard
        };
        let law =
            Guard::<Fixed32>::new(&settings, &defaults.guarded_device()).expect("the defaults");
        let g = specified(&law);
        for (field, value) in [
            ("capacity", g.capacity),
            ("refill", g.refill),
            ("damping", g.damping),
            ("furthest", g.furthest),
            ("count", g.count),
            ("slack", g.slack),
            ("per_reach", g.per_reach),
        ] {
            assert!(
                text.contains(&format!("  {field} := {value};\n")),
                "{field} is {value}"
            );
        }
        let four = [g.late, g.stray, g.in_flight, g.overrun]
            .map(|x| x.to_string())
            .join(" ");
        assert!(
            text.contains(&format!("Definition {name} : guard := shipped {four}.")),
            "{name}: {four}"
        );
    }
}

/// Checks that `Guard::new` refuses a displacement in flight (under a force after the sample that ends it) of more than a quarter
/// of the format. The displacement in flight is slightly more if the delay is a whole tick and the largest displacement is a
/// quarter of the format.
#[test]
fn a_way_in_flight_beyond_a_quarter_is_refused() {
    let device = GuardedDevice {
        rate_hz: 1,
        force_limit: Si::ONE,
        count: Si::lit("0.0999"),
    };
    let made = |overspeed| {
        let settings = GuardSettings {
            capacity: Si::ONE,
            refill: Si::ZERO,
            share_of_damping: Si::ONE,
            damping: Si::ZERO,
            overspeed,
            delay: Si::ONE,
            lag: Si::ZERO,
            change: ChangeOfForce::Measured,
            on: true,
        };
        Guard::<Fixed32>::new(&settings, &device)
    };
    assert!(made(Si::lit("31.85")).is_ok_and(|law| law.valid()));
    let refused = made(Si::lit("31.88"));
    assert!(
        matches!(
            refused,
            Err(SettingsError::OutOfFormat {
                field: Field::GuardDelay,
                ..
            })
        ),
        "{refused:?}"
    );
}
