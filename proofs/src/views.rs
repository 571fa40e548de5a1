//! Properties of values for telemetry and of measurements: the laws' views, the observers alone, a law's input, and the guard on
//! the mirrored axis.
//!
//! `E` is the energy, `f` the force, `x` a position, `e` a penetration, `Δ` a displacement; `'` marks the new value.
//!
//! ```text
//! view = what the memory holds             p11_view_*
//! E' = E + f(n-1) (x - x(n-1))             p1_observer_exact
//! E' = E + f (x - x(n-1))                  p1_observer_thesis
//! Δ = e - e(n-1)                           p11_sample
//! f = -guard(-Δ, -f_wanted | -f(n-1))      p11_guard_mirrored
//! ```

use crate::format::Format;
use crate::stage::{any_stage, stage_holds};
use crate::valid::Valid;
use crate::{cover, property, staged_property, such};
use touchstone_control::law::{Contact, EnhancedSfa, Fba, Law, Sample, Sfa, Spring, Tdpa, View};
use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{Energy, Fixed8, Fixed32, Force, Number, Position};

type N = Fixed8;

const fn contact(inside: bool) -> Contact {
    match inside {
        true => Contact::First,
        false => Contact::Free,
    }
}

property! {
    /// P11 (refinement): the view (values for telemetry) of a law without an offset tells whether it is in contact, and the energy
    /// if the law observes one.
    equation "view = (inside, E)"
    over "law, memory"
    fn p11_view_without_offset(s) {
        let none = View { contact: Contact::Free, energy: None, offset: Position::zero(), mass: None };
        let state = <Spring<N> as Valid<N>>::any_state(s);
        assert!(Spring::<N>::any(s).view(&state) == View { contact: contact(state.inside), ..none });
        let state = <Tdpa<N> as Valid<N>>::any_state(s);
        let view = View { contact: contact(state.inside), energy: Some(state.energy), ..none };
        assert!(Tdpa::<N>::any(s).view(&state) == view);
        cover!(s, state.inside, "in contact");
        let state = <Fba<N> as Valid<N>>::any_state(s);
        let view = View { contact: contact(state.inside), energy: Some(state.energy), ..none };
        assert!(Fba::<N>::any(s).view(&state) == view);
        cover!(s, !state.inside, "free");
    }
}
property! {
    /// P11 (refinement): the view (values for telemetry) of SFA has its contact phase and offset. That of the enhanced law also has
    /// the energy without the lent part, and the virtual mass while it is in use.
    equation "view = (contact, E - loan, O, x_m)"
    over "law, memory"
    fn p11_view_with_offset(s) {
        let (law, state) = (Sfa::<N>::any(s), <Sfa<N> as Valid<N>>::any_state(s));
        let view = View { contact: state.contact, energy: None, offset: state.offset, mass: None };
        assert!(law.view(&state) == view);
        let (law, state) = (EnhancedSfa::<N>::any(s), <EnhancedSfa<N> as Valid<N>>::any_state(s));
        let view = law.view(&state);
        assert!(view.contact == state.contact && view.offset == state.augmented.offset);
        let energy = match state.contact {
            Contact::Free => 0,
            Contact::First | Contact::Augmenting => {
                (N::of_energy(state.energy.0) - N::of_energy(law.credit.0)).clamp(i64::from(i16::MIN), i64::from(i16::MAX))
            }
        };
        assert!(view.energy.map(|shown| N::of_energy(shown.0)) == Some(energy));
        let mass = match state.contact {
            Contact::Augmenting => Some(state.augmented.mass.position),
            Contact::Free | Contact::First => None,
        };
        assert!(view.mass == mass);
        cover!(s, mass.is_some() && energy < 0, "on loan");
        cover!(s, state.contact == Contact::Free, "free");
    }
}
/// The bits of an 8-bit position or force as an integer.
fn bits(x: <N as Number>::Signal) -> i32 {
    x.to_bits().into()
}

property! {
    /// P1 (energy): the exact observer's energy grows by last force times displacement, for positions and forces of 8 bits.
    equation "E(n) = E(n-1) + f(n-1) (x(n) - x(n-1))"
    over "start, two ticks of position and force"
    by kissat fn p1_observer_exact(s) {
        let mut at = N::any_position(s);
        let mut observer = ExactObserver::new(at);
        assert_reached!(observer.energy == Energy::zero());
        let (mut energy, mut acted) = (0, 0);
        for _ in 0..2 {
            let (x, force) = (N::any_position(s), N::any_force(s));
            let moved = (bits(x.0) - bits(at.0)).clamp(-128, 127);
            energy = (energy + acted * moved).clamp(i16::MIN.into(), i16::MAX.into());
            (at, acted) = (x, bits(force.0));
            let shown = observer.tick(x, force);
            assert!(i32::from(shown.0.to_bits()) == energy && shown == observer.energy);
            cover!(s, energy < 0, "has given energy");
        }
    }
}
property! {
    /// P1 (energy): the thesis' observer multiplies the displacement by the new force, not by the last one.
    equation "E(n) = E(n-1) + f(n) (x(n) - x(n-1))"
    over "start, two ticks of position and force"
    by kissat fn p1_observer_thesis(s) {
        let mut at = N::any_position(s);
        let mut observer = ThesisObserver::new(at);
        assert_reached!(observer.energy == Energy::zero());
        let mut energy = 0;
        for _ in 0..2 {
            let (x, force) = (N::any_position(s), N::any_force(s));
            let moved = (bits(x.0) - bits(at.0)).clamp(-128, 127);
            energy = (energy + bits(force.0) * moved).clamp(i16::MIN.into(), i16::MAX.into());
            at = x;
            let shown = observer.tick(x, force);
            assert!(i32::from(shown.0.to_bits()) == energy && shown == observer.energy);
            cover!(s, energy < 0, "has given energy");
        }
    }
}
property! {
    /// P11 (refinement): the displacement in a law's input is the difference of two positions, limited to the format. Inside the
    /// wall it is at most the penetration.
    equation "Δ = e - e(n-1); inside min(Δ, e)"
    over "two positions"
    fn p11_sample(s) {
        let (e, last) = (N::any_position(s), N::any_position(s));
        let sample = Sample::measured(e, last);
        let moved = (N::of_signal(e.0) - N::of_signal(last.0)).clamp(-128, 127);
        assert!(sample.e == e && N::of_signal(sample.moved.0) == moved);
        assert!(N::of_signal(sample.moved_inside().0) == moved.min(N::of_signal(e.0)));
        cover!(s, moved > N::of_signal(e.0), "the surface lay between");
    }
}
staged_property! {
    /// P11 (refinement): the guard on the mirrored axis gives the mirrored result: displacements and forces have the opposite sign.
    equation "f = -guard(-Δ, -f_wanted | -f(n-1))"
    over "memory, displacement, the part before the change, wanted force; under the checker whatever the guard answers"
    by minisat fn p11_guard_mirrored(s) {
        let before = such!(s, any_stage::<Fixed32, S>(s), |it| cfg!(kani) || stage_holds(&it), "of samples: Guard::new; invariant, kept by p1_account_stays and p4_overspeed");
        let (moved, before_change, wanted) = (Fixed32::any_position(s), Fixed32::any_position(s), Fixed32::any_force(s));
        let mut seen = before;
        (seen.state.force, seen.state.older) = (-before.state.force, -before.state.older);
        let other = seen.moved(-moved, -before_change, -wanted);
        let mut stage = before;
        let force = stage.moved_mirrored(moved, before_change, wanted);
        assert!(force == -other && stage.tripped == seen.tripped && stage.limited == seen.limited);
        let state = stage.state;
        assert!(state.account == seen.state.account);
        assert!(state.force == -seen.state.force && state.older == -seen.state.older);
        cover!(s, force != Force::zero(), "a force");
        cover!(s, stage.tripped, "overspeed");
    }
}
