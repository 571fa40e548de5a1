//! Tests of the positions of a knob.

use super::{HYSTERESIS, Positions, deepest};
use crate::scene::{DetentRing, Endstops, Environment};

fn dial() -> Environment {
    Environment {
        detents: Some(DetentRing {
            strength_n_m: 0.012,
            ..DetentRing::default()
        }),
        endstops: Some(Endstops {
            lower_rad: -0.1309,
            upper_rad: 2.7489,
            stiffness_n_m_per_rad: None,
        }),
        ..Environment::default()
    }
}

/// The number changes where a SmartKnob with a snap point of 0.75 and this bias changes it: away from 0 at 0.75 + bias of the way to
/// the next number, towards 0 at 0.75 - bias.
#[test]
fn a_bias_holds_number_0_longer() {
    for (bias, shift) in [(0.0, 0), (0.2, 0), (0.2, 5)] {
        let begun = || {
            let mut positions = Positions::every(1.0, 0.0);
            positions.bias = bias;
            positions.call(shift);
            positions
        };
        let from = |number: i64, way: f64| {
            let mut positions = begun();
            positions.stand_at(number - shift);
            positions.take((number - shift) as f64 + way);
            positions.number().unwrap() - number
        };
        for (number, up, down) in [
            (0, 0.75 + bias, 0.75 + bias),
            (1, 0.75 + bias, 0.75 - bias),
            (4, 0.75 + bias, 0.75 - bias),
            (-1, 0.75 - bias, 0.75 + bias),
            (-7, 0.75 - bias, 0.75 + bias),
        ] {
            assert_eq!(
                [from(number, up - 1e-6), from(number, up + 1e-6)],
                [0, 1],
                "{number}"
            );
            assert_eq!(
                [from(number, 1e-6 - down), from(number, -1e-6 - down)],
                [0, -1],
                "{number}"
            );
        }
        // A fast turn ends where a slow one does.
        for end in -40..=40 {
            let end = 0.1 * f64::from(end) + 0.013;
            let (mut slow, mut fast) = (begun(), begun());
            for step in 0..=1000 {
                slow.take(end * f64::from(step) / 1000.0);
            }
            fast.take(0.0);
            fast.take(end);
            assert_eq!(slow.number(), fast.number(), "{end}");
        }
    }
}

#[test]
fn a_position_changes_beyond_the_ridge_and_once() {
    let mut positions = Positions::of(&dial()).unwrap();
    let pitch = positions.pitch_rad;
    assert_eq!(positions.numbers(), Some((0, 10)));
    assert_eq!(positions.take(0.01).unwrap().change, 0);
    // Movement around the ridge between two positions reports no change.
    for way in [0.45, 0.55, 0.49, 0.7, 0.3, 0.74] {
        assert_eq!(positions.take(way * pitch), None, "{way}");
    }
    let place = positions.take(0.76 * pitch).unwrap();
    assert_eq!((place.position, place.change), (1, 1));
    assert!((place.beside + 0.24).abs() < 1e-9);
    // A fast turn over several positions is reported as one change that counts all of them.
    let place = positions.take(7.9 * pitch).unwrap();
    assert_eq!((place.position, place.change), (8, 7));
    // A fast turn that ends just beyond a ridge does not count the position behind that ridge. Turning back over the ridge
    // then changes nothing.
    assert_eq!(positions.take(3.48 * pitch).unwrap().position, 4);
    assert_eq!(positions.take(8.51 * pitch).unwrap().position, 8);
    assert_eq!(positions.take(8.2 * pitch), None);
    // Beyond an end stop the position stays at the last one.
    assert_eq!(positions.take(13.0 * pitch).unwrap().position, 10);
    assert_eq!(positions.take(14.0 * pitch), None);
    assert_eq!(positions.take(-5.0 * pitch).unwrap().position, 0);
}

/// Detents without torque number the positions, unless clicks or a profile beside them do.
#[test]
fn detents_without_torque_are_counted() {
    use crate::scene::Clicks;
    let mut around = dial();
    around.detents.as_mut().unwrap().strength_n_m = 0.0;
    let silent = Positions::of(&around).unwrap();
    assert_eq!(silent.numbers(), Some((0, 10)));
    around.click = Some(Clicks {
        per_rev: 12,
        ..Clicks::default()
    });
    assert_eq!(Positions::of(&around).unwrap().numbers(), Some((0, 5)));
}

#[test]
fn a_number_is_given_without_a_move() {
    let mut positions = Positions::of(&dial()).unwrap();
    positions.take(2.0 * positions.pitch_rad);
    positions.call(100);
    assert_eq!(positions.numbers(), Some((98, 108)));
    let place = positions.take(3.0 * positions.pitch_rad).unwrap();
    assert_eq!((place.position, place.change), (101, 1));
}

#[test]
fn a_number_is_kept_where_angles_begin_anew() {
    let mut positions = Positions::every(0.1, 0.0);
    positions.take(5.72);
    assert_eq!(positions.number(), Some(57));
    let place = positions.settle(0.01, positions.number());
    assert_eq!((place.position, place.change), (57, 0));
    assert!((place.beside - 0.1).abs() < 1e-9);
    assert_eq!(positions.take(0.12).unwrap().position, 58);
    // Between end stops, as on a dial, the angle alone gives the number.
    let mut dial = Positions::of(&dial()).unwrap();
    dial.take(5.0 * dial.pitch_rad);
    let place = dial.settle(2.0 * dial.pitch_rad, dial.number());
    assert_eq!((place.position, place.change), (2, 0));
}

#[test]
fn many_turns_lose_none() {
    let mut positions = Positions::every(0.1, 0.03);
    let (mut sum, mut seen) = (0, 0);
    for step in 0..200_000_i64 {
        if let Some(place) = positions.take(0.007 * step as f64) {
            sum += place.change;
            seen = place.position;
        }
    }
    assert_eq!(sum, seen);
    assert!((seen as f64 * 0.1 + 0.03 - 0.007 * 200_000.0).abs() < 0.1 * (0.5 + HYSTERESIS));
}

#[test]
fn listed_positions_have_their_places_in_the_list() {
    use crate::scene::DetentList;
    let around = Environment {
        detent_list: Some(DetentList {
            positions_rad: vec![-1.0, 0.0, 0.3, 2.0],
            strengths_n_m: vec![0.02],
            widths_rad: vec![0.3],
        }),
        ..Environment::default()
    };
    let mut positions = Positions::of(&around).unwrap();
    assert_eq!(positions.numbers(), Some((0, 3)));
    assert_eq!(positions.take(-3.0).unwrap().position, 0);
    // The number changes at three quarters of the gap between the two neighbouring angles.
    for (angle, wanted) in [
        (-0.3, None),
        (-0.2, Some(1)),
        (0.2, None),
        (0.23, Some(2)),
        (1.5, None),
        (1.6, Some(3)),
        (9.0, None),
        (0.8, None),
        (0.7, Some(2)),
        (-0.1, Some(1)),
    ] {
        let place = positions.take(angle);
        assert_eq!(place.map(|it| it.position), wanted, "{angle}");
    }
    assert_eq!([0, 3].map(|it| positions.angle_of(it)), [-1.0, 2.0]);
    // A board stores the list as a torque profile. In the profile the knob rests at the same angles.
    let drawn = Environment {
        profile: around.acting_profile().map(std::borrow::Cow::into_owned),
        ..Environment::default()
    };
    let on_board = Positions::of(&drawn).unwrap();
    assert_eq!(on_board.numbers(), Some((0, 3)));
    for i in 0..4 {
        let off = on_board.angle_of(i) - positions.angle_of(i);
        assert!(off.abs() < 1e-9, "{i}: {off}");
    }
    // Positions beyond an end stop are left out.
    let stopped = Environment {
        endstops: Some(Endstops {
            lower_rad: -0.2,
            upper_rad: 1.0,
            stiffness_n_m_per_rad: None,
        }),
        ..around
    };
    assert_eq!(Positions::of(&stopped).unwrap().numbers(), Some((1, 2)));
}

#[test]
fn a_profile_draws_to_its_deepest_place() {
    // The profiles are a magnetic detent, a ridge at point 3, and a valley in the middle.
    for (points, place) in [
        (&[0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0][..], 0.0),
        (&[0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0], 0.0),
        (&[0.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0], 0.5),
    ] {
        assert_eq!(deepest(points), place, "{points:?}");
    }
}
