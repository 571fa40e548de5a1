//! Tests of environments (several walls on both sides and detents on one knob): what they guarantee together, for fast and abrupt
//! motions and with every control law.

use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Face, MOST_WALLS, Reading, Refused, Side, Spacing,
    WallSettings,
};
use touchstone_control::{
    Controller, Fixed16, Fixed32, Force, LawKind, Position, Reported, Settings, Si, StatesKind,
};
use touchstone_tests::environment::{
    COUNT_RAD, COUNTS, at, built, detents, encoder, mirrored, wall,
};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

/// A random motion of a hand in encoder counts, within ±`reach`: slow and fast, to and fro, with jumps over a wall.
fn path(seed: u64, ticks: usize, reach: i64) -> Vec<i64> {
    let mut random = Random::new(seed);
    let (mut at, mut speed) = (0_i64, 0_i32);
    (0..ticks)
        .map(|_| {
            match random.bits() % 64 {
                0 => at += i64::from(random.whole(150)),
                1..=3 => speed = random.whole(40),
                4 => speed = 0,
                _ => {}
            }
            at = (at + i64::from(speed) + i64::from(random.whole(1))).clamp(-reach, reach);
            at
        })
        .collect()
}

fn laws() -> Vec<Settings> {
    let mut all = Vec::new();
    for law in <LawKind as touchstone_control::Choice>::ALL {
        for states in [StatesKind::Measured, StatesKind::Estimated] {
            let mut settings = Settings {
                law: *law,
                states,
                ..Settings::thesis()
            };
            settings.guard.on = true;
            all.push(settings);
        }
    }
    all
}

#[test]
fn a_mirrored_environment_answers_a_mirrored_motion_with_mirrored_forces() {
    fn body<N: Reported>() {
        let walls = [
            wall("0.05", Side::Above),
            wall("-0.031", Side::Below),
            wall("0.09", Side::Above),
        ];
        let images = walls.each_ref().map(mirrored);
        let detent = detents();
        let image = DetentSettings {
            centre: -detent.centre,
            ..detent
        };
        for (seed, mut settings) in (1..).zip(laws()) {
            // For even seeds a guard that has to reduce forces, for odd seeds one that has not. The guard's rounding must be
            // mirrored, too.
            settings.guard.capacity = si(if seed % 2 == 0 { "0.001" } else { "0.045" });
            // Also a guard with a delay, which rounds its part of a displacement.
            settings.guard.delay = si(if seed % 3 == 0 { "0.0004" } else { "0" });
            let mut here = built::<N>(&settings, &walls, Some(&detent));
            let mut there = built::<N>(&settings, &images, Some(&image));
            let (mut limited, mut pushed) = (0, [0, 0]);
            for count in path(seed, 4_000, 700) {
                let (f, g) = (here.tick(&at(count), None), there.tick(&at(-count), None));
                assert_eq!(f, -g, "{:?} {:?} {count}", settings.law, settings.states);
                limited += u32::from(here.guard.as_ref().is_some_and(|it| it.limited));
                pushed[usize::from(f > Force::zero())] += 1;
            }
            assert!(pushed[0] > 300 && pushed[1] > 300, "{pushed:?}");
            assert!(seed % 2 == 1 || limited > 50, "{limited}");
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
    body::<f64>();
}

#[test]
fn two_walls_are_two_scenes() {
    // Motions so gentle that the account covers everything and the guard changes no force.
    for mut settings in laws() {
        settings.guard.capacity = si("8");
        settings.guard.overspeed = si("900");
        settings.force_limit = si("0.5");
        let (right, left) = ("0.05", "-0.031");
        let mut both = built::<Fixed32>(
            &settings,
            &[wall(right, Side::Above), wall(left, Side::Below)],
            None,
        );
        let mut alone = built::<Fixed32>(&settings, &[wall(right, Side::Above)], None);
        let mut controllers = [(); 2].map(|()| Controller::<Fixed32>::new(&settings).unwrap());
        let scales = [si(right), -si(left)].map(|surface| encoder().before(surface));
        let mut touched = [0, 0];
        for count in path(3, 6_000, 500) {
            let ways = [count, -count];
            let mut forces = [Force::zero(); 2];
            for ((controller, scale), (way, force)) in controllers
                .iter_mut()
                .zip(&scales)
                .zip(ways.iter().zip(&mut forces))
            {
                *force = controller.tick(scale.penetration(*way));
            }
            // A controller gets only its own force reported. In `both` each wall gets the force of both walls, so estimated states
            // make other forces there while both push.
            let together = both.tick(&at(count), None);
            assert_eq!(alone.tick(&at(count), None), forces[0], "{settings:?}");
            if settings.states == StatesKind::Measured {
                assert_eq!(together, forces[0] - forces[1], "{:?}", settings.law);
            }
            for (touched, force) in touched.iter_mut().zip(forces) {
                *touched += u32::from(force > Force::zero());
            }
        }
        assert!(touched[0] > 300 && touched[1] > 300, "{touched:?}");
    }
}

/// Checks that a second wall which was never touched does not change the force. With estimated states each wall has its own
/// estimator, which gets every commanded force.
#[test]
fn a_wall_that_is_not_touched_is_not_there() {
    let settings = Settings::default();
    let far = [wall("0.05", Side::Above), wall("-2", Side::Below)];
    let mut both = built::<Fixed32>(&settings, &far, None);
    let mut own = Controller::<Fixed32>::new(&settings).unwrap();
    let scale = encoder().before(si("0.05"));
    let mut touched = 0;
    for n in 0..4_000_i32 {
        let count = (330.0 + 60.0 * (f64::from(n) / 80.0).sin()) as i64;
        let force = own.tick(scale.penetration(count));
        assert_eq!(both.tick(&at(count), None), force, "{n}");
        touched += u32::from(force > Force::zero());
    }
    assert!(touched > 1_000);
}

#[test]
fn detents_are_a_triangle_with_no_work_over_a_pitch() {
    fn body<N: Reported>(step: f64) {
        let quiet = Settings::thesis();
        let detent = detents();
        let (pitch, strength, centre) = (0.261_799_4, 0.03, 0.012_345_67);
        let triangle = |x: f64| {
            let beyond = (x - centre) / pitch;
            let beyond = beyond - beyond.round();
            let share = if beyond.abs() <= 0.25 {
                beyond
            } else {
                beyond.signum() * (0.5 - beyond.abs())
            };
            4.0 * strength * share
        };
        let mut environment = built::<N>(&quiet, &[], Some(&detent));
        // The pitch in rad and its inverse are right to 2^-33. After 20,000 turns (480,000 pitches) the detents are at most 5e-4
        // of a pitch off.
        for turn in [0_i64, 1, -1, 50, -50, 20_000] {
            let from = turn * i64::from(COUNTS);
            let mut work = 0.0;
            let mut largest = 0.0_f64;
            for count in from - 833..from + 833 {
                let x = count as f64 * COUNT_RAD;
                let force = environment.tick(&at(count), None).to_f64();
                let drift = 4.0 * strength * (turn.unsigned_abs() as f64 * 24.0) * 2f64.powi(-30);
                assert!(
                    (force - triangle(x)).abs() < step + drift + 1e-9,
                    "{turn} {count}: {force} {}",
                    triangle(x)
                );
                largest = largest.max(force.abs());
                work += force * COUNT_RAD;
            }
            // Over the 1666 counts of a pitch: half a count's force at each end, and a quantum of each force.
            assert!(work.abs() < strength * COUNT_RAD + step * pitch, "{work}");
            assert!(largest <= strength && largest > strength * (1.0 - 0.02));
        }
    }
    body::<Fixed32>(2.0 * 2f64.powi(-24));
    body::<Fixed16>(2.0 * 2f64.powi(-14));
    body::<f64>(2f64.powi(-31));
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let refused = |settings: &Settings, walls: &[WallSettings], detents: &DetentSettings| {
        Environment::<Fixed32>::new(settings, walls, Some(detents)).unwrap_err()
    };
    let (plain, good) = (Settings::thesis(), detents());
    let many = [wall("0", Side::Above); MOST_WALLS + 1];
    assert_eq!(refused(&plain, &many, &good), Refused::TooManyWalls);
    let mut stiff = wall("0", Side::Below);
    stiff.k_desired = si("500001");
    let two = [wall("0", Side::Above), stiff];
    assert!(matches!(refused(&plain, &two, &good), Refused::Wall(1, _)));
    for pitch in ["0.0009", "6.3", "0", "-1"] {
        let pitch = si(pitch);
        assert_eq!(
            refused(
                &plain,
                &[],
                &DetentSettings {
                    spacing: Spacing::Pitch(pitch),
                    ..good
                }
            ),
            Refused::Pitch(pitch)
        );
    }
    for per_turn in [0, 6284] {
        assert_eq!(
            refused(
                &plain,
                &[],
                &DetentSettings {
                    spacing: Spacing::PerTurn(per_turn),
                    ..good
                }
            ),
            Refused::PerTurn(per_turn)
        );
    }
    for strength in ["-0.001", "0.500001"] {
        let strength = si(strength);
        let with = DetentSettings { strength, ..good };
        assert!(matches!(
            refused(&plain, &[], &with),
            Refused::Strength { .. }
        ));
    }
    for error in [
        refused(&plain, &two, &good),
        refused(&plain, &many, &good),
        refused(
            &plain,
            &[],
            &DetentSettings {
                spacing: Spacing::Pitch(si("7")),
                ..good
            },
        ),
    ] {
        touchstone_tests::si::assert_one_line(&error.to_string());
    }
}

#[test]
fn a_reading_is_odd() {
    let both = [Side::Above, Side::Below];
    let mut random = Random::new(2);
    for _ in 0..20_000 {
        let count = i64::from(random.whole(1 << 30)) << (random.bits() % 20);
        let (here, there) = (at(count), at(-count));
        let angle = |it: &Counted| Reading::<Fixed32>::angle(it);
        assert_eq!(angle(&here), -angle(&there));
        for side in both {
            let face = Face {
                surface: Si::from_num(random.real()),
                side,
            };
            let image = mirrored(&WallSettings {
                face,
                k_desired: Si::ZERO,
            })
            .face;
            let here: Position<Fixed32> = here.penetration(&face.reached());
            assert_eq!(here, there.penetration(&image.reached()));
        }
    }
}

/// Number of turns for tests far from angle 0. It is so large that a position there does not occur by chance.
const FAR: i64 = 10_000;

/// The same wall, moved by this many whole turns.
fn further(wall: &WallSettings, turns: i64) -> WallSettings {
    // A turn in units of 2^-64 rad.
    let way = (i128::from(turns) * 0x6_487e_d511_0b46_11a6 + (1 << 31)) >> 32;
    let surface = wall.face.surface + Si::from_bits(way as i64);
    WallSettings {
        face: Face {
            surface,
            ..wall.face
        },
        ..*wall
    }
}

#[test]
fn a_knob_is_the_same_ten_thousand_turns_on() {
    let walls = [wall("0.4", Side::Above), wall("-0.31", Side::Below)];
    for mut settings in laws() {
        settings.guard.change = touchstone_control::ChangeOfForce::Measured;
        settings.guard.delay = si("0.0001");
        settings.guard.lag = si("0.0003");
        for ring in [
            DetentSettings::around_a_turn(24, si("0.2"), si("0.0123")),
            DetentSettings::around_a_turn(7, si("0.2"), si("-1.3")),
        ] {
            let runs = [0, FAR, -FAR].map(|turns| {
                let walls = walls.each_ref().map(|wall| further(wall, turns));
                let from = turns * i64::from(COUNTS);
                let mut environment = built::<Fixed32>(&settings, &walls, Some(&ring));
                let mut random = Random::new(77);
                let felt = path(19, 6_000, 3_000).into_iter().map(|count| {
                    let since = encoder().moved(i64::from(random.whole(20)));
                    let force = environment.tick(&at(from + count), Some(since));
                    let account = environment
                        .guard
                        .map(|guard| (guard.account(), guard.limited));
                    (force, account, environment.tripped())
                });
                felt.collect::<Vec<_>>()
            });
            let [near, ..] = &runs;
            let pushes = near.iter().filter(|(force, ..)| *force != Force::zero());
            let limited = near
                .iter()
                .filter(|(_, account, _)| account.is_some_and(|(_, limited)| limited));
            assert!(pushes.count() > 100 && limited.count() > 10, "no test");
            for (far, turns) in runs.iter().zip(["0", "10,000", "-10,000"]) {
                assert!(far == near, "{turns} turns on, {:?}", settings.law);
            }
        }
    }
}

/// Checks that walls and detents feel the same after the knob was turned ten thousand times in steps: the code keeps no memory of
/// the way. A wall is off while the knob is deeper inside it than the position format reaches (128 rad).
#[test]
fn a_knob_that_was_turned_there_is_the_same() {
    let settings = Settings::default();
    let ring = DetentSettings::around_a_turn(24, si("0.02"), si("0.0123"));
    let walls = [wall("0.4", Side::Above)];
    let built = |walls: &[WallSettings]| built::<Fixed32>(&settings, walls, Some(&ring));
    for turns in [FAR, -FAR] {
        let (end, step) = (turns * i64::from(COUNTS), turns.signum() * 300);
        let mut turned = built(&walls);
        let mut at_end = 0;
        for n in 0..=end / step {
            turned.tick(&at(n * step), None);
            // The motor is at rest: the hand turns it through the wall.
            turned.commanded(Force::zero());
            let inside = (n * step) as f64 * COUNT_RAD - 0.4;
            assert_eq!(turned.is_beyond_reach(), inside >= 128.0 - 1e-6, "{inside}");
            at_end = n * step;
        }
        assert!(!turned.tripped());
        let mut fresh = built(&[]);
        fresh.guard = turned.guard;
        fresh.tick(&at(at_end - end), None);
        turned.tick(&at(at_end), None);
        for n in 0..2_000_i32 {
            let count = (600.0 * (f64::from(n) / 8.0).sin()) as i64;
            let force = fresh.tick(&at(count), None);
            assert_eq!(turned.tick(&at(end + count), None), force, "{turns} {n}");
        }
        assert_eq!(turned.guard, fresh.guard);
    }
}
