//! Properties of the guard as a stage of the controller (`control/src/guard/guarded.rs`). Their subjects are: the displacement that
//! the stage measures; that no motion under a force goes uncounted at the end of positions; that overspeed stays until the stage
//! resumes; and the memory after resuming.
//!
//! `Δ` is the displacement, `e` the measured and `x` the true position, `B` the energy in the account and `C` its capacity.
//!
//! ```text
//! tripped => f = 0, tripped'                 p4_stage_latches
//! Δ = e - e(n-1), none at the first sample   w32::p9_stage_measures
//! f acts => Δ = x - x(n-1), x without end    p9_no_way_uncounted
//! Δ = e - e(n-1), e in 64 bits               w32::p9_stage_without_end
//! resumed: B' = min(B, C'), f = 0            p7_stage_resumes
//! ```

use crate::format::Format;
use crate::guard::room;
use crate::source::Source;
#[cfg(kani)]
use crate::source::Symbolic;
use crate::valid::Valid;
use crate::{cover, property, such};
use fixed::FixedI32;
use fixed::types::I1F7;
use touchstone_control::guard::FURTHEST_ANGLE;
use touchstone_control::{
    Energy, Fixed8, Fixed32, Force, Guard, GuardState, Guarded, Position, Si,
};

#[cfg(kani)]
use core::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};
#[cfg(kani)]
use touchstone_control::guard::Overspeed;

/// Defines a property of the guard's stage that holds for any results of its guard; equal arguments give equal results.
#[macro_export]
macro_rules! staged_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::Guard::tick_with_change, $crate::stage::any_tick)]
            $($property)*
        }
    };
}

/// Replaces [`Guard::tick_with_change`]: any memory and any force or overspeed, and the same for equal arguments. The guard itself
/// is not compared, because there is only one.
#[cfg(kani)]
pub fn any_tick<N: Format>(
    _: &Guard<N>,
    state: &mut GuardState<N>,
    moved: Position<N>,
    before_change: Position<N>,
    wanted: Force<N>,
) -> Result<Force<N>, Overspeed> {
    static ASKED: AtomicBool = AtomicBool::new(false);
    static QUESTION: [AtomicI64; 6] = [const { AtomicI64::new(0) }; 6];
    static ANSWER: [AtomicI64; 5] = [const { AtomicI64::new(0) }; 5];
    let words = |state: &GuardState<N>| {
        let of = |force: Force<N>| N::of_signal(force.0);
        [
            N::of_energy(state.account.0),
            of(state.force),
            of(state.older),
        ]
    };
    let [account, force, older] = words(state);
    let signals = [moved.0, before_change.0, wanted.0].map(N::of_signal);
    let question = [account, force, older, signals[0], signals[1], signals[2]];
    let s = &mut Symbolic;
    let after = GuardState {
        account: N::any_energy(s),
        force: N::any_force(s),
        older: N::any_force(s),
    };
    let (shown, fine) = (N::any_force(s), s.bool());
    let [account, force, older] = words(&after);
    let answer = [account, force, older, N::of_signal(shown.0), fine.into()];
    let asked = ASKED.swap(true, Relaxed);
    let mut same = asked;
    for at in 0..question.len() {
        same &= QUESTION[at].load(Relaxed) == question[at];
        QUESTION[at].store(question[at], Relaxed);
    }
    for at in 0..answer.len() {
        kani::assume(!same | (ANSWER[at].load(Relaxed) == answer[at]));
        ANSWER[at].store(answer[at], Relaxed);
    }
    *state = after;
    if fine { Ok(shown) } else { Err(Overspeed) }
}

/// A guard's stage (guard, memory, last position) with any content; in random tests the memory mostly satisfies the guard's
/// invariant.
pub fn any_stage<N: Format, S: Source>(s: &mut S) -> Guarded<N> {
    let mut stage = Guarded::new(Guard::any(s));
    stage.state = <Guard<N> as Valid<N>>::any_state(s);
    stage.last = s.bool().then(|| N::any_position(s));
    stage.limited = s.bool();
    stage.tripped = s.bool();
    stage
}

/// Whether every force that acts can still end before a displacement reaches the end of the range of positions. Before the first
/// sample no force may act.
fn place_holds<N: Format>(stage: &Guarded<N>) -> bool {
    let before_end = |displacements: i64| {
        let furthest = N::of_signal(stage.guard.furthest.0);
        let end = N::of_signal(N::HIGHEST) - displacements * furthest;
        let last = stage.last.map(|e| N::of_signal(e.0).abs());
        last.is_some_and(|last| last < end)
    };
    let still = |force: Force<N>| force == Force::zero();
    (still(stage.state.force) || before_end(2)) && (still(stage.state.older) || before_end(1))
}

/// Whether a position is so near to the end of the range that the guard allows no force: within two largest displacements of that
/// end.
fn is_beyond_edge<N: Format>(stage: &Guarded<N>, e: Position<N>) -> bool {
    let furthest = N::of_signal(stage.guard.furthest.0);
    N::of_signal(e.0).abs() >= N::of_signal(N::HIGHEST) - 2 * furthest
}

/// Whether a guard's stage is as `Guard::new` makes it, its memory satisfies the guard's invariant, and every force that acts can
/// end before the end of positions.
pub fn stage_holds<N: Format>(stage: &Guarded<N>) -> bool {
    let still = stage.state.force == Force::zero();
    stage.guard.valid()
        && stage.guard.holds(&stage.state)
        && (!stage.tripped || still)
        && place_holds(stage)
}

/// Properties of the guard's stage at 8 bits.
pub mod w8 {
    use super::*;
    type N = Fixed8;

    property! {
        /// P4 (limits): after overspeed the guard's stage gives the force 0 and remembers no force, whatever the law requests.
        /// Until then the force is the guard's.
        equation "tripped  =>  f = 0, tripped'; else |f| <= |f_wanted|"
        over "valid configuration, memory in the invariant, sample, wanted force"
        by cadical fn p4_stage_latches(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| stage_holds(&it), "Guard::new; invariant, kept by p1_account_stays and p4_overspeed");
            let (e, wanted) = (N::any_position(s), N::any_force(s));
            let mut after = before;
            let force = after.tick(e, None, wanted);
            assert!(after.tripped || !before.tripped);
            assert!(force == after.state.force);
            assert!(!after.tripped || force == Force::zero());
            let (least, most) = (wanted.min(Force::zero()), wanted.max(Force::zero()));
            assert!(force >= least && force <= most);
            assert!(after.limited == (force != wanted) && after.last == Some(e));
            cover!(s, before.tripped && wanted != Force::zero(), "stays off");
            cover!(s, after.tripped && !before.tripped, "trips");
            cover!(s, force != Force::zero(), "a force");
        }
    }
    property! {
        /// P9 (end of positions): while a force acts or is on its way, the counted displacement is the true one, wherever the
        /// device goes. A position beyond the format's end is measured as that end; the motion there counts as overspeed.
        equation "f or f(n-1) /= 0, |Δ| <= d  =>  e = x, |e(n-1)| < end, for every x; and f' /= 0 => |e| < end - 2 d"
        over "valid configuration, memory in the invariant, true position of 16 bits, wanted force"
        by cadical fn p9_no_way_uncounted(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| stage_holds(&it), "Guard::new; invariant, kept by p1_account_stays, p4_overspeed and here");
            let wanted = N::any_force(s);
            let x = if s.shortcut() { N::of_signal(N::any_position(s).0) as i16 } else { s.u16().cast_signed() };
            let measured = x.clamp(i16::from(i8::MIN), i16::from(i8::MAX));
            let e = Position(I1F7::from_bits(measured as i8));
            let mut after = before;
            let _ = after.tick(e, None, wanted);
            assert!(place_holds(&after));
            let acts = before.state.force != Force::zero() || before.state.older != Force::zero();
            let moved = before.last.map_or(Position::zero(), |last| e - last).modulus();
            if acts && moved <= before.guard.furthest {
                let last = before.last.map(|last| N::of_signal(last.0));
                assert_reached!(measured == x && last.is_some_and(|last| last.abs() < N::of_signal(N::HIGHEST)));
            }
            cover!(s, acts && measured != x, "overspeed into the end");
            cover!(s, after.tripped && !before.tripped && after.state.older != Force::zero(), "the last force is on its way");
            cover!(s, before.state.older != Force::zero() && is_beyond_edge(&before, e) && moved <= before.guard.furthest, "and ends");
        }
    }
    property! {
        /// P7 (end of contact): a guard's stage that resumes keeps what is left in the energy account, at most its own capacity. It
        /// has no force and no overspeed.
        equation "B' = min(B, C'), f = 0, not tripped"
        over "two valid configurations, memory in the invariant of the one before"
        by cadical fn p7_stage_resumes(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| stage_holds(&it), "Guard::new; invariant, kept by p1_account_stays and p4_overspeed");
            let guard = such!(s, Guard::<N>::any(s), |it| it.valid(), "Guard::new");
            let after = Guarded::new(guard).resumed(&before);
            assert!(!after.tripped && after.last.is_none());
            let account = before.state.account.min(guard.capacity);
            assert!(after.state == GuardState { account, ..GuardState::default() });
            assert!(guard.holds(&after.state));
            cover!(s, before.state.account < Energy::zero(), "a deficit stays");
            cover!(s, before.state.account > guard.capacity, "a smaller account");
        }
    }
}

/// Properties of the guard's stage at 32 bits, for any results of its guard.
pub mod w32 {
    use super::*;
    type N = Fixed32;

    /// A guard's stage just before the end of the range of positions, and a position within one displacement of it. Random samples
    /// would hardly ever get there.
    fn at_the_edge<S: Source>(s: &mut S, guard: Guard<N>) -> (Guarded<N>, Position<N>) {
        let mut stage = Guarded::new(guard);
        let mut within = |most: Position<N>| {
            let bits = s.u32() & i32::MAX.cast_unsigned();
            Position::<N>(FixedI32::from_bits(
                bits.cast_signed() % (most.0.to_bits() + 1),
            ))
        };
        let reach = guard.furthest;
        let edge = Position(N::HIGHEST) - reach - reach;
        let before = edge - Position::quantum() - within(reach);
        let e = before + within(reach);
        let _ = stage.tick(before, None, N::any_force(s));
        (stage, e)
    }

    staged_property! {
        /// P9 (end of positions): the guard gets the displacement since the last sample, and 0 at the first sample. Near the end of
        /// the range of positions it gets the same, and the force is 0.
        equation "(memory, f) = guard(memory, e - e(n-1), x - e(n-1), f_wanted), none of x: 0; first sample: guard(memory, 0, x - e, f_wanted); beyond the edge f = 0"
        over "furthest displacement, memory, sample, with and without one at the change of force, wanted force; under the checker whatever the guard answers"
        by minisat fn p9_stage_measures(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| (cfg!(kani) || stage_holds(&it)) && room(&it.guard.furthest) && !it.tripped, "Guard::new; case: tripped is p4_stage_latches");
            let (before, e) = if s.shortcut() { at_the_edge(s, before.guard) } else { (before, N::any_position(s)) };
            let wanted = N::any_force(s);
            let at_change = s.bool().then(|| N::any_position(s));
            let mut after = before;
            let force = after.tick(e, at_change, wanted);
            let mut state = before.state;
            let from = before.last.unwrap_or(e);
            let (moved, before_change) = (e - from, at_change.map_or(Position::zero(), |x| x - from));
            let ends = wanted != Force::zero() && is_beyond_edge(&before, e);
            match before.guard.tick_with_change(&mut state, moved, before_change, wanted) {
                Ok(_) if ends => {
                    let none = GuardState { force: Force::zero(), ..state };
                    assert_reached!(after.tripped && force == Force::zero() && after.state == none);
                }
                Ok(alone) => assert_reached!(!after.tripped && alone == force && state == after.state),
                Err(_) => assert_reached!(after.tripped && state.account == after.state.account),
            }
            assert!(after.guard == before.guard && after.last == Some(e));
            cover!(s, before.last.is_none() && force != Force::zero(), "the first sample");
            cover!(s, before.last.is_some_and(|last| last != e) && !after.tripped, "moved");
            cover!(s, ends && after.state.older != Force::zero(), "a force ends there");
        }
    }

    /// The guard's stage with the axis reversed: the forces that it remembers have the other sign.
    fn reversed(stage: &Guarded<N>) -> Guarded<N> {
        let mut other = *stage;
        other.state.force = -stage.state.force;
        other.state.older = -stage.state.older;
        other
    }

    staged_property! {
        /// P9 (end of positions): an environment's positions may lie beyond the ends of the format, so its guard's stage gets the
        /// difference of the last two positions. If the force that acted was negative, the stage gets it with the axis reversed. At
        /// the end of the range of angles, the force is 0.
        equation "(memory, f) = moved(memory, e - e(n-1), e - e(n-1) - since, f_wanted), no e(n-1): 0, none of since: 0; f(n-1) < 0: all with the other sign; |e| at the end => f = 0"
        over "furthest displacement, memory, two positions of 64 bits in whole steps, with and without one at the change of force, wanted force; under the checker whatever the guard answers"
        by minisat fn p9_stage_without_end(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| (cfg!(kani) || stage_holds(&it)) && room(&it.guard.furthest), "Guard::new");
            let last = s.bool().then(|| Si::from_bits(s.i64() & !0xff));
            let now = if s.shortcut() && s.bool() {
                let step = i64::from(N::any_position(s).0.to_bits()) << 8;
                last.unwrap_or_default().saturating_add(Si::from_bits(step))
            } else {
                Si::from_bits(s.i64() & !0xff)
            };
            let since = s.bool().then(|| N::any_position(s));
            let wanted = N::any_force(s);
            let mut after = before;
            let force = after.tick_without_end(last, now, since, wanted);
            let steps = last.map_or(0, |last| (i128::from(now.to_bits()) - i128::from(last.to_bits())) >> 8);
            let bits = steps.clamp(i32::MIN.into(), i32::MAX.into()) as i32;
            let moved = Position::<N>(FixedI32::from_bits(bits));
            let before_change = since.map_or(Position::zero(), |since| moved - since);
            let acted = before.state;
            let turns = acted.force < Force::zero() || (acted.force == Force::zero() && acted.older < Force::zero());
            let ends = wanted != Force::zero() && now.saturating_abs() >= FURTHEST_ANGLE;
            let mut alone = if turns { reversed(&before) } else { before };
            alone.tripped |= ends;
            let given = if turns {
                -alone.moved(-moved, -before_change, -wanted)
            } else {
                alone.moved(moved, before_change, wanted)
            };
            let alone = if turns { reversed(&alone) } else { alone };
            assert!(after == alone && force == given);
            assert!(!ends || force == Force::zero());
            cover!(s, last.is_none() && force != Force::zero(), "the first sample");
            cover!(s, turns && force > Force::zero(), "a force that turns round");
            cover!(s, turns && force < Force::zero(), "a force against a negative motion");
            cover!(s, ends && !before.tripped, "where angles end");
            cover!(s, steps > i128::from(i32::MAX), "further than a displacement reaches");
        }
    }
}
