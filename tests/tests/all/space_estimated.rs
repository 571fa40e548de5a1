//! Tests of estimated states on three axes: on a plane they equal those of one axis, and at rest they equal the true state.

use touchstone_control::estimator::EstimatorState;
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{
    Direction, Leaving, Magnitude, PerAxis, Rule, Shape, Shell, SpaceWall, SurfacePoint, Vector,
};
use touchstone_control::{AnyLaw, EstimatorSettings, Force, LawKind, Position, Si};
use touchstone_tests::si::si;
use touchstone_tests::space::{F, UNIT, at, in_n, mm, newton, omega, place_in_mm, push_in_n};
use touchstone_tests::variants;

const RATE_HZ: u32 = 1000;

/// Estimator settings for one axis of an omega.3 (haptic device with three axes), with commands that act half a control period
/// late.
fn axis() -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: si("62.6"),
        inertia: si("0.148"),
        damping: si("2.5"),
        delay_s: si("0.0005"),
    }
}

fn told(wall: &mut SpaceWall<F, Shape<F>, AnyLaw<F>>) {
    let estimator = UNIT.estimator(&[axis(); 3], RATE_HZ, Si::from_num(12));
    wall.estimator = Some(estimator.expect("settings"));
}

fn floor() -> Shape<F> {
    Shape::Plane(Plane {
        normal: Direction::along(2, false),
        height: Position::zero(),
    })
}

fn wall(shape: Shape<F>, shell: Shell<F, AnyLaw<F>>) -> SpaceWall<F, Shape<F>, AnyLaw<F>> {
    let mut wall = SpaceWall::new(shape, SurfacePoint::new(Rule::Closest), shell, newton(12.0));
    told(&mut wall);
    wall
}

/// Position of the hand in mm, rounded to encoder counts of 10 µm. The hand presses into the floor, releases, and moves to and
/// fro along the floor.
fn press(tick: u32) -> [f64; 3] {
    let t = f64::from(tick) / 1000.0;
    let count = |x: f64| (x * 100.0).round() / 100.0;
    [
        count(20.0 * (3.0 * t).sin()),
        count(-7.0 * (5.0 * t).sin()),
        count(0.3 - 0.8 * (9.0 * t).sin().max(-0.5)),
    ]
}

#[test]
fn a_floor_is_the_wall_of_one_axis_to_the_bit() {
    let (mut compared, mut pushing) = (0, 0);
    for (name, settings) in variants::all(&omega(LawKind::Spring, 25.0)) {
        let law = UNIT.law::<F>(&settings).expect("settings");
        let estimator = UNIT.estimator::<F>(&[axis(); 3], RATE_HZ, Si::from_num(12));
        assert!(estimator.is_ok());
        // The same settings converted to centimetres by hand.
        let one = EstimatorSettings {
            inertia: si("0.148") / 100,
            damping: si("0.025"),
            ..axis()
        };
        let one = one.estimator::<F>(RATE_HZ, Si::from_num(12)).expect("one");
        let mut state = EstimatorState::default();
        let mut alone = law;
        let mut three = [
            Shell::Magnitude(Magnitude::new(law)),
            Shell::PerAxis(PerAxis::new([law; 3], Leaving::Decoupled)),
        ]
        .map(|shell| wall(floor(), shell));
        let mut last = Force::zero();
        for tick in 0..2000 {
            let [x, y, z] = press(tick);
            one.commanded(&mut state, last);
            let expected = alone.tick(one.tick(&mut state, mm(-z)));
            last = expected.min(newton(12.0));
            for wall in &mut three {
                let force = wall.tick(at(x, y, z)).expect("no guard");
                let upwards = Vector([Force::zero(), Force::zero(), last]);
                assert_eq!(force, upwards, "{name}, tick {tick}");
            }
            compared += 1;
            pushing += usize::from(last > Force::zero());
        }
    }
    println!("{compared} ticks equal to the bit, {pushing} of them with a force");
    assert!(pushing > compared / 3, "{pushing} of {compared} push");
}

/// Checks that at rest inside a ball the estimated position equals the measured one, to three steps of the number format: the
/// wall's spring gives the force of the measured position.
#[test]
fn at_rest_the_place_is_the_measured_one() {
    let centre = Vector::default();
    let sphere = Shape::Sphere(Sphere {
        centre,
        radius: mm(30.0),
    });
    let settings = omega(LawKind::Spring, 5.0);
    let law = UNIT.law::<F>(&settings).expect("settings");
    let mut wall = wall(sphere, Shell::Magnitude(Magnitude::new(law)));
    let here = at(-12.0, 8.0, 25.5);
    let mut force = Vector::default();
    for _ in 0..2000 {
        force = wall.tick(here).expect("no guard");
    }
    let measured = place_in_mm(here);
    let length = measured.iter().map(|x| x * x).sum::<f64>().sqrt();
    let expected = measured.map(|x| 5.0 * (30.0 - length) * x / length);
    for (is, should) in push_in_n(force).into_iter().zip(expected) {
        // A step of the number format is 6e-7 mm; three of them are allowed, at 5 N/mm.
        assert!((is - should).abs() < 1e-5, "{is} for {should}");
    }
}

/// Checks that the estimator uses the force that is reported to it by `commanded`, not the force that the law asked for: a copy of
/// the wall that gets a report of 0 after each control period soon gives other forces.
#[test]
fn a_force_that_did_not_act_is_told() {
    let law = UNIT.law::<F>(&omega(LawKind::Spring, 5.0)).expect("law");
    let mut acts = wall(floor(), Shell::Magnitude(Magnitude::new(law)));
    let mut lost = acts;
    let mut apart = 0.0_f64;
    for tick in 0..300 {
        let [x, y, z] = press(tick);
        let a = acts.tick(at(x, y, z)).expect("no guard");
        let b = lost.tick(at(x, y, z)).expect("no guard");
        lost.commanded(Vector::default());
        apart = apart.max((in_n(a.0[2]) - in_n(b.0[2])).abs());
    }
    assert!(apart > 0.01, "{apart} N");
}
