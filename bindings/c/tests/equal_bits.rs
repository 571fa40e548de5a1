//! Tests that C programs get the same bits from the library as Rust code gets from the control crate, for random motions and
//! forces, with sanitizers on.

mod program;

use program::{Program, SANITIZERS, number};
use std::fmt::Write as _;
use touchstone_control::environment::profile::Shape;
use touchstone_control::environment::{
    CentreSettings, ClickSettings, Counted, DetentSettings, DrySettings, Extent, Face,
    FeelSettings, InertiaSettings, ProfileSettings, Side, Spacing, ViscousSettings, WallSettings,
};
use touchstone_control::estimator::EstimatorState;
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{
    ChangeOfForce, Choice, Controller, CountScale, Environment, Fixed32, Force, Guard,
    GuardSettings, Guarded, GuardedDevice, LawKind, Position, PositionSettings, Settings, Si,
};

const OK: i64 = 0;
const OVERSPEED: i64 = 6;

/// The C programs' random numbers.
struct Random(u32);

impl Random {
    const START: Self = Self(0x2545_F491);

    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }
}

/// The C programs' digest of results.
struct Digest(u64);

impl Digest {
    const START: Self = Self(0xCBF2_9CE4_8422_2325);

    fn add(&mut self, value: u64) {
        self.0 = (self.0 ^ value).wrapping_mul(0x0100_0000_01B3);
    }

    fn add32(&mut self, value: i32) {
        self.add(u64::from(value.cast_unsigned()));
    }
}

fn si(text: &str) -> Si {
    text.parse().expect("a number")
}

/// A constant as the macro `TS_SI` makes it, which rounds towards zero where `Si` rounds to the nearest.
fn ts_si(value: f64) -> Si {
    Si::from_bits((value * 4_294_967_296.0) as i64)
}

/// Repeats the control periods of `examples/hostile.c` in Rust. Returns the lines that the C program must print.
fn hostile_in_rust(ticks_per_law: u64) -> String {
    let mut random = Random::START;
    let device = GuardedDevice {
        rate_hz: 1000,
        force_limit: si("0.5"),
        count: ts_si(0.000_157_079_633),
    };
    let shipped = GuardSettings {
        damping: ts_si(0.0004),
        change: ChangeOfForce::Measured,
        ..GuardSettings::default()
    };
    let made = Guard::new(&shipped, &device).expect("a guard");
    let mut guard = Guarded::<Fixed32>::new(made);
    let limit = Force::from_si(device.force_limit).expect("a force");
    let signal = I8F24::from_bits;
    let mut lines = String::new();
    for (law, word) in LawKind::ALL.iter().zip(LawKind::WORDS) {
        let settings = Settings {
            k_desired: si("14"),
            law: *law,
            ..Settings::default()
        };
        let fresh = Controller::<Fixed32>::new(&settings).expect("a wall");
        let mut wall = fresh;
        let estimator = settings
            .estimator
            .estimator::<Fixed32>(settings.rate_hz, settings.force_limit)
            .expect("an estimator");
        let mut estimated = EstimatorState::default();
        let mut digest = Digest::START;
        let status = |tripped| if tripped { OVERSPEED as i32 } else { OK as i32 };
        for _ in 0..ticks_per_law {
            let chance = random.next();
            let moved = if chance.is_multiple_of(1000) {
                random.next().cast_signed()
            } else {
                (random.next() % 1_000_001).cast_signed() - 500_000
            };
            let wanted = Force(signal(random.next().cast_signed())).within(limit);
            let allowed = guard.moved(Position(signal(moved)), Position(signal(moved / 3)), wanted);
            digest.add32(allowed.0.to_bits());
            digest.add32(status(guard.tripped));
            if guard.tripped {
                guard = Guarded::new(made).resumed(&guard);
            }
            if chance.is_multiple_of(7) {
                guard.commanded(Force(signal(allowed.0.to_bits() / 2)));
            }
            let small = (random.next() % 200_001).cast_signed() - 100_000;
            let far = if chance.is_multiple_of(5000) {
                random.next().cast_signed() / 4
            } else {
                0
            };
            let place = Position(signal(small + far));
            let force = wall.tick(place);
            digest.add32(force.0.to_bits());
            digest.add32(status(wall.tripped()));
            if wall.tripped() {
                wall.resume(&fresh);
            }
            if chance.is_multiple_of(5) {
                wall.commanded(Force(signal(force.0.to_bits() / 2)));
            }
            let sample = estimator.tick(&mut estimated, place);
            digest.add32(status(false));
            digest.add32(sample.e.0.to_bits());
            digest.add32(sample.moved.0.to_bits());
            estimator.commanded(&mut estimated, force);
        }
        writeln!(lines, "{word} {:016x}", digest.0).expect("a text");
    }
    lines
}

/// Runs 150,000 control periods with each law, or as many as `TOUCHSTONE_HOSTILE` says.
#[test]
fn guard_estimator_and_every_law_have_the_bits_of_the_rust_code() {
    let ticks_per_law = number("TOUCHSTONE_HOSTILE", 150_000);
    let program = Program::c("hostile", &["examples/hostile.c"]).with(&SANITIZERS);
    let program = program.with(&[&format!("-DTICKS_PER_LAW={ticks_per_law}u")]);
    if let Some(said) = program.said(&[]) {
        assert_eq!(said, hostile_in_rust(ticks_per_law));
        assert_eq!(said.lines().count(), 7);
    }
}

/// The feel of `tests/feel.c`.
fn all_parts(settings: &Settings, around: bool) -> Environment<Fixed32> {
    let wall = |surface, k_desired, side| WallSettings {
        face: Face {
            surface: si(surface),
            side,
        },
        k_desired: si(k_desired),
    };
    let walls = [
        wall("1", "5", Side::Above),
        wall("-1", "4", Side::Below),
        wall("700", "5", Side::Above),
    ];
    let spacing = |per_turn, pitch| {
        if around {
            Spacing::PerTurn(per_turn)
        } else {
            Spacing::Pitch(si(pitch))
        }
    };
    let detents = DetentSettings {
        spacing: spacing(24, "0.25"),
        strength: si("0.03125"),
        centre: si("0.125"),
    };
    let feel = FeelSettings {
        spring: Some(CentreSettings {
            centre: si("0.5"),
            stiffness: si("0.25"),
            strength: si("0.0625"),
        }),
        viscous: Some(ViscousSettings {
            damping: si("0.0009765625"),
            bandwidth_hz: si("100"),
        }),
        dry: Some(DrySettings {
            strength: si("0.015625"),
            stretch: si("0.0078125"),
        }),
        click: Some(ClickSettings {
            spacing: spacing(36, "0.1875"),
            centre: si("0.0625"),
            strength: si("0.03125"),
            duration_s: si("0.0078125"),
        }),
        inertia: Some(InertiaSettings {
            inertia: si("0.00000762939453125"),
            bandwidth_hz: si("12"),
        }),
    };
    let points: Vec<i16> = (0..7)
        .map(|i| (i * 7919 % 20_001 - 10_000) as i16)
        .collect();
    let profile = ProfileSettings {
        extent: if around {
            Extent::PerTurn(3)
        } else {
            Extent::Until(si("1.5"))
        },
        start: si("-0.5"),
        strength: si("0.0625"),
        shape: Shape::new(&points).expect("points"),
    };
    Environment::new(settings, &walls, Some(&detents))
        .and_then(|it| it.with_feel(&feel, settings))
        .and_then(|it| it.with_profile(&profile, settings.force_limit))
        .expect("a feel")
}

/// Repeats the control periods of `tests/feel.c` in Rust.
fn feel_in_rust() -> u64 {
    let settings = Settings {
        position: PositionSettings::of_counts_per_rev(16_384),
        ..Settings::default()
    };
    let scale = CountScale::new(16_384, Si::ZERO).expect("a scale");
    let (mut random, mut digest, mut count) = (Random::START, Digest::START, 0_i64);
    for around in [false, true] {
        let mut feel = all_parts(&settings, around);
        for _ in 0..50_000 {
            let chance = random.next();
            count += i64::from(random.next() % 41) - 20;
            if chance.is_multiple_of(3000) {
                count = i64::from(random.next()) * i64::from(random.next().cast_signed());
            }
            if chance % 3000 == 1 {
                count = i64::from(random.next() % 6000) - 3000;
            }
            let force = feel.tick(&Counted { scale, count }, None);
            let tripped = feel.tripped();
            digest.add(i64::from(force.0.to_bits()).cast_unsigned());
            digest.add((if tripped { OVERSPEED } else { OK }).cast_unsigned());
            if chance.is_multiple_of(5) {
                feel.commanded(Force(I8F24::from_bits(force.0.to_bits() / 2)));
            }
            if chance % 1000 == 2 {
                feel.switched_off();
            }
            if chance % 1000 == 2 || tripped {
                feel.begin(None);
            }
            let account = feel.guard.expect("a guard").account();
            digest.add(account.0.to_bits().cast_unsigned());
        }
    }
    digest.0
}

#[test]
fn a_hundred_thousand_ticks_of_feels_have_the_bits_of_the_rust_code() {
    let program = Program::c("feel", &["tests/feel.c"]).with(&SANITIZERS);
    if let Some(said) = program.said(&[]) {
        assert_eq!(said.trim(), format!("{:016x}", feel_in_rust()));
    }
}
