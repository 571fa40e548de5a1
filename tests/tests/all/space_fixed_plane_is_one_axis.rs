//! Tests that the three-axis form of a control law equals its one-axis form bit for bit on a plane, for every law with every option
//! and planes of any inclination.

use touchstone_control::law::Sample;
use touchstone_control::space::environment::Plane;
use touchstone_control::space::{
    Along, Direction, Leaving, Magnitude, PerAxis, Rule, SurfacePoint, Turn,
};
use touchstone_control::{AnyLaw, Force, Position};
use touchstone_tests::random::Random;
use touchstone_tests::space::{F, Place, UNIT, at, direction, mm, omega};
use touchstone_tests::variants;

/// A path of the hand near a plane: presses about 2 mm deep with slides of about 0.1 mm per control period, and releases in
/// between. In half of the time the positions are rounded to counts of 10 µm.
fn path(ticks: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let (mut depth, mut drift) = (0.0_f64, [0.0, 0.0]);
    (0..ticks)
        .map(|tick| {
            let phase = tick as f64 / 97.0;
            depth = 0.8 * depth + 0.2 * (1.6 * phase.sin() + 0.4 + 0.05 * random.real());
            for slide in &mut drift {
                *slide = 0.99 * *slide + 0.1 * random.real();
            }
            let count = |x: f64| (x * 100.0).round() / 100.0;
            if tick % 500 < 250 {
                [count(drift[0]), count(drift[1]), count(depth)]
            } else {
                [drift[0], drift[1], depth]
            }
        })
        .collect()
}

fn planes() -> [Plane<F>; 5] {
    [
        Direction::along(2, false),
        Direction::along(0, true),
        direction(1.0, 1.0, 1.0),
        direction(0.2, -0.5, 0.7),
        direction(-0.001, 0.003, 1.0),
    ]
    .map(|normal| Plane {
        normal,
        height: mm(3.0),
    })
}

/// The point at these coordinates along the plane, `depth` mm below it.
fn below(plane: &Plane<F>, [a, b, depth]: [f64; 3]) -> Place {
    let n = plane.normal;
    // Two directions perpendicular to the normal.
    let side = n.across(at(10.0, 3.0, -7.0));
    let (u, v) = (
        Direction::of(side).unwrap(),
        Direction::of(n.across(at(-2.0, 9.0, 5.0))).unwrap(),
    );
    n.times(plane.height - mm(depth)) + u.times(mm(a)) + v.times(mm(b))
}

#[test]
fn every_law_gives_the_bits_of_one_axis() {
    let (mut compared, mut pushing) = (0, 0);
    for k in [5.0, 25.0] {
        for (name, settings) in variants::all(&omega(touchstone_control::LawKind::Spring, k)) {
            let law = UNIT
                .law::<F>(&settings)
                .unwrap_or_else(|why| panic!("{name}: {why}"));
            for (which, plane) in planes().into_iter().enumerate() {
                for rule in [Rule::Closest, Rule::Restricted(Turn::of_ratio(mm(0.1).0))] {
                    let mut alone = law;
                    let mut shell = Magnitude::new(law);
                    let mut point = SurfacePoint::new(rule);
                    let mut last = Position::zero();
                    for (tick, step) in path(1500, 7).into_iter().enumerate() {
                        let touch = point.tick(&plane, below(&plane, step));
                        let force = shell.tick(&touch);
                        let expected = alone.tick(Sample::measured(touch.depth, last));
                        last = touch.depth;
                        assert_eq!(
                            shell.law, alone,
                            "{name}, plane {which}, tick {tick}: the memory"
                        );
                        assert_eq!(
                            force,
                            plane.normal.times_force(expected),
                            "{name}, plane {which}, tick {tick}"
                        );
                        compared += 1;
                        pushing += usize::from(expected > Force::zero());
                    }
                }
            }
        }
    }
    println!("{compared} ticks equal to the bit, {pushing} of them with a force");
    assert!(pushing > compared / 3, "{pushing} of {compared} push");
}

/// Checks one control law per axis on a plane at right angles to one axis. The law of this axis gives the bits of the one-axis law,
/// and the other two laws get no penetration, under every rule for the end of a contact.
#[test]
fn per_axis_agrees_with_magnitude_on_a_horizontal_plane() {
    let plane = planes()[0];
    for leaving in [Leaving::Decoupled, Leaving::AnyAxis, Leaving::Projection] {
        for (name, settings) in variants::all(&omega(touchstone_control::LawKind::Spring, 25.0)) {
            let law = UNIT.law::<F>(&settings).expect("settings");
            let mut one = Magnitude::new(law);
            let mut three = PerAxis::new([law; 3], leaving);
            let mut point = SurfacePoint::new(Rule::Closest);
            for (tick, step) in path(1500, 9).into_iter().enumerate() {
                let touch = point.tick(&plane, below(&plane, step));
                let (expected, force) = (one.tick(&touch), three.tick(&touch));
                assert_eq!(force, expected, "{name}, {leaving:?}, tick {tick}");
            }
        }
    }
}

/// Checks that a control law that was reset equals a new one.
#[test]
fn a_reset_is_a_new_law() {
    for (name, settings) in variants::all(&omega(touchstone_control::LawKind::Spring, 25.0)) {
        let law: AnyLaw<F> = UNIT.law(&settings).expect("settings");
        let mut used = law;
        let mut last = Position::zero();
        for [_, _, depth] in path(300, 3) {
            let e = mm(depth);
            Along::tick(&mut used, Sample::measured(e, last));
            last = e;
        }
        Along::reset(&mut used);
        assert_eq!(used, law, "{name}");
    }
}
