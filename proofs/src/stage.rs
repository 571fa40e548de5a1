//! The guard as a stage of the controller (`control/src/guard/guarded.rs`): what it measures, that no motion under a force goes
//! uncounted where positions end, that overspeed latches, and what is left of its memory when it is taken up again.
//!
//! ```text
//! tripped => f = 0, tripped'                 p4_stage_latches
//! Δ = e - e(n-1), none at the first sample   p9_stage_measures
//! f acts => Δ = x - x(n-1), x without end    p9_no_way_uncounted
//! resumed: B' = min(B, C'), f = 0            p7_stage_resumes
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{cover, property, such};
use fixed::types::I1F7;
use touchstone_control::{Energy, Fixed8, Force, Guard, GuardState, Guarded, Position};

/// Any stage whose memory satisfies the guard's invariant.
pub fn any_stage<N: Format, S: Source>(s: &mut S) -> Guarded<N> {
    let mut stage = Guarded::new(Guard::any(s));
    stage.state = <Guard<N> as Valid<N>>::any_state(s);
    stage.last = s.bool().then(|| N::any_position(s));
    stage.limited = s.bool();
    stage.tripped = s.bool();
    stage
}

/// Where the last sample was, a force that acts can end before a displacement reaches the end of what positions can say; without
/// a last sample none acts.
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

/// Whether no force is shown there: from two furthest displacements before the format's end on, to either side.
fn is_beyond_edge<N: Format>(stage: &Guarded<N>, e: Position<N>) -> bool {
    let furthest = N::of_signal(stage.guard.furthest.0);
    N::of_signal(e.0).abs() >= N::of_signal(N::HIGHEST) - 2 * furthest
}

/// What `Guard::new` sees to, the guard's invariant, and that a force that acts can end.
pub fn stage_holds<N: Format>(stage: &Guarded<N>) -> bool {
    let still = stage.state.force == Force::zero();
    stage.guard.valid()
        && stage.guard.holds(&stage.state)
        && (!stage.tripped || still)
        && place_holds(stage)
}

/// At 8 bits.
pub mod w8 {
    use super::*;
    type N = Fixed8;

    property! {
        /// P4: once there was overspeed no force is shown and none is remembered, whatever is wanted; until then the force is the guard's.
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
            if wanted >= Force::zero() {
                assert!(force >= Force::zero() && force <= wanted);
            } else {
                assert!(force <= Force::zero() && force >= wanted);
            }
            assert!(after.limited == (force != wanted) && after.last == Some(e));
            cover!(s, before.tripped && wanted != Force::zero(), "stays off");
            cover!(s, after.tripped && !before.tripped, "trips");
            cover!(s, force != Force::zero(), "a force");
        }
    }
    property! {
        /// P9: the displacement that the guard is told is that since the last sample, and none at the first; at the end of what positions
        /// can say the same is booked, and the force is none.
        equation "(memory, f) = guard(memory, e - e(n-1), f_wanted); first sample: guard(memory, 0, f_wanted); beyond the edge f = 0"
        over "valid configuration, memory in the invariant, sample, wanted force"
        by kissat fn p9_stage_measures(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| stage_holds(&it) && !it.tripped, "Guard::new; invariant; case: tripped is p4_stage_latches");
            let (e, wanted) = (N::any_position(s), N::any_force(s));
            let mut after = before;
            let force = after.tick(e, None, wanted);
            let mut state = before.state;
            let moved = before.last.map_or(Position::zero(), |last| e - last);
            let ends = wanted != Force::zero() && is_beyond_edge(&before, e);
            match before.guard.tick(&mut state, moved, wanted) {
                Ok(_) if ends => {
                    let none = GuardState { force: Force::zero(), ..state };
                    assert!(after.tripped && force == Force::zero() && after.state == none);
                }
                Ok(alone) => assert!(!after.tripped && alone == force && state == after.state),
                Err(_) => assert!(after.tripped && state.account == after.state.account),
            }
            cover!(s, before.last.is_none() && force != Force::zero(), "the first sample");
            cover!(s, before.last.is_some_and(|last| last != e) && !after.tripped, "moved");
            cover!(s, ends && after.state.older != Force::zero(), "a force ends there");
        }
    }
    property! {
        /// P9: while a force acts, or one is still on its way, what is counted is the true displacement, wherever the device goes: a
        /// position beyond the format's end, which is measured as that end, is overspeed first.
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
                assert!(measured == x && last.is_some_and(|last| last.abs() < N::of_signal(N::HIGHEST)));
            }
            cover!(s, acts && measured != x, "overspeed into the end");
            cover!(s, after.tripped && !before.tripped && after.state.older != Force::zero(), "the last force is on its way");
            cover!(s, before.state.older != Force::zero() && is_beyond_edge(&before, e) && moved <= before.guard.furthest, "and ends");
        }
    }
    property! {
        /// P7: taken up again, it has the account that was left, or its own capacity if that is less, no force, and no overspeed.
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
