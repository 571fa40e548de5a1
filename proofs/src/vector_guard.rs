//! Properties of the energy guard on three axes: its energy account is the sum over three axes, and the account covers its force.
//!
//! At 32 bits they run in random tests: products on three axes are beyond the solvers even at 8 bits. At 8 bits all inputs of
//! one configuration per property are tried (`cargo xtask prove --every vector_guard`).
//!
//! `B` is the energy in the account, `C` the most that it holds, `R` the reserve, `F` the force vector, `D` the largest
//! displacement plus an encoder count. `s` is the longer of the last two forces, `o` the energy charged at overspeed per squared
//! force, `1` one step of the position format, and `q` the distance charged per change of force.
//!
//! ```text
//! B' = max(min(sum of three axes, C), R)   p1_vector_account
//! |F| <= (B' - R)/D, same direction        p1_vector_account
//! over-speed: B - s (o s + 1)              p1_vector_account
//! ```

use crate::format::Format;
use crate::objects::{position, signed, vector};
use crate::source::Source;
use crate::space::{force_bits, forces, position_bits, positions, squares};
use crate::valid::Valid;
use crate::{assume, cover, property};
use touchstone_control::guard::Overspeed;
use touchstone_control::space::{Spatial, Vector, VectorGuard, VectorGuardState};
use touchstone_control::{
    Compliance, Energy, Fixed8, Fixed32, Force, Guard, Number, Position, Ratio, Stiffness,
};

/// Inputs of one tick of a guard on three axes: the hand's motion, its part before the force changed, and the requested force.
struct Tick<N: Format + Spatial> {
    moved: Vector<Position<N>>,
    before_change: Vector<Position<N>>,
    wanted: Vector<Force<N>>,
}

const fn wide(x: i64) -> i128 {
    x as i128
}
fn energy<N: Format>(e: Energy<N>) -> i128 {
    wide(N::of_energy(e.0))
}
fn length<N: Format>(x: Position<N>) -> i128 {
    wide(N::of_signal(x.0))
}
fn sum_of_squares(v: [i64; 3]) -> i128 {
    v.iter().map(|x| wide(*x) * wide(*x)).sum()
}
/// The square root, rounded up.
fn root_up(square: i128) -> i128 {
    let root = square.isqrt();
    root + i128::from(root * root < square)
}
/// Energy that the trusted damping dissipated over a displacement, whose length is uncertain by an encoder count and a step of the
/// number format.
fn damped<N: Format>(law: &Guard<N>, moved: [i64; 3]) -> i128 {
    let surely = (root_up(sum_of_squares(moved)) - length(law.count) - 1).max(0);
    ((wide(N::of_gain(law.damping.0)) * surely) >> N::GAIN_BITS) * surely
}
/// Most energy that a force of this size may still cost after the next sample, which the guard keeps in reserve.
fn reserve<N: Format>(law: &Guard<N>, size: Force<N>) -> i128 {
    wide(N::of_signal(size.0)) * length(law.in_flight)
}

/// The exact sum of the energy account over three axes, without the energy that the damping dissipates.
fn booked<N: Format + Spatial>(
    law: &Guard<N>,
    before: &VectorGuardState<N>,
    tick: &Tick<N>,
) -> i128 {
    let (f, older) = (force_bits(before.against), force_bits(before.older));
    let (x, early) = (position_bits(tick.moved), position_bits(tick.before_change));
    let late = wide(N::of_signal_ratio(law.late.0));
    let stray = wide(N::of_signal_ratio(law.stray.0));
    let mut sum = energy(before.account) + energy(law.refill);
    for i in 0..3 {
        let (change, on) = (wide(f[i]) - wide(older[i]), wide(x[i]) - wide(early[i]));
        let under = wide(early[i]) + ((late * on + stray * change) >> N::SIGNAL_BITS);
        sum += wide(f[i]) * wide(x[i]) - change * under - change.abs() * length(law.slack);
    }
    sum
}

/// Whether a tick of the guard on three axes follows the equations of this file.
fn is_as_said<N: Format + Spatial>(
    guard: &VectorGuard<N>,
    before: &VectorGuardState<N>,
    tick: &Tick<N>,
    after: &VectorGuardState<N>,
    answer: Result<Vector<Force<N>>, Overspeed>,
) {
    let law = &guard.of_length;
    let furthest = length(law.furthest).pow(2);
    let moved = position_bits(tick.moved);
    let cleared = |account: i128| {
        energy(after.account) == account
            && *after
                == VectorGuardState {
                    account: after.account,
                    ..VectorGuardState::default()
                }
    };
    if sum_of_squares(moved) > furthest
        || sum_of_squares(position_bits(tick.before_change)) > furthest
    {
        // The energy that the hand can have gained by the last force and by the one that still acts.
        let older = root_up(sum_of_squares(force_bits(before.older)));
        let size = wide(N::of_signal(before.size.0)).max(older);
        let over = (wide(N::of_signal_ratio(law.overrun.0)) * size) >> N::SIGNAL_BITS;
        let way = (over + 1).min(wide(N::of_signal(N::HIGHEST)));
        assert_reached!(answer == Err(Overspeed) && cleared(energy(before.account) - size * way));
        return;
    }
    let Ok(force) = answer else {
        panic!("no overspeed");
    };
    let refilled = energy(law.refill) + damped(law, moved);
    if before.account < Energy::zero() {
        // With an energy deficit the force is 0.
        assert!(force_bits(force) == [0; 3]);
        assert_reached!(cleared(
            (energy(before.account) + refilled).min(energy(law.capacity))
        ));
        return;
    }
    let kept = reserve(law, before.size);
    let sum = booked(law, before, tick) + damped(law, moved);
    assert!(energy(after.account) == sum.min(energy(law.capacity)).max(kept));
    // The force is no longer than the account covers, and no component grows or changes its sign.
    let free = energy(after.account) - kept;
    let limit = (wide(N::of_gain(law.per_reach.0)) * (free >> N::SIGNAL_BITS)) >> N::GAIN_BITS;
    let shown = force_bits(force);
    assert!(sum_of_squares(shown) <= limit * limit);
    let wanted = force_bits(tick.wanted);
    let smaller = shown
        .iter()
        .zip(wanted)
        .all(|(a, b)| a.abs() <= b.abs() && (*a == 0 || (*a < 0) == (b < 0)));
    assert!(smaller);
    let long = root_up(sum_of_squares(wanted));
    assert!(long > limit || force == tick.wanted);
    // If the force was shortened, each axis is right to three steps of the format.
    assert!(long <= limit || sum_of_squares(shown) >= (limit - 6).max(0).pow(2));
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let turned = wide(shown[i]) * wide(wanted[j]) - wide(shown[j]) * wide(wanted[i]);
        assert_reached!(turned.abs() <= 3 * wide(wanted[i].abs() + wanted[j].abs()));
    }
    assert!(after.against == -force && after.older == before.against);
    assert_reached!(sum_of_squares(shown) <= wide(N::of_signal(after.size.0)).pow(2));
}

/// The properties at 32 bits, the width of the firmware, in random tests.
pub mod w32 {
    use super::*;
    type N = Fixed32;

    /// A configuration that the guard's constructor can give, and a memory within its limits.
    fn any<S: Source>(s: &mut S) -> Option<(VectorGuard<N>, VectorGuardState<N>)> {
        let mut of_length = None;
        for _ in 0..200 {
            let guard = Guard::<N>::any(s);
            if guard.valid() {
                of_length = Some(guard);
                break;
            }
        }
        let guard = VectorGuard::of(of_length?);
        let most = guard.of_length.largest_force(guard.of_length.capacity);
        let account = N::any_energy(s);
        let force = |s: &mut S| forces::<N, S>(s).within(most);
        let (against, older) = (force(s), force(s));
        let account = if account >= Energy::zero() {
            account.min(guard.of_length.capacity)
        } else {
            Energy::zero()
        };
        let state = VectorGuardState {
            account,
            against,
            older,
            size: against.length_up().min(most),
        };
        Some((guard, state))
    }

    property! {
        /// P1 (energy): the account of the guard on three axes is the exact sum over the axes, with the damping of the
        /// displacement's length. The account covers the force. The force is never longer than the requested one and has its
        /// direction.
        equation "B' = max(min(B + P T + Σ (f Δ - g u - |g| q) + c m m, C), R), |F| <= (B' - R)/D"
        over "valid configuration, memory in the invariant, displacement, wanted force"
        by sampled fn p1_vector_account(s) {
            let Some((guard, before)) = any(s) else {
                assume!(s, false, "Guard::new");
                return;
            };
            let furthest = guard.of_length.furthest;
            let tick = Tick {
                moved: positions::<N, S>(s).within(furthest),
                before_change: Vector::default(),
                wanted: forces::<N, S>(s),
            };
            let mut state = before;
            let answer = guard.tick(&mut state, tick.moved, tick.wanted);
            is_as_said(&guard, &before, &tick, &state, answer);
            let wanted = squares::<N>(force_bits(tick.wanted));
            cover!(s, state.account < before.account, "paid");
            cover!(s, answer.is_ok_and(|force| force_bits(force) != [0; 3] && squares::<N>(force_bits(force)) < wanted), "shortened");
            cover!(s, damped(&guard.of_length, position_bits(tick.moved)) > 0, "damped");
        }
    }
}

/// The properties at 8 bits, of which all inputs are tried.
pub mod w8 {
    use super::*;
    type N = Fixed8;

    fn force(x: i64) -> Force<N> {
        Force(position(x).0)
    }
    /// A vector along two axes only, so that few enough inputs remain to try all.
    fn flat<S: Source>(s: &mut S, width: u32, by: i64) -> [i64; 3] {
        [by * signed(s, width), 0, by * signed(s, width)]
    }
    fn as_force(v: [i64; 3]) -> Vector<Force<N>> {
        Vector(v.map(force))
    }
    /// A guard that `Guard::new` could give, for a device with a delay, with every coefficient in use.
    pub(crate) fn guard() -> VectorGuard<N> {
        let of_length = Guard::<N> {
            capacity: Energy(<N as Number>::Energy::from_bits(900)),
            refill: Energy(<N as Number>::Energy::from_bits(7)),
            damping: Stiffness(<N as Number>::Gain::from_bits(9)),
            furthest: position(9),
            count: position(1),
            late: Ratio(<N as Number>::Ratio::from_bits(40)),
            stray: Compliance(<N as Number>::Ratio::from_bits(30)),
            slack: position(1),
            per_reach: Stiffness(<N as Number>::Gain::from_bits(20)),
            in_flight: position(3),
            overrun: Compliance(<N as Number>::Ratio::from_bits(50)),
        };
        VectorGuard::of(of_length)
    }
    /// A memory within the guard's limits, or one with an energy deficit.
    fn memory<S: Source>(s: &mut S, guard: &VectorGuard<N>) -> VectorGuardState<N> {
        let account = Energy(<N as Number>::Energy::from_bits(
            (150 * signed(s, 4)) as i16,
        ));
        if account < Energy::zero() {
            return VectorGuardState {
                account,
                ..VectorGuardState::default()
            };
        }
        let against = as_force(flat(s, 3, 4));
        let older = as_force([0, 4 * signed(s, 2), 3]);
        let size = against.length_up();
        let most = guard.of_length.largest_force(guard.of_length.capacity);
        VectorGuardState {
            account: account
                .min(guard.of_length.capacity)
                .max(guard.of_length.reserve(size.min(most))),
            against: if size <= most {
                against
            } else {
                Vector::default()
            },
            older,
            size: if size <= most { size } else { Force::zero() },
        }
    }

    property! {
        /// P1 (energy): the account of the guard on three axes is the exact sum over the axes, with the damping of the
        /// displacement's length. The account covers the force, which is never longer than the requested one and has its direction.
        /// Overspeed is charged with what the acting forces can have lost. With a deficit the force is 0.
        equation "B' = max(min(B + P T + Σ (f Δ - g u - |g| q) + c m m, C), R), |F| <= (B' - R)/D"
        over "one configuration; accounts of 4 bits, forces of 3 bits along two axes, older ones of 2, displacements of 4 and 3 bits, wanted forces of 2 bits"
        by sampled fn p1_vector_account(s) {
            let guard = guard();
            let before = memory(s, &guard);
            let tick = Tick {
                moved: vector([signed(s, 4), 0, 3 * signed(s, 3)]),
                before_change: Vector::default(),
                wanted: as_force(flat(s, 2, 9)),
            };
            let mut state = before;
            let answer = guard.tick(&mut state, tick.moved, tick.wanted);
            is_as_said(&guard, &before, &tick, &state, answer);
            cover!(s, answer == Err(Overspeed), "overspeed");
            cover!(s, before.account < Energy::zero() && state.account > before.account, "a deficit");
            cover!(s, state.account < before.account, "paid");
            cover!(s, answer.is_ok_and(|force| force != tick.wanted && force_bits(force) != [0; 3]), "shortened");
        }
    }
    property! {
        /// P1 (energy): if the position was also read when the force changed, the guard counts the motion before the change under
        /// the older force alone.
        equation "u = b + floor(late (Δ - b) + stray g)"
        over "one configuration; accounts of 4 bits, forces of 3 bits along two axes, older ones of 2, both parts of a displacement of 2 bits an axis"
        by sampled fn p1_vector_change(s) {
            let guard = guard();
            let before = memory(s, &guard);
            let tick = Tick {
                moved: vector(flat(s, 2, 4)),
                before_change: vector([5 * signed(s, 2), signed(s, 2), 0]),
                wanted: as_force([0, 0, 9]),
            };
            let mut state = before;
            let answer = guard.tick_with_change(&mut state, tick.moved, tick.before_change, tick.wanted);
            is_as_said(&guard, &before, &tick, &state, answer);
            cover!(s, answer == Err(Overspeed), "overspeed before the change");
            cover!(s, answer.is_ok_and(|force| force != tick.wanted), "shortened");
        }
    }
    property! {
        /// P9 (end of positions): if any coordinate is within two largest displacements of the end of positions, the guard's force
        /// is 0, and a requested force is refused. Elsewhere the place has no effect on the tick.
        equation "|x_i| >= end - 2 d: 0, and Err where F ≠ 0"
        over "one configuration; every coordinate of 8 bits, along each axis, displacements of 2 bits along two axes, wanted forces of 2 bits"
        by sampled fn p9_no_force_at_the_end(s) {
            let guard = guard();
            let mut at = [0; 3];
            at[(s.bits(2) % 3) as usize] = signed(s, 8);
            let (moved, wanted) = (vector(flat(s, 2, 4)), as_force(flat(s, 2, 3)));
            let before = VectorGuardState { against: as_force([3, 0, -4]), size: force(5), ..guard.full() };
            let (mut state, mut other) = (before, before);
            let answer = guard.tick_at(&mut state, vector(at), moved, wanted);
            // The end at 127 minus two largest displacements of 9.
            let ends = at.iter().any(|x| x.abs() >= 127 - 18) && wanted != Vector::default();
            let shown = if ends { Vector::default() } else { wanted };
            let expected = guard.tick(&mut other, moved, shown);
            assert!(state == other && answer == if ends { Err(Overspeed) } else { expected });
            assert!(guard.full() == VectorGuardState { account: guard.of_length.capacity, ..VectorGuardState::default() });
            cover!(s, ends && at[1] < 0, "at an end");
        }
    }
    property! {
        /// P4 (limits): a reported force that is at most the guard's becomes the force that the account counts; a larger one counts
        /// as the guard's.
        equation "|F| <= s: against = -F, s' = |F| up"
        over "forces of 4 bits along two axes, sizes of 4 bits"
        by sampled fn p4_vector_commanded(s) {
            let guard = guard();
            let size = s.bits(4).cast_signed();
            let before = VectorGuardState { against: as_force([1, 0, 0]), size: force(size), ..guard.full() };
            let told = flat(s, 4, 1);
            let mut state = before;
            guard.commanded(&mut state, as_force(told));
            let up = root_up(sum_of_squares(told));
            let expected = if up <= wide(size) {
                VectorGuardState { against: as_force(told.map(|x| -x)), size: force(up as i64), ..before }
            } else {
                before
            };
            assert!(state == expected);
            cover!(s, state != before, "smaller");
            cover!(s, state == before, "larger");
        }
    }

    /// Checks that `Guard::new` could give the guard that the properties at 8 bits use.
    #[cfg(all(test, not(kani)))]
    #[test]
    fn the_configuration_is_valid() {
        assert_reached!(guard().of_length.valid());
    }
}
