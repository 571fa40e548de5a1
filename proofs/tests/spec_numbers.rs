//! Tests that extreme numbers and the operations of vectors equal exact calculations with integers. A comparison within an error
//! bound would not detect a wrong last digit.

use touchstone_control::fixed::types::{I8F24, I16F48};
use touchstone_control::magnitude::Word as _;
use touchstone_control::observer::ExactObserver;
use touchstone_control::reciprocal::Reciprocal32;
use touchstone_control::space::{Axes, Direction, Spatial, Vector};
use touchstone_control::{Fixed8, Fixed16, Fixed32, Force, Number, Position, Si, Stiffness};
use touchstone_proofs::spec::hands::Random;

/// The square root of `n`, rounded down.
fn root(n: i128) -> i128 {
    n.isqrt()
}
fn root_up(n: i128) -> i128 {
    let root = root(n);
    root + i128::from(root * root != n)
}

/// Specification of a number format: bits of its word, and fractional bits of a signal (position or force).
#[derive(Clone, Copy)]
struct Format {
    bits: u32,
    fraction: u32,
}

impl Format {
    fn most(self) -> i128 {
        (1 << (self.bits - 1)) - 1
    }
    fn signed(self, size: i128, negative: bool) -> i128 {
        let size = size.min(self.most());
        if negative { -size } else { size }
    }

    /// The direction of a vector: each component divided by the length, both with as many digits as the root has, rounded towards
    /// zero.
    fn unit(self, v: Axes<i128>) -> Option<Axes<i128>> {
        let largest = v.iter().map(|x| x.abs()).max()?;
        if largest == 0 {
            return None;
        }
        let mut up = 0;
        while largest << up < 1 << (self.bits - 2) {
            up += 1;
        }
        let scaled = v.map(|x| x.abs() << up);
        let length = root_up(scaled.iter().map(|x| x * x).sum());
        let mut unit = [0; 3];
        for (out, (size, x)) in unit.iter_mut().zip(scaled.into_iter().zip(v)) {
            *out = self.signed((size << self.fraction) / length, x < 0);
        }
        Some(unit)
    }

    /// A long vector scaled so that its components fit the digits from which a direction is calculated: up to two bits less than a
    /// word, rounded down.
    fn leading(self, v: Axes<i128>) -> Option<Axes<i128>> {
        let largest = v.iter().map(|x| x.abs()).fold(0, |all, x| all | x);
        if largest == 0 {
            return None;
        }
        let digits = 128 - largest.leading_zeros();
        let room = self.bits - 2;
        Some(if digits >= room {
            v.map(|x| x >> (digits - room))
        } else {
            v.map(|x| x << (room - digits))
        })
    }

    /// The direction `u` turned in the plane of `u` and `towards`: `u` times the cosine plus the direction across it times the
    /// sine. One step of Newton's method makes the result 1 long.
    fn turned(self, u: Axes<i128>, towards: Axes<i128>, turn: [i128; 2]) -> Option<Axes<i128>> {
        const NEAR_ONE: u32 = 30;
        let cross = |[a, b, c]: Axes<i128>, [x, y, z]: Axes<i128>| {
            [b * z - c * y, c * x - a * z, a * y - b * x]
        };
        let axis = self.leading(cross(towards, u))?;
        let side = self.unit(self.leading(cross(u, axis))?)?;
        let mut part = [0; 3];
        for (out, (u, side)) in part.iter_mut().zip(u.into_iter().zip(side)) {
            let long = turn[0] * u + turn[1] * side;
            *out = if 2 * self.fraction >= NEAR_ONE {
                long >> (2 * self.fraction - NEAR_ONE)
            } else {
                long << (NEAR_ONE - 2 * self.fraction)
            };
        }
        let squares: i128 = part.iter().map(|x| x * x).sum();
        let factor = ((3 << (2 * NEAR_ONE)) - squares) >> NEAR_ONE;
        let down = 2 * NEAR_ONE + 1 - self.fraction;
        Some(part.map(|x| {
            let size = (x * factor).abs() >> down;
            self.signed(size, x * factor < 0)
        }))
    }

    /// A vector without its part along a direction, with both products rounded towards zero.
    fn across(self, u: Axes<i128>, v: Axes<i128>) -> Axes<i128> {
        let one = 1_i128 << self.fraction;
        let along = (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / one;
        [0, 1, 2].map(|i| ((v[i] << self.fraction) - along * u[i]) / one)
    }

    /// A vector cut to a limit: each component is multiplied by one common ratio, which has as many bits as a component.
    fn within(self, v: Axes<i128>, limit: i128) -> Axes<i128> {
        let square: i128 = v.iter().map(|x| x * x).sum();
        if square <= limit * limit {
            return v;
        }
        let length = root_up(square);
        let share = (limit << (self.bits - 1)) / length;
        v.map(|x| self.signed((x.abs() * share) >> (self.bits - 1), x < 0))
    }
}

macro_rules! beside {
    ($test:ident, $name:ident, $int:ty, $rounds:literal) => {
        #[test]
        fn $test() {
            type N = $name;
            type Signal = <N as Number>::Signal;
            let of = |v: Axes<i128>| v.map(|x| Signal::from_bits(x as $int));
            let bits = |v: Axes<Signal>| v.map(|x| i128::from(x.to_bits()));
            let format = Format {
                bits: <$int>::BITS,
                fraction: Signal::FRAC_NBITS,
            };
            let mut random = Random(5);
            let (mut directions, mut turns, mut cuts, mut near) = (0_u64, 0_u64, 0_u64, 0_u64);
            for _ in 0..$rounds {
                let mut any = |size: u32| {
                    i128::from(random.signed(u64::from(size)))
                        .clamp(<$int>::MIN.into(), <$int>::MAX.into())
                };
                let word = <$int>::BITS - 1;
                let v = [any(word), any(word), any(word)];
                let unit = N::unit(of(v)).map(bits);
                assert_eq!(unit, format.unit(v), "unit of {v:?}");
                let (length, by_root) = N::polar(of(v));
                assert_eq!(by_root.map(bits), unit);
                let square: i128 = v.iter().map(|x| x * x).sum();
                assert_eq!(
                    i128::from(length.to_bits()),
                    root(square).min(format.most()),
                    "length of {v:?}"
                );
                let Some(u) = unit else { continue };
                directions += 1;

                let w = [any(word), any(word), any(word)];
                let across = bits(N::across(of(u), of(w)));
                let expected = format.across(u, w);
                let fits = expected.iter().all(|x| x.abs() <= format.most());
                assert!(!fits || across == expected, "{w:?} across {u:?}");

                // Turns towards another direction, a close one, and the same one.
                let small = (1 << 3) - 1;
                let close = u.map(|x| (x + any(5) % small).clamp(-format.most(), format.most()));
                let other = format.unit(w).unwrap_or(u);
                let Some(turn) = format.unit([any(word).abs(), any(word).abs(), 0]) else {
                    continue;
                };
                for towards in [other, format.unit(close).unwrap_or(u), u, u.map(|x| -x)] {
                    let turned = N::turned(
                        of(u),
                        of(towards),
                        [turn[0], turn[1]].map(|x| Signal::from_bits(x as $int)),
                    );
                    let expected = format.turned(u, towards, [turn[0], turn[1]]);
                    assert_eq!(
                        turned.map(bits),
                        expected,
                        "{u:?} towards {towards:?} by {turn:?}"
                    );
                    turns += u64::from(expected.is_some());
                    near += u64::from(expected.is_some() && towards != other);
                }

                let limit = any(word).abs().min(format.most());
                if square <= format.most() * format.most() && limit > 0 {
                    let cut = Vector(of(v).map(Force::<N>))
                        .within(Force(Signal::from_bits(limit as $int)));
                    let expected = format.within(v, limit);
                    if root_up(square) < format.most() {
                        assert_eq!(bits(cut.0.map(|f| f.0)), expected, "{v:?} within {limit}");
                        cuts += u64::from(expected != v);
                    }
                }
            }
            println!("{directions} directions, {turns} turned, {near} of these hardly, {cuts} cut");
            assert!(directions > 1000 && turns > 1000 && near > 100 && cuts > 100);
        }
    };
}
beside!(vectors_of_8_bits_beside_whole_numbers, Fixed8, i8, 300_000);
beside!(
    vectors_of_16_bits_beside_whole_numbers,
    Fixed16,
    i16,
    100_000
);
beside!(
    vectors_of_32_bits_beside_whole_numbers,
    Fixed32,
    i32,
    100_000
);

#[test]
fn a_vector_that_is_longer_than_the_format_is_cut_to_the_limit() {
    let signal = <Fixed8 as Number>::Signal::from_bits;
    let square = |v: Axes<i8>| v.iter().map(|x| i32::from(*x).pow(2)).sum::<i32>();
    let mut cuts = 0_u32;
    for x in (i8::MIN..=i8::MAX).step_by(5) {
        for y in (i8::MIN..=i8::MAX).step_by(5) {
            for z in (i8::MIN..=i8::MAX).step_by(5) {
                if square([x, y, z]) <= 126 * 126 {
                    continue;
                }
                let v = Vector([x, y, z].map(|x| Position::<Fixed8>(signal(x))));
                for limit in (1..=126).step_by(3) {
                    let cut = v.within(Position(signal(limit)));
                    let size = square(cut.0.map(|x| x.0.to_bits()));
                    assert!(size <= i32::from(limit).pow(2), "{v:?} within {limit}");
                    cuts += 1;
                }
            }
        }
    }
    assert!(cuts > 1_000_000);
}

#[test]
fn three_quarters_and_roots_are_rounded_down() {
    for x in 0..=i8::MAX {
        let three = <Fixed8 as Spatial>::three_quarters(<Fixed8 as Number>::Signal::from_bits(x));
        assert_eq!(i32::from(three.to_bits()), 3 * i32::from(x) / 4);
    }
    for e in i16::MIN..=i16::MAX {
        let of = <Fixed8 as Number>::Energy::from_bits(e);
        let root = i32::from(Fixed8::root_of_squares(of).to_bits());
        let e = i32::from(e).max(0);
        assert_eq!(root, (e as u32).isqrt().min(127) as i32, "{e}");
    }
}

#[test]
fn a_setting_at_the_end_of_a_signal_is_cut_towards_zero() {
    let mut random = Random(6);
    for round in 0..200_000_u64 {
        let si = if round < 2000 {
            (round.cast_signed() - 1000) << 8
        } else {
            random.signed(63)
        };
        let near = si + random.within(3);
        for si in [si, near] {
            let told = Fixed32::saturating_signal(Si::from_bits(si));
            let expected = (si / 256).clamp(i32::MIN.into(), i32::MAX.into());
            assert_eq!(i64::from(told.to_bits()), expected, "{si}");
        }
    }
}

#[test]
fn an_energy_fits_or_is_refused() {
    // An energy has 48 fractional bits, a setting 32: shifted up by 16.
    let energy = |si: i64| Fixed32::energy(Si::from_bits(si)).map(I16F48::to_bits);
    let most = i64::MAX >> 16;
    for sign in [1, -1] {
        for si in [0, 1, 1 << 32, most - 1, most] {
            assert_eq!(energy(sign * si), Some((sign * si) << 16));
        }
        for si in [most + 1, 1 << 48, 1 << 50, i64::MAX - 1, i64::MAX] {
            assert_eq!(energy(sign * si), None, "{si}");
        }
    }
    assert_eq!(energy(i64::MIN), None);
    // The same for formats with fewer fractional bits than a setting.
    let gain = |si: i64| Fixed32::gain(Si::from_bits(si)).map(|k| i64::from(k.to_bits()));
    for (si, bits) in [(0, 0), ((1 << 20) - 1, 0), (1 << 20, 1), (5 << 32, 5 << 12)] {
        assert_eq!(gain(si), Some(bits));
    }
    assert_eq!(gain(1 << 51), None);
}

#[test]
fn what_has_no_end_of_its_own_ends_with_the_format() {
    let lowest = Position::<Fixed32>(I8F24::MIN);
    assert_eq!(lowest.modulus(), Position(I8F24::MAX));
    assert_eq!(Fixed32::energy_per(I16F48::ONE, I8F24::ZERO), I8F24::MAX);
    assert_eq!(Fixed32::energy_per(I16F48::ZERO, I8F24::ZERO), I8F24::MAX);
    // A division by 0 gives (0, 0). Otherwise the result is the quotient, and quotient times divisor; `None` if the quotient
    // exceeds 31 bits.
    for (divisor, wide) in [(0, 0), (0, 1), (0, u64::MAX)] {
        assert_eq!(u32::divides_within(divisor, wide), Some((0, 0)));
    }
    assert_eq!(7_u32.divides_within(20), Some((2, 14)));
    assert_eq!(1_u32.divides_within(1 << 31), None);
    assert_eq!(
        1_u32.divides_within((1 << 31) - 1),
        Some(((1 << 31) - 1, (1 << 31) - 1))
    );
    // The reciprocal of 0 is 0. An observer remembers where it was placed.
    assert_eq!(Reciprocal32::new(0).inverse, 0);
    let observer = |x| ExactObserver::<Fixed32>::new(Position(I8F24::from_bits(x)));
    assert_ne!(observer(1), observer(2));
    // A tension is rounded up, for the largest and the smallest stiffness.
    let k = Stiffness::<Fixed32>(touchstone_control::fixed::types::I20F12::DELTA);
    for (x, up) in [(1, 1), (4096, 1), (4097, 2), (-1, 0), (i32::MAX, 524_288)] {
        let product = k * Position(I8F24::from_bits(x));
        assert_eq!(product.outward_up(), Force(I8F24::from_bits(up)), "{x}");
    }
}

#[test]
fn a_direction_is_not_turned_towards_itself() {
    let x = Direction::<Fixed32>::along(0, false);
    let turn = touchstone_control::space::Turn::of_ratio(I8F24::ONE);
    assert_eq!(x.turned(&x, &turn), x);
    assert_eq!(x.turned(&x.opposite(), &turn), x);
}
