//! Properties at 8 bits of the steps between a virtual object and a law on three axes: displacement along a normal, surface point,
//! friction.
//!
//! All inputs of each step are tried (`cargo xtask prove --every contact`). `m` is a displacement, `n` a normal, `u` a direction
//! out, `x` a position, `e` a penetration and `z` a stretch. `'` marks the last tick at `n`, `x` and `e`, and the new value at `u`,
//! `z` and the anchor.
//!
//! ```text
//! m = -n'·(x - x'), rounded down, or e - e' where n = n'    p4_displacement
//! normal turns by at most the cone's angle                  p4_point_restricted
//! z = x - anchor, cut to what the normal force holds        p4_friction_sticks_and_slides
//! ```

use crate::format::Format;
use crate::objects::{N, ONE, bits, parts, position, signed, squares, vector};
use crate::{assume, cover, property};
use touchstone_control::law::Sample;
use touchstone_control::space::environment::{Cuboid, Sphere};
use touchstone_control::space::{
    Direction, Friction, FrictionState, Nearest, Rule, Surface, SurfacePoint, Touch, Track, Turn,
    Vector,
};
use touchstone_control::{Compliance, Force, Number, Position, Stiffness};

pub(crate) fn force(bits: i64) -> Force<N> {
    Force(position(bits).0)
}
pub(crate) fn stiffness(bits: i64) -> Stiffness<N> {
    Stiffness(<N as Number>::Gain::from_bits(bits as i8))
}
pub(crate) fn compliance(bits: i64) -> Compliance<N> {
    Compliance(<N as Number>::Ratio::from_bits(bits as i8))
}
pub(crate) fn force_bits(v: Vector<Force<N>>) -> [i64; 3] {
    v.0.map(|x| N::of_signal(x.0))
}
pub(crate) fn place_bits(v: Vector<Position<N>>) -> [i64; 3] {
    v.0.map(bits)
}
/// The scalar product of a direction and a vector, rounded down.
pub(crate) fn along(u: &Direction<N>, v: [i64; 3]) -> i64 {
    let ([a, b, c], [x, y, z]) = (parts(u), v);
    (a * x + b * y + c * z).div_euclid(ONE)
}
pub(crate) fn less([x, y, z]: [i64; 3], [a, b, c]: [i64; 3]) -> [i64; 3] {
    [x - a, y - b, z - c]
}
pub(crate) fn touch(at: [i64; 3], normal: Direction<N>, depth: i64) -> Touch<N> {
    Touch {
        at: vector(at),
        normal,
        depth: position(depth),
        moved: None,
    }
}

property! {
    /// P4 (geometry): the displacement that a law gets is the hand's displacement along the normal of the last tick, rounded down.
    /// On a surface that did not turn it is the change of penetration, which differs only by rounding. An estimated displacement is
    /// projected on the same normal.
    equation "m = floor(-n'·(x - x')); e - e' where n = n' and |e - e' - m| <= 2"
    over "normals of 3 bits along two axes, places of 3 bits along two axes, depths of 3 bits; turned or not, estimated or not"
    by sampled fn p4_displacement(s) {
        let flat = |s: &mut S| [signed(s, 3), 0, signed(s, 3)];
        let Some(normal) = Direction::of(vector(flat(s))) else {
            return;
        };
        let (from, to, was, depth) = (flat(s), flat(s), signed(s, 3), signed(s, 3));
        let turned = s.bool();
        let now = if turned { Direction::along(1, false) } else { normal };
        let mut track = Track::default();
        let first = track.sample(&touch(from, normal, was));
        // The first sample starts at the surface, as on one axis.
        assert!(first == Sample::measured(position(was), Position::zero()));
        assert!(track.normal().is_none() && track.depth() == Position::zero());
        assert!(place_bits(track.moved(&touch(from, normal, was))) == [0; 3]);
        track.keep(&touch(from, normal, was));
        assert!(track.normal() == Some(normal) && bits(track.depth()) == was);
        let here = touch(to, now, depth);
        let way = less(to, from);
        assert!(place_bits(track.moved(&here)) == way);
        let inwards = along(&normal.opposite(), way);
        let straight = !turned && (depth - was - inwards).abs() <= 2;
        let told = track.sample(&here);
        assert!(bits(told.e) == depth && bits(told.moved) == if straight { depth - was } else { inwards });
        let estimated = Touch { moved: Some(vector(to)), ..here };
        assert!(place_bits(track.moved(&estimated)) == to);
        assert!(bits(track.sample(&estimated).moved) == along(&normal.opposite(), to));
        let fresh = Track::default().sample(&estimated);
        assert!(bits(fresh.moved) == along(&now.opposite(), to));
        cover!(s, turned, "turned");
        cover!(s, !turned && !straight, "the closest point jumped");
    }
}
property! {
    /// P4 (geometry): with the rule "closest", the surface point is the one that the object gives for the side where the hand was
    /// in the last tick.
    equation "closest: nearest(x, side of the last tick)"
    over "a box, two places of 4 bits along two axes"
    by sampled fn p4_point_closest(s) {
        let body = Cuboid { centre: vector([0; 3]), half: vector([6, 5, 7]) };
        let mut point = SurfacePoint::new(Rule::Closest);
        let none = Direction([position(0).0; 3]);
        let (first, second) = ([signed(s, 4), 0, signed(s, 4)], [signed(s, 4), 0, signed(s, 4)]);
        let seen = body.nearest(vector(first), &none);
        assert!(point.tick(&body, vector(first)) == Touch::measured(vector(first), seen));
        let then = body.nearest(vector(second), &seen.normal);
        let told = point.tick(&body, vector(second));
        assert!(told == Touch { at: vector(second), normal: then.normal, depth: then.depth, moved: None });
        cover!(s, second == [0; 3] && seen.normal != then.normal, "the middle, from outside an edge");
        cover!(s, bits(seen.depth) > 0 && then.normal != seen.normal, "jumps");
    }
}
property! {
    /// P4 (geometry): with the rule "point of penetration", the way out leads back to where the hand came in, until the hand has
    /// left.
    equation "depth u = entry - x"
    over "a box, three places of 4 bits along two axes"
    by sampled fn p4_point_of_penetration(s) {
        let body = Cuboid { centre: vector([0; 3]), half: vector([6, 5, 7]) };
        let mut point = SurfacePoint::new(Rule::Penetration);
        let mut entry: Option<[i64; 3]> = None;
        let mut side = Direction([position(0).0; 3]);
        for _ in 0..3 {
            let at = [signed(s, 4), 0, signed(s, 4)];
            let nearest = body.nearest(vector(at), &side);
            side = nearest.normal;
            let told = point.tick(&body, vector(at));
            if bits(nearest.depth) <= 0 {
                assert_reached!(told == Touch::measured(vector(at), nearest));
                entry = None;
                continue;
            }
            let came_in = entry.unwrap_or_else(|| {
                let out = place_bits(nearest.normal.times(nearest.depth));
                [at[0] + out[0], at[1] + out[1], at[2] + out[2]]
            });
            let way = less(came_in, at);
            let (depth, normal) = Direction::polar(vector(way));
            let expected = match normal {
                Some(normal) => Nearest { normal, depth },
                None => nearest,
            };
            assert!(told == Touch::measured(vector(at), expected));
            cover!(s, entry.is_some() && way != [0; 3], "pulled back");
            entry = Some(came_in);
        }
    }
}
property! {
    /// P4 (geometry): with the rule "restricted", the surface point is the closest one if that lies in the cone. Otherwise the
    /// direction turns by at most the cone's angle, to the precision of 8 bits, and leads out of the object.
    equation "u·u' >= cos a less 6 quanta; u' = nearest where u·nearest >= cos a"
    over "box or ball, two places inside of 4 bits along two axes, cones of 27 to 45 degrees"
    by sampled fn p4_point_restricted(s) {
        let turn = Turn::of_ratio(position(64 + s.bits(6).cast_signed()).0);
        let box_ = Cuboid { centre: vector([0; 3]), half: vector([6, 5, 7]) };
        let ball = Sphere { centre: vector([0; 3]), radius: position(7) };
        let round = s.bool();
        let mut point = SurfacePoint::new(Rule::Restricted(turn));
        let mut side = Direction([position(0).0; 3]);
        let mut was: Option<Direction<N>> = None;
        for _ in 0..2 {
            let at = vector([signed(s, 4), 0, signed(s, 4)]);
            let (nearest, told) = if round {
                (ball.nearest(at, &side), point.tick(&ball, at))
            } else {
                (box_.nearest(at, &side), point.tick(&box_, at))
            };
            side = nearest.normal;
            assume!(s, bits(nearest.depth) > 0, "case: inside; outside is p4_point_closest");
            let Some(last) = was.replace(told.normal) else {
                assert_reached!(told == Touch::measured(at, nearest));
                continue;
            };
            let cosine = N::of_signal(turn.cosine);
            if along(&last, parts(&nearest.normal)) >= cosine {
                assert_reached!(told == Touch::measured(at, nearest));
            } else {
                let turned = along(&last, parts(&told.normal));
                assert!(turned >= cosine - 6);
                let size = squares(parts(&told.normal));
                assert!(((ONE - 8) * (ONE - 8)..=ONE * ONE).contains(&size));
                // A ball offers no direction but that to its closest point, so the surface point turns by the whole angle.
                let between = along(&last, parts(&nearest.normal));
                assert!(!round || between < 10 - ONE || turned <= cosine + 6 && along(&nearest.normal, parts(&told.normal)) >= between);
                let out = if round { ball.exit(at, &told.normal, &side) } else { box_.exit(at, &told.normal, &side) };
                assert!(out == Some(told.depth));
                assert!(round || told.depth <= box_.exit(at, &last, &side).unwrap_or(told.depth));
                cover!(s, !round && told.normal != last, "turned in the box");
                cover!(s, told.normal != last, "turned by the cone's angle");
                cover!(s, !round && told.normal == last, "straight on is shorter");
            }
        }
    }
}
property! {
    /// P4 (geometry): friction sticks to its anchor while the stretch (distance from the anchor) is at most what the normal force
    /// holds. Beyond that it slides, cut to the kinetic limit, and sticks again below three quarters of it. It pulls against the
    /// stretch; without a normal force nothing is kept.
    equation "z = x - anchor; slides: |z| > s f_n; cut to k f_n where longer; F = -k z towards zero"
    over "reaches of 4 bits, stiffness of 3 bits, normal force of 3 bits; a place of 4 bits along one axis and of 3 along another, eight times as large, from rest and slid"
    by sampled fn p4_friction_sticks_and_slides(s) {
        let (fixed, kinetic) = (s.bits(4).cast_signed() * 8, s.bits(4).cast_signed() * 8);
        assume!(s, kinetic <= fixed, "FrictionSettings::friction");
        let stiff = s.bits(3).cast_signed() * 4;
        let law = Friction::<N> {
            stiffness: stiffness(stiff),
            static_reach: compliance(fixed),
            kinetic_reach: compliance(kinetic),
        };
        let pressed = s.bits(3).cast_signed() * 16;
        let up = Direction::along(2, false);
        let home = [1, -1, 0];
        let slid = s.bool();
        let mut state = FrictionState::default();
        let _ = law.tick(&mut state, &touch(home, up, 1), force(pressed.max(1)));
        assert!(place_bits(state.stretch) == [0; 3] && !state.sliding);
        state.sliding = slid;
        let at = [8 * signed(s, 4), 8 * signed(s, 3), 0];
        let pull = law.tick(&mut state, &touch(at, up, 1), force(pressed));
        if pressed <= 0 {
            assert_reached!(state == FrictionState::default() && force_bits(pull) == [0; 3]);
            return;
        }
        let reach = |bits: i64| N::of_signal((compliance(bits) * force(pressed)).0);
        let z = less(at, home);
        let long = |than: i64| squares(z) > than * than;
        let slides = slid || long(reach(fixed));
        let stretch = place_bits(state.stretch);
        if slides && long(reach(kinetic)) {
            assert!(squares(stretch) <= reach(kinetic) * reach(kinetic) && state.sliding);
            let shorter = stretch.iter().zip(z).all(|(cut, z)| cut.abs() <= z.abs() && cut * z >= 0);
            assert!(shorter);
            // At most three steps of the format are lost per axis, and the stretch keeps its direction.
            let lost = (reach(kinetic) - 5).max(0);
            let turned = stretch[0] * z[1] - stretch[1] * z[0];
            assert!(turned.abs() <= 3 * (z[0].abs() + z[1].abs()));
            assert_reached!(squares(stretch) >= lost * lost);
        } else {
            assert!(stretch == z);
            assert_reached!(state.sliding == (slides && long(reach(kinetic) * 3 / 4)));
        }
        let expected = stretch.map(|z| -N::of_signal((stiffness(stiff) * position(z)).towards_zero().0));
        assert!(force_bits(pull) == expected);
        let hold = state.contact;
        let Some(hold) = hold else {
            panic!("nothing is held");
        };
        assert!(less(at, place_bits(hold.anchor)) == stretch && place_bits(hold.last) == at && hold.normal == up);
        cover!(s, slides && !slid, "lets go");
        cover!(s, slid && !state.sliding, "holds again");
        cover!(s, !slides && z != [0; 3] && force_bits(pull) != [0; 3], "sticks");
    }
}
property! {
    /// P4 (geometry): where the surface turns, the stretch of friction (distance from its anchor) is turned into the new tangent
    /// plane and does not get longer; the anchor follows.
    equation "|z'| <= |z|, z' = z - (n·z) n to 3 quanta, z' = x - anchor' to 3 quanta"
    over "normals of 3 bits along two axes, a stretch of 4 bits along two axes, four times as large, the HIP at rest"
    by sampled fn p4_friction_turns(s) {
        let Some(normal) = Direction::of(vector([signed(s, 3), 0, signed(s, 3)])) else {
            return;
        };
        let law = Friction::<N> {
            stiffness: stiffness(8),
            static_reach: compliance(127),
            kinetic_reach: compliance(127),
        };
        let up = Direction::along(2, false);
        let mut state = FrictionState::default();
        let _ = law.tick(&mut state, &touch([0; 3], up, 1), force(127));
        let at = [4 * signed(s, 4), 4 * signed(s, 4), 0];
        let _ = law.tick(&mut state, &touch(at, up, 1), force(127));
        let before = place_bits(state.stretch);
        let _ = law.tick(&mut state, &touch(at, normal, 1), force(127));
        let after = place_bits(state.stretch);
        assert!(squares(after) <= squares(before));
        let inner: i64 = parts(&normal).iter().zip(before).map(|(n, z)| n * z).sum();
        for i in 0..3 {
            let exact = before[i] * ONE * ONE - inner * parts(&normal)[i];
            assert_reached!((after[i] * ONE * ONE - exact).abs() <= 3 * ONE * ONE);
        }
        assert!(normal != up || after == before);
        let hold = state.contact.map(|hold| (place_bits(hold.anchor), hold.normal));
        let Some((anchor, of)) = hold else {
            panic!("nothing is held");
        };
        let left = less(at, anchor);
        // The anchor is turned into the plane, and so is the stretch: each loses up to two steps of the format per axis.
        assert!(of == normal && less(left, after).iter().all(|x| x.abs() <= 3));
        // On a surface that does not turn, the anchor stays bit for bit.
        let aside = [at[0] + 1, at[1], 0];
        let _ = law.tick(&mut state, &touch(aside, normal, 1), force(127));
        assert!(state.sliding || state.contact.is_some_and(|hold| place_bits(hold.anchor) == anchor));
        cover!(s, after != before && squares(after) > 0, "shortened");
    }
}
