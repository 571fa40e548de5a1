//! The guard as a stage of the controller (`control/src/guard/guarded.rs`): what it measures, that overspeed latches, and what is left of
//! its memory when it is taken up again.
//!
//! ```text
//! tripped => f = 0, tripped'                 p4_stage_latches
//! Δ = e - e(n-1), none at the first sample   p9_stage_measures
//! resumed: B' = min(B, C'), f = 0            p7_stage_resumes
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{cover, property, such};
use touchstone_control::{Energy, Fixed8, Force, Guard, GuardState, Guarded, Position};

/// Any stage whose memory satisfies the guard's invariant.
fn any_stage<N: Format, S: Source>(s: &mut S) -> Guarded<N> {
    Guarded {
        guard: Guard::any(s),
        state: <Guard<N> as Valid<N>>::any_state(s),
        last: s.bool().then(|| N::any_position(s)),
        limited: s.bool(),
        tripped: s.bool(),
    }
}

fn stage_holds<N: Format>(stage: &Guarded<N>) -> bool {
    let still = stage.state.force == Force::zero();
    stage.guard.valid() && stage.guard.holds(&stage.state) && (!stage.tripped || still)
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
        /// P9: the displacement that the guard is told is that since the last sample, and none at the first.
        equation "(memory, f) = guard(memory, e - e(n-1), f_wanted); first sample: guard(memory, 0, f_wanted)"
        over "valid configuration, memory in the invariant, sample, wanted force"
        by cadical fn p9_stage_measures(s) {
            let before = such!(s, any_stage::<N, S>(s), |it| stage_holds(&it) && !it.tripped, "Guard::new; invariant; case: tripped is p4_stage_latches");
            let (e, wanted) = (N::any_position(s), N::any_force(s));
            let mut after = before;
            let force = after.tick(e, None, wanted);
            let mut state = before.state;
            let moved = before.last.map_or(Position::zero(), |last| e - last);
            match before.guard.tick(&mut state, moved, wanted) {
                Ok(alone) => assert!(!after.tripped && alone == force && state == after.state),
                Err(_) => assert!(after.tripped && state.account == after.state.account),
            }
            cover!(s, before.last.is_none() && force != Force::zero(), "the first sample");
            cover!(s, before.last.is_some_and(|last| last != e) && !after.tripped, "moved");
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
