//! What stands between an object and a law at 8 bits: displacement along a normal, the surface point, friction, the shells of three axes.
//!
//! All inputs of each are tried (`cargo xtask prove --every shells`).
//!
//! ```text
//! m = -n'·(x - x'), rounded down, or e - e' where n = n'    p4_displacement
//! turned by no more than the cone                           p4_point_restricted
//! z = x - anchor, cut to what the normal force holds        p4_friction_sticks_and_slides
//! F = n f(e, m)                                             p4_magnitude_is_the_law
//! F_i = ± f_i(|n_i| e, ..)                                  p4_per_axis_is_three_laws
//! E' = E - F·Δ + c |Δ|², |F| = min(k e, limit, bound(E'))   p1_bounding_is_the_sum
//! F = guard(limit(shell + friction))                       p4_wall_is_its_parts
//! ```

use crate::format::Format;
use crate::objects::{N, ONE, bits, direction, parts, position, signed, squares, vector};
use crate::{assume, cover, property};
use touchstone_control::law::{Fba, Sample, Spring, SpringState};
use touchstone_control::space::environment::{Cuboid, Sphere};
use touchstone_control::space::{
    Along, Bounding, Direction, Friction, FrictionState, Held, Leaving, Magnitude, Nearest,
    PerAxis, Rule, Shell, SpaceWall, Surface, SurfacePoint, Touch, Track, Turn, Vector,
};
use touchstone_control::{AnyLaw, Compliance, Energy, Force, Number, Position, Stiffness};

fn force(bits: i64) -> Force<N> {
    Force(position(bits).0)
}
fn stiffness(bits: i64) -> Stiffness<N> {
    Stiffness(<N as Number>::Gain::from_bits(bits as i8))
}
fn compliance(bits: i64) -> Compliance<N> {
    Compliance(<N as Number>::Ratio::from_bits(bits as i8))
}
fn force_bits(v: Vector<Force<N>>) -> [i64; 3] {
    v.0.map(|x| N::of_signal(x.0))
}
fn place_bits(v: Vector<Position<N>>) -> [i64; 3] {
    v.0.map(bits)
}
/// `floor(u·v)`.
fn along(u: &Direction<N>, v: [i64; 3]) -> i64 {
    let ([a, b, c], [x, y, z]) = (parts(u), v);
    (a * x + b * y + c * z).div_euclid(ONE)
}
fn less([x, y, z]: [i64; 3], [a, b, c]: [i64; 3]) -> [i64; 3] {
    [x - a, y - b, z - c]
}
fn touch(at: [i64; 3], normal: Direction<N>, depth: i64) -> Touch<N> {
    Touch {
        at: vector(at),
        normal,
        depth: position(depth),
        moved: None,
    }
}

property! {
    /// P4: what a law is told to have moved is the part of the displacement along the normal of the last tick, rounded down; on a surface that did not
    /// turn the change of the penetration, where both are the same but for rounding; an estimated displacement is taken along the same normal.
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
        // As of one degree of freedom: from the surface.
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
    /// P4: the closest surface point is the object's, seen from the side of the last tick.
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
    /// P4: by the point of penetration the way out is that to where the HIP came in, until it has left.
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
                assert!(told == Touch::measured(vector(at), nearest));
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
    /// P4: the restricted surface point is the closest one where that lies in the cone; else the direction turns by the cone's angle at most, to what
    /// 8 bits say of it, and leads out of the object.
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
                assert!(told == Touch::measured(at, nearest));
                continue;
            };
            let cosine = N::of_signal(turn.cosine);
            if along(&last, parts(&nearest.normal)) >= cosine {
                assert!(told == Touch::measured(at, nearest));
            } else {
                let turned = along(&last, parts(&told.normal));
                assert!(turned >= cosine - 6);
                let size = squares(parts(&told.normal));
                assert!(size <= ONE * ONE && size >= (ONE - 8) * (ONE - 8));
                // Out of a ball there is no other way to ask for than the one towards its closest point, by the whole angle.
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
    /// P4: friction sticks to its anchor while the stretch is within what the normal force holds, slides cut to the kinetic part of it, holds again
    /// below three quarters of that, and pulls against the stretch; without a normal force nothing is kept.
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
            assert!(state == FrictionState::default() && force_bits(pull) == [0; 3]);
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
            // No more than three quanta an axis is lost, and it points as it did.
            let lost = (reach(kinetic) - 5).max(0);
            let turned = stretch[0] * z[1] - stretch[1] * z[0];
            assert!(turned.abs() <= 3 * (z[0].abs() + z[1].abs()));
            assert!(squares(stretch) >= lost * lost);
        } else {
            assert!(stretch == z);
            assert!(state.sliding == (slides && long(reach(kinetic) * 3 / 4)));
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
    /// P4: where the surface turns, the stretch of friction is laid into the new tangent plane and is not longer than it was, and the anchor with it.
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
            assert!((after[i] * ONE * ONE - exact).abs() <= 3 * ONE * ONE);
        }
        assert!(normal != up || after == before);
        let hold = state.contact.map(|hold| (place_bits(hold.anchor), hold.normal));
        let Some((anchor, of)) = hold else {
            panic!("nothing is held");
        };
        let left = less(at, anchor);
        // Laid once into the plane for the anchor and once more for the stretch: two quanta an axis each.
        assert!(of == normal && less(left, after).iter().all(|x| x.abs() <= 3));
        // On a surface that does not turn the anchor stays, to the bit.
        let aside = [at[0] + 1, at[1], 0];
        let _ = law.tick(&mut state, &touch(aside, normal, 1), force(127));
        assert!(state.sliding || state.contact.is_some_and(|hold| place_bits(hold.anchor) == anchor));
        cover!(s, after != before && squares(after) > 0, "shortened");
    }
}

/// A spring that is never at its limit.
fn spring(stiff: i64) -> Held<N, Spring<N>> {
    Held::new(Spring {
        desired: stiffness(stiff),
        damping: stiffness(0),
        limit: force(127),
    })
}

property! {
    /// P4: one law along the normal is that law, told penetration and displacement, and its force points out.
    equation "F = n f(e, m)"
    over "stiffness of 3 bits, normals of 3 bits an axis, depths of 5 bits"
    by sampled fn p4_magnitude_is_the_law(s) {
        let Some(normal) = direction(s, 3) else {
            return;
        };
        let (stiff, depth) = (8 * s.bits(3).cast_signed(), signed(s, 5));
        let mut shell = Magnitude::new(spring(stiff));
        let mut of_shell = Shell::Magnitude(shell);
        let touched = touch([0; 3], normal, depth);
        let told = shell.tick(&touched);
        let mut law = spring(stiff);
        let size = law.tick(Sample { e: position(depth), moved: Position::zero() });
        assert!(told == normal.times_force(size) && of_shell.tick(&touched) == told);
        assert!(shell.law == law && law.touches() == (depth > 0));
        // The second tick is told how far the HIP has moved along the normal of the first.
        let mut damped = spring(stiff);
        damped.law.damping = stiffness(40);
        let mut shell = Magnitude::new(damped);
        let _ = shell.tick(&touched);
        let deeper = Sample::measured(position(depth + 2), position(depth));
        let there = less([0; 3], place_bits(normal.times(position(2))));
        let then = touch(there, normal, depth + 2);
        let expected = damped.tick(deeper);
        assert!((along(&normal.opposite(), there) - 2).abs() > 2 || shell.tick(&then) == normal.times_force(expected));
        // Chosen at run time it is the same law.
        let mut any = AnyLaw::Spring(law.law, SpringState::default());
        let same = Sample { e: position(depth), moved: Position::zero() };
        assert!(Along::tick(&mut any, same) == size && any.touches() == law.touches());
        Along::reset(&mut any);
        assert!(!any.touches());
        law.reset();
        assert!(law.state == SpringState::default() && !law.touches());
        cover!(s, force_bits(told)[0] < 0, "pushes against x");
    }
}
property! {
    /// P4: a law an axis is told the size of its part of the penetration, with a minus outside, and pushes to the side of the surface.
    equation "F_i = ± f_i(|n_i| e)"
    over "stiffness of 2 bits an axis, normals of 3 bits an axis, depths of 5 bits, from outside at rest"
    by sampled fn p4_per_axis_is_three_laws(s) {
        let Some(normal) = direction(s, 3) else {
            return;
        };
        let stiff = [(); 3].map(|()| 16 * s.bits(2).cast_signed());
        let depth = signed(s, 5);
        let leaving = [Leaving::Decoupled, Leaving::AnyAxis, Leaving::Projection, Leaving::default()][s.bits(2) as usize];
        let mut shell = PerAxis::new(stiff.map(spring), leaving);
        let mut of_shell = Shell::PerAxis(shell);
        let touched = touch([0; 3], normal, depth);
        let told = shell.tick(&touched);
        assert!(of_shell.tick(&touched) == told);
        for i in 0..3 {
            let part = parts(&normal)[i];
            // Towards zero.
            let e = part.abs() * depth / ONE;
            let mut law = spring(stiff[i]);
            let size = law.tick(Sample { e: position(e), moved: Position::zero() });
            let size = N::of_signal(size.0);
            assert!(force_bits(told)[i] == if part < 0 { -size } else { size });
        }
        cover!(s, force_bits(told).iter().all(|f| *f < 0), "against all axes");
    }
}

property! {
    /// P4: each of three laws is told its part of the displacement along the normal of the last tick: on a surface that does not turn the change of its own
    /// penetration, to the bit.
    equation "m_i = e_i - e_i'; |n_i'| m where the surface turned or the closest point jumped"
    over "normals of 3 bits along two axes, depths of 4 bits, places of 3 bits along two axes; turned or not"
    by sampled fn p4_per_axis_is_told_its_part(s) {
        let Some(normal) = Direction::of(vector([signed(s, 3), 0, signed(s, 3)])) else {
            return;
        };
        let damped = |_: usize| {
            let mut law = spring(24);
            law.law.damping = stiffness(40);
            law
        };
        let mut shell = PerAxis::new([0, 1, 2].map(damped), Leaving::Decoupled);
        let (was, depth) = (signed(s, 4), signed(s, 4));
        let at = [signed(s, 3), 0, signed(s, 3)];
        let now = if s.bool() { Direction::along(2, true) } else { normal };
        let turned = now != normal;
        let _ = shell.tick(&touch([0; 3], normal, was));
        let told = shell.tick(&touch(at, now, depth));
        let part = |u: i64, length: i64| u.abs() * length / ONE;
        let inwards = along(&normal.opposite(), at);
        let straight = !turned && (depth - was - inwards).abs() <= 2;
        for i in 0..3 {
            let (before, after) = (parts(&normal)[i], parts(&now)[i]);
            let e = part(after, depth);
            let moved = if straight { e - part(before, was) } else { part(before, inwards) };
            let size = damped(i).tick(Sample { e: position(e), moved: position(moved) });
            let size = N::of_signal(size.0);
            // A component of 0 keeps the side that it had.
            let negative = if after == 0 { before < 0 } else { after < 0 };
            assert!(force_bits(told)[i] == if negative { -size } else { size });
        }
        cover!(s, straight && depth != was && depth > 0, "straight in");
        cover!(s, turned && depth > 0 && inwards != 0, "turned");
    }
}
property! {
    /// P1: the energy of vector force bounding is the exact sum of what the force took along the displacement and of what the damping took, and its force
    /// is the spring's, as far as limit and energy allow, along the normal; it begins anew outside.
    equation "E' = min(E - F·Δ + c Σ Δ_i², cap); |F| = min(k e, limit, bound sqrt E')"
    over "three places of 2 bits along two axes and of 1 along the third, depths of 2 bits, normals of 2 bits along two axes, two dampings"
    by sampled fn p1_bounding_is_the_sum(s) {
        let Some(normal) = Direction::of(vector([signed(s, 2), 0, signed(s, 2)])) else {
            return;
        };
        let cap = if s.bool() { 64 } else { 1 << 13 };
        let damping = if s.bool() { 120 } else { 9 };
        let law = Fba::<N> {
            desired: stiffness(127),
            device_damping: stiffness(damping),
            bound: stiffness(30),
            limit: force(20),
            energy_cap: Energy(<N as Number>::Energy::from_bits(cap)),
        };
        let mut shell = Bounding::new(law);
        let energy = |e: Energy<N>| N::of_energy(e.0);
        let (mut sum, mut last, mut pull) = (0, None, [0; 3]);
        for _ in 0..3 {
            let (at, depth) = ([signed(s, 2), signed(s, 2), -signed(s, 1)], signed(s, 2));
            let told = shell.tick(&touch(at, normal, depth));
            let way = less(at, last.unwrap_or(at));
            last = Some(at);
            if depth <= 0 {
                assert!(told == Vector::default() && energy(shell.energy()) == 0);
                (sum, pull) = (0, [0; 3]);
                continue;
            }
            // Of the damping as stored, with 3 digits, rounded down once.
            let loss = |x: i64| (damping * x.abs() >> 3) * x.abs();
            for i in 0..3 {
                sum += loss(way[i]) - pull[i] * way[i];
            }
            sum = sum.min(i64::from(cap));
            assert!(energy(shell.energy()) == sum);
            let wanted = (127 * depth >> 3).min(20);
            let size = wanted.min(30 * sum.max(0).isqrt() >> 3);
            assert!(told == normal.times_force(force(size)));
            pull = force_bits(told);
            cover!(s, size < wanted && size > 0, "bounded");
            cover!(s, sum == 64, "at the cap");
            cover!(s, size == wanted && sum > 0, "as wanted");
        }
    }
}

property! {
    /// P4: a wall of three axes is its parts one after the other: the surface point, the law, friction under what presses along the normal, the limit,
    /// and the guard, which is told how the HIP moved and what was commanded in the end.
    equation "F = guard(limit(shell(touch) + friction(touch, n·F)))"
    over "a box; two places of 4 and 3 bits along two axes, limits of 3 bits; with and without friction, guard, a later change"
    by sampled fn p4_wall_is_its_parts(s) {
        let (with_friction, with_guard, changed) = (s.bool(), s.bool(), s.bool());
        let limit = force(4 + 8 * s.bits(3).cast_signed());
        let body = Cuboid { centre: vector([0; 3]), half: vector([6, 5, 7]) };
        let mut point = SurfacePoint::new(Rule::Closest);
        let mut shell = Shell::Magnitude(Magnitude::new(spring(80)));
        let mut wall = SpaceWall::new(body, point, shell, limit);
        let law = Friction::<N> {
            stiffness: stiffness(40),
            static_reach: compliance(60),
            kinetic_reach: compliance(40),
        };
        let mut friction = with_friction.then(|| (law, FrictionState::default()));
        let mut guard = with_guard.then(|| (crate::vector_guard::w8::guard(), crate::vector_guard::w8::guard().full()));
        (wall.friction, wall.guard) = (friction, guard);
        let mut last = None;
        for _ in 0..2 {
            let at = vector([signed(s, 4), 0, signed(s, 3)]);
            let told = wall.tick(at);
            let touched = point.tick(&body, at);
            let mut pull = shell.tick(&touched);
            if let Some((law, state)) = &mut friction {
                let pressed = force(along(&touched.normal, force_bits(pull)));
                pull = pull + law.tick(state, &touched, pressed);
            }
            let pull = pull.within(limit);
            let way = less(place_bits(at), place_bits(last.unwrap_or(at)));
            last = Some(at);
            let expected = match &mut guard {
                Some((guard, state)) => guard.tick_at(state, at, vector(way), pull),
                None => Ok(pull),
            };
            assert!(told == expected && wall.friction == friction && wall.guard == guard);
            if changed {
                wall.commanded(Vector::default());
                if let Some((guard, state)) = &mut guard {
                    guard.commanded(state, Vector::default());
                }
                assert!(wall.guard == guard);
            }
            cover!(s, told.is_err(), "overspeed");
            cover!(s, told.is_ok_and(|told| squares(force_bits(told)) > 0 && told != pull), "guarded");
            cover!(s, pull != Vector::default() && pull.is_longer(limit - Force::quantum()), "at the limit");
        }
    }
}
