//! Tests that lengths, directions, fractions and limits of fixed-point vectors keep their documented errors, for difficult and
//! random vectors. No vector causes a division by zero.

use touchstone_control::space::number::Spatial;
use touchstone_control::space::{Direction, Turn, Vector};
use touchstone_control::{Fixed8, Fixed16, Fixed32, Force, Position};
use touchstone_tests::random::Random;
use touchstone_tests::space::{F, angle, length, mm, numbers};

type Words = [i32; 3];

fn position(bits: Words) -> Vector<Position<F>> {
    Vector(bits.map(|b| Position(fixed::types::I8F24::from_bits(b))))
}

/// Test vectors: components at ten powers of two and their neighbours, at zero and at the ends of the range, and random vectors
/// of all lengths.
fn vectors() -> Vec<Words> {
    let mut parts = vec![0, i32::MAX, i32::MIN, i32::MIN + 1];
    for bit in [0, 1, 5, 11, 15, 16, 23, 24, 29, 30] {
        for part in [(1 << bit) - 1, 1 << bit, (1 << bit) + 1] {
            parts.extend([part, -part]);
        }
    }
    let mut all = Vec::new();
    for &x in &parts {
        for &y in &parts {
            for &z in &parts {
                all.push([x, y, z]);
            }
        }
    }
    let mut random = Random::new(41);
    for _ in 0..200_000 {
        let shift = random.bits() % 31;
        all.push([(); 3].map(|()| (random.bits() as i32) >> shift));
    }
    all
}

/// The exact sum of the squares of a vector's components, as raw integers.
fn squares(v: Words) -> u128 {
    v.iter().map(|x| u128::from(x.unsigned_abs()).pow(2)).sum()
}

#[test]
fn lengths_are_less_than_a_quantum_off_to_their_side() {
    let most = u128::from(i32::MAX.unsigned_abs());
    for v in vectors() {
        let down = u128::from(position(v).length_down().0.to_bits().unsigned_abs());
        let up = u128::from(position(v).length_up().0.to_bits().unsigned_abs());
        let n = squares(v);
        assert!(down * down <= n, "{v:?}");
        assert!((down + 1) * (down + 1) > n || down == most, "{v:?}");
        assert!(up * up >= n || up == most, "{v:?}");
        assert!(up == 0 || (up - 1) * (up - 1) < n, "{v:?}");
    }
}

#[test]
fn directions_are_never_longer_than_one_and_right_to_a_quantum_however_short_the_vector() {
    let (mut worst_part, mut worst_length) = (0.0_f64, 0.0_f64);
    for v in vectors() {
        let Some(u) = Direction::of(position(v)) else {
            assert_eq!(v, [0; 3]);
            continue;
        };
        let bits = u.0.map(|x| x.to_bits());
        assert!(
            squares(bits) <= 1 << 48,
            "{v:?} gives {bits:?}, longer than 1"
        );
        let size = length(v.map(f64::from));
        for (part, bits) in v.into_iter().zip(bits) {
            let exact = f64::from(part) / size * 16_777_216.0;
            let off = exact.abs() - f64::from(bits.unsigned_abs());
            assert!(bits == 0 || (bits < 0) == (part < 0), "{v:?}");
            // Allowed are one quantum and a 64th of it, and a millionth for this test's own arithmetic.
            assert!(off > -1e-6 && off < 1.0 + 1.0 / 64.0, "{v:?}: {off} quanta");
            worst_part = worst_part.max(off);
        }
        worst_length = worst_length.max(16_777_216.0 - length(bits.map(f64::from)));
    }
    println!("worst part {worst_part:.4} quanta, worst length {worst_length:.3} quanta short");
    assert!(worst_length < 1.8);
}

#[test]
fn a_limited_vector_is_within_the_limit_and_keeps_its_direction() {
    let limits = [0, 1, 2, 1000, 12 << 24, i32::MAX];
    for v in vectors().into_iter().step_by(3) {
        let force: Vector<Force<F>> = position(v).map(|x| Force(x.0));
        for limit in limits {
            let limited = force.within(Force(fixed::types::I8F24::from_bits(limit)));
            let bits = limited.0.map(|x| x.0.to_bits());
            let bound = u128::from(limit.unsigned_abs()).pow(2);
            if squares(v) <= bound {
                assert_eq!(bits, v);
                continue;
            }
            // A length beyond the format's end saturates, and is not checked; no force of a device is that large.
            if squares(v) > u128::from(i32::MAX.unsigned_abs()).pow(2) {
                continue;
            }
            assert!(squares(bits) <= bound, "{v:?} within {limit} is {bits:?}");
            let share = f64::from(limit) / length(v.map(f64::from));
            for (part, bits) in v.into_iter().zip(bits) {
                let off = share * f64::from(part.unsigned_abs()) - f64::from(bits.unsigned_abs());
                assert!(
                    off > -1e-6 && off < 2.0,
                    "{v:?} within {limit}: {off} quanta"
                );
                assert!(bits == 0 || (bits < 0) == (part < 0));
            }
        }
    }
}

/// Checks unit vectors in the 8-bit format for one in fifteen of all vectors. The code is generic, so that the same source serves
/// all number formats.
#[test]
fn every_direction_of_8_bits() {
    for x in i8::MIN..=i8::MAX {
        for y in (i8::MIN..=i8::MAX).step_by(5) {
            for z in (i8::MIN..=i8::MAX).step_by(3) {
                let v = [x, y, z].map(fixed::types::I1F7::from_bits);
                let size = length([x, y, z].map(f64::from));
                let Some(unit) = Fixed8::unit(v) else {
                    assert_eq!([x, y, z], [0; 3]);
                    continue;
                };
                let bits = unit.map(|u| f64::from(u.to_bits()));
                assert!(length(bits) <= 128.0);
                for (part, bits) in [x, y, z].into_iter().zip(bits) {
                    let off = (f64::from(part) / size * 128.0).abs() - bits.abs();
                    assert!(off > -1e-6 && off <= 3.0, "{x} {y} {z}: {off}");
                }
            }
        }
    }
}

#[test]
fn nothing_is_divided_by_a_zero_vector() {
    fn zero<N: Spatial>() {
        let none = [N::Signal::default(); 3];
        assert_eq!(N::unit(none), None);
        assert_eq!(N::length_up(none), N::Signal::default());
        let nothing = N::Signal::default();
        assert_eq!(
            N::share(N::ONE, N::ONE, nothing),
            nothing,
            "a share of nothing"
        );
    }
    zero::<Fixed32>();
    zero::<Fixed16>();
    zero::<Fixed8>();
    zero::<f64>();
    let none: Vector<Force<F>> = Vector::default();
    assert_eq!(none.within(Force::zero()), none);
    // A direction that is turned towards itself or its opposite stays.
    let up = Direction::<F>::default();
    let turn = Turn::of_ratio(mm(0.1).0);
    assert_eq!(up.turned(&up, &turn), up);
    assert_eq!(up.turned(&up.opposite(), &turn), up);
}

#[test]
fn a_turn_is_by_its_angle() {
    let mut random = Random::new(5);
    let mut any =
        || Direction::of(position([(); 3].map(|()| random.whole(1 << 28)))).expect("not zero");
    let mut worst = 0.0_f64;
    for ratio in [0.001, 0.01, 0.1, 1.0] {
        // A ratio is a pure number. As a position in centimetres, 1 is 10 mm.
        let turn = Turn::<F>::of_ratio(mm(10.0 * ratio).0);
        for _ in 0..20_000 {
            let (from, to) = (any(), any());
            let (a, b) = (numbers(&from), numbers(&to));
            // Nearly parallel or opposite directions have no unique plane in which to turn, and a turn must not go past its aim.
            if angle(a, b) < ratio.atan() + 1e-3 || angle(a, b) > 3.139 {
                continue;
            }
            let turned = numbers(&from.turned(&to, &turn));
            let off = (angle(a, turned) - ratio.atan()).abs();
            worst = worst.max(off);
            assert!(
                (angle(turned, b) - (angle(a, b) - ratio.atan())).abs()
                    < 1e-6 / angle(a, b).sin().min(1.0)
            );
        }
    }
    println!("worst error of a turn {worst:.1e} rad");
    assert!(worst < 1e-6);
}
