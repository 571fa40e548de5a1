//! Properties of vectors and directions: sums, signs, lengths, and multiples of a direction.
//!
//! ```text
//! (v + w)_i = v_i + w_i, and v - w, -v     p1_vector_sums
//! (u l)_i = u_i l towards zero             p4_direction_times, p4_direction_times_force
//! opposite = -u, along(i) = e_i            p4_direction_signs
//! u·v, |v|, v - (v·u) u                     p4_scalar_products, p4_lengths, p4_across_is_shorter
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::{cover, property};
use touchstone_control::space::{Direction, Vector};
use touchstone_control::{Fixed8, Force, Number, Position};

type N = Fixed8;

/// Limits a number to the range of 8 bits.
const fn shown(x: i64) -> i64 {
    if x < -128 {
        -128
    } else if x > 127 {
        127
    } else {
        x
    }
}

/// A direction with any three components except the lowest number, which no direction has.
fn any_direction<S: Source>(s: &mut S) -> Direction<N> {
    let lowest = -Position(N::HIGHEST);
    let any = |s: &mut S| N::any_position(s).max(lowest).0;
    Direction([any(s), any(s), any(s)])
}

property! {
    /// P1 (energy): vectors are added, subtracted and negated component by component, and each component saturates.
    equation "(v + w)_i = v_i + w_i, (v - w)_i = v_i - w_i, (-v)_i = -v_i"
    over "two vectors"
    fn p1_vector_sums(s) {
        let any = |s: &mut S| Vector([N::any_position(s), N::any_position(s), N::any_position(s)]);
        let (v, w) = (any(s), any(s));
        for axis in 0..3 {
            let of = |v: Vector<Position<N>>| N::of_signal(v.0[axis].0);
            assert!(of(v + w) == shown(of(v) + of(w)));
            assert!(of(v - w) == shown(of(v) - of(w)));
            assert!(of(-v) == shown(-of(v)));
            assert_reached!(of(v.map(|x| x + x)) == shown(2 * of(v)));
        }
        cover!(s, v + w == v - w && v != w, "nothing is added");
    }
}
property! {
    /// P4 (geometry): a vector of a given length along a direction has that length times each component, rounded towards zero.
    equation "(u l)_i = u_i l towards zero"
    over "direction, length"
    by kissat fn p4_direction_times(s) {
        let u = any_direction(s);
        let length = N::any_position(s);
        let way = u.times(length);
        {
            // One random axis: one comparison is quicker for the solver than three.
            let axis = usize::from(s.u8() % 3);
            let part = i16::from(u.0[axis].to_bits()) * i16::from(length.0.to_bits());
            assert_reached!(i16::from(way.0[axis].0.to_bits()) == part / 128);
        }
        cover!(s, N::of_signal(way.0[0].0) < 0, "back");
    }
}
property! {
    /// P4 (geometry): a force along a direction has its size times each component of the direction, rounded towards zero.
    equation "(u f)_i = u_i f towards zero"
    over "direction, force"
    by kissat fn p4_direction_times_force(s) {
        let u = any_direction(s);
        let force = N::any_force(s);
        let pull = u.times_force(force);
        {
            // One random axis: one comparison is quicker for the solver than three.
            let axis = usize::from(s.u8() % 3);
            let part = i16::from(u.0[axis].to_bits()) * i16::from(force.0.to_bits());
            assert_reached!(i16::from(pull.0[axis].0.to_bits()) == part / 128);
        }
        cover!(s, N::of_signal(pull.0[2].0) < 0, "down");
    }
}
property! {
    /// P4 (geometry): `along(i)` gives the direction of axis `i`; the opposite of a direction has negated components.
    equation "opposite = -u; along(i) = e_i"
    over "direction, axis"
    fn p4_direction_signs(s) {
        let u = any_direction(s);
        let other = u.opposite();
        let (axis, against) = (usize::from(s.u8() % 3), s.bool());
        let along = Direction::<N>::along(axis, against);
        for of in 0..3 {
            assert!(N::of_signal(other.0[of]) == -N::of_signal(u.0[of]));
            let part = N::of_signal(along.0[of]);
            assert_reached!((part != 0) == (of == axis) && (part < 0) == (of == axis && against));
        }
        assert!(Direction::<N>::default() == Direction::along(2, false));
        cover!(s, against && axis == 1, "against y");
    }
}

/// The scalar product of a direction and a vector, rounded down and limited to the range of the format.
fn scalar(u: Direction<N>, v: [i64; 3]) -> i64 {
    let [x, y, z] = u.0.map(N::of_signal);
    shown((x * v[0] + y * v[1] + z * v[2]).div_euclid(128))
}
/// The direction of an arbitrary vector, whose components of 4 bits the source of inputs gives; `None` for the zero vector.
fn short_direction<S: Source>(s: &mut S) -> Option<Direction<N>> {
    let part = |s: &mut S| Position(<N as Number>::Signal::from_bits(s.bits(4) as i8 - 8));
    Direction::of(Vector([part(s), part(s), part(s)]))
}

property! {
    /// P4 (geometry): the part of a displacement or a force along a direction, and the cosine between two directions, are scalar
    /// products, rounded down.
    equation "u·v = floor(Σ u_i v_i)"
    over "directions of 4 bits an axis, vectors of 4 bits an axis, sixteen times as large"
    by sampled fn p4_scalar_products(s) {
        let Some(u) = short_direction(s) else {
            return;
        };
        let part = |s: &mut S| Position::<N>(<N as Number>::Signal::from_bits(16 * (s.bits(4) as i8 - 8)));
        let v = Vector([part(s), part(s), part(s)]);
        let expected = scalar(u, v.0.map(|x| N::of_signal(x.0)));
        assert!(N::of_signal(u.component(v).0) == expected);
        assert!(N::of_signal(u.component_of_force(v.map(|x| Force(x.0))).0) == expected);
        let lowest = -Position(N::HIGHEST);
        let other = Direction::<N>(v.0.map(|x| x.max(lowest).0));
        assert!(N::of_signal(u.cosine(&other)) == scalar(u, other.0.map(N::of_signal)));
        cover!(s, expected == -128, "the lowest value");
        cover!(s, expected == 127, "the highest value");
    }
}
property! {
    /// P4 (geometry): the length of a vector is the root of the sum of its squared components, rounded down or up, and limited to
    /// the format.
    equation "floor |v|, ceil |v|"
    over "every vector"
    by sampled fn p4_lengths(s) {
        let v = Vector([N::any_position(s), N::any_position(s), N::any_position(s)]);
        let square: i64 = v.0.iter().map(|x| N::of_signal(x.0).pow(2)).sum();
        let (down, up) = (N::of_signal(v.length_down().0), N::of_signal(v.length_up().0));
        assert!(down >= 0 && down * down <= square && (down == 127 || (down + 1) * (down + 1) > square));
        assert!(up == down || up == down + 1);
        assert!(up == 127 || up * up >= square);
        assert!(up == 0 || (up - 1) * (up - 1) < square);
        cover!(s, up == down && up > 0, "a whole length");
        cover!(s, square > 127 * 127, "longer than the format");
    }
}
property! {
    /// P4 (geometry): the part of a vector across a direction is never longer than the vector. It is the vector minus the part
    /// along the direction, to two steps of the number format.
    equation "|v - (v·u) u| <= |v|"
    over "directions of 4 bits an axis, vectors of 4 bits an axis, five times as large"
    by sampled fn p4_across_is_shorter(s) {
        let Some(u) = short_direction(s) else {
            return;
        };
        let part = |s: &mut S| Position::<N>(<N as Number>::Signal::from_bits(5 * (s.bits(4) as i8 - 8)));
        let v = Vector([part(s), part(s), part(s)]);
        let across = u.across(v).0.map(|x| N::of_signal(x.0));
        let was = v.0.map(|x| N::of_signal(x.0));
        let square = |v: [i64; 3]| v.iter().map(|x| x * x).sum::<i64>();
        assert!(square(across) <= square(was));
        let [a, b, c] = u.0.map(N::of_signal);
        let inner = a * was[0] + b * was[1] + c * was[2];
        for (axis, u) in [a, b, c].into_iter().enumerate() {
            // Both sides are 128² times as large as the numbers that they stand for: directions are stored in steps of 1/128.
            let exact = was[axis] * 128 * 128 - inner * u;
            assert_reached!((across[axis] * 128 * 128 - exact).abs() < 2 * 128 * 128);
        }
        cover!(s, across != was && across != [0; 3], "a part is across");
    }
}
property! {
    /// P4 (geometry): a vector that is cut to a limit is at most six steps of the number format shorter than the limit.
    equation "|v| > l: l - 6 quanta <= |v'| <= l"
    over "vectors of 4 bits an axis, sixteen times as large, limits of 7 bits"
    by sampled fn p4_within_is_hardly_shorter(s) {
        let part = |s: &mut S| Position::<N>(<N as Number>::Signal::from_bits(16 * (s.bits(4) as i8 - 8)));
        let v = Vector([part(s), part(s), part(s)]);
        let limit = (s.bits(7) as i64).min(126);
        let after = v.within(Position(<N as Number>::Signal::from_bits(limit as i8)));
        let square = |v: Vector<Position<N>>| v.0.iter().map(|x| N::of_signal(x.0).pow(2)).sum::<i64>();
        if square(v) <= limit * limit {
            assert_reached!(after == v);
            return;
        }
        let least = (limit - 6).max(0);
        assert!(square(after) <= limit * limit && square(after) >= least * least);
        cover!(s, square(v) > 127 * 127, "longer than the format");
    }
}
