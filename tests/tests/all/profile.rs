//! Tests of a drawn torque profile in every number format: its points, its copies, its mirror image, its limits and its refusals.

use touchstone_control::environment::{
    Environment, Extent, MOST_POINTS, ProfileSettings, Refused, Shape, WHOLE,
};
use touchstone_control::{Fixed16, Fixed32, Force, Reported, Settings, Si};
use touchstone_tests::environment::{COUNTS, at, built, unguarded};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

/// A knob with a torque profile (torque over angle) and no wall.
fn drawn<N: Reported>(profile: &ProfileSettings) -> Environment<N> {
    let settings = unguarded();
    built::<N>(&settings, &[], None)
        .with_profile(profile, settings.force_limit)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn random_shape(random: &mut Random, points: usize) -> Vec<i16> {
    (0..points)
        .map(|_| random.whole(i32::from(WHOLE)) as i16)
        .collect()
}

/// The profile's torque in N·m at an angle in rad, by linear interpolation. A positive torque pushes towards smaller angles.
fn expected(profile: &ProfileSettings, angle: f64) -> f64 {
    let shape: Vec<f64> = (profile.shape.points().iter())
        .map(|point| f64::from(*point) / f64::from(WHOLE))
        .collect();
    let start = profile.start.to_num::<f64>();
    let (place, after): (f64, &dyn Fn(usize) -> usize) = match profile.extent {
        Extent::PerTurn(per_turn) => {
            let pitch = std::f64::consts::TAU / f64::from(per_turn);
            let place = ((angle - start) / pitch).rem_euclid(1.0) * shape.len() as f64;
            (place, &|before| (before + 1) % shape.len())
        }
        Extent::Until(end) => {
            let last = shape.len() - 1;
            let share = ((angle - start) / (end.to_num::<f64>() - start)).clamp(0.0, 1.0);
            (share * last as f64, &move |before| (before + 1).min(last))
        }
    };
    let before = (place.floor() as usize).min(shape.len() - 1);
    let way = place - before as f64;
    -profile.strength.to_num::<f64>() * (shape[before] * (1.0 - way) + shape[after(before)] * way)
}

fn extents() -> [Extent; 5] {
    [
        Extent::PerTurn(1),
        Extent::PerTurn(7),
        Extent::PerTurn(100),
        Extent::Until(si("0.9")),
        Extent::Until(si("40")),
    ]
}

/// Torque profiles of every extent and several numbers of points, with random shape and position.
fn profiles() -> Vec<ProfileSettings> {
    let mut random = Random::new(49);
    let mut all = Vec::new();
    for extent in extents() {
        for points in [2, 3, 8, MOST_POINTS] {
            all.push(ProfileSettings {
                extent,
                start: si("-0.31") + Si::from_num(random.whole(1000)) / 10_000,
                strength: si("0.05"),
                shape: Shape::new(&random_shape(&mut random, points)).unwrap(),
            });
        }
    }
    all
}

#[test]
fn the_force_is_the_line_between_the_points() {
    fn body<N: Reported>(step: f64) {
        for profile in profiles() {
            let mut environment = drawn::<N>(&profile);
            let mut random = Random::new(3);
            for _ in 0..2_000 {
                let count = i64::from(random.whole(3 * COUNTS as i32));
                let angle = count as f64 / f64::from(COUNTS) * std::f64::consts::TAU;
                let force = environment.tick(&at(count), None).to_f64();
                let wrong = (force - expected(&profile, angle)).abs();
                // At 100 copies a turn the position is known to 1e-6 of a copy. The line between two points is at least a 96th of
                // a copy long, and the torque changes along it by at most twice the strength of 0.05 N·m.
                assert!(
                    wrong <= step + 2e-4 * 0.05,
                    "{wrong} at {angle}: {profile:?}"
                );
            }
        }
    }
    body::<Fixed32>(2.0 * 2f64.powi(-24));
    body::<Fixed16>(2.0 * 2f64.powi(-14));
    body::<f64>(1e-9);
}

#[test]
fn a_profile_never_pushes_harder_than_its_strength() {
    fn body<N: Reported>() {
        let strength = Force::<N>::from_f64(0.05);
        for mut profile in profiles() {
            let points: Vec<i16> = (profile.shape.points().iter())
                .map(|point| WHOLE * point.signum())
                .collect();
            profile.shape = Shape::new(&points).unwrap();
            let mut environment = drawn::<N>(&profile);
            let (mut most, mut least) = (Force::zero(), Force::zero());
            for count in -40_000..40_000_i64 {
                let force = environment.tick(&at(count), None);
                (most, least) = (
                    if force > most { force } else { most },
                    if force < least { force } else { least },
                );
            }
            assert!(most <= strength && least >= -strength, "{most:?} {least:?}");
            // And a level profile reaches the strength, except for roundings towards zero.
            profile.shape = Shape::new(&[WHOLE; 3]).unwrap();
            let level = drawn::<N>(&profile).tick(&at(17), None);
            let quanta = Force(N::QUANTUM) + Force(N::QUANTUM) + Force(N::QUANTUM);
            assert!(level <= quanta - strength, "{level:?}");
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
}

#[test]
fn copies_are_the_same_at_every_turn() {
    for profile in profiles() {
        if matches!(profile.extent, Extent::Until(_)) {
            continue;
        }
        let mut environment = drawn::<Fixed32>(&profile);
        for count in (0..i64::from(COUNTS)).step_by(17) {
            let here = environment.tick(&at(count), None);
            for turns in [1, -1, 10_000, -10_000, 1_000_000] {
                let there = environment.tick(&at(count + turns * i64::from(COUNTS)), None);
                assert_eq!(here, there, "{count} and {turns} turns");
            }
        }
    }
}

#[test]
fn a_mirrored_profile_gives_mirrored_forces() {
    fn body<N: Reported>() {
        for profile in profiles() {
            let mut points: Vec<i16> = profile.shape.points().iter().map(|it| -it).collect();
            let (extent, start) = match profile.extent {
                Extent::PerTurn(_) => {
                    // The first point stays the first, and the second becomes the last.
                    points[1..].reverse();
                    (profile.extent, -profile.start)
                }
                Extent::Until(end) => {
                    points.reverse();
                    (Extent::Until(-profile.start), -end)
                }
            };
            let image = ProfileSettings {
                extent,
                start,
                shape: Shape::new(&points).unwrap(),
                ..profile
            };
            let (mut here, mut there) = (drawn::<N>(&profile), drawn::<N>(&image));
            for count in (-60_000..60_000_i64).step_by(7) {
                let (f, g) = (here.tick(&at(count), None), there.tick(&at(-count), None));
                assert_eq!(f, -g, "{count}: {profile:?}");
            }
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
    body::<f64>();
}

/// Checks that a torque profile that drives the knob in every turn gives the hand the energy in the energy guard's account and its
/// refill, and no more.
#[test]
fn the_guard_pays_for_a_profile_that_is_a_motor() {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    let motor = ProfileSettings {
        extent: Extent::PerTurn(1),
        start: Si::ZERO,
        strength: si("0.05"),
        shape: Shape::new(&[WHOLE, WHOLE]).unwrap(),
    };
    let mut environment = built::<Fixed32>(&settings, &[], None)
        .with_profile(&motor, settings.force_limit)
        .unwrap();
    let (mut given, mut most, mut bare) = (0.0_f64, 0.0_f64, 0.0);
    // The device's own damping dissipates this energy, so that it does not reach the hand.
    let speed = std::f64::consts::TAU;
    let damped = settings.device_damping.to_num::<f64>() * speed * speed * 1e-3;
    let mut force = 0.0;
    // One turn a second, for five turns.
    let step = i64::from(COUNTS / 1000);
    for tick in 0..5_000_i64 {
        let moved = step as f64 / f64::from(COUNTS) * std::f64::consts::TAU;
        given += -force * moved - damped;
        most = most.max(given);
        bare += 0.05 * moved;
        force = environment.tick(&at(tick * step), None).to_f64();
    }
    let capacity = settings.guard.capacity.to_num::<f64>();
    let refill = settings.guard.refill.to_num::<f64>();
    assert!(bare > 1.5, "{bare}");
    assert!(
        most > 0.8 * capacity && most <= capacity + 5.0 * refill,
        "{most} J of {capacity} J and {refill} W"
    );
}

#[test]
fn what_is_no_profile_is_refused_by_name() {
    for points in [0, 1, MOST_POINTS + 1] {
        assert_eq!(
            Shape::new(&vec![0; points]).unwrap_err(),
            Refused::Points(points)
        );
    }
    for point in [WHOLE + 1, -WHOLE - 1, i16::MIN, i16::MAX] {
        assert_eq!(Shape::new(&[0, point]).unwrap_err(), Refused::Point(point));
    }
    let good = ProfileSettings {
        extent: Extent::PerTurn(1),
        start: Si::ZERO,
        strength: si("0.05"),
        shape: Shape::new(&[0, 1]).unwrap(),
    };
    let refused = |profile: ProfileSettings| {
        let settings = unguarded();
        let error = built::<Fixed32>(&settings, &[], None)
            .with_profile(&profile, settings.force_limit)
            .unwrap_err();
        touchstone_tests::si::assert_one_line(&error.to_string());
        error
    };
    for per_turn in [0, 6284] {
        let extent = Extent::PerTurn(per_turn);
        assert_eq!(
            refused(ProfileSettings { extent, ..good }),
            Refused::PerTurn(per_turn)
        );
    }
    for end in ["0", "-1", "0.0009", "6284"] {
        let extent = Extent::Until(si(end));
        assert_eq!(
            refused(ProfileSettings { extent, ..good }),
            Refused::Length(si(end))
        );
    }
    for strength in ["-0.001", "0.500001"] {
        let strength = si(strength);
        assert!(matches!(
            refused(ProfileSettings { strength, ..good }),
            Refused::ProfileStrength { .. }
        ));
    }
}
