//! Vectors and directions, as far as they are sums and signs, and a direction's multiples.
//!
//! ```text
//! (v + w)_i = v_i + w_i, and v - w, -v     p1_vector_sums
//! (u l)_i = u_i l towards zero             p4_direction_times, p4_direction_times_force
//! opposite = -u, along(i) = e_i            p4_direction_signs
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::{cover, property};
use touchstone_control::space::{Direction, Vector};
use touchstone_control::{Fixed8, Position};

type N = Fixed8;

/// What 8 bits show of a number.
const fn shown(x: i64) -> i64 {
    if x < -128 {
        -128
    } else if x > 127 {
        127
    } else {
        x
    }
}

/// Any three components but the lowest number, which no direction has.
fn any_direction<S: Source>(s: &mut S) -> Direction<N> {
    let lowest = -Position(N::HIGHEST);
    let any = |s: &mut S| N::any_position(s).max(lowest).0;
    Direction([any(s), any(s), any(s)])
}

property! {
    /// P1: vectors are added, subtracted and turned about by their components, each of which saturates.
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
            assert!(of(v.map(|x| x + x)) == shown(2 * of(v)));
        }
        cover!(s, v + w == v - w && v != w, "nothing is added");
    }
}
property! {
    /// P4: so far along a direction is each component's part, towards zero.
    equation "(u l)_i = u_i l towards zero"
    over "direction, length"
    by kissat fn p4_direction_times(s) {
        let u = any_direction(s);
        let length = N::any_position(s);
        let way = u.times(length);
        for axis in 0..3 {
            let part = N::of_signal(u.0[axis]) * N::of_signal(length.0);
            assert!(N::of_signal(way.0[axis].0) == part / 128);
        }
        cover!(s, N::of_signal(way.0[0].0) < 0, "back");
    }
}
property! {
    /// P4: a force along a direction is each component's part, towards zero.
    equation "(u f)_i = u_i f towards zero"
    over "direction, force"
    by kissat fn p4_direction_times_force(s) {
        let u = any_direction(s);
        let force = N::any_force(s);
        let pull = u.times_force(force);
        for axis in 0..3 {
            let part = N::of_signal(u.0[axis]) * N::of_signal(force.0);
            assert!(N::of_signal(pull.0[axis].0) == part / 128);
        }
        cover!(s, N::of_signal(pull.0[2].0) < 0, "down");
    }
}
property! {
    /// P4: the axes are what they are named, and the opposite of a direction is its components with the other sign.
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
            assert!((part != 0) == (of == axis) && (part < 0) == (of == axis && against));
        }
        assert!(Direction::<N>::default() == Direction::along(2, false));
        cover!(s, against && axis == 1, "against y");
    }
}
