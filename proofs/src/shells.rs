//! Properties at 8 bits of the laws on three axes (shells), and of the wall that is made of them.
//!
//! All inputs of each are tried (`cargo xtask prove --every shells`). `F` is the force vector, `n` the normal, `e` the penetration,
//! `m` and `Δ` the displacement, `E` the energy, `c` the damping per tick.
//!
//! ```text
//! F = n f(e, m)                                             p4_magnitude_is_the_law
//! F_i = ± f_i(|n_i| e, ..)                                  p4_per_axis_is_three_laws
//! E' = E - F·Δ + c |Δ|², |F| = min(k e, limit, bound(E'))   p1_bounding_is_the_sum
//! F = guard(limit(shell + friction))                       p4_wall_is_its_parts
//! ```

use crate::contact::{along, compliance, force, force_bits, less, place_bits, stiffness, touch};
use crate::format::Format;
use crate::objects::{N, ONE, direction, parts, position, signed, squares, vector};
use crate::{cover, property};
use touchstone_control::law::{Contact, Fba, Sample, Spring, SpringState, View};
use touchstone_control::space::environment::Cuboid;
use touchstone_control::space::{
    Along, Bounding, Direction, Friction, FrictionState, Held, Leaving, Magnitude, PerAxis, Rule,
    Shell, SpaceWall, SurfacePoint, Vector,
};
use touchstone_control::{AnyLaw, Energy, Force, Number, Position};

/// A spring whose force never reaches its limit, with the given stiffness.
fn spring(stiff: i64) -> Held<N, Spring<N>> {
    Held::new(Spring {
        desired: stiffness(stiff),
        damping: stiffness(0),
        limit: force(127),
    })
}

/// A law for tests that pushes with the smallest force above 0 everywhere.
#[derive(Debug, Clone, Copy)]
struct Pushes;

impl Along<N> for Pushes {
    fn tick(&mut self, _: Sample<N>) -> Force<N> {
        force(1)
    }
    fn view(&self) -> View<N> {
        View {
            contact: Contact::Free,
            energy: None,
            offset: Position::zero(),
            mass: None,
        }
    }
    fn reset(&mut self) {}
}

property! {
    /// P4 (geometry): a three-axis law (shell) with one law along the normal passes penetration and displacement to that law, and
    /// its force points out of the object.
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
        // In the second tick the law gets the HIP's displacement along the normal of the first tick.
        let mut damped = spring(stiff);
        damped.law.damping = stiffness(40);
        let mut shell = Magnitude::new(damped);
        let _ = shell.tick(&touched);
        let deeper = Sample::measured(position(depth + 2), position(depth));
        let there = less([0; 3], place_bits(normal.times(position(2))));
        let then = touch(there, normal, depth + 2);
        let expected = damped.tick(deeper);
        assert!((along(&normal.opposite(), there) - 2).abs() > 2 || shell.tick(&then) == normal.times_force(expected));
        // A law that is chosen at run time is the same law.
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
    /// P4 (geometry): a three-axis law (shell) with one law per axis passes to each law the penetration times the absolute value of
    /// the normal's component on that axis; outside, this is negative. Each law pushes towards the surface.
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
        for (i, &stiff) in stiff.iter().enumerate() {
            let part = parts(&normal)[i];
            // Rounded towards zero.
            let e = part.abs() * depth / ONE;
            let mut law = spring(stiff);
            let size = law.tick(Sample { e: position(e), moved: Position::zero() });
            let size = N::of_signal(size.0);
            assert_reached!(force_bits(told)[i] == if part < 0 { -size } else { size });
        }
        // A component of 0 counts as positive, for any force that its law gives there.
        let pushing = PerAxis::new([Pushes; 3], leaving).tick(&touched);
        for (i, part) in parts(&normal).into_iter().enumerate() {
            assert_reached!(force_bits(pushing)[i] == if part < 0 { -1 } else { 1 });
        }
        cover!(s, force_bits(told).iter().all(|f| *f < 0), "against all axes");
    }
}

property! {
    /// P4 (geometry): each of the three laws of a shell gets its part of the displacement along the normal of the last tick. On a
    /// surface that did not turn, that part is the change of the law's own penetration, bit for bit.
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
            // If the new component is 0, the sign of the last tick stays.
            let negative = if after == 0 { before < 0 } else { after < 0 };
            assert_reached!(force_bits(told)[i] == if negative { -size } else { size });
        }
        cover!(s, straight && depth != was && depth > 0, "straight in");
        cover!(s, turned && depth > 0 && inwards != 0, "turned");
    }
}
property! {
    /// P1 (energy): the energy of force bounding on three axes is the exact sum of the force's work along the displacement and of
    /// the energy that damping dissipated. The force is the spring's along the normal, as far as limit and energy allow. Outside
    /// the object the law restarts.
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
                assert_reached!(told == Vector::default() && energy(shell.energy()) == 0);
                (sum, pull) = (0, [0; 3]);
                continue;
            }
            // From the damping as stored, with 3 fractional bits, rounded down once.
            let loss = |x: i64| ((damping * x.abs()) >> 3) * x.abs();
            for i in 0..3 {
                sum += loss(way[i]) - pull[i] * way[i];
            }
            sum = sum.min(i64::from(cap));
            assert!(energy(shell.energy()) == sum);
            let wanted = ((127 * depth) >> 3).min(20);
            let size = wanted.min((30 * sum.max(0).isqrt()) >> 3);
            assert!(told == normal.times_force(force(size)));
            pull = force_bits(told);
            cover!(s, size < wanted && size > 0, "bounded");
            cover!(s, sum == 64, "at the cap");
            cover!(s, size == wanted && sum > 0, "as wanted");
        }
    }
}

property! {
    /// P4 (geometry): a wall on three axes runs its parts in this order: surface point, law, friction under the force along the
    /// normal, limit, guard. The guard gets the hand's motion and the force that was finally commanded.
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
                assert_reached!(wall.guard == guard);
            }
            cover!(s, told.is_err(), "overspeed");
            cover!(s, told.is_ok_and(|told| squares(force_bits(told)) > 0 && told != pull), "guarded");
            cover!(s, pull != Vector::default() && pull.is_longer(limit - Force::quantum()), "at the limit");
        }
    }
}
