//! Properties of the arithmetic on three axes: roots, lengths, limits, the exact work of a vector, the end of a contact, friction.
//!
//! ```text
//! r² <= n < (r + 1)²                         p5_root_karatsuba
//! |u| <= 1, no zero vector has one           p4_unit
//! |v| > l  <=>  Σ v_i² > l²                  p4_longer
//! |v across u| <= |v|                        p4_across
//! |u turned| <= 1, at the given angle to u    p4_turned
//! |F'| <= limit, no component grows          p4_within
//! W = Σ F_i d_i                              p1_vector_work
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::{assume, cover, property, such};
use touchstone_control::space::{
    Direction, Friction, FrictionState, Leaving, Spatial, Touch, Vector, root,
};
use touchstone_control::{Compliance, Fixed8, Fixed32, Force, Number, Position, Stiffness};

pub(crate) fn positions<N: Format + Spatial, S: Source>(s: &mut S) -> Vector<Position<N>> {
    Vector([N::any_position(s), N::any_position(s), N::any_position(s)])
}

pub(crate) fn forces<N: Format + Spatial, S: Source>(s: &mut S) -> Vector<Force<N>> {
    Vector([N::any_force(s), N::any_force(s), N::any_force(s)])
}

/// The sum of the squares of three integers.
pub(crate) fn squares<N: Format>(bits: [i64; 3]) -> N::Exact {
    let [x, y, z] = bits.map(N::exact);
    x * x + y * y + z * z
}

pub(crate) fn force_bits<N: Format + Spatial>(v: Vector<Force<N>>) -> [i64; 3] {
    v.0.map(|x| N::of_signal(x.0))
}

pub(crate) fn position_bits<N: Format + Spatial>(v: Vector<Position<N>>) -> [i64; 3] {
    v.0.map(|x| N::of_signal(x.0))
}

/// Whether a vector is at most a quarter of the format's range long. The guard's constructor guarantees this for forces, its check
/// for overspeed for displacements.
fn short<N: Format>(bits: [i64; 3], quarter: i64) -> bool {
    squares::<N>(bits) <= N::exact(quarter) * N::exact(quarter)
}

/// Property of the 16-bit square root, which is calculated by halves from an 8-bit root.
pub mod w16 {
    use super::*;

    property! {
        /// P5 (roots): the square root that is calculated by halves is exact at 16 bits.
        equation "r r <= n < (r + 1) (r + 1)"
        over "every number"
        fn p5_root_karatsuba(s) {
            let n = s.u16();
            let root = u32::from(root::root_16(n));
            assert!(root * root <= u32::from(n) && (root + 1) * (root + 1) > u32::from(n));
            cover!(s, root == 255, "the largest");
            cover!(s, root * root == u32::from(n) && root > 16, "a square");
        }
    }
}

/// Property of the 32-bit square root, which is calculated by halves from a 16-bit root.
pub mod root32 {
    use super::*;

    property! {
        /// P5 (roots): the square root that is calculated by halves is exact at 32 bits.
        equation "r r <= n < (r + 1) (r + 1)"
        over "every number"
        by sampled fn p5_root_of_halves(s) {
            let n = u32::from(s.u8()) << 24 | s.bits(24) as u32;
            let root = u64::from(root::root_32(n));
            assert!(root * root <= u64::from(n) && (root + 1) * (root + 1) > u64::from(n));
            cover!(s, root == 65_535, "the largest");
            cover!(s, root * root == u64::from(n) && root > 256, "a square");
        }
    }
}

/// Property of the 64-bit square root, which the firmware uses.
pub mod w64 {
    use super::*;

    property! {
        /// P5 (roots): the square root that is calculated by halves is exact at 64 bits.
        equation "r r <= n < (r + 1) (r + 1)"
        over "every number"
        by sampled fn p5_root_of_words(s) {
            let n = s.u64();
            let root = u128::from(root::root_64(n));
            assert!(root * root <= u128::from(n) && (root + 1) * (root + 1) > u128::from(n));
            cover!(s, root == u128::from(u32::MAX), "the largest");
            cover!(s, root * root == u128::from(n) && root > 1 << 16, "a square");
        }
    }
}

macro_rules! space {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, unit $unit:ident, across $across:ident, longer $longer:ident, polar $polar:ident, within $within:ident, work $work:ident, leaving $leaving:ident, friction $friction:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;

            property! {
                /// P4 (limits): a direction is at most 1 long. Its components have the signs of the vector's components and are
                /// right to two steps of the number format (three at 8 bits). Only the zero vector has no direction.
                equation "|u| <= 1, |v_i|/|v| - 2 quanta <= |u_i| <= |v_i|/|v|"
                over "every vector"
                by $unit fn p4_unit(s) {
                    let v = positions::<N, S>(s);
                    let bits = position_bits(v);
                    let Some(u) = Direction::of(v) else {
                        assert_reached!(bits == [0; 3]);
                        return;
                    };
                    assert!(bits != [0; 3]);
                    let one = N::exact(1 << N::SIGNAL_BITS);
                    let unit = u.0.map(N::of_signal);
                    assert!(squares::<N>(unit) <= one * one);
                    let signs = unit.iter().zip(bits).all(|(u, v)| *u == 0 || (*u < 0) == (v < 0));
                    assert!(signs);
                    let (slack, square) = (if N::BITS == 8 { 3 } else { 2 }, squares::<N>(bits));
                    let near = unit.iter().zip(bits).all(|(u, v)| {
                        let (u, v) = (N::exact(u.abs()), N::exact(v.abs()));
                        let most = v * v * (one * one);
                        u * u * square <= most && (u + N::exact(slack)) * (u + N::exact(slack)) * square >= most
                    });
                    assert!(near);
                    cover!(s, unit[0] == 0 && bits[0] != 0, "a component of less than a quantum");
                    cover!(s, bits[0] == N::of_signal(N::LOWEST), "the lowest value");
                }
            }
            property! {
                /// P4 (limits): a vector that is cut to a limit is within the limit, and none of its components grows or changes
                /// its sign. A vector within the limit is unchanged.
                equation "|F'| <= limit, |F'_i| <= |F_i|"
                over "every vector, every limit from 0 to below the end of the format"
                by $within fn p4_within(s) {
                    let limit = N::any_force(s);
                    assume!(s, limit >= Force::zero() && limit.0 < N::HIGHEST, "validate: a limit is far within the format");
                    let v = forces::<N, S>(s);
                    let most = N::exact(N::of_signal(limit.0));
                    let limited = v.within(limit);
                    let stays = limited == v;
                    let after = force_bits(limited);
                    assert!(squares::<N>(after) <= most * most);
                    // Nothing else is claimed of a vector that is unchanged.
                    if !stays {
                        let bits = force_bits(v);
                        assert_reached!(squares::<N>(bits) > most * most);
                        for (a, b) in after.into_iter().zip(bits) {
                            assert_reached!(a.abs() <= b.abs() && (a == 0 || (a < 0) == (b < 0)));
                        }
                    }
                    cover!(s, !stays && after[0] != 0, "shortened");
                    cover!(s, stays && after[0] != 0, "left as it is");
                }
            }
            property! {
                /// P4 (limits): the code reports a vector as longer than a limit if and only if it is longer.
                equation "|v| > l  <=>  Σ v_i² > l²"
                over "every vector, every limit that is not negative"
                by $longer fn p4_longer(s) {
                    let limit = N::any_position(s);
                    assume!(s, limit >= Position::zero(), "limits are not negative");
                    let v = positions::<N, S>(s);
                    let most = N::exact(N::of_signal(limit.0));
                    let longer = v.is_longer(limit);
                    assert!(longer == (squares::<N>(position_bits(v)) > most * most));
                    cover!(s, longer, "longer");
                    cover!(s, !longer && position_bits(v)[0] < 0, "within");
                }
            }
            property! {
                /// P4 (limits): the length that is returned with a direction is the vector's length. Every vector except the zero
                /// vector has a direction.
                equation "polar(v) = (floor |v|, v/|v|)"
                over "every vector"
                by $polar fn p4_polar(s) {
                    let v = positions::<N, S>(s);
                    let (length, direction) = Direction::polar(v);
                    let square = squares::<N>(position_bits(v));
                    let long = N::exact(N::of_signal(length.0));
                    let one = N::exact(1);
                    assert!(long >= N::exact(0) && long * long <= square);
                    assert!(length.0 == N::HIGHEST || (long + one) * (long + one) > square);
                    assert!(direction.is_none() == (square == N::exact(0)));
                    cover!(s, direction.is_none(), "the zero vector");
                    cover!(s, length.0 == N::HIGHEST, "longer than the format");
                }
            }
            property! {
                /// P4 (limits): the part of a vector across a direction is never longer than the vector.
                equation "|v - (v·u) u| <= |v|"
                over "every direction that a vector can have, every vector"
                by $across fn p4_across(s) {
                    let (along, v) = (positions::<N, S>(s), positions::<N, S>(s));
                    let Some(u) = Direction::of(along) else {
                        return;
                    };
                    let across = position_bits(u.across(v));
                    assert!(squares::<N>(across) <= squares::<N>(position_bits(v)));
                    cover!(s, across != [0; 3] && across != position_bits(v), "a part is across");
                }
            }
            property! {
                /// P1 (energy): the work of a force vector is the exact sum of three exact products.
                equation "W = Σ F_i d_i"
                over "forces and displacements of at most a quarter of the format"
                by $work fn p1_vector_work(s) {
                    let quarter = N::of_signal(N::HIGHEST) >> 2;
                    let f = such!(s, forces::<N, S>(s), |f| short::<N>(force_bits(f), quarter), "VectorGuard::new");
                    let d = such!(s, positions::<N, S>(s), |d| short::<N>(position_bits(d), quarter), "VectorGuard::tick: overspeed");
                    let ([f1, f2, f3], [d1, d2, d3]) = (force_bits(f).map(N::exact), position_bits(d).map(N::exact));
                    let sum = f1 * d1 + f2 * d2 + f3 * d3;
                    assert!(N::exact(N::of_energy(f.work(d).0)) == sum);
                    cover!(s, sum < N::exact(0), "given");
                    cover!(s, sum > N::exact(0), "taken");
                }
            }
            property! {
                /// P7 (end of contact): outside the object, a contact with the rule "projection" ends if and only if the distance
                /// is longer than the offset's part along it. With the rule "decoupled" it never ends in this way. If no axis has
                /// left, no rule ends the contact.
                equation "left  <=>  Σ e_i e_i > Σ |e_i| O_i"
                over "penetrations outside, offsets, of at most a quarter of the format"
                by $leaving fn p7_leaving(s) {
                    // Outside, as PerAxis::tick asks only there; offsets are not negative (p2_offset_*).
                    let mut size = || Position::<N>(<N as Number>::Signal::from_bits(s.bits(N::BITS - 3) as _));
                    let e = -Vector([size(), size(), size()]);
                    let o = Vector([size(), size(), size()]);
                    let (e_bits, o_bits) = (position_bits(e), position_bits(o));
                    let ([e1, e2, e3], [o1, o2, o3]) = (e_bits.map(N::exact), o_bits.map(N::exact));
                    let along = -(e1 * o1) - e2 * o2 - e3 * o3;
                    let left = Leaving::Projection.ends(e, o);
                    assert!(left == (squares::<N>(e_bits) > along));
                    assert!(!Leaving::Decoupled.ends(e, o));
                    let any = e_bits.iter().zip(o_bits).any(|(e, o)| e + o < 0);
                    assert!(Leaving::AnyAxis.ends(e, o) == any);
                    assert!(any || !left);
                    cover!(s, any && !left, "Fig. 4.8: one axis has left, the object has not");
                    cover!(s, left && o_bits != [0; 3], "left with an offset");
                }
            }
            property! {
                /// P4 and P7: the stretch of friction (distance from its anchor) is never longer than its state (sliding or
                /// sticking) allows. Without a normal force nothing is remembered.
                equation "|z| <= reach_k f_n  or stuck and  |z| <= reach_s f_n"
                over "configuration with kinetic at most static, any memory, position along the axes"
                by $friction fn p4_friction(s) {
                    let eighth = N::of_signal(N::HIGHEST) >> 3;
                    let near = |v: [i64; 3]| v.iter().all(|x| x.abs() <= eighth);
                    let law = Friction::<N> {
                        stiffness: N::any_stiffness(s),
                        static_reach: N::any_compliance(s),
                        kinetic_reach: N::any_compliance(s),
                    };
                    assume!(
                        s,
                        law.stiffness >= Stiffness::zero()
                            && law.kinetic_reach >= Compliance::zero()
                            && law.static_reach >= law.kinetic_reach,
                        "FrictionSettings::friction"
                    );
                    let at = such!(s, positions::<N, S>(s), |x| near(position_bits(x)), "coordinates: the unit of length");
                    let touch = Touch {
                        at,
                        normal: Direction::along(2, s.bool()),
                        depth: Position::quantum(),
                        moved: None,
                    };
                    let at = such!(s, positions::<N, S>(s), |x| near(position_bits(x)), "coordinates: the unit of length");
                    let home = Touch { at, ..touch };
                    let (before, pressed) = (N::any_force(s), N::any_force(s));
                    let mut state = FrictionState::default();
                    let first = law.tick(&mut state, &home, before);
                    // No stretch yet: no force.
                    assert!(force_bits(first) == [0; 3]);
                    let _ = law.tick(&mut state, &touch, pressed);
                    if pressed <= Force::zero() {
                        assert_reached!(state == FrictionState::default());
                        return;
                    }
                    let reach = |compliance: Compliance<N>| N::exact(N::of_signal((compliance * pressed).0));
                    let (kinetic, fixed) = (reach(law.kinetic_reach), reach(law.static_reach));
                    let length = squares::<N>(position_bits(state.stretch));
                    assert!(length <= kinetic * kinetic || !state.sliding && length <= fixed * fixed);
                    cover!(s, state.sliding, "slides");
                    cover!(s, !state.sliding && length > N::exact(0), "sticks");
                }
            }
        }
    };
}
space!(
    /// The properties of this file at 8 bits. All inputs are tried (`PROPERTIES` of `examples/every.rs`), or a solver proves the
    /// property; `across` and `friction` are only tested on random samples.
    w8, Fixed8, unit sampled, across sampled, longer kissat, polar sampled, within sampled, work kissat, leaving sampled, friction sampled
);
space!(
    /// The properties of this file at 32 bits, the width of the firmware, in random tests.
    w32, Fixed32, unit sampled, across sampled, longer sampled, polar sampled, within sampled, work sampled, leaving sampled, friction sampled
);

/// Property of a direction that is turned, at 32 bits in random tests: solvers cannot follow products of products.
pub mod turn {
    use super::*;
    use touchstone_control::space::Turn;
    type N = Fixed32;

    property! {
        /// P4 (limits): a turned direction is at most 1 long, and at most three steps of the number format shorter. The cosine of
        /// its angle to the old direction is the given one, to eight steps, unless it is the old direction.
        equation "|u'| <= 1, u·u' = cos a"
        over "directions, ratios of across to along"
        by sampled fn p4_turned(s) {
            let (a, b) = (positions::<N, S>(s), positions::<N, S>(s));
            let (Some(from), Some(to)) = (Direction::of(a), Direction::of(b)) else {
                return;
            };
            let ratio = N::any_position(s);
            assume!(s, ratio > Position::zero(), "Rule::Restricted: a cone");
            let turn = Turn::of_ratio(ratio.0);
            let turned = from.turned(&to, &turn);
            let bits = turned.0.map(N::of_signal);
            let one = i128::from(1_i64 << N::SIGNAL_BITS);
            assert!(squares::<N>(bits) <= one * one);
            assert!(squares::<N>(bits) >= (one - 3) * (one - 3));
            if turned == from {
                return;
            }
            let was = from.0.map(N::of_signal);
            let cosine: i128 = bits.iter().zip(was).map(|(x, y)| i128::from(*x) * i128::from(y)).sum();
            let asked = i128::from(N::of_signal(turn.cosine)) * one;
            assert!((cosine - asked).abs() <= 8 * one);
            cover!(s, turn.sine > turn.cosine, "far");
            cover!(s, N::of_signal(turn.sine) < 1000, "by a hair");
        }
    }
}
