//! Proves that `AnyLaw`, the law chosen at run time, calls the law of its variant for a tick, for a view and for clearing the
//! memory.
//!
//! Which law is called does not depend on the values of products, quotients and roots. So the model checker replaces these, and the
//! parts of a tick, by small functions of their arguments and memory. The same functions are used on both sides of the comparison.
//! `refines.rs` and `refines_enhanced.rs` prove how a law uses the real operations.
//!
//! ```text
//! any law = the law      p11_any_law_*
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{cover, such};
use touchstone_control::estimator::EstimatedMotion;
use touchstone_control::law::{
    Damped, DampedState, EnhancedSfa, Fba, Law, Sample, Sfa, Spring, Tdpa,
};
use touchstone_control::velocity::{Smoothed, Velocity, VelocityState};
use touchstone_control::{AnyLaw, Fixed8, Force, Number as _};

type N = Fixed8;

/// Defines a property of `AnyLaw` in which small functions replace products, quotients and roots; `and [..]` lists further pairs of
/// a function and its replacement.
macro_rules! any_law_property {
    (and [$($pair:tt)*] $($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::Fixed8 as touchstone_control::Number>::scale, crate::any_law::small::scale)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::product, crate::any_law::small::product)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::work, crate::any_law::small::work)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::divide, crate::any_law::small::divide)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::divide_by, crate::any_law::small::divide_by)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::energy_per, crate::any_law::small::energy_per)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::root, crate::any_law::small::root)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::affordable, crate::any_law::small::affordable)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::passivity_step, crate::any_law::small::passivity_step)
            $($pair)*]
            $($property)*
        }
    };
    ($($property:tt)*) => {
        any_law_property!(and [] $($property)*);
    };
}

/// Functions that replace products, quotients and roots: cheap functions of the operands, so small that sums of their results do
/// not overflow.
#[cfg(kani)]
pub mod small {
    use touchstone_control::estimator::EstimatedMotion;
    use touchstone_control::law::{Contact, EnhancedSfa, EnhancedState};
    use touchstone_control::velocity::{Velocity, VelocityState};
    use touchstone_control::{Energy as OfWork, Fixed8, Force, Number, Position, Tension};

    type Signal = <Fixed8 as Number>::Signal;
    type Gain = <Fixed8 as Number>::Gain;
    type Energy = <Fixed8 as Number>::Energy;
    type Divisor = <Fixed8 as Number>::Divisor;

    fn of(a: i8, b: i8) -> Signal {
        Signal::from_bits((a ^ (b >> 1)) >> 3)
    }
    fn long(a: i8, b: i8) -> i16 {
        of(a, b).to_bits().into()
    }
    /// The exclusive OR of a double word's lower and upper half.
    fn folded(wide: i16) -> i8 {
        wide as i8 ^ (wide >> 8) as i8
    }

    pub fn scale(r: Signal, x: Signal) -> Signal {
        of(r.to_bits(), x.to_bits())
    }
    pub fn product(k: Gain, x: Signal) -> i16 {
        long(k.to_bits(), x.to_bits())
    }
    pub fn work(f: Signal, d: Signal) -> Energy {
        Energy::from_bits(long(f.to_bits(), d.to_bits()))
    }
    pub fn divide(p: i16, k: Gain) -> Signal {
        of(folded(p), k.to_bits())
    }
    pub fn divide_by(p: i16, k: &Divisor) -> Signal {
        of(folded(p), k.cast_signed())
    }
    pub fn energy_per(e: Energy, x: Signal) -> Signal {
        of(folded(e.to_bits()), x.to_bits())
    }
    pub fn root(e: Energy) -> Signal {
        of(folded(e.to_bits()), 0)
    }
    pub fn affordable(e: Energy, f: Signal) -> (Signal, Energy) {
        (energy_per(e, f), Energy::from_bits(e.to_bits() >> 1))
    }
    pub fn passivity_step(e: Energy, f: Signal, d: Signal) -> (Energy, Signal) {
        (
            Energy::from_bits(long(folded(e.to_bits()), d.to_bits())),
            of(f.to_bits(), d.to_bits()),
        )
    }
    /// Replaces `Velocity::tick` by a cheaper function when the model checker runs.
    pub fn velocity<N: Number>(
        _: &Velocity<N>,
        state: &mut VelocityState<N>,
        at: Position<N>,
    ) -> Position<N> {
        let before = match state {
            VelocityState::Motion(Some(motion)) => Position(N::narrow(motion.position)),
            _ => Position::quantum(),
        };
        let position = N::widen(at.0);
        *state = VelocityState::Motion(Some(EstimatedMotion {
            position,
            ..EstimatedMotion::default()
        }));
        at - before
    }
    /// Replaces `EnhancedSfa::hand_over` by a cheaper function when the model checker runs.
    pub fn hand_over<N: Number>(_: &EnhancedSfa<N>, state: &mut EnhancedState<N>) {
        state.contact = Contact::Augmenting;
        (state.augmented.mass.position, state.augmented.at_mass) = (state.last, state.force);
    }
    /// Replaces `EnhancedSfa::offset` by a cheaper function when the model checker runs.
    pub fn offset<N: Number>(
        _: &EnhancedSfa<N>,
        state: &EnhancedState<N>,
        e: Position<N>,
    ) -> Position<N> {
        e - state.augmented.offset
    }
    /// Replaces `EnhancedSfa::affordable_move` by a cheaper function when the model checker runs.
    pub fn affordable_move<N: Number>(
        _: &EnhancedSfa<N>,
        from: Position<N>,
        drive: Tension<N>,
        wanted: Force<N>,
        energy: &mut OfWork<N>,
    ) -> (Force<N>, Position<N>) {
        *energy = *energy + *energy;
        (drive.towards_zero().min(wanted), from)
    }
}

/// Asserts that `AnyLaw` does the same as the law of its variant in a tick, in a view and when the memory is cleared. Returns the
/// force.
fn dispatched<L, S: Source>(
    s: &mut S,
    any_law: fn(L, L::State) -> AnyLaw<N>,
    law: L,
    before: L::State,
) -> Force<N>
where
    L: Law<N> + Copy,
{
    let mut any = any_law(law, before);
    let sample = Sample {
        e: N::any_position(s),
        moved: N::any_position(s),
    };
    let mut state = before;
    let force = law.tick(&mut state, sample);
    assert!(any.tick(sample) == force && any == any_law(law, state));
    assert!(any.view() == law.view(&state));
    any.forget();
    assert_reached!(any == any_law(law, L::State::default()));
    force
}

any_law_property! {
    /// P11 (refinement): `AnyLaw` that holds a spring does the same as that spring.
    equation "tick, view, forget = the law's"
    over "valid configuration, memory in the invariant, sample; under the checker small functions in the place of products, quotients, roots and steps"
    by minisat fn p11_any_law_spring(s) {
        let law = such!(s, Spring::<N>::any(s), |law| law.valid(), "validate");
        let before = such!(s, <Spring<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
        let force = dispatched(s, AnyLaw::Spring, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
/// Any state of the velocity filter of a spring: at rest at any position, or as before the first sample.
fn any_motion<S: Source>(s: &mut S) -> VelocityState<N> {
    let position = N::widen(N::any_position(s).0);
    let motion = EstimatedMotion {
        position,
        ..EstimatedMotion::default()
    };
    VelocityState::Motion(s.bool().then_some(motion))
}
any_law_property! {
    and [(touchstone_control::velocity::Velocity::tick, crate::any_law::small::velocity)]
    /// P11 (refinement): `AnyLaw` that holds a spring with a velocity filter does the same as that spring.
    equation "tick, view, forget = the law's"
    over "valid spring, filter of any share, memory of the spring and of a position or none, sample; under the checker small functions in the place of the filter, products and roundings"
    by minisat fn p11_any_law_damped(s) {
        let spring = such!(s, Spring::<N>::any(s), |law| law.valid(), "validate");
        let velocity = Velocity::Smoothed(Smoothed { share: s.i32() & i32::MAX });
        let law = Damped { spring, velocity };
        let before = DampedState { spring: <Spring<N> as Valid<N>>::any_state(s), velocity: any_motion(s) };
        let force = dispatched(s, AnyLaw::Damped, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
any_law_property! {
    /// P11 (refinement): `AnyLaw` that holds a TDPA law (time-domain passivity) does the same as that law.
    equation "tick, view, forget = the law's"
    over "valid configuration, memory in the invariant, sample; under the checker small functions in the place of products, quotients, roots and steps"
    by minisat fn p11_any_law_tdpa(s) {
        let law = such!(s, Tdpa::<N>::any(s), |law| law.valid(), "validate");
        let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
        let force = dispatched(s, AnyLaw::Tdpa, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
any_law_property! {
    /// P11 (refinement): `AnyLaw` that holds a force bounding law does the same as that law.
    equation "tick, view, forget = the law's"
    over "valid configuration, memory in the invariant, sample; under the checker small functions in the place of products, quotients, roots and steps"
    by minisat fn p11_any_law_fba(s) {
        let law = such!(s, Fba::<N>::any(s), |law| law.valid(), "validate");
        let before = such!(s, <Fba<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
        let force = dispatched(s, AnyLaw::Fba, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
any_law_property! {
    /// P11 (refinement): `AnyLaw` that holds an SFA law (successive force augmentation) does the same as that law.
    equation "tick, view, forget = the law's"
    over "valid configuration, memory in the invariant, sample; under the checker small functions in the place of products, quotients, roots and steps"
    by minisat fn p11_any_law_sfa(s) {
        let law = such!(s, Sfa::<N>::any(s), |law| law.valid(), "validate");
        let before = such!(s, <Sfa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
        let force = dispatched(s, AnyLaw::Sfa, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
any_law_property! {
    and [(touchstone_control::law::EnhancedSfa::hand_over, crate::any_law::small::hand_over)
    (touchstone_control::law::EnhancedSfa::offset, crate::any_law::small::offset)
    (touchstone_control::law::EnhancedSfa::affordable_move, crate::any_law::small::affordable_move)]
    /// P11 (refinement): `AnyLaw` that holds an enhanced law does the same as that law.
    equation "tick, view, forget = the law's"
    over "valid configuration, memory in the invariant, sample; under the checker small functions in the place of products, quotients, hand-over, offset and paid move"
    by minisat fn p11_any_law_enhanced(s) {
        let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
        let before = such!(s, <EnhancedSfa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p1_* and p4_*");
        let force = dispatched(s, AnyLaw::Enhanced, law, before);
        cover!(s, force != Force::zero(), "a force");
    }
}
